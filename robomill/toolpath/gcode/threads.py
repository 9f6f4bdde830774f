"""G76: cutting a thread along Z in passes, each a little deeper (lathe)."""

import math
from dataclasses import dataclass

from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.moves import find_end
from robomill.toolpath.gcode.program import FEED, TRAVERSE
from robomill.toolpath.gcode.rules.motion_rules import spindle_speed
from robomill.toolpath.gcode.words import Block

MAX_PASSES = 10_000


@dataclass
class _Thread:
    """What does not change from pass to pass: depths are measured from the drive line towards the work."""

    machine: Machine
    line: int
    inward: float
    drive: float
    start_z: float
    target_z: float
    end_depth: float
    height: float
    taper: float
    entry: bool
    leave: bool
    speed: float
    taper_speed: float

    def go(self, kind: int, depth: float, z: float, speed: float = 0.0) -> None:
        end = list(self.machine.p)
        end[0], end[2] = self.drive + self.inward * depth, z
        self.machine.go(kind, self.line, end, speed)

    def cut(self, depth: float, offset: float) -> None:
        """One pass at ``depth``, shifted by ``offset`` along Z."""
        clear = depth - self.end_depth
        begin, target = self.start_z - offset, self.target_z - offset
        self.go(TRAVERSE, clear, begin)
        if self.taper and self.entry:
            self.go(FEED, depth - self.height, begin, self.taper_speed)
            self.go(FEED, depth, begin - self.taper, self.taper_speed)
        else:
            self.go(TRAVERSE, depth, begin)
        if self.taper and self.leave:
            self.go(FEED, depth, target + self.taper, self.speed)
            self.go(FEED, depth - self.height, target, self.taper_speed)
        else:
            self.go(FEED, depth, target, self.speed)
        self.go(TRAVERSE, clear, target)


def thread(machine: Machine, block: Block) -> None:
    """G76 P pitch Z end I peak offset J first depth K full depth, with R, Q, E, H and L as LinuxCNC has them."""
    words = block.words
    for letter in "pijk":
        if letter not in words:
            raise block.refuse(f"G76 needs {letter.upper()}.")
    machine.need_compensation_off(block, "G76")
    if machine.spindle == 0:
        raise block.refuse("G76 needs a turning spindle; start it with M3 or M4.")
    if words["i"] == 0 or words["j"] <= 0 or words["k"] <= words["j"]:
        raise block.refuse("G76 needs I other than 0, J above 0 and K above J.")
    machine.motion = 760
    end = find_end(machine, block)
    if end[3:] != machine.p[3:]:
        raise block.refuse("G76 takes no A, B or C.")
    scale = 0.5 if machine.diameter_mode else 1.0
    peak, first, full = abs(words["i"]) * scale, words["j"] * scale, words["k"] * scale
    backward = end[2] > machine.p[2]
    slope = math.tan(math.radians(words.get("q", 0.0))) * (-1.0 if backward else 1.0)
    taper = max(words.get("e", 0.0), 0.0)
    pitch = words["p"] * machine.factor * spindle_speed(machine)
    flags = round(words.get("l", 0.0))
    shape = _Thread(
        machine,
        block.line,
        1.0 if words["i"] > 0 else -1.0,
        machine.p[0],
        machine.p[2],
        end[2] + full * slope,
        full + peak,
        full,
        -taper if backward else taper,
        bool(flags & 1),
        bool(flags & 2),
        abs(pitch),
        abs(pitch) * (math.hypot(taper, full) / taper if taper > 0 else 1.0),
    )
    degression = max(words.get("r", 1.0), 1.0)
    depth, passes = peak + first, 1
    while depth < shape.end_depth:
        shape.cut(depth, (depth - peak) * slope)
        passes += 1
        depth = peak + first * passes ** (1.0 / degression)
        if passes > MAX_PASSES:
            raise block.refuse(f"G76 would need more than {MAX_PASSES} passes; give a larger J.")
    for _ in range(min(round(words.get("h", 0.0)), MAX_PASSES) + 1):
        shape.cut(shape.end_depth, (shape.end_depth - peak) * slope)
    machine.go(TRAVERSE, block.line, end)
    machine.p = end
