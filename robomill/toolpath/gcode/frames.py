"""Coordinates that are shifted and turned on top of their coordinate system: G68, TRANS and ROT, CYCL DEF 7 and 10."""

from robomill.toolpath.gcode import codes as modal
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.rules.motion_rules import rotate
from robomill.toolpath.gcode.words import Block


def without_offsets(machine: Machine) -> list[float]:
    """The current point without offsets (tool length left in)."""
    point = [p + o for p, o in zip(machine.p, machine.g92)]
    point[0], point[1] = rotate(point[0], point[1], machine.rotation)
    return [p + o for p, o in zip(point, machine.g5x)]


def turn_about(machine: Machine, block: Block) -> None:
    """G68: coordinates are turned by R degrees about X, Y (where they are not given: about where the tool is).

    The centre is a place in G91, too (Fanuc, Mitsubishi); whether R is one there is a setting of the control.
    """
    machine.need_compensation_off(block, "G68")
    words = block.words
    if machine.scale is not None:
        raise block.refuse("G68 while coordinates are scaled (G51) is not read; end that first (G50).")
    if block.g.get(modal.PLANE, 10 * machine.plane) != 170 or "r" not in words:
        raise block.refuse("G68 is read in G17, with R, its angle; write the moves out.")
    if machine.before_turn is not None and not machine.is_absolute(block):
        raise block.refuse("G68 in G91 inside of G68 turns to R or by R, as the control is set; write it in G90.")
    if words.keys() & set("zijk"):
        raise block.refuse("G68 with Z, I, J or K turns coordinates in space, which is not read; write the moves out.")
    turn_back(machine)
    if words.keys() & {"a", "b"}:  # Mach3's names of the centre
        words["x"], words["y"] = words.pop("a", 0.0), words.pop("b", 0.0)
    centre = [words.pop(letter, at) + o for letter, at, o in zip("xy", machine.p, machine.g92)]
    machine.before_turn = machine.g5x, machine.rotation
    rotation = machine.rotation + words.pop("r")
    was, now = (rotate(centre[0], centre[1], angle) for angle in (machine.rotation, rotation))
    origin = [machine.g5x[0] + was[0] - now[0], machine.g5x[1] + was[1] - now[1], *machine.g5x[2:]]
    _see(machine, origin, rotation)


def turn_back(machine: Machine) -> None:
    """G69: coordinates are as they were before G68."""
    if machine.before_turn is not None:
        (origin, rotation), machine.before_turn = machine.before_turn, None
        _see(machine, origin, rotation)


def _see(machine: Machine, origin: list[float], rotation: float) -> None:
    """The machine stays where it is; its place counts from another origin and direction."""
    point = [p - o for p, o in zip(without_offsets(machine), origin)]
    point[0], point[1] = rotate(point[0], point[1], -rotation)
    machine.p = [p - o for p, o in zip(point, machine.g92)]
    machine.g5x, machine.rotation = origin, rotation


def frame_of(machine: Machine) -> tuple[list[float], float]:
    """How far coordinates are shifted (x, y, z) and turned (degrees) on top of their coordinate system."""
    if machine.before_turn is None:
        return [0.0] * 3, 0.0
    origin, rotation = machine.before_turn
    return [now - was for now, was in zip(machine.g5x[:3], origin)], machine.rotation - rotation


def see_frame(machine: Machine, shift: list[float], angle: float) -> None:
    """Coordinates are shifted and turned so far on top of their coordinate system, and no further (TRANS, ROT)."""
    turn_back(machine)
    machine.before_turn = machine.g5x, machine.rotation
    x, y = rotate(shift[0], shift[1], machine.rotation)
    origin = [machine.g5x[0] + x, machine.g5x[1] + y, machine.g5x[2] + shift[2], *machine.g5x[3:]]
    _see(machine, origin, machine.rotation + angle)
