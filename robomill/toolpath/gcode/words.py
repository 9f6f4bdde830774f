"""One line of a program, as words: letters with values, G and M codes by modal group, settings and comments."""

from dataclasses import dataclass, field

from robomill.errors import GCodeError
from robomill.toolpath.gcode.codes import COOLANT, G_GROUPS, M_GROUPS, g_name
from robomill.toolpath.gcode.expressions import Reader
from robomill.toolpath.gcode.foreign import said_of
from robomill.toolpath.gcode.parameters import MAX_SETTINGS, Parameters
from robomill.toolpath.tools import MOST

_BLANKS = str.maketrans("", "", " \t\r\f\v\x1a\xa0")
_VALUE_LETTERS = frozenset("abcdefhijklpqrstuvwxyz$@^")
_WHOLE = {"h": "The H word", "l": "The L word", "t": "The T word"}
_NOT_NEGATIVE = {"f": "A feed rate", "s": "A spindle speed", "t": "A tool number", "h": "An H word", "l": "An L word"}


@dataclass(slots=True)
class Block:
    """What a line says. ``words`` maps letters (``@`` polar radius, ``^`` polar angle) to values.

    ``g`` and ``m`` map modal groups to codes (G codes ten times their number); ``motion_rules`` is the G code of the
    motion that the line makes, -1 for none. ``twice`` is the refusal that LinuxCNC has for words that other controls
    take together (G0 G0, M7 M8). ``falls`` says that I, J and K are the first, the fall and the least of Haas's pecks;
    ``then`` is the tool that Mazak's T1 T2 M6 makes ready for the next change, ``bolts`` are places around a circle
    where the cycle of the line drills. ``once`` is the motion that is in force again behind a line whose
    own motion holds for it alone (Sinumerik's G63, Fanuc's G31), -1 for none.
    """

    line: int
    words: dict[str, float] = field(default_factory=dict)
    g: dict[int, int] = field(default_factory=dict)
    m: dict[int, int] = field(default_factory=dict)
    settings: list[tuple[int | str, float]] = field(default_factory=list)
    comment: str = ""
    unknown_m: list[int] = field(default_factory=list)
    unknown_g: list[int] = field(default_factory=list)
    motion: int = -1
    twice: str = ""
    falls: bool = False
    then: int = -1
    bolts: list[tuple[float, float]] = field(default_factory=list)
    once: int = -1

    def refuse(self, message: str) -> GCodeError:
        """The error to raise: ``message`` with the line in front."""
        return GCodeError.at(self.line, message)


_BRACKETS = str.maketrans("()", "[]")


def normalise(raw: str, line: int) -> str:
    """``raw`` in lower case without blanks; what is in ``( )`` and after ``;`` stays as written."""
    if "(" not in raw and ";" not in raw:
        return raw.translate(_BLANKS).lower()
    out, at = [], 0
    while at < len(raw):
        bracket, semicolon = raw.find("(", at), raw.find(";", at)
        if semicolon >= 0 and (bracket < 0 or semicolon < bracket):
            out += [raw[at:semicolon].translate(_BLANKS).lower(), raw[semicolon:]]
            break
        if bracket < 0:
            out.append(raw[at:].translate(_BLANKS).lower())
            break
        close, nested = raw.find(")", bracket), raw.find("(", bracket + 1)
        if close < 0:
            raise GCodeError.at(line, "a comment is not closed; add ).")
        if 0 <= nested < close:
            raise GCodeError.at(line, "a comment holds another (; comments cannot be nested.")
        out += [raw[at:bracket].translate(_BLANKS).lower(), raw[bracket : close + 1]]
        at = close + 1
    return "".join(out)


def flattened(raw: str) -> str:
    """``raw`` with brackets for the parentheses within its comments: ``(DRILL (HSS))`` is one comment where they pair,
    else it ends at the first that closes, as on grbl and on Fanuc's controls."""
    out, at = "", 0
    while (begin := raw.find("(", at)) >= 0 and ";" not in raw[at:begin]:
        depth, end = 1, begin + 1
        while end < len(raw) and depth:
            depth += {"(": 1, ")": -1}.get(raw[end], 0)
            end += 1
        end = raw.find(")", begin) + 1 if depth else end
        if end == 0:
            break
        out += f"{raw[at:begin]}({raw[begin + 1 : end - 1].translate(_BRACKETS)})"
        at = end
    return out + raw[at:]


def skip_number(reader: Reader) -> None:
    """Pass the block delete slash and the N number at the start of a line, in this order or the other."""
    text = reader.text
    if text.startswith("/", reader.at):
        reader.at += 1
        while text[reader.at : reader.at + 1].isdigit():
            reader.at += 1
    if text[reader.at : reader.at + 1] == "n":
        end = reader.at + 1
        while end < len(text) and (text[end].isdigit() or text[end] == "."):
            end += 1
        if end == reader.at + 1:
            raise reader.refuse(f"N is followed by {text[end : end + 10] or 'nothing'!r}; expected a line number.")
        reader.at = end
        if text.startswith("/", end):
            skip_number(reader)


def read_words(reader: Reader, diameter_mode: bool = False) -> Block:
    """The rest of the line as a Block. Settings are collected, not made: they take effect after the line."""
    block = Block(reader.line)
    text = reader.text
    while reader.at < len(text):
        letter = text[reader.at]
        if letter == "g":
            _read_g(reader, block)
        elif letter in _VALUE_LETTERS:
            _read_value(reader, block, letter)
        elif letter == "m":
            _read_m(reader, block)
        elif letter == "(":
            end = text.index(")", reader.at)
            block.comment = text[reader.at + 1 : end]
            reader.at = end + 1
        elif letter == ";":
            break
        elif letter == "#":
            _read_setting(reader, block)
        else:
            raise reader.refuse(_bad_character(reader))
    if diameter_mode and "x" in block.words:
        block.words["x"] /= 2.0
    return block


def _bad_character(reader: Reader) -> str:
    text, at = reader.text, reader.at
    letter = text[at]
    if letter == "," and at and text[at - 1].isdigit():
        return f"{text[max(at - 6, 0) : at + 3]!r} has a decimal comma; write a point."
    if letter == "n":
        return "N is not at the start of the line; a line number comes first."
    if letter == "o" and at and text[at - 1].isdigit() and text[at + 1 : at + 2] in (".", ""):
        return f"{text[max(at - 3, 0) : at + 3]!r} has a letter O among its digits; write the digit 0."
    if letter == "o":
        return "an O word is not at the start of the line; put it on a line of its own."
    if letter == "=":
        return said_of(reader.raw, text, at) or "found = without a parameter before it; expected #1= and a value."
    if letter in "+-*":
        return f"found {text[at : at + 20]!r} after a value; an expression stands in [ ], as in #1=[#2+1]."
    shown = letter if letter.isprintable() else f"\\x{ord(letter):02x}"
    return f"found {shown!r} where a word should start; expected a letter with a value."


def _read_value(reader: Reader, block: Block, letter: str) -> None:
    twice = f"{letter.upper()} is given twice; a word can stand on a line once."
    if letter in block.words and (letter != "t" or block.then >= 0):
        raise reader.refuse(twice)
    reader.at += 1
    value = reader.value()
    if letter in _WHOLE:
        nearest = float(round(value))
        if abs(value - nearest) > 1e-4:
            raise reader.refuse(f"{_WHOLE[letter]} is {value:g}; expected a whole number.")
        value = nearest
    if value < 0 and letter in _NOT_NEGATIVE:
        raise reader.refuse(f"{_NOT_NEGATIVE[letter]} is {value:g}; it cannot be negative.")
    if letter == "t" and value > MOST:
        raise reader.refuse(f"A tool number is {value:g}; tool numbers run up to {MOST}.")
    if letter in block.words:
        block.then, block.twice = round(value), twice
        return
    block.words[letter] = value


def _read_g(reader: Reader, block: Block) -> None:
    reader.at += 1
    number = reader.value()
    if not 0.0 <= number < 1000.0 or abs(10.0 * number - round(10.0 * number)) > 0.01:
        raise reader.refuse(f"G{number:g} is not a G code.")
    code = round(10.0 * number)
    group = G_GROUPS.get(code)
    if group is None:
        block.unknown_g.append(code)
        return
    if code == 800 and group in block.g:
        return
    if block.g.get(group, 800) != 800:
        text = f"{g_name(block.g[group])} and {g_name(code)} are of one modal group; a line can hold one of them."
        if block.g[group] != code:
            raise reader.refuse(text)
        block.twice = text
    block.g[group] = code


def _read_m(reader: Reader, block: Block) -> None:
    reader.at += 1
    code = reader.integer("An M code")
    if code < 0:
        raise reader.refuse(f"M{code} is not an M code.")
    group = M_GROUPS.get(code)
    if group is None:
        block.unknown_m.append(code)
        return
    if group in block.m:
        text = f"M{block.m[group]} and M{code} are of one modal group; a line can hold one of them."
        if block.m[group] != code and not (group == COOLANT and code != 9 != block.m[group]):
            raise reader.refuse(text)
        block.twice = text
    block.m[group] = code
    if len(block.m) > 4:
        raise reader.refuse("there are more than 4 M codes; a line can hold 4.")


def _read_setting(reader: Reader, block: Block) -> None:
    reader.at += 1
    key: int | str
    if reader.text[reader.at : reader.at + 1] == "<":
        key = reader.name()
    else:
        key = reader.integer("The number of a parameter")
    if reader.text[reader.at : reader.at + 1] != "=":
        raise reader.refuse(f"found {reader.rest()!r} after a parameter; expected = and a value.")
    reader.at += 1
    block.settings.append((key, reader.value()))
    if len(block.settings) > MAX_SETTINGS:
        raise reader.refuse(f"there are more than {MAX_SETTINGS} parameters set; a line can set {MAX_SETTINGS}.")


def apply_settings(block: Block, store: Parameters) -> None:
    """Set the parameters that the line sets, all with values from before the line."""
    for key, value in block.settings:
        try:
            store.set(key, value)
        except GCodeError as exc:
            raise block.refuse(str(exc)) from None
