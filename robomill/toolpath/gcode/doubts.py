"""What is doubted of a program that has been read: findings that a person should look at before trusting its path."""

import re

import numpy as np

from robomill.arrays import IntArray
from robomill.provenance import Finding, Level
from robomill.toolpath.findings import Findings
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.offsets import stored_system, system_name
from robomill.toolpath.gcode.program import TRAVERSE, Program
from robomill.toolpath.gcode.scan import COMMENT_BYTES
from robomill.toolpath.path import NO_SPINDLE, ROTARY_ASKED
from robomill.units import format_si, from_si, to_si

LIKELY = (0.008, 3.0)
"""m: parts smaller or larger than this are doubted."""
MOST_SAID = 1000
"""Stretches of a program that one finding counts."""
FEW, RARE, RARE_ON_FANUC = 3, 0.1, 1.0 / 3.0
"""So many whole numbers with a point (X10.) show how a program writes them; of so small a share none is a slip: of a
larger one in the code of a control that may count the others in thousandths."""
LARGE = 1000
"""A whole number without a point, beside numbers that have one, is doubted from here on however many there are."""
SAMPLE = 2_000_000
"""Bytes at the start of a program in which that is looked for."""


def _coordinate(number: bytes) -> re.Pattern[bytes]:
    """What finds coordinates and centres by their numbers: the letter first, which is quickly looked for."""
    return re.compile(rb"[XYZIJxyzij](?<![A-Za-z_#\[(<\"=].)-?" + number + rb"(?![\d_.\[]|[Ee][-+\d])")


_POINTED, _WHOLE = _coordinate(rb"\d{1,9}+\.\d*+"), _coordinate(rb"0*+([1-9]\d{0,8}+)(\.0*+)?+")
_ATAN = re.compile(rb"\bATAN?\s*\[", re.IGNORECASE)
_LATHE_TOOL = re.compile(rb"(?<![A-Za-z0-9])[Tt](\d\d)\1(?![\d.])")
_CHANGES = re.compile(rb"[Mm]0?6(?![\d.])|(?<![A-Za-z#<])[Yy]\s*[-+.\d#\[]")
QUARTER, SLACK = 90.0, 1e-6
"""degrees that a tool which leans is led through, or stands from upright, without a doubt; and of rounding."""
LONG_DWELL = 60.0
"""s, on average over a program: so long none waits, so the number is in another unit."""


def _without_comments(data: bytes) -> bytes:
    """A program with a blank for each comment: its lines stay."""
    return COMMENT_BYTES.sub(b" ", data) if b"(" in data or b";" in data else data


def doubt_points(findings: Findings, data: bytes, on_fanuc: bool = False) -> None:
    """Note whole numbers without a point where others have one (X10.): many controls count them in thousandths."""
    sample = _without_comments(data[:SAMPLE])
    whole = _WHOLE.findall(sample)
    pointless = [int(number) for number, point in whole if not point]
    if not pointless:
        return
    share = RARE_ON_FANUC if on_fanuc else RARE
    rare = len(whole) - len(pointless) >= FEW and len(pointless) <= max(share * len(whole), 1.0)
    least = 1 if rare else LARGE
    if not (rare or _POINTED.search(sample)) or (max(pointless) < least and len(data) <= SAMPLE):
        return
    data = _without_comments(data)
    for found in _WHOLE.finditer(data):
        if not found[2] and int(found[1]) >= least:
            line = data.count(b"\n", 0, found.start()) + 1
            text = (
                f"{found[0].decode('ascii', 'replace')} has no decimal point where other whole numbers have one: it is "
                "read as whole units; many controls (Fanuc) take it for thousandths: write the point"
            )
            findings.add("no-point", "suspicious", line, text)
            return


def doubt_all_points(findings: Findings, data: bytes, program: Program) -> None:
    """Say of a Fanuc program without any point how its numbers are read: aloud where no machine is so large."""
    sample = _without_comments(data[:SAMPLE])
    largest = max((int(number) for number, point in _WHOLE.findall(sample) if not point), default=0)
    if program.extents is None or largest == 0 or _POINTED.search(sample):
        return
    size = float(np.subtract(*program.extents[::-1]).max())
    level: Level = "suspicious" if size > LIKELY[1] else "info"
    unit, step = ("inches", 1e-4) if program.units == "in" else ("mm", 1e-3)
    text = (
        f"no number has a decimal point: they are read as whole {unit}; a control with conventional decimal input "
        f"reads {largest} as {largest * step:g} {unit}: write the points"
    )
    findings.add("no-points", level, 0, text)


def doubt_lathe(findings: Findings, data: bytes, program: Program) -> None:
    """Say of a program that looks like a lathe's how it is read: T0101 without M6, and nothing that names Y."""
    sample = _without_comments(data[:SAMPLE])
    if program.extents is None or not _LATHE_TOOL.search(sample) or _CHANGES.search(sample):
        return
    text = (
        "this looks like the program of a lathe (T0101, no M6, no Y), where X counts as a diameter and F per turn; it "
        "is read as one of a mill, so do not trust this path"
    )
    findings.add("lathe", "suspicious", 0, text)


def doubt_fanuc(findings: Findings, data: bytes, program: Program) -> None:
    """Say where a Fanuc control may do otherwise than is read: turns of arcs, cycles from below R, angles of ATAN."""
    turned = np.flatnonzero(program.turns > 1)
    if len(turned):
        text = (
            "P beside G2 or G3 is read as a number of turns (LinuxCNC); Fanuc and Haas have no such word and make one "
            "turn: write each turn on its own line"
        )
        findings.add("arc-turns", "warning", int(program.line[turned[0]]), text, len(turned))
    rises = _rises_to_r(program)
    if len(rises):
        text = (
            "the cycle begins below its R: it is read as rising to R first; Fanuc controls go to the hole at the "
            "height where the tool is, and back to that in G98: write a G0 to above R before it"
        )
        findings.add("cycle-below-r", "warning", int(program.line[rises[0]]), text, len(rises))
    if found := _ATAN.search(_without_comments(data[:SAMPLE])):
        text = (
            "ATAN is read as -180 to 180 degrees; a Fanuc control gives these or 0 to 360, as its parameter 6004.0 "
            "(NAT) says: check what depends on that"
        )
        findings.add("atan-range", "info", data.count(b"\n", 0, found.start()) + 1, text)


def _rises_to_r(program: Program) -> IntArray:
    """Moves of cycles that rise to R where the program itself has led the tool below it: their rows."""
    z, moved = program.end[:, 2] - program.start[:, 2], program.end != program.start
    sideways = moved[:, :2].any(axis=1)
    rises = (program.kind == TRAVERSE) & ~sideways & (z > 0.0)
    rises[1:] &= program.line[1:] != program.line[:-1]
    across = (program.kind == TRAVERSE) & sideways & ~moved[:, 2] & ~program.away.any(axis=1)
    follows = np.flatnonzero(across[1:] & (program.line[1:] == program.line[:-1]))
    led = np.cumsum(moved[:, 2]) > moved[:, 2]  # a height was said before
    return np.intersect1d(np.flatnonzero(rises & led), follows)


def doubt(machine: Machine, program: Program) -> None:
    """Note all that is doubted."""
    if machine.dwell_time > LONG_DWELL * machine.dwells:
        text = (
            f"the program waits {machine.dwell_time:g} s in {machine.dwells} dwells, as P counts seconds here; where "
            "it counts milliseconds (Fanuc, without a point) choose that dialect."
        )
        machine.findings.add("long-dwell", "suspicious", 0, text)
    if not len(program.line):
        machine.findings.add(
            "no-move", "warning", 0, "the program moves nothing; subprograms move where they are called"
        )
    _doubt_length(machine, program)
    _doubt_spindle(machine, program)
    _doubt_size(machine, program)
    _doubt_spin(machine, program)
    _doubt_zero(machine, program)
    _doubt_home(machine, program)
    _doubt_table(machine, program)


def turned_far(program: Program, table: str = "") -> list[tuple[str, float, int]]:
    """Axes that cuts turn through more than a quarter, or stand a quarter off in, as faces of a part do that a table
    turns; and C at all beside an A or B that is not the ``table``: which, by how many degrees, and from which line on.
    """
    cuts = np.flatnonzero(program.at_feed)
    if not len(cuts) or not (program.rotary.any() or program.rotary0.any()):
        return []
    angles = np.vstack([program.rotary0[cuts], program.rotary[cuts]])
    with np.errstate(over="ignore"):
        most = np.degrees(np.maximum(np.abs(angles).max(axis=0), np.ptp(angles, axis=0)))
    found = []
    stands = (program.rotary0[cuts] == program.rotary[cuts]).all(axis=0)
    least = np.where(stands, QUARTER - SLACK, QUARTER + SLACK)
    leans = [axis for axis in (0, 1) if "ABC"[axis] != table]
    if (angles[:, leans].any(axis=1) & (angles[:, 2] != 0.0)).any():
        least[2] = 0.0  # a head or table that turns the lean aside, but where C is the tool's own turn
    for axis in np.flatnonzero(most > least):
        turned = (np.abs(program.rotary[cuts, axis]) > 0.0) | (np.abs(program.rotary0[cuts, axis]) > 0.0)
        found.append(("ABC"[axis], float(most[axis]), int(program.line[cuts[turned][0]])))
    return found


def _doubt_table(machine: Machine, program: Program) -> None:
    """Ask what turns where an axis turns far, or C beside a lean: a tool that leans, or a table with the part."""
    for letter, most, line in turned_far(program):
        text = (
            f"{letter} turns by {most:.0f} degrees: does it turn the part (a rotary table) or lean the tool? It "
            f"is read as the tool's, and nothing is judged, until the rotary axis is stated"
        )
        machine.findings.add(ROTARY_ASKED, "warning", line, text)


def doubt_second_table(program: Program, table: str) -> tuple[Finding, ...]:
    """The findings of a program whose axis ``table`` turns the part: is there another axis that turns as far?"""
    kept = tuple(each for each in program.findings if each.code != ROTARY_ASKED)
    more = tuple(
        Finding(
            "warning",
            f"{letter} turns by {most:.0f} degrees beside the rotary table {table[-1]}: two tables are not read, and "
            "nothing is judged; post the program with the direction of the tool",
            line,
            code=ROTARY_ASKED,
        )
        for letter, most, line in turned_far(program, table[-1])
        if letter != table[-1]
    )
    return (*more, *kept)


def _doubt_home(machine: Machine, program: Program) -> None:
    """Say which cuts go to or from a place that only the machine knows."""
    lost = np.flatnonzero(program.unplaced & (program.kind != TRAVERSE))
    if len(lost):
        text = (
            "this cut lies where only the machine knows (after G28, G30 or G53) and is left out of what is cut; write "
            "a G0 with X, Y and Z before it"
        )
        machine.findings.add("cut-unplaced", "warning", int(program.line[lost[0]]), text, len(lost))


def _doubt_zero(machine: Machine, program: Program) -> None:
    """Say where the program places its own zero, and where systems that nobody has placed lie over one another."""
    cuts = np.flatnonzero(program.at_feed)
    first = np.array([row for row, _ in machine.systems])
    used = [machine.systems[i][1] for i in np.unique(np.searchsorted(first, cuts, "right") - 1)]
    for system in sorted(set(used) & set(machine.placed)):
        place, turned = stored_system(machine, system)
        origin = [from_si(to_si(value, machine.unit), "mm") for value in place[:3]]
        if any(origin) or turned:
            shown = " ".join(f"{letter}{value:g}" for letter, value in zip("XYZ", origin))
            text = (
                f"the program itself places {system_name(machine, system)} at {shown} (mm): the path lies that far "
                "from part zero; remove that line where part zero is meant to be there"
            )
            machine.findings.add("zero-placed", "warning", machine.placed[system], text)
    unset = [system_name(machine, system) for system in sorted(set(used) - set(machine.placed))]
    if len(set(used)) == 1 and unset and used[0] != 1:
        text = f"part zero is taken to be that of {unset[0]}, which the program does not place"
        machine.findings.add("zero-taken", "info", 0, text)
    if len(set(used)) > 1 and unset:
        several = f"{', '.join(unset)} are" if len(unset) > 1 else f"{unset[0]} is"
        text = (
            f"the program cuts in {len(set(used))} coordinate systems, and {several} nowhere placed: they lie over one "
            "another at part zero; place each with G10 L2 P1 X... Y... Z... (P2 for G55), or read them one at a time"
        )
        machine.findings.add("zeros-overlaid", "warning", 0, text)


def _doubt_length(machine: Machine, program: Program) -> None:
    """Warn of cuts with the length of another tool."""
    wrong = np.flatnonzero(program.lift.any(axis=1) & program.at_feed) if machine.lifts else np.zeros(0, dtype=np.int64)
    for tool in np.unique(program.tool[wrong]):
        row = int(wrong[program.tool[wrong] == tool][0])
        lifted = float(program.lift[row, 2])
        off = f"{format_si(abs(lifted), 'mm')} {'higher' if lifted > 0.0 else 'lower'}"
        message = f"tool {tool} cuts with the length of another tool (G43): its tip goes {off} than is said"
        machine.findings.add("wrong-length", "warning", int(program.line[row]), message)


def _doubt_spindle(machine: Machine, program: Program) -> None:
    """Note cuts with a spindle that stands still, and tools that are chosen and never changed to."""
    still = np.flatnonzero(program.at_feed & (program.n_s == 0.0))
    if len(still) and program.n_s.any():
        message = "cuts with the spindle stopped; start it with S and M3 or M4 before"
        for line in program.line[still[np.append(True, np.diff(still) > 1)]][:MOST_SAID]:
            machine.findings.add("spindle-stopped", "warning", int(line), message)
    elif len(still):
        machine.findings.add(
            NO_SPINDLE, "info", 0, "the spindle turns in no cut: no S with M3 or M4 is in force (M6 ends it)"
        )
    if machine.selected and not program.tool.any() and program.at_feed.any():
        message = f"T{machine.selected} is chosen, but no M6 changes to it: the cuts are taken as made without a number"
        machine.findings.add("no-change", "warning", 0, message)


def _doubt_spin(machine: Machine, program: Program) -> None:
    """Say how C is read where a cut has one: a machine whose table or head swivels by C stands otherwise."""
    spun = np.flatnonzero(program.at_feed & (program.rotary[:, 2] != 0.0))
    leans = spun[program.rotary[spun, :2].any(axis=1)]
    if len(spun):
        message = (
            "C is read as a turn of the tool about its own axis, which changes no cut; a machine whose table or head "
            "swivels by C stands otherwise: post the program with the tool's lean in A and B"
        )
        level: Level = "warning" if len(leans) else "info"
        machine.findings.add("c-spins", level, int(program.line[(leans if len(leans) else spun)[0]]), message)


def _doubt_size(machine: Machine, program: Program) -> None:
    """Note a part that would have a likelier size in the other unit, 25.4 times off."""
    if program.extents is None:
        return
    size = float(np.subtract(*program.extents[::-1]).max())
    inch = to_si(1.0, "in") / to_si(1.0, "mm")
    shown = format_si(size, "mm", 1)
    if not machine.unit_said and 0.0 < size < LIKELY[0]:
        other = format_si(size * inch, "mm", 1)
        machine.findings.add(
            "size-doubt", "suspicious", 0, f"the part is {shown} across; if the program means inches, it is {other}"
        )
    elif size > LIKELY[1]:
        other = format_si(size / inch, "mm", 1)
        machine.findings.add(
            "size-doubt", "suspicious", 0, f"the part is {shown} across; a unit taken wrongly would make it {other}"
        )
