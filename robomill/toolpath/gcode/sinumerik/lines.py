"""Lines of Sinumerik controls (840D, 828D) in LinuxCNC's words."""

import re

from robomill.errors import GCodeError
from robomill.toolpath.gcode.frames import frame_of
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.rules.motion_rules import MINUTE
from robomill.toolpath.gcode.standing import note_step
from robomill.toolpath.gcode.tilted import tilt, turned_by, upright
from robomill.toolpath.gcode.tool_axis import angles_of
from robomill.units import to_si

_SILENT = re.compile(
    r"\b(?:TRAORI|TRAFOOF|FFWON|FFWOF|SOFT|BRISK|COMPCAD|COMPON|COMPOF|COMPCURV|COMPSURF|STOPRE|CFTCP|CFIN|CFC|ORIWKS|"
    r"ORIAXES|ORIVECT|ORIMKS|UPATH|SPATH|NORM|DIAMOF|FNORM|FLIN|FGROUP|SETMS|CUT2D|CDOF|WALIMOF|WALIMON|"
    r"CUT2DF|SPCO[NF]|TCO(?:ABS|FR)|PAROTOF|TOROTOF|TRAILOF|DYN(?:NORM|ROUGH|SEMIFIN|FINISH|POS|PREC)|RTLIO(?:N|F)|"
    r"STOPFIFO|STARTFIFO|FIFOCTRL|CPRECON|CPRECOF|ORISON|ORISOF|SBLON|SBLOF|DISPLON|DISPLOF)\b(?:[ \t]*\([^()]*\))?|"
    r"\bOFFN[ \t]*=[ \t]*0+(?:\.0*)?(?![.\d])|"
    r"\b(?:DISC|SF)[ \t]*=[ \t]*0+(?:\.0*)?(?![.\d])|\b[HM]\d*[ \t]*=[ \t]*QU[ \t]*\([ \t]*\d+[ \t]*\)|"
    r"\bH\d*[ \t]*=[ \t]*[-+.\d]+|"
    r"\b(?:ADIS|ADISPOS|CTOL|OTOL|ATOL|(?:ACC|JERKLIM|VELOLIM)\[\w+\])[ \t]*=[ \t]*[.\d]+|"
    r"\bLIMS(?:\[\d\])?[ \t]*=[ \t]*[.\d]+|"
    r"\bG2[56][ \t]+(?:S\d*[ \t]*=?[ \t]*[\d.]+[ \t]*)+|\bGROUP_(?:BEGIN|END)[ \t]*\([^()]*\)|"
    r"\bSPOS(?:\[\d\])?[ \t]*=[ \t]*[-+.\d]+|\b(?:CYCLE832|WORKPIECE)[ \t]*\([^()]*\)",
    re.IGNORECASE,
)
_FEED_RADIUS = re.compile(r"\bFGREF[ \t]*\[(\w+)\][ \t]*=[ \t]*[.\d]+", re.IGNORECASE)
_ROUND_CORNERS = re.compile(r"\bKONT[CT]?\b", re.IGNORECASE)
_UNITS = {"G70": "G20", "G700": "G20", "G71": "G21", "G710": "G21", "G500": "G54", "G153": "G53", "SUPA": "G53"}
_WORDS = re.compile(r"\b(?:G70|G700|G71|G710|G500|G153|SUPA)\b", re.IGNORECASE)
_ZEROS = r"\bG5(?:[4-7]|0[5-9]|[1-9]\d)\b"
_SETTABLE = re.compile(_ZEROS, re.IGNORECASE)
_CHOSEN = re.compile(rf"^[^;\n]*?{_ZEROS}".encode(), re.MULTILINE | re.IGNORECASE)
_GOES = re.compile(r"\b[XYZ](?:1?[ \t]*=|[ \t]*[-+.\d])", re.IGNORECASE)
_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)"
_EXPONENT = re.compile(rf"({_NUMBER})EX([-+]?\d{{1,3}})\b", re.IGNORECASE)
_PLACE = re.compile(rf"\b([XYZABCIJK])[ \t]*=[ \t]*(AC|IC)[ \t]*\([ \t]*({_NUMBER})[ \t]*\)", re.IGNORECASE)
_VECTOR = re.compile(rf"\b([ABC])3[ \t]*=[ \t]*({_NUMBER})", re.IGNORECASE)
_ORIENTATION = re.compile(r"\b(?:([ABC])([24-7])[ \t]*=|(LEAD|TILT|THETA|AN[23])[ \t]*=)", re.IGNORECASE)
_NOT_READ = re.compile(r"\b(FB|[IJK]1)[ \t]*=", re.IGNORECASE)
_SWIVEL = re.compile(r"\bCYCLE800[ \t]*\(([^()]*)\)", re.IGNORECASE)
_TURNS = re.compile(r"\b(G0?4)[ \t]+S[ \t]*=?[ \t]*([.\d]+)", re.IGNORECASE)
_TURN = re.compile(r"\bTURN\s*=\s*(\d+)", re.IGNORECASE)
MOST_TURNS = 999
"""Full turns that a Sinumerik adds to an arc at most."""
_TOOL = re.compile(r"\bT[ \t]*=?[ \t]*\"([^\"]*)\"", re.IGNORECASE)
_SPINDLE = re.compile(r"\bM1[ \t]*=[ \t]*(\d+)", re.IGNORECASE)
_TAP = re.compile(r"\bG33[12]\b", re.IGNORECASE)
_PITCH = re.compile(rf"\bK[ \t]*=?[ \t]*({_NUMBER})", re.IGNORECASE)
_MESSAGE = re.compile(r"\bMSG[ \t]*\(((?:\"[^\"]*\"|\([^()]*\)|[^()\"])*)\)(?:[ \t]*,[ \t]*[01]\b)?", re.IGNORECASE)
_FIXED_POINT = re.compile(
    rf"\b(G7[45])((?:[ \t]+(?:[XYZ](?:1[ \t]*=|[ \t]*=)?[ \t]*{_NUMBER}|FP[ \t]*=[ \t]*\d))+)[ \t]*$", re.IGNORECASE
)
_MODES = re.compile(r"\bG9[01]\b(?!\.)", re.IGNORECASE)
_CODE = re.compile(r"(?:[^;\"]|\"[^\"]*\"|\"(?=[^\"]*$))*+")
_FOLLOWS = {"G70": False, "G71": False, "G700": True, "G710": True}
_FEED = re.compile(rf"(?<![A-Za-z_])F(?:1?[ \t]*=)?[ \t]*({_NUMBER})", re.IGNORECASE)
_ADDRESS = r"[A-DF-Z][-+]?(?:\d+(?:\.\d*)?|\.\d+)"
_EDGE = re.compile(r"\bD(\d+)\b", re.IGNORECASE)
_TIGHT = re.compile(rf"(?<![\w.+\-])(?:{_ADDRESS})+[A-DF-Z]?(?![\w.(+\-])")
_EACH = re.compile(rf"({_ADDRESS})(?=[A-Z])")


def parted(raw: str) -> tuple[str, str]:
    """A line's code, and its comment with the ; before it; a ; in quotes begins none."""
    found = _CODE.match(raw)
    at = len(raw) if found is None else found.end()
    return raw[:at], raw[at:]


def spaced(code: str) -> str:
    """A line (capitals, no comment) with blanks between its words; names, of two letters or more, stay whole."""
    if '"' in code:
        return code
    if "EX" in code:
        code = _written_out(code)
    return _TIGHT.sub(lambda found: _EACH.sub(r"\1 ", found[0]), code)


def _written_out(code: str) -> str:
    """Numbers with EX for times ten to the, as plain ones."""
    return _EXPONENT.sub(lambda found: f"{float(found[1] + 'e' + found[2]):.15f}", code)


def translated(raw: str, number: int, machine: Machine) -> str:
    """The line in LinuxCNC's words; what is left out on the way is noted. Raises GCodeError naming the line."""
    code, comment = parted(raw)
    for found in _SILENT.findall(code):
        machine.findings.add("harmless-word", "ignored", number, f"{_name(found)} is left out: it moves nothing")
    for found in _ROUND_CORNERS.findall(code):
        text = f"{found} is read as NORM; from behind the contour a control goes round its corner"
        machine.findings.add("approach", "warning", number, text)
    for axis in _FEED_RADIUS.findall(code.upper()):
        text = (
            f"FGREF[{axis}] is left out: the feed of a move that turns {axis} alone counts in degrees a minute, where "
            "a control counts it along a circle of that radius"
        )
        machine.findings.add("turning-feed", "warning", number, text)
    code = _FEED_RADIUS.sub("", code)
    code = _SWIVEL.sub(
        lambda found: _unswivelled(found, number, machine), _ROUND_CORNERS.sub("", _SILENT.sub("", code))
    )
    message = _MESSAGE.search(code)
    if message is not None:  # other words may stand before it and behind it
        shown = message[1].strip('" ').replace("(", "[").replace(")", "]").replace('"', "")
        code, comment = code[: message.start()] + code[message.end() :], f" (MSG,{shown}){comment}"
    code = _FIXED_POINT.sub(lambda found: _fixed_point(found, machine), code)
    code = _feeds(code, number, machine)
    code = _in_machine(code, machine)
    code = _WORDS.sub(lambda found: _UNITS[found[0].upper()], code)
    code = _written_out(code)
    code = _tool_axis(code, number, machine)
    code = _places(code, machine)
    code = _TAP.sub(lambda _: _tapped(code, number, machine), _SPINDLE.sub(r"M\1", code))
    code = _TURNS.sub(lambda found: _waited(found, number, machine), code)
    code = re.sub(r"\b(G0?4)\s+F\s*=?", r"\1 P", code, flags=re.IGNORECASE)
    code = re.sub(r"\bCR\s*=", "R", code, flags=re.IGNORECASE)
    code = _TURN.sub(lambda found: _whole_turns(found[1], number), code)
    if (other := _NOT_READ.search(code)) is not None:
        feed = other[1].upper() == "FB"
        why = "is the feed of its block alone" if feed else "is a point on the arc of CIP; G2 and G3 need I=, J= or CR="
        raise GCodeError.at(number, f"{other[1].upper()}= {why}{', which is not read; write F' if feed else ''}.")
    code = re.sub(r"\b([XYZABCIJKFS])1?\s*=\s*([-+.\d]+)", r"\1\2", code, flags=re.IGNORECASE)
    code = re.sub(r"\b(?:M17|RET)\b", "M2", code, flags=re.IGNORECASE)
    code = _TOOL.sub(lambda found: named_tool(found[1], number, machine), code)
    code = _EDGE.sub(lambda found: _edge(int(found[1]), number, machine), code)
    return code + comment


def _edge(edge: int, number: int, machine: Machine) -> str:
    """D says which edge of the tool: each has a length and a radius of its own, of which a tool table knows the
    first."""
    if edge > 1:
        text = f"D{edge} is another edge of the tool, with its own length and radius; those of the tool table count"
        machine.findings.add("tool-edge", "warning", number, text)
    return ""


def chooses_zeros(data: bytes) -> bool:
    """Whether a program has G54 to G57 or G505 to G599, in which its part lies."""
    return _CHOSEN.search(data) is not None


def _in_machine(code: str, machine: Machine) -> str:
    """G500 ends G54 and its kin: what a program that has one of them says behind it are places in the machine."""
    said = _WORDS.findall(code)
    if machine.zero_ended is not None:
        ends = any(each.upper() == "G500" for each in said)
        machine.zero_ended = ends or (machine.zero_ended and not _SETTABLE.search(code))
    machine.machine_word = "G500" if machine.zero_ended else "G53"
    if not machine.zero_ended or not _GOES.search(code) or not _absolute(code, machine):
        return code
    return code if re.search(r"\b(?:G0*53|G153|SUPA)\b", code, re.IGNORECASE) else f"{code} G53"


def _unswivelled(found: re.Match[str], number: int, machine: Machine) -> str:
    """CYCLE800 whose places and angles are all 0 swivels nothing, and back what is swivelled; others tilt the plane.

    _MODE names the axes that _A, _B and _C turn about, each as the turns before have left it, by two bits each: 1 X, 2
    Y, 3 Z, from the lowest on. 64 and on are angles in space, _A about Z and then _B about Y as that has left it; 128
    and on (angles of projection, places of the machine's axes) are not read. _X0 to _Z0 are the place that is
    turned about, _X1 to _Z1 lead to the new zero along the new axes.
    """
    said = [each.strip() for each in found[1].split(",")] + [""] * 16
    if not any(each.strip("0.+-") for each in said[4:13]):
        if machine.tilted is None:
            machine.findings.add("harmless-word", "ignored", number, "CYCLE800 by 0 is left out: it swivels nothing")
        upright(machine, stays=not found[1].strip())
        return ""
    if not all(re.fullmatch(rf"(?:{_NUMBER})?", each) for each in (said[2], said[3], *said[4:14])):
        raise GCodeError.at(number, "CYCLE800 is read with numbers alone; write them out.")
    state, mode = (int(float(said[at] or "0")) for at in (2, 3))
    axes = "".join(" XYZ"[mode >> 2 * place & 3] for place in range(3))
    if mode >> 6 == 1:
        axes = "ZY"
    elif mode >> 6 or " " in axes or len(set(axes)) < 3:
        text = (
            f"CYCLE800 is read axis by axis (_MODE 57, 27 ...) and by angles in space (64), found {mode}; write that."
        )
        raise GCodeError.at(number, text)
    if state % 10 or (said[13] and float(said[13]) == 0.0):
        text = "CYCLE800 is read as a new plane (_ST ends in 0) to which the tool is swivelled (_DIR -1 or 1) alone."
        raise GCodeError.at(number, text)
    if any(frame_of(machine)[0]):
        raise GCodeError.at(number, "CYCLE800 inside of TRANS is not read; end that before, or give it as X0, Y0, Z0.")
    x0, y0, z0, a, b, c, x1, y1, z1 = (float(each or "0") for each in said[4:13])
    upright(machine)
    tilt(machine, "CYCLE800", turned_by(axes, (a, b, c)), (x0, y0, z0), (x1, y1, z1))
    return ""


def _feeds(code: str, number: int, machine: Machine) -> str:
    """F in the unit of the line before, as it is read: G70 and G71 change lengths alone, G700 and G710 feeds too."""
    said = [each.upper() for each in _WORDS.findall(code) if each.upper() in _FOLLOWS]
    inch = machine.unit == "in"
    if said:
        machine.feeds_follow = _FOLLOWS[said[-1]] or machine.feeds_unsure
        inch = said[-1] in ("G70", "G700")
        if said[-1] == "G70" and machine.feeds_unsure:
            text = (
                "G70: feeds are read in in/min, too, as controls with an inch basic system take them; a Sinumerik "
                "whose basic system is metric takes them in mm/min: choose that dialect where it does"
            )
            machine.findings.add("feeds-inch", "warning", number, text)
        elif said[-1] == "G70":
            text = (
                "G70: feeds still count in mm/min, as on a control whose basic system is metric; where it is inch they "
                "are 25.4 times as fast: write G700, which counts them in in"
            )
            machine.findings.add("feeds-metric", "warning", number, text)
    counts = "in" if inch and machine.feeds_follow else "mm"
    if counts == machine.unit or machine.feed_mode == 930:
        return code
    ratio = to_si(1.0, counts) / to_si(1.0, machine.unit)
    return _FEED.sub(lambda found: f"F{float(found[1]) * ratio:.12f}", code)


def _tapped(code: str, number: int, machine: Machine) -> str:
    """G331 taps down and G332 up again, in step with a spindle that they turn themselves, by the sign of K."""
    pitch = _PITCH.search(code)
    if pitch is None or float(pitch[1]) == 0.0:
        raise GCodeError.at(number, "G331 and G332 need K, the pitch along Z; I and J are not read.")
    if machine.spindle:
        return "G33"
    machine.note("tap-turns", "info", "G331 turns the spindle by itself (rigid tapping)")
    return "G33 M3" if float(pitch[1]) > 0.0 else "G33 M4"


def _fixed_point(found: re.Match[str], machine: Machine) -> str:
    """G74 and G75 lead some axes to places of the machine; they are of their block alone."""
    text = (
        f"{found[1].upper()} goes to a fixed point of the machine, which is not known here: the tool is taken to be "
        "clear of the part until X, Y and Z are given again"
    )
    machine.note("machine-place", "info", text)
    named = {letter.upper() for letter in re.findall(r"\b([XYZ])", found[2], re.IGNORECASE)}
    machine.set_away(tuple(away or letter in named for away, letter in zip(machine.away, "XYZ")))
    return ""


def _whole_turns(said: str, number: int) -> str:
    """TURN= counts the full turns before the arc that leads to the end; P counts that one too."""
    if len(said) > 9 or int(said) > MOST_TURNS:
        raise GCodeError.at(number, f"TURN={said[:20]} is more than a Sinumerik takes; expected 0 to {MOST_TURNS}.")
    return f"P{int(said) + 1}"


def _waited(found: re.Match[str], number: int, machine: Machine) -> str:
    """G4 S waits for turns of the spindle."""
    if machine.speed == 0.0:
        raise GCodeError.at(number, "G4 S waits for turns of the spindle, and no S has said how fast it turns.")
    return f"{found[1]} P{MINUTE * float(found[2]) / machine.speed:.9f}"


def _name(found: str) -> str:
    return found.split("(")[0].strip().upper()


def _absolute(code: str, machine: Machine) -> bool:
    modes = _MODES.findall(code)
    return machine.absolute if not modes else str(modes[-1]).upper() == "G90"


def _tool_axis(code: str, number: int, machine: Machine) -> str:
    """A3= B3= C3= is the tool axis, from the tip to its holder, of any length; what is not given is 0."""
    other = _ORIENTATION.search(code)
    if other is not None:
        word = (f"{other[1]}{other[2]}" if other[1] else other[3]).upper()
        text = f"{word}= gives the tool's orientation in a way that is not read; write its direction as A3= B3= C3=."
        raise GCodeError.at(number, text)
    found = {letter.upper(): float(value) for letter, value in _VECTOR.findall(code)}
    if not found:
        return code
    axis = found.get("A", 0.0), found.get("B", 0.0), found.get("C", 0.0)
    if max(map(abs, axis)) < 1e-9:
        raise GCodeError.at(number, "the tool axis A3= B3= C3= is 0; expected a direction.")
    before = machine.p[3], machine.p[4]
    a, b = angles_of(axis, before)
    if not _absolute(code, machine):
        a, b = a - before[0], b - before[1]
    return f"{_VECTOR.sub('', code)} A{a:.12f} B{b:.12f}"


def _places(code: str, machine: Machine) -> str:
    """AC( ) says a place and IC( ) a step, whatever mode is in force: as the mode in force counts."""
    absolute = _absolute(code, machine)
    here = machine.said_point()

    def counted(found: re.Match[str]) -> str:
        letter, way, value = found[1].upper(), found[2].upper(), float(found[3])
        centre = letter in "IJK"
        at = here["IJK".index(letter) if centre else "XYZABC".index(letter)]
        if way == "IC" and letter in "XYZ" and "XYZ".index(letter) in machine.moved:
            note_step(machine, letter)
        places = machine.arc_absolute if centre else absolute
        if (way == "AC") == places:
            return f" {letter}[{found[3]}]"
        return f" {letter}[{value + at if places else value - at:.15f}]"

    return _PLACE.sub(counted, code)


def named_tool(name: str, number: int, machine: Machine) -> str:
    """The word of T="...", by the number that the tool table gives that name; none where it gives none."""
    tools = machine.tools
    found = [tool.number for tool in (tools or {}).values() if tool.name and tool.name.lower() == name.lower()]
    if found:
        return f"T{found[0]}"
    machine.tool_name, machine.selected = name, 0
    if tools is None:
        text = f'tool "{name[:40]}" is of unknown size: there is no tool table'
        machine.findings.add("named-tool", "info", number, text)
    else:
        text = f'tool "{name[:40]}" is not in the tool table: its size is not known; add it there under that name'
        machine.findings.add("tool-unknown", "warning", number, text)
    return ""
