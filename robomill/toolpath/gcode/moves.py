"""The moves of a line: its words handed to the rules of ``motion_rules``, their refusals in words, and returns home."""

import math

from robomill.toolpath.gcode import compensated_corners
from robomill.toolpath.gcode.codes import G_GROUP, LETTERS, M_GROUP, NON_MODAL, WIDTH, Q, g_name
from robomill.toolpath.gcode.corners import AT_END, ROUND
from robomill.toolpath.gcode.machine import XYZABC, Machine
from robomill.toolpath.gcode.program import FEED, TAP, TRAVERSE, Move, Rows
from robomill.toolpath.gcode.rules import cycle_rules as cycles, motion_rules as rules
from robomill.toolpath.gcode.words import Block
from robomill.units import format_si

SENTENCES = {
    rules.NO_FEED_ON_LINE: "{name} in inverse time mode (G93) needs an F word on its line.",
    rules.NO_FEED: "{name} needs a feed rate; give an F word above 0 first.",
    rules.NO_SPEED: "{name} in feed per revolution (G95) needs a spindle speed; give an S word first.",
    rules.ARC_AFTER_G40: "the move after G40 must be straight, not an arc.",
    rules.ARC_IN_NO_PLANE: "{name} in G{plane} with a rotated coordinate system (G10 R) is in no plane.",
    rules.ARC_WITHOUT_FORM: "{name} needs its centre (I, J, K) or its radius (R).",
    rules.ARC_WITH_TWO_FORMS: "{name} has both a centre (I, J, K) and a radius (R); give one of them.",
    rules.ARC_ACROSS_PLANE: "{name} has {across}, which is not in the plane G{plane}.",
    rules.ARC_CENTRE_INCOMPLETE: "{name} with absolute centre (G90.1) needs {missing}.",
    rules.RADIUS_WITHOUT_END: "{name} with R needs an end point in its plane ({ends}); R cannot say a full circle.",
    rules.ARC_ON_ITS_CENTRE: "{name} has a radius of 0; start or end lies on its centre.",
    rules.ARC_OFF_ITS_CIRCLE: "{name} does not end on its circle: the radius is {figures[0]} at the start and "
    "{figures[1]} at the end; they may differ by {figures[2]}.",
    rules.RADIUS_TO_START: "{name} with R ends where it starts; a full circle needs I, J or K.",
    rules.RADIUS_TOO_SMALL: "{name} cannot reach its end: R is {figures[0]}, half the distance is {figures[1]}.",
    rules.NO_ANGLE: "@ at the origin needs an angle ^.",
    rules.NO_DIRECTION: "incremental polar coordinates have no direction at the origin; move away first.",
    cycles.CYCLE_IN_INVERSE_TIME: "{name} cannot be used in inverse time mode (G93); use G94 first.",
    cycles.NO_CLEARANCE: "{name} needs R, its clearance plane.",
    cycles.NO_BOTTOM: "{name} needs {third}, the bottom of the hole.",
    cycles.REPEATS: f"{{name}} has L{{words[l]:g}}; expected 1 to {cycles.MAX_REPEATS} repeats.",
    cycles.NO_DWELL: "{name} needs P, its dwell in seconds.",
    cycles.NO_PECK: "{name} needs Q, its depth per peck.",
    cycles.PECK_OF_NOTHING: "{name} has {pecked}; the depth per peck must be above 0.",
    cycles.BACK_BORE_INCOMPLETE: "{name} needs {missing}.",
    cycles.SPINDLE_STANDS: "{name} needs a turning spindle; start it with M3 or M4.",
    cycles.WRONG_SPINDLE: "{name} needs the spindle turning with {sense}.",
    cycles.CLEARANCE_BELOW_BOTTOM: "{name}: R is below {third}, the bottom of the hole; R must not be below it.",
    cycles.TOO_MANY_PECKS: f"Q{{peck:g}} would need more than {cycles.MAX_PECKS} pecks; give a larger Q.",
}
"""What is said for a code of ``motion_rules`` or ``cycle_rules``."""


def demand(machine: Machine, block: Block, code: int, name: str = "") -> None:
    """Raise the refusal that a code of ``motion_rules`` stands for; 0 is none. ``name`` is the motion's, else its G."""
    if code == 0:
        return
    machine.arc_refused = code in (rules.ARC_OFF_ITS_CIRCLE, rules.ARC_ON_ITS_CENTRE) and not machine.arc_absolute
    first, second, third = rules.axes(machine.plane)
    raise block.refuse(
        SENTENCES[code].format(
            name=name or g_name(block.motion),
            plane=machine.plane,
            across="IJK"[third],
            third="XYZ"[third],
            missing=next(("IJK"[a] for a in (first, second, third) if "ijk"[a] not in block.words), ""),
            ends=f"{'XYZ'[min(first, second)]} or {'XYZ'[max(first, second)]}",
            words=block.words,
            peck=machine.cycle[Q],
            pecked=" ".join(f"{letter.upper()}{block.words[letter]:g}" for letter in "qijk" if letter in block.words),
            sense="M3" if block.motion == 840 else "M4",
            figures=[format_si(value * machine.factor, "mm", 4) for value in machine.figures],
        )
    )


def plain_words(block: Block) -> list[float]:
    """The words and codes of a line as the rules take them: in the columns of ``codes``, NaN where not given."""
    words = [math.nan] * WIDTH
    for letter, value in block.words.items():
        if letter in LETTERS:
            words[LETTERS.index(letter)] = value
    for group, code in block.g.items():
        words[G_GROUP + group] = code
    for group, code in block.m.items():
        words[M_GROUP + group] = code
    return words


def need_feed(machine: Machine, block: Block, name: str) -> None:
    """Refuse a move at feed without a feed rate."""
    demand(machine, block, rules.check_feed(machine, plain_words(block)), name)


def find_end(machine: Machine, block: Block, words: list[float] | None = None) -> list[float]:
    """Where the line leads: (x, y, z, a, b, c) in the current coordinate system. ``words``: its plain words."""
    words = words or plain_words(block)
    if block.g.get(NON_MODAL) == 530:
        if rules.is_polar(words):
            raise block.refuse("polar coordinates cannot be used with G53.")
        return _machine_end(machine, block.words)
    base = machine.p
    if machine.compensation is not None and machine.compensation.programmed is not None:
        base = machine.compensation.programmed_point(machine)
    end = list(base)
    demand(machine, block, rules.end_point(machine, words, end))
    return end


def _machine_end(machine: Machine, words: dict[str, float]) -> list[float]:
    """Where words of G53 lead: they count in machine coordinates."""
    x, y = rules.rotate(machine.p[0] + machine.g92[0], machine.p[1] + machine.g92[1], machine.rotation)
    offset = machine.length_offset
    x = words["x"] - machine.g5x[0] - offset[0] if "x" in words else x
    y = words["y"] - machine.g5x[1] - offset[1] if "y" in words else y
    x, y = rules.rotate(x, y, -machine.rotation)
    end = [x - machine.g92[0], y - machine.g92[1], *machine.p[2:]]
    for axis, letter in enumerate("zabc", 2):
        if letter in words:
            end[axis] = words[letter] - machine.g5x[axis] - machine.g92[axis] - (offset[2] if axis == 2 else 0.0)
    return end


def place(machine: Machine, block: Block) -> None:
    """What the words of a line's motion say of where the tool is: G53 says it in the machine, which is not known.

    Where the program itself has said where its part zero lies there (G10 L2), it is.
    """
    if block.g.get(NON_MODAL) == 530 and machine.system not in machine.placed:
        _leave(
            machine,
            f"{machine.machine_word} goes to a place in the machine",
            [letter in block.words for letter in "xyz"],
        )
    else:
        machine.place(block.words)


def _leave(machine: Machine, what: str, axes: list[bool]) -> None:
    if not any(axes):
        return
    text = (
        f"{what}, which is not known here: the tool is taken to be clear of the part until X, Y and Z are given again"
    )
    machine.note("machine-place", "info", text)
    machine.set_away(tuple(before or now for before, now in zip(machine.away, axes)))


def move(machine: Machine, block: Block) -> None:
    """G0, G1, G2 and G3.

    On a Fanuc cutter compensation begins and ends on moves in its plane: what goes along the third axis alone goes
    straight, before G41 has begun, and still aside of the contour where G40 has not yet been followed by a move in it.
    (16/18, Operator's Manual: a movement not in the offset plane is a block without tool movement.)
    """
    words = plain_words(block)
    demand(machine, block, rules.check_move(machine, words, block.motion))
    end = find_end(machine, block, words)
    compensation = machine.compensation
    is_arc = rules.is_arc(block.motion)
    in_plane = is_arc or _in_plane(machine, block)
    waits = machine.is_fanuc and not in_plane and compensation is not None and compensation.programmed is None
    if compensation is not None and compensation.radius > 0 and not waits and not (is_arc and machine.plane == 19):
        if machine.rounding:
            machine.need_compensation_off(block, "RNDM")
        machine.arc_not_allowed = False
        rules.keep_motion(machine, block.motion)
        if block.motion == rules.LINE:
            rules.inverse_time(machine, words, rules.straight_length(machine.p, end))
        if block.g.get(NON_MODAL) == 530:
            machine.need_compensation_off(block, "G53")
        compensated_corners.follow(machine, block, end)
        return
    row, aside = Move(block.line), None if is_arc else _aside(machine, block)
    there = end if aside is None else [p + step for p, step in zip(end, aside)]
    demand(machine, block, rules.make_move(machine, words, block.motion, there, row))
    if block.once >= 0:
        row.thread = True
        rules.keep_motion(machine, block.once)
    if aside is not None:
        machine.p, machine.arc_not_allowed = end, True
    else:
        machine.leaving = None
    if machine.corner is not None and not (row.kind == FEED or (is_arc and machine.corner.kind == ROUND)):
        raise block.refuse(AT_END)
    machine.recorder.add(row, machine.corner_of(row.kind))


def _in_plane(machine: Machine, block: Block) -> bool:
    """Whether a line names an axis of the plane, or a polar place in it."""
    named = {"xyz"[axis] for axis in rules.axes(machine.plane)[:2]}
    return not block.words.keys().isdisjoint(named | {"@", "^"})


def _aside(machine: Machine, block: Block) -> list[float] | None:
    """How far aside of the contour a line goes that names no axis of the plane behind G40; None back onto it."""
    if machine.leaving is None or _in_plane(machine, block):
        return None
    if machine.is_fanuc:
        return machine.leaving
    if max(map(abs, machine.leaving)) > 1e-9:
        text = "cutter compensation ends without a move in its plane: the tool is taken to go back onto the contour,"
        machine.note("ends-aside", "warning", f"{text} which it may cut into; leave the contour in the plane first")
    return None


def drill(machine: Machine, block: Block) -> None:
    """G73, G74 and G81 to G89."""
    machine.need_compensation_off(block, g_name(block.motion))
    rows = Rows(machine)
    refusal = cycles.cycle(machine, plain_words(block), block.motion, block.line, [0.0] * 6, rows)
    rows.keep()
    demand(machine, block, refusal)
    if block.motion == 880:
        machine.note("manual-retract", "warning", "G88 stops for a retract by hand, which the path leaves out")
    if cycles.is_tap(block.motion) and machine.plane != 17 and not machine.is_fanuc:
        message = f"{g_name(block.motion)} outside of G17 taps along the wrong axes, as LinuxCNC does"
        machine.note("tap-axes", "warning", message)


def centre_of_arc(
    machine: Machine, block: Block, start: tuple[float, float], end: tuple[float, float]
) -> tuple[float, float]:
    """Centre (u, v) in the plane of the arc of a line. Raises GCodeError naming both radii if they differ too much."""
    code, u, v = rules.arc_centre(machine, plain_words(block), block.motion, start, end)
    demand(machine, block, code)
    return u, v


def in_step(machine: Machine, block: Block) -> None:
    """G33 and G33.1: K per turn of the spindle."""
    machine.arc_not_allowed = False
    machine.motion = block.motion
    end = find_end(machine, block)
    if machine.compensation is not None and machine.compensation.radius > 0:
        machine.need_compensation_off(block, "G53" if block.g.get(NON_MODAL) == 530 else "G33")
    if machine.spindle == 0:
        raise block.refuse("G33 needs a turning spindle; start it with M3 or M4.")
    pitch_speed = abs(block.words["k"]) * machine.factor * rules.spindle_speed(machine)
    if pitch_speed == 0.0:
        raise block.refuse("G33 needs S and K above 0: they say how fast it cuts.")
    machine.go(TAP if block.motion == 331 else FEED, block.line, end, pitch_speed)
    if block.motion == 330:
        machine.p = end


def home(machine: Machine, block: Block, code: int) -> None:
    """G28 and G30: by way of the point on the line to the stored point, which is 5161... or 5181... (mm)."""
    machine.need_compensation_off(block, f"G{code // 10}")
    end = find_end(machine, block)
    machine.place(block.words)
    aside = _aside(machine, block) or [0.0] * 6
    machine.go(TRAVERSE, block.line, [p + step for p, step in zip(end, aside)])
    stored = 5161 if code == 280 else 5181
    values = machine.store.values(stored, 6)
    if code // 10 not in machine.homes and not any(values):
        given = [letter in block.words for letter in "xyz"]
        none = not any(letter in block.words for letter in XYZABC)
        _leave(machine, f"G{code // 10} goes to the machine's home", [none or each for each in given])
    target = [machine.from_user(v) for v in values[:3]] + values[3:]
    target = _machine_end(machine, dict(zip(XYZABC, target)))
    chosen = [letter in block.words for letter in XYZABC]
    final = [t if c or not any(chosen) else e for t, e, c in zip(target, end, chosen)]
    machine.go(TRAVERSE, block.line, [p + step for p, step in zip(final, aside)])
    machine.p = final


def save_home(machine: Machine, block: Block, code: int) -> None:
    """G28.1 and G30.1: store the current point."""
    if machine.compensation is not None:
        raise block.refuse("a reference point cannot be stored with cutter compensation on; use G40 first.")
    stored = 5161 if code == 281 else 5181
    machine.homes.add(code // 10)
    total = [machine.p[i] + machine.g5x[i] + machine.g92[i] for i in range(6)]
    lengths = [machine.to_user(total[i] + machine.length_offset[i]) for i in range(3)]
    machine.store.put(stored, [*lengths, *total[3:]])
