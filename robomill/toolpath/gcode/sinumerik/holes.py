"""Holes as cycles of Sinumerik and Heidenhain drill them: down in pecks, which break the chip or bring it out."""

import math
from dataclasses import dataclass, replace

from robomill.errors import GCodeError
from robomill.toolpath.gcode.fanuc.macro_calls import MacroCalls
from robomill.toolpath.gcode.program import FEED, TRAVERSE
from robomill.toolpath.gcode.rules.motion_rules import MINUTE, dwell, feed_speed
from robomill.toolpath.gcode.words import Block
from robomill.toolpath.plane import polar

MAX_PECKS = 10_000
A_TURN = 1e-6
"""A share of a turn that is none."""
_OF_OLDER = 17
"""Values of CYCLE83 before SINUMERIK Operate."""


@dataclass(frozen=True)
class Peck:
    """A depth of a drilling cycle before its bottom, a height as all of them. From there the tool goes ``out`` of the
    hole, and back at rapid down to ``on``; or it breaks the chip: up to ``on``, ``at_feed`` or at rapid."""

    depth: float
    on: float
    out: bool
    at_feed: bool = False


@dataclass(frozen=True)
class Round:
    """How a hole is milled: its centre line (a ``radius``), how deep a turn leads, 1 counter-clockwise or -1."""

    radius: float
    step: float
    turn: int


@dataclass(frozen=True)
class Hole:
    """A drilling cycle: heights along Z in program units, dwells in s, feeds.

    A ``feed`` of 0 is the one in force, so is an ``out`` of infinity; an ``out`` of 0 is a rapid. A tap goes by its
    ``pitch`` at its own ``turns`` in and out (1/min; 0: S), or ``taps`` by a feed, in a chuck that gives. ``first`` is
    by how much the first depth is gone to slower. The tool waits for ``dwell`` at the bottom, for ``between`` at each
    depth before it and for ``above`` when it has come out of the hole in between; one that is ``round`` is milled.
    """

    retract: float
    clear: float
    bottom: float
    dwell: float
    feed: float
    out: float
    pecks: tuple[Peck, ...]
    pitch: float
    taps: bool = False
    turns: tuple[float, float] = (0.0, 0.0)
    first: float = 1.0
    between: float = 0.0
    above: float = 0.0
    round: Round | None = None


class Holes(MacroCalls):
    """Drills a hole where the tool stands."""

    def drill_here(self, hole: Hole, line: int) -> None:
        """Drill where the tool stands."""
        machine = self.machine
        block = Block(line)
        self.check_hole(hole, block)
        if hole.round is not None:
            self._mill(hole, hole.round, line)
            return
        down = hole.feed * machine.factor / MINUTE if hole.feed else None
        out = hole.out * machine.factor / MINUTE if 0.0 < hole.out < math.inf else None
        before, speed_out = (machine.motion, machine.speed), machine.speed
        if hole.pitch:
            turns = [each or machine.speed for each in hole.turns]
            if 0.0 in turns:
                raise block.refuse("CYCLE84 needs a spindle speed; give an S word first.")
            down, out = (hole.pitch * machine.factor * each / MINUTE for each in turns)
            machine.speed, speed_out = turns
        machine.motion = 840 if hole.pitch or hole.taps else machine.motion
        self._to(TRAVERSE, line, hole.clear)
        begin = down if hole.first == 1.0 else hole.first * (feed_speed(machine) if down is None else down)
        for n, peck in enumerate(hole.pecks):
            self._to(FEED, line, peck.depth, down if n else begin)
            self._wait(hole.between)
            if peck.out:
                self._to(FEED if hole.out else TRAVERSE, line, hole.clear, out)
                self._wait(hole.above)
            if peck.on < hole.clear if peck.out else peck.on > peck.depth:
                self._to(*(FEED, line, peck.on, down) if peck.at_feed else (TRAVERSE, line, peck.on))
        self._to(FEED, line, hole.bottom, down if hole.pecks else begin)
        self._wait(hole.dwell)
        machine.speed = speed_out
        if hole.out or hole.pitch:
            self._to(FEED, line, hole.clear, out)
        self._to(TRAVERSE, line, hole.retract)
        machine.motion, machine.speed = before

    def check_hole(self, hole: Hole, block: Block) -> None:
        """Raise GCodeError where a cycle cannot be drilled."""
        machine = self.machine
        machine.need_compensation_off(block, "A drilling cycle")
        if machine.plane != 17:
            raise block.refuse("a drilling cycle is read in the plane G17 alone.")
        if machine.scale is not None and machine.scale.factors[2] != 1.0:
            raise block.refuse("a drilling cycle while Z is scaled or mirrored is not read; end that before.")
        if machine.feed == 0.0 and hole.feed == 0.0 and hole.pitch == 0.0:
            raise block.refuse("a drilling cycle needs a feed rate; give an F word above 0 first.")

    def _mill(self, hole: Hole, circle: Round, line: int) -> None:
        """Down in a helix about where the tool stands, from its height on, once around at the bottom, to the middle and
        up."""
        machine = self.machine
        x, y = machine.p[:2]
        v_f = hole.feed * machine.factor / MINUTE if hole.feed else feed_speed(machine)
        turns = (hole.clear - hole.bottom) / circle.step
        place = polar(circle.radius, circle.turn * math.tau * (turns % 1.0), x, y)
        self._to(TRAVERSE, line, hole.clear)
        self._cut_to(line, (x + circle.radius, y, hole.clear), v_f)
        for (u, v), top, count in (
            (place, hole.clear, max(math.ceil(turns - A_TURN), 1)),
            (place, hole.bottom, 1),
        ):
            end = [u, v, hole.bottom, *machine.p[3:]]
            machine.go_arc(line, end, 17, [x, y, top], circle.turn * count, v_f)
            machine.p = end
        self._cut_to(line, (x, y, hole.bottom), v_f)
        self._to(TRAVERSE, line, hole.clear)
        self._to(TRAVERSE, line, hole.retract)

    def _cut_to(self, line: int, place: tuple[float, float, float], v_f: float) -> None:
        machine = self.machine
        end = [*place, *machine.p[3:]]
        machine.go(FEED, line, end, v_f)
        machine.p = end

    def _wait(self, seconds: float) -> None:
        if seconds:
            dwell(self.machine, seconds)

    def _to(self, kind: int, line: int, height: float, v_f: float | None = None) -> None:
        machine = self.machine
        end = [*machine.p[:2], height, *machine.p[3:]]
        machine.place({"z": height})
        machine.go(kind, line, end, v_f)
        machine.p = end


COARSE: dict[float, float] = dict(
    zip(
        (3, 4, 5, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 27, 30, 33, 36, 39, 42, 45, 48),
        (0.5, 0.7, 0.8, 1, 1.25, 1.5, 1.75, 2, 2, 2.5, 2.5, 2.5, 3, 3, 3.5, 3.5, 4, 4, 4.5, 4.5, 5),
        strict=True,
    )
)
"""mm: pitch of coarse metric threads by their size, M3 to M48 (ISO 261)."""


def drilling_cycle(kind: str, given: list[float], factor: float, line: int) -> Hole:
    """CYCLE81 to 89 by its ``kind`` ("83") and what is ``given`` in its brackets (NaN for nothing), lengths in program
    units of ``factor`` m."""
    given = [*given, *[math.nan] * (17 - len(given))]
    retract, reference, safety, bottom, below = given[:5]
    if math.isnan(retract + reference) or (math.isnan(bottom) and math.isnan(below)):
        raise GCodeError.at(line, f"CYCLE{kind} needs RTP, RFP and DP or DPR, as in CYCLE{kind}(50,0,2,-10).")
    if kind in "8182" and not math.isnan(given[6]) and given[6] != 0.0:
        raise GCodeError.at(line, f"CYCLE{kind} counts its depth by the diameter (_GMODE), which is not read; give DP.")
    if math.isnan(bottom) or abs(below) > 0.0:  # where both are given DPR counts
        bottom = reference - abs(below)
    clear = reference + (0.0 if math.isnan(safety) else abs(safety))
    if bottom >= clear or retract < clear:
        raise GCodeError.at(line, f"CYCLE{kind}: expected RTP above RFP + SDIS, and the depth below; mend them.")
    wait = given[8] if kind == "83" else given[5] if kind != "87" else math.nan
    pitch, turns = _tapped(given, factor, line) if kind == "84" else (0.0, (0.0, 0.0))
    feeds = [0.0 if math.isnan(v) else abs(v) for v in (given[6], given[7])] if kind == "85" else [0.0, 0.0]
    feeds[1] = math.inf if kind == "89" else feeds[1]
    seconds = 0.0 if math.isnan(wait) else max(wait, 0.0)
    hole = Hole(retract, clear, bottom, seconds, feeds[0], feeds[1], (), pitch, turns=turns)
    return _pecked(hole, given, reference, factor, line) if kind == "83" else hole


def of_percentages(given: list[float]) -> list[float] | None:
    """What CYCLE83 is given where its DAM and FRF are percentages, as SINUMERIK Operate writes them (90 and 90): as the
    factors that they are; None where they are none. Operate gives more values than the older cycle has, and no stroke
    can be less by more than the first one is deep."""
    if len(given) <= _OF_OLDER:
        return None
    first = abs(given[6]) if math.isnan(given[5]) else abs(given[1] - given[5])
    less, slower = given[7], given[10]
    falls, slows = first < less <= 100.0, 1.0 < slower <= 100.0
    if not (falls or slows):
        return None
    return [
        *given[:7],
        -less / 100.0 if falls else less,
        *given[8:10],
        slower / 100.0 if slows else slower,
        *given[11:],
    ]


def _tapped(given: list[float], factor: float, line: int) -> tuple[float, tuple[float, float]]:
    """CYCLE84: its pitch, in program units or by _PITA in mm, and turns (1/min) in and out: SST, and SST1 or SST."""
    size, pitch, _, going_in, out, _, unit = (0.0 if math.isnan(each) else abs(each) for each in given[7:14])
    if pitch == 0.0 and size in COARSE:
        return COARSE[size] * 1e-3 / factor, (going_in, out or going_in)
    if pitch == 0.0:
        raise GCodeError.at(line, "CYCLE84 needs PIT, its pitch, or MPIT, the size of its thread (3 to 48); give it.")
    if unit not in (0.0, 1.0):
        raise GCodeError.at(line, f"CYCLE84 has its pitch by _PITA {unit:g}; expected 0 or 1, a length.")
    return pitch * (1e-3 / factor if unit else 1.0), (going_in, out or going_in)


def _pecked(hole: Hole, given: list[float], reference: float, factor: float, line: int) -> Hole:
    """CYCLE83: VARI 1 goes out of the hole and back at rapid to DIS1 above the depth (0: 0.6 mm, or a 50th of holes
    deeper than 30 mm, 7 mm at most); VARI 0 goes up by VRT (0: 1 mm) at feed."""
    said = [0.0 if math.isnan(each) else each for each in given]
    mm = 1e-3 / factor
    goes_out, depth = said[11] == 1.0, reference - hole.bottom
    usual = min(max(0.6 * mm, depth / 50.0 if depth > 30.0 * mm else 0.0), 7.0 * mm) if goes_out else mm
    up = abs(said[16 if goes_out else 14]) or usual
    depths = _depths(given, reference, hole.bottom, line)
    pecks = tuple(Peck(each, min(each + up, hole.clear), goes_out, not goes_out) for each in depths)
    slower, last = said[10] if 0.0 < said[10] < 1.0 else 1.0, said[15]
    dwell = last if last > 0.0 else hole.dwell
    return replace(hole, dwell=dwell, pecks=pecks, first=slower, between=hole.dwell, above=max(said[9], 0.0))


def _depths(given: list[float], reference: float, bottom: float, line: int) -> list[float]:
    """Depths of CYCLE83 before the last: FDEP or FDPR first; then each stroke is less by DAM, and DAM at least, or
    by a factor where DAM is negative, and MDEP at least."""
    first = reference - abs(given[6]) if math.isnan(given[5]) else given[5]
    step = reference - first
    if math.isnan(first) or step <= 0.0:
        raise GCodeError.at(line, "CYCLE83 needs FDEP or FDPR, its first depth.")
    less, least = (0.0 if math.isnan(each) else each for each in (given[7], given[13]))
    if less < -1.0:
        raise GCodeError.at(line, f"CYCLE83 has DAM {less:g}; a factor is -1 to 0, an amount above 0.")
    depths: list[float] = []
    while first > bottom:
        depths.append(first)
        step = max(step - less, less) if less > 0.0 else max(-less * step, least) if less < 0.0 else step
        rest = first - bottom
        first -= 0.5 * rest if step == less < rest <= 2.0 * less else step  # the last two are alike
        if len(depths) > MAX_PECKS:
            raise GCodeError.at(line, f"CYCLE83 would need more than {MAX_PECKS} pecks; give a larger FDPR.")
    return depths
