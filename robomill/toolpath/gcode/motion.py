"""Straight moves, arcs and returns home: from the words of a line to recorded moves."""

from __future__ import annotations

import math

from robomill.toolpath.gcode.arcs import AXES
from robomill.toolpath.gcode.machine import XYZABC, Machine, rotate
from robomill.toolpath.gcode.modal import NON_MODAL
from robomill.toolpath.gcode.program import FEED, TAP
from robomill.toolpath.gcode.words import Block
from robomill.units import format_si

SPIRAL_TOLERANCE = {"mm": 0.02 * math.sqrt(2.0), "in": 0.002 * math.sqrt(2.0)}
"""The radii to start and end of an arc given by its centre may differ by this much (program units), or by"""
SPIRAL_SHARE = 1e-3
"""this share of the larger radius, whichever is more, but never by more than 100 times the first figure."""
RADIUS_TOLERANCE = {"mm": 0.00005 * 25.4, "in": 0.00005}
"""A radius below this is none; half a chord may exceed a given radius by this much. In program units."""


def find_end(machine: Machine, block: Block) -> list[float]:
    """Where the line leads: (x, y, z, a, b, c) in the current coordinate system."""
    words = block.words
    base = machine.p
    if machine.compensation is not None and machine.compensation.programmed is not None:
        base = machine.compensation.programmed_point(machine)
    is_polar = "@" in words or "^" in words
    if block.g.get(NON_MODAL) == 530:
        if is_polar:
            raise block.refuse("polar coordinates cannot be used with G53.")
        return _machine_end(machine, words)
    end = list(base)
    if machine.absolute:
        for axis, letter in enumerate(XYZABC):
            if letter in words:
                end[axis] = words[letter]
        if is_polar:
            end[0], end[1] = polar(block, end[0], end[1])
        return end
    for axis, letter in enumerate(XYZABC):
        if letter in words:
            end[axis] += words[letter]
    if is_polar:
        end[0], end[1] = polar_step(block, end[0], end[1])
    return end


def _machine_end(machine: Machine, words: dict[str, float]) -> list[float]:
    x, y = rotate(machine.p[0] + machine.g92[0], machine.p[1] + machine.g92[1], machine.rotation)
    offset = machine.length_offset
    x = words["x"] - machine.g5x[0] - offset[0] if "x" in words else x
    y = words["y"] - machine.g5x[1] - offset[1] if "y" in words else y
    x, y = rotate(x, y, -machine.rotation)
    end = [x - machine.g92[0], y - machine.g92[1], *machine.p[2:]]
    for axis, letter in enumerate("zabc", 2):
        if letter in words:
            end[axis] = words[letter] - machine.g5x[axis] - machine.g92[axis] - (offset[2] if axis == 2 else 0.0)
    return end


def polar(block: Block, x: float, y: float) -> tuple[float, float]:
    """Absolute polar words ``@`` radius and ``^`` angle; what is not given stays."""
    words = block.words
    if "^" not in words and x == 0 and y == 0:
        raise block.refuse("@ at the origin needs an angle ^.")
    radius = words.get("@", math.hypot(x, y))
    angle = math.radians(words["^"]) if "^" in words else math.atan2(y, x)
    return radius * math.cos(angle), radius * math.sin(angle)


def polar_step(block: Block, x: float, y: float) -> tuple[float, float]:
    """Incremental polar words: ``@`` adds to the radius, ``^`` to the angle."""
    if x == 0 and y == 0:
        raise block.refuse("incremental polar coordinates have no direction at the origin; move away first.")
    radius = math.hypot(x, y) + block.words.get("@", 0.0)
    angle = math.atan2(y, x) + math.radians(block.words.get("^", 0.0))
    return radius * math.cos(angle), radius * math.sin(angle)


def check_feed(machine: Machine, block: Block, what: str) -> None:
    """Refuse a feed move without a feed rate."""
    if machine.feed_mode == 930:
        if "f" not in block.words:
            raise block.refuse(f"{what} in inverse time mode (G93) needs an F word on its line.")
    elif machine.feed == 0.0:
        raise block.refuse(f"{what} needs a feed rate; give an F word above 0 first.")
    elif machine.feed_mode == 950 and machine.speed == 0.0:
        raise block.refuse(f"{what} in feed per revolution (G95) needs a spindle speed; give an S word first.")


def inverse_time_feed(machine: Machine, block: Block, length: float) -> None:
    """In G93 the F word is the inverse of the minutes that the move takes."""
    if machine.feed_mode == 930:
        machine.feed = max(0.1, length * block.words["f"])


def straight(machine: Machine, block: Block) -> None:
    """G0, G1, G33 and G33.1."""
    motion = block.motion
    machine.arc_not_allowed = False
    if motion == 10:
        check_feed(machine, block, "G1")
    machine.motion = motion
    end = find_end(machine, block)
    if motion == 10 and machine.feed_mode == 930:
        change = [e - s for e, s in zip(end, machine.p)]
        moved = change[:3] if any(abs(c) > 1e-7 for c in change[:3]) else change[3:]
        inverse_time_feed(machine, block, math.sqrt(sum(c * c for c in moved)))
    compensation = machine.compensation
    if compensation is not None and compensation.radius > 0:
        if block.g.get(NON_MODAL) == 530:
            raise block.refuse("G53 cannot be used with cutter compensation on; use G40 first.")
        if motion > 10:
            raise block.refuse("G33 cannot be used with cutter compensation on; use G40 first.")
        compensation.straight(machine, block, end)
        return
    if motion in (330, 331):
        if machine.spindle == 0:
            raise block.refuse("G33 needs a turning spindle; start it with M3 or M4.")
        pitch_speed = abs(block.words["k"]) * machine.factor * machine.spindle_speed
        machine.go(TAP if motion == 331 else FEED, block.line, end, pitch_speed)
        if motion == 330:
            machine.p = end
        return
    if motion == 10:
        machine.feed_to(block.line, end)
    else:
        machine.traverse(block.line, end)
    machine.p = end


def arc(machine: Machine, block: Block) -> None:
    """G2 and G3, by centre or by radius."""
    if machine.arc_not_allowed:
        raise block.refuse("the move after G40 must be straight, not an arc.")
    name = f"G{block.motion // 10}"
    if machine.plane not in AXES:
        raise block.refuse(f"{name} needs a plane G17, G18 or G19.")
    if machine.rotation and machine.plane != 17:
        raise block.refuse(f"{name} in G{machine.plane} with a rotated coordinate system (G10 R) is in no plane.")
    has_centre = any(letter in block.words for letter in "ijk")
    if not has_centre and "r" not in block.words:
        raise block.refuse(f"{name} needs its centre (I, J, K) or its radius (R).")
    if has_centre and "r" in block.words:
        raise block.refuse(f"{name} has both a centre (I, J, K) and a radius (R); give one of them.")
    check_feed(machine, block, name)
    _check_arc_words(machine, block, name, has_centre)
    end = find_end(machine, block)
    machine.motion = block.motion
    compensation = machine.compensation
    if compensation is not None and compensation.radius > 0 and machine.plane != 19:
        compensation.arc(machine, block, end)
        return
    first, second, third = AXES[machine.plane]
    centre = arc_centre(machine, block, machine.p[first], machine.p[second], end[first], end[second])
    turn = arc_turn(block)
    length = arc_length(machine.p, end, centre, turn, first, second, third)
    inverse_time_feed(machine, block, length)
    centre_point = list(machine.p[:3])
    centre_point[first], centre_point[second] = centre
    machine.go_arc(
        block.line, end, machine.plane, (centre_point[0], centre_point[1], centre_point[2]), turn, machine.feed_speed
    )
    machine.p = end


def _check_arc_words(machine: Machine, block: Block, name: str, has_centre: bool) -> None:
    first, second, third = AXES[machine.plane]
    allowed, across = ("ijk"[first], "ijk"[second]), "ijk"[third]
    if has_centre:
        if across in block.words:
            raise block.refuse(f"{name} has {across.upper()}, which is not in the plane G{machine.plane}.")
        if machine.arc_absolute:
            for letter in allowed:
                if letter not in block.words:
                    raise block.refuse(f"{name} with absolute centre (G90.1) needs {letter.upper()}.")
    elif not any(letter in block.words for letter in ("xyz"[first], "xyz"[second], "@", "^")):
        axes = f"{'XYZ'[min(first, second)]} or {'XYZ'[max(first, second)]}"
        raise block.refuse(f"{name} with R needs an end point in its plane ({axes}); R cannot say a full circle.")


def arc_turn(block: Block) -> int:
    """Signed number of started turns."""
    turns = round(block.words.get("p", 1.0))
    return -turns if block.motion == 20 else turns


def arc_length(
    p: list[float], end: list[float], centre: tuple[float, float], turn: int, first: int, second: int, third: int
) -> float:
    """Length as the reference reckons it for inverse time feeds: with the radius at the start."""
    radius = math.hypot(p[first] - centre[0], p[second] - centre[1])
    theta = find_turn(p[first], p[second], centre, turn, end[first], end[second])
    return math.hypot(radius * theta, end[third] - p[third])


def find_turn(x1: float, y1: float, centre: tuple[float, float], turn: int, x2: float, y2: float) -> float:
    """Signed angle (rad) swept about ``centre`` from point 1 to point 2."""
    alpha = math.atan2(y1 - centre[1], x1 - centre[0])
    beta = math.atan2(y2 - centre[1], x2 - centre[0])
    if turn > 0:
        return (beta + 2.0 * math.pi if beta <= alpha else beta) - alpha + (turn - 1) * 2.0 * math.pi
    return beta - (alpha + 2.0 * math.pi if alpha <= beta else alpha) + (turn + 1) * 2.0 * math.pi


def arc_centre(
    machine: Machine, block: Block, x: float, y: float, end_x: float, end_y: float, compensated: bool = False
) -> tuple[float, float]:
    """Centre in the plane of an arc from (x, y) to (end_x, end_y), all in program units of the current system.

    Raises GCodeError naming both radii (mm) if they differ too much.
    """
    if "r" in block.words:
        return _centre_from_radius(machine, block, x, y, end_x, end_y)
    first, second, _ = AXES[machine.plane]
    i, j = block.words.get("ijk"[first], 0.0), block.words.get("ijk"[second], 0.0)
    centre = (i, j) if machine.arc_absolute else (x + i, y + j)
    r_start, r_end = math.hypot(centre[0] - x, centre[1] - y), math.hypot(centre[0] - end_x, centre[1] - end_y)
    name = f"G{block.motion // 10}"
    if min(r_start, r_end) < RADIUS_TOLERANCE[machine.unit]:
        raise block.refuse(f"{name} has a radius of 0; start or end lies on its centre.")
    tolerance = SPIRAL_TOLERANCE[machine.unit]
    allowed = min(max(tolerance, SPIRAL_SHARE * max(r_start, r_end)), 100.0 * tolerance)
    if abs(r_start - r_end) > allowed:
        radii = [format_si(r * machine.factor, "mm", 4) for r in (r_start, r_end)]
        raise block.refuse(
            f"{name} does not end on its circle: the radius is {radii[0]} at the start and {radii[1]} at the end; "
            f"they may differ by {format_si(allowed * machine.factor, 'mm', 4)}."
        )
    return centre


def _centre_from_radius(
    machine: Machine, block: Block, x: float, y: float, end_x: float, end_y: float
) -> tuple[float, float]:
    radius = block.words["r"]
    name = f"G{block.motion // 10}"
    if end_x == x and end_y == y:
        raise block.refuse(f"{name} with R ends where it starts; a full circle needs I, J or K.")
    size = abs(radius)
    half = 0.5 * math.hypot(end_x - x, end_y - y)
    if half - size > RADIUS_TOLERANCE[machine.unit] or size == 0.0:
        shown = format_si(size * machine.factor, "mm", 4), format_si(half * machine.factor, "mm", 4)
        raise block.refuse(f"{name} cannot reach its end: R is {shown[0]}, half the distance is {shown[1]}.")
    if half / size > 1.0 - 1e-12:
        half = size
    side = -1.0 if (block.motion == 20) == (radius > 0) else 1.0
    theta = math.atan2(end_y - y, end_x - x) + side * math.pi / 2.0
    offset = size * math.cos(math.asin(half / size))
    return (end_x + x) / 2.0 + offset * math.cos(theta), (end_y + y) / 2.0 + offset * math.sin(theta)


def home(machine: Machine, block: Block, code: int) -> None:
    """G28 and G30: by way of the point on the line to the stored point, which is 5161... or 5181... (mm)."""
    if machine.compensation is not None:
        raise block.refuse(f"G{code // 10} cannot be used with cutter compensation on; use G40 first.")
    end = find_end(machine, block)
    machine.traverse(block.line, end)
    stored = 5161 if code == 280 else 5181
    values = machine.store.numbered[stored : stored + 6]
    target = [machine.from_user(v) for v in values[:3]] + values[3:]
    words = dict(zip(XYZABC, target))
    target = _machine_end(machine, words)
    chosen = [letter in block.words for letter in XYZABC]
    final = [t if c or not any(chosen) else e for t, e, c in zip(target, end, chosen)]
    machine.traverse(block.line, final)
    machine.p = final


def save_home(machine: Machine, block: Block, code: int) -> None:
    """G28.1 and G30.1: store the current point."""
    if machine.compensation is not None:
        raise block.refuse("a reference point cannot be stored with cutter compensation on; use G40 first.")
    stored = 5161 if code == 281 else 5181
    total = [machine.p[i] + machine.g5x[i] + machine.g92[i] for i in range(6)]
    lengths = [machine.to_user(total[i] + machine.length_offset[i]) for i in range(3)]
    machine.store.numbered[stored : stored + 6] = [*lengths, *total[3:]]
