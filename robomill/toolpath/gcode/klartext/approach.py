"""APPR and DEP of Heidenhain's dialogue: to a contour and away from it, along its tangent, its normal or an arc.

The tool's centre comes to the first contour point as compensation wants it, square beside the contour, and leaves from
there. LEN and R are lengths of the path of the centre: the manual's own examples round with R5 a cutter of radius 10
(TNC 640, User's Manual for Klartext Programming, Approaching and departing a contour).
"""

import math
import re
from dataclasses import dataclass

from robomill.errors import GCodeError
from robomill.toolpath.gcode import codes as modal
from robomill.toolpath.gcode.cutters import compensation_on
from robomill.toolpath.gcode.klartext.patterns import KlartextPatterns
from robomill.toolpath.gcode.klartext.values import NUMBER
from robomill.toolpath.gcode.program import FEED, TRAVERSE
from robomill.toolpath.gcode.rules.motion_rules import MINUTE
from robomill.toolpath.gcode.words import Block
from robomill.toolpath.plane import centre_by_radius, polar, turned
from robomill.toolpath.tools import Tool
from robomill.units import to_si

Point = tuple[float, float]
_FORM = re.compile(r"(APPR|DEP) (P?)(LT|LN|CT|LCT)\b(.*)")
_SIDE = re.compile(r"(?<![A-Z])R(0|L|R)(?![\d.,])")
_SIZE = re.compile(rf"(?<![A-Z])(LEN|CCA|R) ?({NUMBER})")
_PLACE = re.compile(rf"(?<![A-Z])(I?)(PR|PA|[XYZ]) ?({NUMBER})")
_FEED = re.compile(rf"(?<![A-Z])F ?({NUMBER}|AUTO|MAX)")
_M = re.compile(r"(?<![A-Z])M ?(\d+)")
_NEXT = re.compile(r"(LP|L|CP|CR|C) (.*)")
_TOOL_DEF = re.compile(rf"TOOL DEF ?(\d+)(?: ?L ?{NUMBER})?(?: ?R ?({NUMBER}))?")
_NO_TANGENT = "APPR needs the first element of its contour (L, LP, C, CP or CR in the plane) on the line behind it."


Places = dict[str, tuple[str, float]]
"""By letter: "I" where it counts as a step, and the value."""


@dataclass(frozen=True)
class _Said:
    """What an APPR or DEP says: its form (LT, LN, CT, LCT), LEN, CCA and R, places, side of compensation, feed."""

    form: str
    sizes: dict[str, float]
    places: Places
    side: str
    feed: float | None


class KlartextApproach(KlartextPatterns):
    """Leads the tool to contours and away from them."""

    side = "0"
    course: Point | None = None

    def approach(self, code: str, line: int) -> str | None:
        """APPR or DEP: its moves are recorded; what is left are its M words."""
        found = _FORM.fullmatch(code)
        if found is None:
            raise GCodeError.at(line, f"{code[:20]} is not read; expected APPR or DEP with LT, LN, CT or LCT.")
        arrives, form, rest = found[1] == "APPR", found[3], found[4]
        side, bare = _SIDE.search(rest), _SIDE.sub("", rest)
        sizes = {name: self.number(value, line) for name, value in _SIZE.findall(bare)}
        places = {letter: (step, self.number(v, line)) for step, letter, v in _PLACE.findall(bare)}
        feed, stops = _FEED.search(bare), [f"M{m}" for m in _M.findall(bare)]
        left = bare
        for pattern in (_SIZE, _PLACE, _FEED, _M):
            left = pattern.sub("", left)
        wants = {"LT": ("LEN",), "LN": ("LEN",), "CT": ("CCA", "R"), "LCT": ("R",)}[form]
        if left.strip() or set(sizes) != set(wants) or sizes.get("LEN", 1.0) <= 0.0 or sizes.get("R", 1.0) == 0.0:
            raise GCodeError.at(line, f"{code[:40]!r} is not read; {found[1]} {form} needs {' and '.join(wants)}.")
        if not 0.0 < sizes.get("CCA", 1.0) <= 360.0 or (form == "LCT" and sizes["R"] < 0.0):
            raise GCodeError.at(line, f"{found[1]} {form} needs CCA from 0 to 360 degrees, and LCT a radius above 0.")
        if self.machine.scale is not None:
            raise GCodeError.at(line, f"{found[1]} in a mirror image is not read; end CYCL DEF 8 before.")
        if any(self.machine.away):
            raise GCodeError.at(line, f"{found[1]} begins where only the machine knows; give X, Y and Z before.")
        if self.per_turn:
            raise GCodeError.at(line, f"{found[1]} under M136 is not read; end it by M137 before.")
        rate = None if feed is None or feed[1] == "MAX" else self.rate(feed[1], line)
        self.machine.plane = 17
        said = _Said(form, sizes, places, side[1] if side else "0", rate)
        if arrives:
            self._arrive(said, line)
        else:
            self._leave(said, line)
        return " ".join(stops) or None

    # --- to the contour
    def _arrive(self, said: _Said, line: int) -> None:
        machine, form, sizes, side = self.machine, said.form, said.sizes, said.side
        if machine.compensation is not None:
            raise GCodeError.at(line, "APPR begins compensation, which is on already; end it with R0 or DEP before.")
        at = self.here()
        goal = self._goal_of(said.places, at, line)
        tangent = _unit(self._first_course(goal, line), line)
        if side != "0":
            compensation_on(machine, Block(line, g={modal.COMPENSATION: 410 if side == "L" else 420}))
        radius = 0.0 if machine.compensation is None else machine.compensation.radius
        normal = _left(tangent) if side == "L" else _right(tangent)
        begin = goal[0] + radius * normal[0], goal[1] + radius * normal[1]
        turn, centre = self._circle(sizes, begin, normal, side)
        if form == "LT":
            before = begin[0] - sizes["LEN"] * tangent[0], begin[1] - sizes["LEN"] * tangent[1]
        elif form == "LN":
            before = begin[0] + sizes["LEN"] * normal[0], begin[1] + sizes["LEN"] * normal[1]
        elif form == "CT":
            before = _about(centre, begin, -turn * math.radians(sizes["CCA"]))
        else:
            before = _touching(centre, abs(sizes["R"]), turn, (at[0], at[1]), line)
        if form == "LCT":
            machine.feed = said.feed or machine.feed
        self._go(before, line, rapid=machine.motion == 0 and form != "LCT")
        machine.feed = said.feed or machine.feed
        if "Z" in said.places:
            self._sink(said.places["Z"], line)
        if form in ("LT", "LN"):
            self._go(begin, line)
        else:
            self._turn_to(begin, centre, turn, line, whole=form == "CT")
        self.side, self.course, machine.motion = side, tangent, 10
        if machine.compensation is not None and radius > 0.0:
            machine.compensation.stand_beside(machine, goal)

    def _first_course(self, goal: list[float], line: int) -> Point:
        """The direction in which the contour begins that the lines behind describe."""
        code, after, _ = self.joined_block(self.pc)
        while (not code or code[0] == "*" or re.match(r"CC [^I]*$", code)) and after < len(self.file.lines):
            if code.startswith("CC"):
                self.set_pole(code, line)
            code, after, _ = self.joined_block(after)
        found = _NEXT.fullmatch(code)
        if found is None:
            raise GCodeError.at(line, _NO_TANGENT)
        kind, rest = found[1], found[2]
        said = _PLACE.findall(rest)
        places = {letter: (step, self.number(value, line)) for step, letter, value in said}
        if kind in ("L", "LP"):
            end = self._goal_of(places, goal, line)
            return end[0] - goal[0], end[1] - goal[1]
        sense = re.search(r"DR ?([-+])", rest)
        if sense is None:
            raise GCodeError.at(line, _NO_TANGENT)
        turn = 1 if sense[1] == "+" else -1
        if kind == "CR":
            size = _SIZE.search(_SIDE.sub("", re.sub(r"DR ?[-+]", "", rest)))
            if size is None:
                raise GCodeError.at(line, _NO_TANGENT)
            end = self._goal_of(places, goal, line)
            centre = centre_by_radius(goal, end, self.number(size[2], line), turn)
        else:
            centre = self.pole_in_plane(line)
        return -turn * (goal[1] - centre[1]), turn * (goal[0] - centre[0])

    # --- away from it
    def _leave(self, said: _Said, line: int) -> None:
        machine, form, sizes = self.machine, said.form, said.sizes
        if self.course is None:
            raise GCodeError.at(line, "DEP goes on from a contour, and no line before it has a direction in the plane.")
        tangent, at = _unit(self.course, line), self.here()
        side, self.side = self.side, "0"
        if machine.compensation is not None:
            machine.compensation.finish(machine, Block(line))
            machine.compensation = None
        normal = _left(tangent) if side == "L" else _right(tangent)
        begin = machine.p[0], machine.p[1]
        machine.feed = said.feed or machine.feed
        if form in ("LT", "LN"):
            along = tangent if form == "LT" else normal
            self._go((begin[0] + sizes["LEN"] * along[0], begin[1] + sizes["LEN"] * along[1]), line)
        else:
            turn, centre = self._circle(sizes, begin, normal, side)
            if form == "CT":
                self._turn_to(_about(centre, begin, turn * math.radians(sizes["CCA"])), centre, turn, line, whole=True)
            else:
                end = self._goal_of(said.places, at, line)
                self._turn_to(_touching(centre, sizes["R"], -turn, (end[0], end[1]), line), centre, turn, line)
                self._go((end[0], end[1]), line)
        if "Z" in said.places:
            self._sink(said.places["Z"], line)
        self.course, machine.motion = None, 10

    @staticmethod
    def _circle(sizes: dict[str, float], begin: Point, normal: Point, side: str) -> tuple[float, Point]:
        """Sense (1: counter-clockwise) and centre of the arc, which lies on the tool's side of the contour."""
        size = sizes.get("R", 0.0)
        turn = (1.0 if side == "L" else -1.0) * (1.0 if size >= 0.0 else -1.0)
        return turn, (begin[0] + size * normal[0], begin[1] + size * normal[1])

    # --- moves of the tool's centre
    def _goal_of(self, places: Places, at: list[float], line: int) -> list[float]:
        end = list(at)
        for axis, letter in enumerate("XYZ"):
            if letter in places:
                end[axis] = places[letter][1] + (at[axis] if places[letter][0] else 0.0)
        if places.keys() & {"PR", "PA"}:
            self.polar_place(places, at, end, line)
        return end

    def _feed_known(self, line: int) -> None:
        if self.machine.feed <= 0.0:
            raise GCodeError.at(line, "APPR and DEP cut, and there is no feed rate; give F.")

    def _go(self, to: Point, line: int, rapid: bool = False) -> None:
        machine = self.machine
        if not rapid:
            self._feed_known(line)
        end = [*to, *machine.p[2:]]
        machine.go(TRAVERSE if rapid else FEED, line, end)
        machine.p = end

    def _sink(self, z: tuple[str, float], line: int) -> None:
        machine = self.machine
        self._feed_known(line)
        end = list(machine.p)
        end[2] = z[1] + (end[2] if z[0] else 0.0)
        machine.go(FEED, line, end)
        machine.p = end

    def _turn_to(self, to: Point, centre: Point, turn: float, line: int, whole: bool = False) -> None:
        """An arc to a point; back to where it begins it is a ``whole`` turn, or none."""
        machine = self.machine
        self._feed_known(line)
        if not whole and math.dist(to, machine.p[:2]) < 1e-9:
            return
        end = [*to, *machine.p[2:]]
        v_f = machine.feed * machine.factor / MINUTE
        machine.go_arc(line, end, 17, [*centre, end[2]], 1 if turn > 0.0 else -1, v_f)
        machine.p = end

    def tool_defined(self, code: str, line: int) -> bool:
        """TOOL DEF 1 L+0 R+5: a tool of a radius that no table has; False for other lines."""
        found = _TOOL_DEF.fullmatch(code)
        if found is None or found[2] is None or int(found[1][:6]) in (self.machine.tools or {}):
            return False
        radius, number = self.number(found[2], line), int(found[1][:6])
        if radius <= 0.0:
            return False
        tool = Tool(number, 2.0 * to_si(radius, self.machine.unit))
        self.machine.tools = {**(self.machine.tools or {}), number: tool}
        return True

    # --- what the reader of moves says
    def here(self) -> list[float]:
        """The programmed point."""
        raise NotImplementedError

    def set_pole(self, code: str, line: int) -> None:
        """CC."""
        raise NotImplementedError

    def pole_in_plane(self, line: int) -> Point:
        """The centre or pole in the plane XY."""
        raise NotImplementedError

    def polar_place(self, places: Places, at: list[float], end: list[float], line: int) -> None:
        """Put the point of PR and PA into ``end``."""
        raise NotImplementedError

    def joined_block(self, index: int) -> tuple[str, int, bool]:
        """The block at ``index``, what comes next, and whether / stands before."""
        raise NotImplementedError


def _unit(course: Point, line: int) -> Point:
    size = math.hypot(*course)
    if size < 1e-9:
        raise GCodeError.at(line, _NO_TANGENT)
    return course[0] / size, course[1] / size


def _left(tangent: Point) -> Point:
    return -tangent[1], tangent[0]


def _right(tangent: Point) -> Point:
    return tangent[1], -tangent[0]


def _about(centre: Point, point: Point, angle: float) -> Point:
    return turned(point[0] - centre[0], point[1] - centre[1], angle, *centre)


def _touching(centre: Point, radius: float, turn: float, point: Point, line: int) -> Point:
    """Where a line from ``point`` comes onto the circle in its sense (``turn``; against it where one leaves)."""
    far = math.dist(centre, point)
    if far < radius * (1.0 + 1e-9):
        raise GCodeError.at(line, "APPR LCT and DEP LCT need a point outside of their arc; take a smaller R.")
    angle = math.atan2(point[1] - centre[1], point[0] - centre[0]) + turn * math.acos(radius / far)
    return polar(radius, angle, *centre)
