"""Where a machine stands that nobody knows: before its first move, on controls that are not LinuxCNC, and where a
probe has met something. There G92 says it."""

from robomill.toolpath.gcode.machine import XYZABC, Machine
from robomill.toolpath.gcode.program import PROBE
from robomill.toolpath.gcode.rules.motion_rules import to_frame
from robomill.toolpath.gcode.words import Block
from robomill.units import to_si


def begins(machine: Machine) -> bool:
    """Whether nobody knows yet where the machine stands."""
    return not (machine.strict or len(machine.recorder) or machine.recorder.held or any(machine.g92) or any(machine.p))


def measured(machine: Machine) -> bool:
    """Whether the tool stands where its probe has met something: the program does not say where that is."""
    last = machine.recorder.last()
    return not machine.strict and last is not None and int(last["kind"]) == PROBE


def stand(machine: Machine, block: Block) -> None:
    """G92 (or G10 L20) says where the tool stands: part zero is where it counts from."""
    probed = measured(machine)
    for axis, letter in enumerate(XYZABC):
        machine.p[axis] = block.words.get(letter, machine.p[axis])
        if axis >= 3:
            machine.turned[axis - 3] = to_si(machine.p[axis], "deg")
    machine.sent = list(machine.p)
    x, y, z = machine.p[:3]
    to_frame(machine, x, y, z, machine.at)
    if probed:
        text = "is read as where the tool stands, from part zero, as its probe has just found it"
        machine.note("probed-zero", "info", f"G92 or G10 L20 behind a probe {text}")
        return
    machine.note("begins-at", "info", "G92 before the first move is read as where the tool stands, from part zero")


def stand_at_home(machine: Machine, block: Block) -> set[int]:
    """G92 behind G28 says where the machine's home lies from part zero, as programs without G54 do: of x, y and z those
    that are so, whose zero is not moved. The home stays a place that is clear of the part, wherever it is.
    """
    homes = {axis for axis, letter in enumerate("xyz") if machine.away[axis] and letter in block.words}
    if not (machine.other_control or machine.feed_in_block):  # LinuxCNC, said or supposed, knows where its home lies
        return set()
    for axis in homes:
        machine.p[axis] = machine.sent[axis] = block.words["xyz"[axis]]
    if homes:
        x, y, z = machine.p[:3]
        to_frame(machine, x, y, z, machine.at)
        text = "G92 or G10 L20 behind G28, G30 or G53 is read as where the tool stands there, from part zero"
        machine.note("begins-at", "info", text)
    return homes


def note_moved(machine: Machine, before: list[float]) -> None:
    """A frame (TRANS, ROT, SCALE ...) has moved the zero of axes: a line says otherwise where the tool stands than
    ``before``."""
    now = machine.said_point()
    machine.moved |= {axis for axis in range(3) if abs(now[axis] - before[axis]) > 1e-9}


def settle(machine: Machine, block: Block) -> None:
    """Say where a line goes by a step along an axis whose zero a frame has moved; a place settles where it is."""
    said = {axis for axis in machine.moved if XYZABC[axis] in block.words}
    if said and not machine.is_absolute(block):
        note_step(machine, XYZABC[min(said)])
    machine.moved -= said


def note_step(machine: Machine, letter: str) -> None:
    """A step behind a frame, which a control may add to what the frame moves (840D sl, setting data 42440)."""
    text = (
        f"{letter.upper()} is a step behind a frame that has moved its zero: it is read as that step alone; "
        f"a Sinumerik adds what the frame moves, unless its setting 42440 is 0: give {letter.upper()} as a place first"
    )
    machine.note("step-behind-frame", "warning", text)
