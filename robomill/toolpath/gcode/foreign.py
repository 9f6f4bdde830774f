"""Words of languages that are not read, so that a refusal can name the word and its language, and say what to do."""

import re
from collections.abc import Mapping

_LEFT_OUT = re.compile(r"\([^()]*\)|;.*|<[^>]*>")
_WORD = re.compile(r"([a-z_]{2,})\d*(?:dc?[cf]?\b)?")
_VARIABLE = re.compile(r"(?:\d*n\d+)?([a-z]+\d*)$")

LANGUAGES = {
    "Fanuc's Macro B": (
        "if while goto then do end",
        "choose the dialect Fanuc-like, or write branches and loops as O words (O1 while [#1 LT 5])",
    ),
    "Sinumerik's splines": (
        "bspline aspline cspline poly",
        "let the CAM system write straight moves and arcs (G1, G2, G3)",
    ),
    "Heidenhain's dialogue": (
        "begin tool cycl lbl blk call cc fmax",
        "let the CAM system write G-code (DIN/ISO)",
    ),
    "Sinumerik": (
        "trans atrans rot arot scale ascale mirror amirror if else endif while endwhile for endfor repeat until loop "
        "endloop gotof gotob gotoc case call mcall extern proc ret def set cycle pocket slot holes longhole supa "
        "workpiece cut transmit tracyl traori trafoof oriwks orimks stopre diamon diamof msg print",
        "let the CAM system write the moves out, without swivels, pockets and variables of its own",
    ),
}
"""Languages: their words, of which two may have the same, and what to do about them."""


def said_of(raw: str, text: str, at: int) -> str:
    """What to say of a word where a value should be, at ``text[at]`` or a letter before; ``""`` if it is none.

    ``text`` is the line ``raw`` in lower case without blanks.
    """
    code = _LEFT_OUT.sub(" ", raw.lower())
    variable = _VARIABLE.search(text[:at])
    if text[at : at + 1] == "=" and variable is not None:
        remedy = LANGUAGES["Sinumerik"][1]
        return f"{variable[1].upper()}= is written as on a Sinumerik, with what is no number; {remedy}."
    for word in _WORD.finditer(code):
        if text.startswith(word[0], max(at - 1, 0)) or text.startswith(word[0], at):
            known = [(name, remedy) for name, (words, remedy) in LANGUAGES.items() if word[1] in words.split()]
            if known:  # of words that two languages have, the macro language's stand before brackets
                name, remedy = known[0 if "[" in code or "#" in code else -1]
                return f"{word[0].upper()} is a word of {name}, which is not read; {remedy}."
            return f"{word[0].upper()} is a word that is not known; expected letters with numbers, such as X10."
    return ""


def meant_elsewhere(letter: str, words: Mapping[str, float], control: str, arc: bool) -> str:
    """What a word that nothing on its line uses means, where it must not be left out; "" for others.

    ``arc`` says that the line moves along one.
    """
    if control == "fanuc" and arc and letter in "lq":
        return f"{letter.upper()} beside G2 or G3 makes a spiral or a cone (Fanuc), which is not read; write its moves."
    if control == "sinumerik":
        texts = {
            "e": "E is no word of a Sinumerik; it writes 1000 as 1EX3, with EX for times ten to the.",
            "l": f"L{words.get('l', 0.0):g} calls a subprogram; put it on a line of its own.",
        }
        return texts.get(letter, "")
    if letter == "e":
        return "E chooses a fixture (Fadal) or feeds filament (a 3D printer), which is not read; write G54."
    if letter == "l" and len(words) == 1:
        return f"L{words['l']:g} alone begins or calls a subprogram (Fadal, Sinumerik); choose Sinumerik if it is one."
    return ""


FIRST_LINES = 40
"""Lines at the start of a file in which a language is told by its own words."""
_TOLD = (
    (
        "KUKA KRL",
        r"&(?:ACCESS|REL|PARAM)\b|(?:GLOBAL[ \t]+)?DEF[ \t]+\w+[ \t]*\([^\n]*\)[ \t]*$|;FOLD\b|(?:PTP|LIN)[ \t]*\{",
    ),
    (
        "ABB RAPID",
        r"%%%|MODULE[ \t]+\w+|(?:PERS|CONST)[ \t]+(?:robtarget|tooldata|wobjdata)\b|[ \t]*Move(?:[LJC]|AbsJ)[ \t]",
    ),
    ("Fanuc's robot language (TP)", r"/PROG\b|/ATTR\b|[ \t]*\d*:[ \t]*[JLC][ \t]+P\["),
    ("Yaskawa's INFORM", r"/JOB\b|//(?:NAME|POS|INST)\b"),
    ("Kawasaki's AS", r"\.PROGRAM\b"),
    ("Mitsubishi's MELFA", r"\d+[ \t]+M(?:OV|VS)[ \t]+P"),
    ("a robot's PDL2 or KAREL", r"PROGRAM[ \t]+\w+[ \t]*$"),
    ("URScript or VAL3", r"def[ \t]+\w+\([^\n]*\):|[ \t]*(?:movel|movej|movep|set_tcp)[ \t]*\("),
    (
        "Okuma's OSP",
        r"\$[\w-]+\.(?:MIN|SSB|SUB|LIB)\b|[^(;\n]*\bG15[ \t]*H[ \t]*\d|[^(;\n]*\bG8[1-9]\b[^(;\n]*\bM5[345]\b|"
        r"(?![^\n]*G43)[^(;\n]*\bG56\b[^(;\n]*\bH[ \t]*\d",
    ),
    ("a 3D printer's G-code", r"[ \t]*(?:N\d+[ \t]*)?(?:G92[ \t]*E[ \t]*-?[\d.]|M1(?:04|09)[ \t]+S\d)"),
    ("Fagor's language", r"%[^\n,]*,M[XYZ]*,"),
    ("HPGL (a plotter's language)", r"(?:IN|PU|PD|SP\d?);"),
    ("Gerber (a circuit board's layer)", r"%FS[LT][AI]X\d"),
    (  # M48 alone is an M word of G-code, too
        "Excellon (a circuit board's holes)",
        r"M48[ \t\r]*\n(?:[^\n]*\n){0,9}?(?:INCH\b|METRIC\b|FMAT\b|VER,|ICI\b|T\d+(?:[FS]\d+)*C\d*\.\d)",
    ),
    ("ShopBot's language", r"(?:SA|SR)[ \t]*$|(?:VD|MS|JS|M[23XYZ]|J[23XYZ])[ \t]*,[ \t]*[-.\d]"),
    ("a page of the web (HTML)", r"[ \t]*<(?:!DOCTYPE[ \t]+html|html)\b"),
    ("a pointer of Git LFS, in place of the file", r"version https://git-lfs"),
    ("a DXF drawing", r"[ \t]*0[ \t]*\n[ \t]*SECTION\b"),
    ("an STL surface", r"solid[ \t]*\w*[^\n]*\n[ \t]*facet\b"),
    ("STEP", r"ISO-10303-21;"),
)
_BRACKETED = (
    ("Fagor's language", r"(?:N\d+[ \t]*)?\((?:(?:RPT|GOTO)[ \t]*N\d|CALL[ \t]*\d+\)[ \t]*$)"),
    ("OSAI's language", r"(?:N\d+[ \t]*)?\((?:(?:U[TA]O|RPT|DIS|TMR),|ERP\)[ \t]*$)"),
)
"""Languages whose statements stand in brackets, which are comments to a control whose programs have a number O."""
_NUMBERED = re.compile(r"^[ \t]*O\d+", re.MULTILINE | re.IGNORECASE)
_REMEDY = "expected G-code, Heidenhain's dialogue or APT; let the CAM system write one of them."


def language_of(text: str) -> tuple[int, str] | None:
    """Line (1-based) and refusal of a file whose first lines are another language's; None for what may be G-code."""
    head = "\n".join(text.split("\n")[:FIRST_LINES])
    for name, pattern in _TOLD if _NUMBERED.search(head) else (*_TOLD, *_BRACKETED):
        found = re.search(rf"^(?:{pattern})", head, re.MULTILINE | re.IGNORECASE)
        if found is not None:
            return head.count("\n", 0, found.start()) + 1, f"this is {name}, which is not read; {_REMEDY}"
    return None
