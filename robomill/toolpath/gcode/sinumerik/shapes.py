"""Sinumerik words that say a shape: patterns of holes, arcs by a point or a tangent, MIRROR, SCALE and CASE.

(840D sl, Programming Manual, Fundamentals: CIP, CT, MIRROR, SCALE; Job Planning, Programming cycles externally: HOLES1,
HOLES2, CYCLE801, CYCLE802.)
"""

import math
import re

from robomill.errors import GCodeError
from robomill.toolpath.gcode.frames import turn_back
from robomill.toolpath.gcode.machine import Scale
from robomill.toolpath.gcode.program import ARC, TRAVERSE
from robomill.toolpath.gcode.rules.motion_rules import rotate
from robomill.toolpath.gcode.sinumerik.words import Hole, SinumerikWords, parts
from robomill.toolpath.gcode.standing import note_moved
from robomill.toolpath.gcode.words import Block
from robomill.toolpath.plane import doubled_area, polar, through, turned

MOST_HOLES = 10_000
_START = re.compile(r"^[ \t/]*(?:N\d+[ \t]*)?(?:[A-Z_]{2}\w*[ \t]*:(?!=)[ \t]*)?")
_SCALED = re.compile(r"(A?)(MIRROR|SCALE)\b(.*)")
_AXIS = re.compile(r"\b([XYZ])[ \t]*=?[ \t]*([-+]?(?:\d+\.?\d*|\.\d+)|(?<==)[^\s]+)")
_HOLES = re.compile(r"(HOLES[12]|CYCLE80[12])[ \t]*\((.*)\)[ \t]*")
_HIDDEN = {"HOLES1": 8, "HOLES2": 8, "CYCLE801": 11, "CYCLE802": 21}
"""Where a pattern says which of its holes are left out."""
_PLANNED = re.compile(r"(?:MCALL[ \t]+)?((?:POCKET|SLOT)[1-4]|LONGHOLE|CYCLE(?:[67]\d|90|840|899|9[2-5]\d?))[ \t]*\(.*")
_MILLS = {
    **dict.fromkeys(("POCKET1", "POCKET3"), "mills a rectangular pocket"),
    **dict.fromkeys(("POCKET2", "POCKET4"), "mills a circular pocket"),
    **dict.fromkeys(("SLOT1", "SLOT2", "LONGHOLE", "CYCLE899"), "mills slots"),
    **dict.fromkeys(("CYCLE61", "CYCLE71"), "mills a face"),
    **dict.fromkeys(("CYCLE62", "CYCLE63", "CYCLE64", "CYCLE72", "CYCLE73", "CYCLE74", "CYCLE75"), "mills a contour"),
    **dict.fromkeys(("CYCLE76", "CYCLE77", "CYCLE79"), "mills a spigot"),
    **dict.fromkeys(("CYCLE70", "CYCLE78", "CYCLE90"), "mills a thread"),
    "CYCLE60": "engraves text",
    "CYCLE840": "taps with a compensating chuck",
}
_CASE = re.compile(r"CASE[ \t]*\(?(.+?)\)?[ \t]+OF\b(.*)")
_BRANCH = re.compile(r"([-+]?\d+|DEFAULT)[ \t]+(GOTO[FBC]?)[ \t]+(\w+)")
_BENT = re.compile(r"\b(CIP|CT)\b")
_MOTION = re.compile(r"\bG0*(?:[0-3]|33|34|35)\b")
_PLACE = re.compile(r"\b([XYZ]|[IJK]1)[ \t]*(?:=[ \t]*)?(?:(AC|IC)[ \t]*\(([^()]*)\)|([-+]?(?:\d+\.?\d*|\.\d+)))")
_MODES = re.compile(r"\bG9([01])\b")
_OTHER = re.compile(r"\bG(?:11[0-2]|7[45])\b")
"""G words whose X, Y and Z are no end of a motion: poles and fixed points."""


class SinumerikShapes(SinumerikWords):
    """Reads what says a shape; ``SinumerikWords`` reads the rest of a line."""

    bent = ""

    def sinumerik_shape(self, code: str, line: int) -> bool:
        """Do ``code`` (capitals, no comment) if it is one of these; False for other lines."""
        plain = _START.sub("", code, count=1).strip()
        scaled = _SCALED.fullmatch(plain)
        if scaled is not None:
            self._scale(scaled[1] + scaled[2], scaled[3].strip(), line)
            return True
        holes = _HOLES.fullmatch(plain)
        if holes is not None:
            self._holes(holes[1], holes[2], line)
            return True
        planned = _PLANNED.fullmatch(plain)
        if planned is not None:
            does = _MILLS.get(planned[1], "turns")
            text = f"{planned[1]} (Sinumerik) {does} in passes that the control plans, which is not read"
            raise GCodeError.at(line, f"{text}; let the CAM system write its moves out (G0, G1, G2, G3).")
        case = _CASE.fullmatch(plain)
        if case is not None:
            self._case(case[1], case[2], line)
            return True
        return False

    def sinumerik_line(self, code: str, line: int) -> str | None:
        """What is left of ``code`` (capitals, no comment); None where it is done."""
        left = super().sinumerik_line(code, line)
        return None if left is None else self._bent_line(left, line)

    # --- frames
    def _scale(self, name: str, text: str, line: int) -> None:
        """MIRROR and SCALE begin anew, AMIRROR and ASCALE add; without words they end what was."""
        machine = self.machine
        machine.need_compensation_off(Block(line), name)
        adds = name[0] == "A"
        said = dict(_AXIS.findall(text))
        if _AXIS.sub("", text).replace("=", "").strip() or (adds and not said):
            raise GCodeError.at(line, f"{name} {text[:20]} is not read; expected axes, as in {name} X0 Y0 or X2 Y2.")
        factors = [1.0, 1.0, 1.0] if not adds or machine.scale is None else list(machine.scale.factors)
        for letter, value in said.items():
            factor = -1.0 if name.endswith("MIRROR") else self.value(value, line)
            if not 1e-6 <= abs(factor) <= 1e3 or (letter == "Z" and factor < 0.0):
                text = "expected X and Y, or SCALE along Z, too, by 0.000001 to 1000"
                raise GCodeError.at(line, f"{name} {letter}{value} is not read; {text}.")
            factors["XYZ".index(letter)] *= factor
        if machine.tilted is not None:
            raise GCodeError.at(line, f"{name} in a swivelled plane is not read; end that before: CYCLE800().")
        before = machine.said_point()
        if not adds:
            turn_back(machine)
        machine.set_scale(Scale(tuple(factors)) if any(f != 1.0 for f in factors) else None)  # type: ignore[arg-type]
        note_moved(machine, before)

    def _frame(self, name: str, text: str, line: int) -> None:
        before = self.machine.said_point()
        if self.machine.scale is not None:
            if name[0] == "A":
                raise GCodeError.at(line, f"{name} inside of MIRROR or SCALE is not read; give it before them.")
            self.machine.set_scale(None)
        super()._frame(name, text, line)
        note_moved(self.machine, before)

    # --- holes
    def _holes(self, name: str, text: str, line: int) -> None:
        """A row (HOLES1), a circle (HOLES2), a grid or frame (CYCLE801) or places (CYCLE802) of what MCALL has said."""
        if self.modal_hole is None:
            raise GCodeError.at(line, f"{name} has nothing to repeat; give MCALL CYCLE81(...) before.")
        said = [each.strip() for each in parts(text)] + [""] * 22
        if said[_HIDDEN[name]].strip('" '):
            raise GCodeError.at(line, f"{name} leaves holes out (_HIDE), which is not read; write their places out.")
        if name == "CYCLE802":
            points = self._places_of(said, line)
        else:
            count = 11 if name == "CYCLE801" else 6
            given = [self.value(each, line) if each else 0.0 for each in said[:count]]
            points = _grid(given, line) if count == 11 else self._row_or_circle(name, given, line)
        self.drill_at(points, self.modal_hole, line)

    def _places_of(self, said: list[str], line: int) -> list[tuple[float, float]]:
        """CYCLE802: up to nine places; its first two numbers say of each X and Y whether it is one (1) or a step."""
        if not all(re.fullmatch("1{1,9}", each) for each in said[:2]):
            raise GCodeError.at(line, "CYCLE802 counts some of its places as steps, which is not read; give places.")
        pairs = [pair for pair in zip(said[2:20:2], said[3:20:2]) if any(pair)]
        if not pairs or not all(map(all, pairs)):
            raise GCodeError.at(line, "CYCLE802 needs X and Y of every place, as in CYCLE802(11,11,10,20,30,20).")
        return [(self.value(x, line), self.value(y, line)) for x, y in pairs]

    def _row_or_circle(self, name: str, given: list[float], line: int) -> list[tuple[float, float]]:
        u, v, third, fourth, fifth, count = given
        number = round(count)
        if not 1 <= number <= MOST_HOLES or (name == "HOLES2" and third <= 0.0):
            raise GCodeError.at(line, f"{name} has {count:g} holes; expected 1 to {MOST_HOLES}, and a radius.")
        if name == "HOLES1":
            angle, first, step = math.radians(third), abs(fourth), abs(fifth)
            along = [first + k * step for k in range(number)]
            points = [polar(a, angle, u, v) for a in along]
            here = self.machine.said_point()
            if math.dist(points[-1], here[:2]) < math.dist(points[0], here[:2]):
                points.reverse()
        else:
            between = fifth if fifth != 0.0 else 360.0 / number
            angles = [math.radians(fourth + k * between) for k in range(number)]
            points = [polar(third, t, u, v) for t in angles]
        return points

    def drill_at(self, points: list[tuple[float, float]], hole: Hole, line: int) -> None:
        """Drill at each of the points (program units, as a line would say them)."""
        machine = self.machine
        for x, y in points:
            machine.place({"x": x, "y": y})
            end = [*machine.meant((x, y)), *machine.p[2:]]
            machine.go(TRAVERSE, line, end)
            machine.p = end
            self.drill_here(hole, line)

    # --- branches
    def _case(self, value: str, branches: str, line: int) -> None:
        chosen = self.value(value, line)
        if _BRANCH.sub("", branches).strip():
            raise GCodeError.at(line, "CASE is not read as it stands; expected CASE(R1) OF 1 GOTOF A DEFAULT GOTOF B.")
        for number, way, label in _BRANCH.findall(branches):
            if number == "DEFAULT" or abs(float(number) - chosen) < 0.5:
                self._jump_to(way, label, line)
                return

    # --- arcs
    def _bent_line(self, code: str, line: int) -> str:
        """CIP and CT, which hold until another motion is said, as G2 and G3."""
        said = _BENT.search(code)
        if said is not None:
            self.bent = said[1]
        elif _MOTION.search(code):
            self.bent = ""
        elif _OTHER.search(code):
            return code
        if not self.bent or not re.search(r"\b(?:[XYZ]|[IJK]1)[ \t]*[-+=.\d]", code):
            return _BENT.sub("", code) if said is not None else code
        machine = self.machine
        if machine.compensation is not None or machine.plane != 17 or any(machine.away):
            text = f"{self.bent} is read in G17, without cutter compensation and from a known place."
            raise GCodeError.at(line, text)
        absolute = machine.absolute if (mode := _MODES.search(code)) is None else mode[1] == "0"
        at = machine.said_point()
        places = {}
        for letter, way, inside, plain in _PLACE.findall(code):
            axis = "XYZ".find(letter) if len(letter) == 1 else "IJK".index(letter[0])
            value = self.value(inside or plain, line)
            places[letter] = value + (at[axis] if way == "IC" or (not way and not absolute) else 0.0)
        end = [places.get(letter, at[axis]) for axis, letter in enumerate("XYZ")]
        if abs(end[2] - at[2]) > 1e-9:
            raise GCodeError.at(line, f"{self.bent} that also climbs is not read; write it as G2 or G3.")
        if self.bent == "CIP":
            middle = [places.get(f"{letter}1", at[axis]) for axis, letter in enumerate("IJK")]
            if abs(middle[2] - at[2]) > 1e-9 or not places.keys() & {"I1", "J1"}:
                raise GCodeError.at(line, "CIP needs I1 and J1, a point of its arc in the plane XY.")
            turn, centre = _through(at, middle, end, line)
        else:
            turn, centre = _tangential(at, end, self._leaving(line), line)
        rest = _BENT.sub("", _PLACE.sub("", code))
        step = [0.0, 0.0] if absolute else at[:2]
        i, j = (c - (0.0 if machine.arc_absolute else a) for c, a in zip(centre, at))
        way = "G3" if turn > 0.0 else "G2"
        return f"{rest} {way} X{end[0] - step[0]:.12f} Y{end[1] - step[1]:.12f} I{i:.12f} J{j:.12f}"

    def _leaving(self, line: int) -> tuple[float, float]:
        """The direction in the plane at the end of the last move, as lines say it."""
        row = self.machine.recorder.last()
        dx, dy = (0.0, 0.0) if row is None else (float(row["end"][k] - row["start"][k]) for k in (0, 1))
        if row is not None and row["kind"] == ARC:
            turn = 1.0 if row["sweep"] > 0.0 else -1.0
            out = row["end"] - row["centre"]
            dx, dy = -turn * float(out[1]), turn * float(out[0])
        if math.hypot(dx, dy) < 1e-12:
            raise GCodeError.at(line, "CT goes on tangentially, and the move before has no direction in the plane.")
        dx, dy = rotate(dx, dy, -self.machine.rotation)
        factors = (1.0, 1.0) if self.machine.scale is None else self.machine.scale.factors[:2]
        return dx / factors[0], dy / factors[1]


def _grid(given: list[float], line: int) -> list[tuple[float, float]]:
    """CYCLE801: columns along the first axis, to and fro from row to row; or the frame of such a grid, around."""
    u, v, angle, across, along, *more = given
    columns, rows, frame = round(more[0]), round(more[1]), more[2] % 10.0
    if not (columns >= 1 and rows >= 1 and columns * rows <= MOST_HOLES):
        text = f"CYCLE801 has {more[0]:g} by {more[1]:g} holes; expected 1 to {MOST_HOLES} in all."
        raise GCodeError.at(line, text)
    if frame not in (0.0, 1.0) or more[4] or more[5]:
        raise GCodeError.at(line, "CYCLE801 has a slanting grid, which is not read; write the places of its holes out.")
    cells = [(i, k) for k in range(rows) for i in (range(columns) if k % 2 == 0 else reversed(range(columns)))]
    if frame:
        cells = [(i, 0) for i in range(columns)]
        cells += [(columns - 1, k) for k in range(1, rows)]
        cells += [(i, rows - 1) for i in reversed(range(columns - 1))] if rows > 1 else []
        cells += [(0, k) for k in reversed(range(1, rows - 1))] if columns > 1 else []
    t = math.radians(angle)
    steps = [(i * abs(across), k * abs(along)) for i, k in cells]
    return [turned(a, b, t, u, v) for a, b in steps]


def _through(start: list[float], middle: list[float], end: list[float], line: int) -> tuple[float, tuple[float, float]]:
    """Sense and centre of the arc through three points."""
    area = doubled_area(start, middle, end)
    if abs(area) < 1e-9:
        raise GCodeError.at(line, "CIP has three points on one line; write it as G1.")
    return (1.0 if area > 0.0 else -1.0), through(start, middle, end)


def _tangential(
    start: list[float], end: list[float], course: tuple[float, float], line: int
) -> tuple[float, tuple[float, float]]:
    """Sense and centre of the arc that leaves ``start`` along ``course``."""
    size = math.hypot(*course)
    u, v = course[0] / size, course[1] / size
    dx, dy = end[0] - start[0], end[1] - start[1]
    across = u * dy - v * dx
    if abs(across) < 1e-9:
        raise GCodeError.at(line, "CT ends straight ahead; write it as G1.")
    radius = (dx * dx + dy * dy) / (2.0 * across)
    return (1.0 if radius > 0.0 else -1.0), (start[0] - v * radius, start[1] + u * radius)
