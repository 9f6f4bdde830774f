"""The machine that the program talks to: modes, offsets and the current point, in the units of the program.

Lengths here are in program units (mm or inch, whatever G20/G21 says) and angles in degrees, as LinuxCNC keeps
them; the rules of ``motion_rules`` make them m and rad in the machine frame.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any
from weakref import WeakMethod

from robomill.errors import GCodeError
from robomill.provenance import Level
from robomill.toolpath.findings import Findings
from robomill.toolpath.gcode.codes import DISTANCE, LETTERS
from robomill.toolpath.gcode.corners import EACH, Corner, joined
from robomill.toolpath.gcode.parameters import Parameters
from robomill.toolpath.gcode.program import ARC, FEED, TAP, TRAVERSE, Move, Recorder
from robomill.toolpath.gcode.rules.mode_rules import system_code
from robomill.toolpath.gcode.rules.motion_rules import MINUTE, feed_speed, rotate, write_arc, write_straight
from robomill.toolpath.gcode.words import Block
from robomill.toolpath.tools import Tool, Tools, own_copy
from robomill.units import from_si, to_si

UNITS = {200: "in", 210: "mm"}
_NO_TOOL = Tool(0)
_SAVED = (
    *("unit_code", "plane", "absolute", "arc_absolute", "feed_mode", "feed", "speed", "spindle"),
    *("retract_r", "spindle_mode", "diameter_mode", "system"),
)
XYZABC = "xyzabc"
STORED_PLACES = (5161, 5181, 5211, *range(5221, 5400, 20))
"""The first of three parameters each that hold a place: of G28, G30 and G92, and of G54 and on."""


@dataclass(frozen=True)
class Scale:
    """Factors and centre along x, y and z, in program units; whether a word that only ``mirrors`` has set them."""

    factors: tuple[float, float, float] = (1.0, 1.0, 1.0)
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mirrors: bool = False

    def place(self, axis: int, value: float) -> float:
        """A place along an axis."""
        return self.centre[axis] + self.factors[axis] * (value - self.centre[axis])

    def said(self, axis: int, value: float) -> float:
        """What a line says of a place along an axis."""
        return self.centre[axis] + (value - self.centre[axis]) / self.factors[axis]


class Machine:
    """State that lines change; the fields that the rules of ``motion_rules`` use are those of ``records.STATE``.

    ``p`` is the current point (x, y, z, a, b, c) in the current coordinate system; ``at`` and ``turned`` are the tip
    (m) and the rotary axes (rad) in the machine frame. ``in_spindle`` is the number of the tool there, ``figures`` are
    those of the last refusal, ``initial_level`` is where a row of cycles began (NaN outside of one), ``waited`` are the
    seconds of dwells since the last move, ``moves`` those of a stretch of plain lines. ``sent`` is the end of the last
    straight move that was recorded: after a tool change or an input the machine is asked where it stands and answers
    with that, as LinuxCNC's preview does. ``length_of`` is the tool whose length is in force (None: none, or one that
    the program itself says); ``lifts`` holds how far the tip stands from the point that is told (m), each with the
    first move for which it holds. ``tool_name`` is the tool that a program calls by name, while no table has it.
    ``shifted_by`` is the last of G52 and G92 (520, 920), which share the shift ``g92``.
    ``systems`` are the coordinate systems that are in force, each with the first move for which it is; ``placed`` those
    that the program itself has placed, each with the line. ``away`` says of which of x, y, z the place is not known, as
    only the machine knows where its home lies;
    ``aways`` are those, each with the first move for which it holds, and ``homes`` those that the program has stored
    itself (28, 30).

    ``tilted`` is the tilted plane in force, ``planes`` are all of them, each with the first move for which it is;
    ``tilt_due`` is one that waits for G53.1, and ``stuck`` why no move may come before; ``left`` are A, B, C (degrees)
    at which it began, if not at 0, and ``leans`` says that it has ended and nothing has turned the tool back.

    ``feeds_follow`` says that feeds count in the unit of lengths (a Sinumerik's G70 and G71 change lengths alone,
    unless ``feeds_unsure``: nothing else shows such a control), ``feed_in_block`` that F beside a word of units counts
    in the new ones; ``sharp`` that compensation goes around outside corners without an arc (G451), ``moved`` which axes
    a frame has moved under the tool, ``keeps_frame`` that TRANS and its kin go on in another of G54 and on.

    ``t_changes`` says that T changes the tool at once, without M6; ``kept_d`` is the D that a G41 without one means,
    None for the tool in the spindle. ``leaving`` is how far aside of the
    contour G40 has left the tool, until it moves in the plane. ``radii`` are the radius and wear that G10 gives a tool.

    ``corner`` is what the line says of the corner at its end (size in program units), ``rounding`` what RNDM says of
    all corners (a radius, 0: none), ``polar_words`` says that X
    and Y are a radius and an angle (G16), ``before_turn`` is the origin and rotation without G68, ``scale`` what
    G51 does to words. ``extended`` are the origins and rotations of G54.1 P1 and on (program units), which are called
    as ``further`` says, ``is_fanuc``
    says that G10 and variables mean what they mean there, ``other_control`` that it is neither LinuxCNC nor grbl,
    ``strict`` that LinuxCNC is stated, ``variable`` what those are that nobody has set, ``machine_word`` which word
    leads to a place in the machine, ``zero_ended`` that none of G54 and on is in force (None: the program has
    none), ``sides`` what it calls G41 and G42. ``keeps_heights`` and ``kept_steps`` are
    those of ``cycle_rules``. ``modal`` is what MCALL or G66 holds, ``r_set`` are the R parameters that a program
    has set.
    """

    kept_d: float | None = None
    zero_ended: bool | None = None
    leaving: list[float] | None = None
    feeds_unsure, keeps_frame, moved = False, False, frozenset[int]()

    def __init__(self, tools: Tools | None) -> None:
        asked = WeakMethod(self.provided)  # no ring that only the garbage collector would undo
        self.store = Parameters(lambda name: asked()(name), (*_AXES, *_PROVIDED))  # type: ignore[misc]
        self.findings = Findings()
        self.recorder = Recorder(joined)
        self.corner: Corner | None = None
        self.rounding = 0.0
        self.polar_words = False
        self.modal: Any = None
        self.r_set: set[int] = set()
        self.scale: Scale | None = None
        self.before_turn: tuple[list[float], float] | None = None
        self.tools = None if tools is None else own_copy(tools)
        self.unit_code, self.units_said = 210, 0
        self.factor = to_si(1.0, "mm")
        self.p, self.sent = [0.0] * 6, [0.0] * 6
        self.at, self.turned = [0.0] * 3, [0.0] * 3
        self.g5x, self.g92, self.shifted_by = [0.0] * 6, [0.0] * 6, 0
        self.rotation = 0.0
        self.system = 1
        self.length_offset = [0.0] * 3
        self.straight = 0
        self.arc_refused = False
        self.motion, self.plane, self.absolute, self.arc_absolute = 800, 17, True, False
        self.feeds_follow, self.feed_in_block, self.sharp = True, False, False
        self.feed_mode, self.feed, self.speed, self.spindle, self.spindle_mode = 940, 0.0, 0.0, 0, 970
        self.retract_r, self.diameter_mode = True, False
        self.tool, self.selected, self.in_spindle = _NO_TOOL, 0, 0
        self.tool_name, self.t_changes = "", False
        self.away: tuple[bool, ...] = (False, False, False)
        self.aways: list[tuple[int, tuple[bool, ...]]] = []
        self.homes: set[int] = set()
        self.tilted: Any = None
        self.planes: list[tuple[int, Any]] = []
        self.tilt_due: Any = None
        self.stuck, self.leans = "", False
        self.left: list[float] = []
        self.strict = False
        self.is_fanuc, self.other_control, self.machine_word = False, False, "G53"
        self.variable: Callable[[Machine, int], float] | None = None
        self.extended: dict[int, tuple[list[float], float]] = {}
        self.further = "G54.1 P{}"
        self.radii: dict[int, list[float]] = {}
        self.systems: list[tuple[int, int]] = [(0, 1)]
        self.placed: dict[int, int] = {}
        self.sides: dict[int, str] = {}
        self.length_of: Tool | None = None
        self.lifts: list[tuple[int, list[float]]] = []
        self.mist = self.flood = False
        self.cycle = [math.nan] * len(LETTERS)
        self.initial_level, self.keeps_heights, self.kept_steps = math.nan, False, False
        self.compensation: Any = None
        self.arc_not_allowed = False
        self.figures = [0.0] * 3
        self.spline: list[tuple[float, float, float]] = []
        self.spline_order = 3
        self.line = 0
        self.seeking = self.broke = self.continued = False
        self.moves, self.dwells, self.dwell_time, self.waited = 0, 0, 0.0, 0.0
        self.messages: list[tuple[int, str]] = []

    def note(self, code: str, level: Level, message: str) -> None:
        """Note something of the line that is being executed."""
        self.findings.add(code, level, self.line, message)

    # --- units
    @property
    def unit(self) -> str:
        """The unit of lengths, "mm" or "in"."""
        return UNITS[self.unit_code]

    @property
    def unit_said(self) -> str:
        """The unit that the program has said, "" if it says none."""
        return UNITS.get(self.units_said, "")

    @property
    def is_plain(self) -> bool:
        """True while the rules of ``mode_rules`` alone say what plain lines do."""
        held = self.compensation is not None or self.recorder.held is not None
        other = self.diameter_mode or self.polar_words or self.modal is not None or self.scale is not None
        counted = self.feeds_follow or self.unit_code == 210
        lost = any(self.away) or self.moved or self.zero_ended or self.stuck or self.leans or self.leaving is not None
        return counted and not (held or other or self.rounding or lost)

    def set_units(self, code: int) -> None:
        """G20 or G21: every length that is kept changes its unit."""
        self.units_said = code
        if code == self.unit_code:
            return
        unit = UNITS[code]
        ratio = to_si(1.0, self.unit) / to_si(1.0, unit)
        turned = [] if self.before_turn is None else [self.before_turn[0]]
        turned += [origin for origin, _ in self.extended.values()]
        for values in (self.p, self.sent, self.g5x, self.g92, self.length_offset, *turned):
            values[:3] = [v * ratio for v in values[:3]]
        if self.scale is not None:
            self.scale = replace(self.scale, centre=tuple(v * ratio for v in self.scale.centre))  # type: ignore[arg-type]
        for first in STORED_PLACES if self.is_fanuc else ():
            self.store.put(first, [v * ratio for v in self.store.values(first, 3)])
        self.feed, self.rounding = self.feed * ratio, self.rounding * ratio
        if self.compensation is not None:
            self.compensation.scale(ratio)
        self.unit_code, self.factor = code, to_si(1.0, unit)

    def to_user(self, length: float) -> float:
        """A length of the program in the unit of stored parameters: mm, on a Fanuc what the program counts in."""
        return length if self.is_fanuc else from_si(to_si(length, self.unit), "mm")

    def from_user(self, length: float) -> float:
        """A stored parameter in program units."""
        return length if self.is_fanuc else from_si(to_si(length, "mm"), self.unit)

    def need_compensation_off(self, block: Block, name: str) -> None:
        """Refuse what cannot be done while cutter compensation is on."""
        if self.compensation is not None:
            raise block.refuse(f"{name} cannot be used with cutter compensation on; use G40 first.")

    def is_absolute(self, block: Block) -> bool:
        """Whether the words of a line are places, not steps."""
        return bool(block.g.get(DISTANCE, 900 if self.absolute else 910) == 900)

    # --- moves
    def go(self, kind: int, line: int, end: list[float], v_f: float | None = None) -> None:
        """Record a straight move to ``end`` (6,) and, except for taps, stand there."""
        if self.stuck:
            raise GCodeError.at(line, self.stuck)
        row, at, turned = Move(line), list(self.at), list(self.turned)
        write_straight(self, kind, end, feed_speed(self) if v_f is None and kind != TRAVERSE else v_f or 0.0, row)
        if kind == TAP:
            self.at, self.turned, row.rotary = at, turned, turned
        self.recorder.add(row)

    def go_arc(self, line: int, end: list[float], plane: int, centre: list[float], turn: int, v_f: float) -> None:
        """Record an arc in ``plane`` about ``centre`` (x, y, z in the current system)."""
        row = Move(line)
        row.plane = plane
        write_arc(self, end, centre, turn, v_f, row)
        self.recorder.add(row)

    # --- tools
    def find_tool(self, number: int) -> Tool | None:
        """The tool of the table; None if there is no table. Tool 0 is no tool. KeyError if it is missing."""
        if number == 0:
            return _NO_TOOL
        return None if self.tools is None else self.tools[number]

    def set_length_offset(self, offset: list[float]) -> None:
        """Apply tool length offsets (program units): the machine stands still, the tip is elsewhere.

        The recorded path goes on from where the tip was last sent, as the reference's does.
        """
        change = [before - after for before, after in zip(self.length_offset, offset)]
        dx, dy = rotate(change[0], change[1], -self.rotation)
        self.p = [self.p[0] + dx, self.p[1] + dy, self.p[2] + change[2], *self.p[3:]]
        self.length_offset = list(offset)

    def note_length(self, tool: Tool | None) -> None:
        """The length of ``tool`` is in force, whatever tool is in the spindle: that one's tip goes somewhere else."""
        self.length_of = tool
        lift = [0.0, 0.0, 0.0]
        if tool is not None and self.tools is not None and self.tool.number:
            lift = [told - true for told, true in zip(tool.offset, self.tool.offset)]
        if lift != (self.lifts[-1][1] if self.lifts else [0.0, 0.0, 0.0]):
            self.lifts.append((len(self.recorder), lift))

    def set_tilted(self, plane: Any) -> None:
        """A plane of ``tilted`` is in force from the next move on; None: the upright one."""
        self.recorder.settle()
        self.tilted = plane
        if self.planes and self.planes[-1][0] == len(self.recorder):
            self.planes.pop()
        self.planes.append((len(self.recorder), plane))

    def stand_at(self, angles: list[float]) -> None:
        """A, B and C stand at angles (degrees), without a move."""
        self.p[3:], self.sent[3:] = angles, angles
        self.turned = [math.radians(angle) for angle in angles]

    # --- places that only the machine knows
    def set_away(self, away: tuple[bool, ...]) -> None:
        """Of x, y and z the place is not known (True) from the next move on."""
        if away != self.away:
            self.away = away
            self.aways.append((len(self.recorder), away))

    def place(self, words: dict[str, float]) -> None:
        """A line says places: they are known from here on, unless they count as steps (G91)."""
        if any(self.away) and self.absolute:
            polar = "@" in words or "^" in words
            said = [letter in words or (polar and letter != "z") for letter in "xyz"]
            self.set_away(tuple(before and not now for before, now in zip(self.away, said)))

    # --- corners
    def set_rounding(self, radius: float) -> None:
        """RNDM: every corner of the contour is rounded from here on; 0 ends it."""
        self.rounding = radius

    def corner_of(self, kind: int) -> Corner | None:
        """What becomes of the corner at the end of a move of a kind, in m and m/s; what the line said is taken."""
        said, self.corner = self.corner, None
        if said is None and self.rounding and kind in (FEED, ARC):
            said = Corner(EACH, self.rounding)
        return None if said is None else said.scaled(self.factor, self.factor / MINUTE)

    # --- coordinates as lines say them
    def set_scale(self, scale: Scale | None) -> None:
        """Words are scaled from here on."""
        self.scale, self.initial_level = scale, math.nan

    def said_point(self) -> list[float]:
        """Where the tool stands (x, y, z, a, b, c) as a line would say it: without cutter compensation and scale."""
        held, scale = self.compensation, self.scale
        point = self.p if held is None or held.programmed is None else held.programmed_point(self)
        if scale is None:
            return list(point)
        return [*(scale.said(axis, point[axis]) for axis in range(3)), *point[3:]]

    def meant(self, place: tuple[float, float]) -> tuple[float, float]:
        """Where X and Y of a line lie in the current coordinate system."""
        scale = self.scale
        return place if scale is None else (scale.place(0, place[0]), scale.place(1, place[1]))

    # --- saved modes
    def save_modes(self) -> dict[str, Any]:
        """What M70 and M73 keep; of G52 and G92 whether they shift."""
        return {name: getattr(self, name) for name in _SAVED} | {"shifted": self.store.numbered[5210] != 0.0}

    # --- values that programs can read
    def provided(self, name: str | int) -> float:
        """Value of a read-only parameter. Raises GCodeError (without a line) where there is none for now."""
        if isinstance(name, int):
            return self._provided_number(name)
        if name in _AXES:
            return self.p[_AXES.index(name)]
        return float(_PROVIDED[name](self))

    def _provided_number(self, index: int) -> float:
        if self.variable is not None and index < 5400:
            return self.variable(self, index)
        if index >= 5420:
            if self.compensation is not None:
                raise GCodeError("the position cannot be read with cutter compensation on; use G40 first.")
            return self.p[index - 5420] if index < 5426 else 0.0
        tool = self.tool
        if 5401 <= index <= 5403:
            return from_si(tool.offset[index - 5401], "mm")
        if index == 5400:
            return float(tool.number)
        return from_si(tool.diameter, "mm") if index == 5410 else float(tool.orientation if index == 5413 else 0)


_AXES = tuple(f"_{letter}" for letter in XYZABC)
_PROVIDED: dict[str, Any] = {
    "_vmajor": lambda m: 2.9,
    "_vminor": lambda m: 0.0,
    "_line": lambda m: m.line,
    "_motion_mode": lambda m: m.motion,
    "_plane": lambda m: 10 * m.plane,
    "_ccomp": lambda m: 400 if m.compensation is None else (410 if m.compensation.left else 420),
    "_metric": lambda m: m.unit == "mm",
    "_imperial": lambda m: m.unit == "in",
    "_absolute": lambda m: m.absolute,
    "_incremental": lambda m: not m.absolute,
    "_inverse_time": lambda m: m.feed_mode == 930,
    "_units_per_minute": lambda m: m.feed_mode == 940,
    "_units_per_rev": lambda m: m.feed_mode == 950,
    "_coord_system": lambda m: system_code(m.system),
    "_tool_offset": lambda m: any(m.length_offset),
    "_retract_r_plane": lambda m: m.retract_r,
    "_retract_old_z": lambda m: not m.retract_r,
    "_spindle_rpm_mode": lambda m: m.spindle_mode == 970,
    "_spindle_css_mode": lambda m: m.spindle_mode == 960,
    "_ijk_absolute_mode": lambda m: m.arc_absolute,
    "_lathe_diameter_mode": lambda m: m.diameter_mode,
    "_lathe_radius_mode": lambda m: not m.diameter_mode,
    "_spindle_on": lambda m: m.spindle != 0,
    "_spindle_cw": lambda m: m.spindle > 0,
    "_mist": lambda m: m.mist,
    "_flood": lambda m: m.flood,
    "_speed_override": lambda m: 1,
    "_feed_override": lambda m: 1,
    "_adaptive_feed": lambda m: 0,
    "_feed_hold": lambda m: 1,
    "_feed": lambda m: m.feed,
    "_rpm": lambda m: m.speed,
    "_current_tool": lambda m: m.tool.number,
    "_current_pocket": lambda m: m.tool.number,
    "_selected_pocket": lambda m: m.selected,
    "_selected_tool": lambda m: m.selected,
    "_u": lambda m: 0,
    "_v": lambda m: 0,
    "_w": lambda m: 0,
    "_call_level": lambda m: m.store.level,
    "_remap_level": lambda m: 0,
    "_task": lambda m: 0,
}
