"""Where a machine stands before its first move: where G92 says, on controls that are not LinuxCNC."""

from robomill.toolpath.gcode.machine import XYZABC, Machine
from robomill.toolpath.gcode.rules.motion_rules import to_frame
from robomill.toolpath.gcode.words import Block
from robomill.units import to_si


def begins(machine: Machine) -> bool:
    """Whether nobody knows yet where the machine stands."""
    return not (machine.strict or len(machine.recorder) or machine.recorder.held or any(machine.g92) or any(machine.p))


def stand(machine: Machine, block: Block) -> None:
    """G92 before the first move says where the tool stands: part zero is where it counts from."""
    for axis, letter in enumerate(XYZABC):
        machine.p[axis] = block.words.get(letter, machine.p[axis])
        if axis >= 3:
            machine.turned[axis - 3] = to_si(machine.p[axis], "deg")
    machine.sent = list(machine.p)
    x, y, z = machine.p[:3]
    to_frame(machine, x, y, z, machine.at)
    machine.note("begins-at", "info", "G92 before the first move is read as where the tool stands, from part zero")
