"""Cutter radius compensation G41, G42: the path of the cutter's centre beside the programmed contour.

Follows LinuxCNC: the entry move leads to the side of its end point (on other controls beside the start of the contour,
square to it: Fanuc type A, Sinumerik NORM, Heidenhain RL and RR); outside corners get an arc about the corner;
inside corners shorten both moves to where the offset contours meet, so a move is held back until the next one
is known; a contour that the cutter cannot follow without gouging is refused. Coordinates u, v are those of the
plane (G17: x, y; G18: z, x) in program units.
"""

import math
from typing import Any

from robomill.errors import GCodeError
from robomill.toolpath.gcode.corners import BETWEEN
from robomill.toolpath.gcode.held_moves import BESIDE_ARC, SHARPEST, HeldMove
from robomill.toolpath.gcode.machine import Machine
from robomill.toolpath.gcode.moves import centre_of_arc, plain_words
from robomill.toolpath.gcode.program import FEED, TRAVERSE
from robomill.toolpath.gcode.rules.motion_rules import arc_length, feed_speed, inverse_time, turns_of
from robomill.toolpath.gcode.words import Block
from robomill.toolpath.plane import axes, polar, swept

CORNER = 0.05
"""rad: directions that differ by less go straight on."""
OVERSHOOT = {"mm": 0.0254, "in": 0.001}
"""rad: an arc may sweep this much farther than programmed to meet the next move."""
_HALF = math.pi / 2.0


class Compensation:
    """State while G41 or G42 is on. ``programmed`` is the programmed point (u, v, w), None before the first move."""

    def __init__(self, left: bool, radius: float, orientation: int, plane: int) -> None:
        self.left = left
        self.radius = radius
        self.orientation = orientation
        self.plane = plane
        self.axes = axes(plane)
        self.programmed: tuple[float, float, float] | None = None
        self.held: list[HeldMove] = []
        self.corner: tuple[float, float] | None = None
        self.entering = False
        self.due: Any = None

    # --- frames
    def current(self, machine: Machine) -> tuple[float, float, float]:
        """The compensated point (u, v, w)."""
        return machine.p[self.axes[0]], machine.p[self.axes[1]], machine.p[self.axes[2]]

    def programmed_point(self, machine: Machine) -> list[float]:
        """The programmed point as (x, y, z, a, b, c)."""
        if self.due is not None:
            return list(self.due.end)
        assert self.programmed is not None
        point = list(machine.p)
        point[self.axes[0]], point[self.axes[1]] = self.programmed[0], self.programmed[1]
        return point

    def centre_of(self, machine: Machine, block: Block, start: list[float], end: list[float]) -> tuple[float, float]:
        """Centre (u, v) of an arc between programmed points (6,)."""
        u, v, _ = self.axes
        return centre_of_arc(machine, block, (start[u], start[v]), (end[u], end[v]))

    def scale(self, ratio: float) -> None:
        """Change the unit of all lengths."""
        if self.due is not None:
            self.due.end[:3] = [v * ratio for v in self.due.end[:3]]
            self.due.corner, self.due.feed = self.due.corner.scaled(ratio), self.due.feed * ratio
        self.radius *= ratio
        if self.programmed is not None:
            self.programmed = (self.programmed[0] * ratio, self.programmed[1] * ratio, self.programmed[2] * ratio)
        if self.corner is not None:
            self.corner = (self.corner[0] * ratio, self.corner[1] * ratio)
        for move in self.held:
            move.end = (move.end[0] * ratio, move.end[1] * ratio, move.end[2] * ratio)
            move.centre = (move.centre[0] * ratio, move.centre[1] * ratio)

    def _inside(self, turn: int) -> bool:
        return (turn > 0) == self.left

    def _hold(
        self, machine: Machine, block: Block, end: tuple[float, float, float], full: list[float], **more: object
    ) -> None:
        rapid = block.motion == 0
        self.held.append(
            HeldMove(
                block.line,
                rapid,
                end,
                (full[3], full[4], full[5]),
                0.0 if rapid else feed_speed(machine),
                **more,  # type: ignore[arg-type]
            )
        )

    # --- the queue
    def release(self, machine: Machine) -> None:
        """Record the moves that were held back."""
        self.corner = None
        shift_u, shift_v = self._lathe_shift()
        for move in self.held:
            end = [0.0, 0.0, 0.0, *move.rotary]
            end[self.axes[0]], end[self.axes[1]] = move.end[0] + shift_u, move.end[1] + shift_v
            end[self.axes[2]] = move.end[2]
            if move.turn:
                centre = [0.0, 0.0, 0.0]
                centre[self.axes[0]], centre[self.axes[1]] = move.centre[0] + shift_u, move.centre[1] + shift_v
                centre[self.axes[2]] = move.end[2]
                machine.go_arc(move.line, end, self.plane, centre, move.turn, move.v_f)
            else:
                machine.go(TRAVERSE if move.rapid else FEED, move.line, end, move.v_f)
        self.held = []

    def _lathe_shift(self) -> tuple[float, float]:
        """(z, x) from the centre of a lathe tool's nose to the point that is programmed; 0 for mills."""
        if self.plane != 18:
            return 0.0, 0.0
        z = {1: 1, 4: 1, 5: 1, 2: -1, 3: -1, 7: -1}.get(self.orientation, 0)
        x = {1: -1, 2: -1, 6: -1, 3: 1, 4: 1, 8: 1}.get(self.orientation, 0)
        return z * self.radius, x * self.radius

    def _finish_at(self, machine: Machine, block: Block, u: float, v: float) -> None:
        """End the held moves at (u, v) and record them. Raises GCodeError where the cutter would gouge."""
        if not self.held:
            return
        corner = self.corner
        for move in self.held:
            if move.turn:
                if move.sweep and corner is not None:
                    sweep = swept(corner, (u, v), move.centre, move.turn, 0.0)
                    if abs(sweep) > abs(move.sweep) + OVERSHOOT[machine.unit]:
                        raise self._gouge(block, "the arc before it")
            elif corner is not None:
                along = move.direction[0] * (u - corner[0]) + move.direction[1] * (v - corner[1])
                if along < 0:
                    raise self._gouge(block, "the straight move before it")
            move.end = (u, v, move.end[2])
        self.release(machine)
        self.corner = (u, v)

    @staticmethod
    def _gouge(block: Block, what: str) -> GCodeError:
        return block.refuse(f"the cutter does not fit into the inside corner with {what}; use a smaller cutter.")

    def finish(self, machine: Machine, block: Block) -> None:
        """Record what is held, as at the end of the program or before a stop."""
        if self.due is not None:
            raise self.due.block.refuse(BETWEEN)
        if self.programmed is not None:
            u, v, _ = self.current(machine)
            self._finish_at(machine, block, u, v)

    def off(self, machine: Machine, block: Block) -> None:
        """G40: record what is held and go on from the programmed point."""
        if self.programmed is not None:
            self.finish(machine, block)
            aside, machine.p = list(machine.p), self.programmed_point(machine)
            machine.leaving = [was - now for was, now in zip(aside, machine.p)] if machine.other_control else None
            machine.arc_not_allowed = True
        machine.compensation = None

    def _stand(self, machine: Machine, u: float, v: float, full: list[float], programmed: tuple[float, float]) -> None:
        w = full[self.axes[2]]
        machine.p = list(full)
        machine.p[self.axes[0]], machine.p[self.axes[1]] = u, v
        self.programmed = (programmed[0], programmed[1], w)

    def stand_beside(self, machine: Machine, start: list[float]) -> None:
        """The tool stands beside the contour's first point ``start``, where moves of its own have led it."""
        u, v, _ = self.current(machine)
        self._stand(machine, u, v, list(machine.p), (start[self.axes[0]], start[self.axes[1]]))
        self.corner = (u, v)

    # --- straight moves
    def straight(self, machine: Machine, block: Block, full: list[float]) -> None:
        """G0 or G1 to the programmed point ``full`` (x, y, z, a, b, c)."""
        u, v, w = (full[axis] for axis in self.axes)
        if self.programmed is None:
            self._enter_straight(machine, block, full, u, v, w)
            return
        pu, pv, _ = self.programmed
        cu, cv, cw = self.current(machine)
        if u == pu and v == pv:
            self._hold(machine, block, (cu, cv, w), full)
            self._stand(machine, cu, cv, full, (u, v))
            return
        alpha = math.atan2(v - pv, u - pu)
        if self.entering:
            cu, cv = self._entered(alpha)
        theta = math.atan2(cv - pv, cu - pu)
        if self.left:
            theta += 2.0 * math.pi if theta < alpha else 0.0
            beta = theta - alpha - _HALF
        else:
            alpha += 2.0 * math.pi if alpha < theta else 0.0
            beta = alpha - theta - _HALF
        gamma = _HALF if self.left else -_HALF
        side = polar(self.radius, alpha + gamma)
        before = self.held[0].turn if self.held else 0
        around = beta > math.pi - CORNER and before != 0 and not self._inside(before)
        if beta < -CORNER or beta > math.pi + CORNER or around:
            if before:
                mid = self._arc_to_line(block, before, (pu, pv), math.atan2(v - pv, u - pu))
            else:
                mid = self._line_to_line(block, (cu, cv), beta, theta + gamma)
            self._finish_at(machine, block, *mid)
        elif beta > CORNER and machine.sharp and beta <= SHARPEST:
            if before:
                raise block.refuse(BESIDE_ARC)
            out = 1.0 / (1.0 + math.cos(beta))  # where both offset cuts meet
            self._finish_at(machine, block, pu + out * (cu - pu + side[0]), pv + out * (cv - pv + side[1]))
        elif beta > CORNER:
            self._finish_at(machine, block, cu, cv)
            self._round(machine, block, full, (pu + side[0], pv + side[1]), (pu, pv), cw)
        else:
            self.release(machine)
            self.corner = (cu, cv)
        self._hold(machine, block, (u + side[0], v + side[1], w), full, direction=(u - pu, v - pv))
        self._stand(machine, u + side[0], v + side[1], full, (u, v))

    def _enter_straight(self, machine: Machine, block: Block, full: list[float], u: float, v: float, w: float) -> None:
        cu, cv, _ = self.current(machine)
        if math.hypot(u - cu, v - cv) <= self.radius and not machine.other_control:
            raise block.refuse(
                "the first move with cutter compensation is not longer than the cutter's radius; start farther away."
            )
        alpha = math.atan2(v - cv, u - cu) + (_HALF if self.left else -_HALF)
        end = polar(self.radius, alpha, u, v)
        self.corner = (cu, cv)
        self._hold(machine, block, (*end, w), full, direction=polar(1.0, alpha))
        self._stand(machine, *end, full, (u, v))
        self.entering = machine.other_control

    def _entered(self, direction: float) -> tuple[float, float]:
        """End the entry move beside the start of the contour, whose ``direction`` there is now known (u, v)."""
        assert self.programmed is not None
        self.entering = False
        side = direction + (_HALF if self.left else -_HALF)
        u, v = polar(self.radius, side, *self.programmed[:2])
        for move in self.held:
            move.end = (u, v, move.end[2])
        return u, v

    def _round(
        self,
        machine: Machine,
        block: Block,
        full: list[float],
        mid: tuple[float, float],
        centre: tuple[float, float],
        w: float,
    ) -> None:
        """Go around an outside corner: an arc, or a straight rapid for G0."""
        turn = 0 if block.motion == 0 else (-1 if self.left else 1)
        self._hold(machine, block, (*mid, w), full, centre=centre, turn=turn)
        self.release(machine)
        self.corner = mid

    def _line_to_line(self, block: Block, at: tuple[float, float], beta: float, back: float) -> tuple[float, float]:
        half = (beta + math.pi) / 2.0
        if half == 0.0:
            raise self._gouge(block, "the straight move before it")
        retreat = self.radius / math.tan(half)
        return polar(retreat, back, *at)

    def _arc_to_line(
        self, block: Block, turn: int, corner: tuple[float, float], direction: float
    ) -> tuple[float, float]:
        previous = self.held[0]
        radius = math.hypot(previous.centre[0] - previous.end[0], previous.centre[1] - previous.end[1])
        inside = self._inside(turn)
        contour = radius + self.radius if inside else radius - self.radius
        theta = direction + _HALF if turn > 0 else direction - _HALF
        phi = math.atan2(previous.centre[1] - corner[1], previous.centre[0] - corner[0])
        distance = contour * math.cos(theta - phi) + (-self.radius if inside else self.radius)
        angle = math.acos(self._ratio(block, distance, radius))
        if inside == (turn > 0):
            angle = -angle
        angle += theta + math.pi
        return polar(radius, angle, *previous.centre)

    def _ratio(self, block: Block, part: float, whole: float) -> float:
        ratio = part / whole if whole else math.inf
        if not -1.0 <= ratio <= 1.0:
            raise self._gouge(block, "the arc before it")
        return ratio

    # --- arcs
    def arc(self, machine: Machine, block: Block, full: list[float]) -> None:
        """G2 or G3 to the programmed point ``full``."""
        u, v, w = (full[axis] for axis in self.axes)
        turn = turns_of(plain_words(block), block.motion)
        if self.programmed is None:
            if machine.other_control:
                raise block.refuse(
                    "cutter compensation begins on a straight move (G0, G1) on this control, not an arc."
                )
            self._enter_arc(machine, block, full, (u, v, w), turn)
            return
        pu, pv, _ = self.programmed
        cu, cv, cw = self.current(machine)
        centre = centre_of_arc(machine, block, (pu, pv), (u, v))
        inverse_time(machine, plain_words(block), arc_length(machine, full, (pu, pv), centre, turn))
        radius = math.hypot(centre[0] - u, centre[1] - v)
        inside = self._inside(turn)
        if inside and radius <= self.radius:
            raise self._too_small(block)
        quarter = -_HALF if self.left else _HALF
        delta = math.atan2(centre[1] - pv, centre[0] - pu)
        alpha = delta - _HALF if turn > 0 else delta + _HALF
        if self.entering:
            cu, cv = self._entered(alpha)
        theta = math.atan2(cv - pv, cu - pu) + quarter
        beta = theta - alpha if self.left else alpha - theta
        beta += -2.0 * math.pi if beta > 1.5 * math.pi else (2.0 * math.pi if beta < -_HALF else 0.0)
        away = (centre[0] - u, centre[1] - v) if inside else (u - centre[0], v - centre[1])
        gamma = math.atan2(away[1], away[0])
        end = polar(self.radius, gamma, u, v)
        sweep = swept((pu, pv), (u, v), centre, turn, 0.0)
        if beta < -CORNER or beta > math.pi + CORNER or (abs(beta - math.pi) < CORNER and not inside):
            if self.held and self.held[0].turn:
                mid = self._arc_to_arc(block, centre, radius, turn)
            else:
                mid = self._line_to_arc(block, centre, radius, turn, theta, beta)
            self._finish_at(machine, block, *mid)
        elif beta > CORNER and machine.sharp:
            raise block.refuse(BESIDE_ARC)
        elif beta > CORNER:
            delta += 0.0 if inside else math.pi
            mid = polar(self.radius, delta, pu, pv)
            self.release(machine)
            self._round(machine, block, full, mid, (pu, pv), cw)
        else:
            self.release(machine)
            self.corner = (cu, cv)
        self._hold(machine, block, (*end, w), full, centre=centre, turn=turn, sweep=sweep)
        self._stand(machine, *end, full, (u, v))

    @staticmethod
    def _too_small(block: Block) -> GCodeError:
        return block.refuse("the arc is not larger than the cutter; the cutter does not fit inside.")

    def _enter_arc(
        self, machine: Machine, block: Block, full: list[float], end: tuple[float, float, float], turn: int
    ) -> None:
        u, v, w = end
        cu, cv, cw = self.current(machine)
        if math.hypot(u - cu, v - cv) <= self.radius:
            raise block.refuse(
                "the first arc with cutter compensation does not lead farther than the cutter's radius; start farther "
                "away."
            )
        size = abs(block.words["r"]) if "r" in block.words else None
        centre = centre_of_arc(machine, block, (cu, cv), (u, v))
        inside = self._inside(turn)
        if inside and (math.hypot(centre[0] - cu, centre[1] - cv) if size is None else size) <= self.radius:
            raise self._too_small(block)
        inverse_time(machine, plain_words(block), arc_length(machine, full, (cu, cv), centre, turn))
        away = (centre[0] - u, centre[1] - v) if inside else (u - centre[0], v - centre[1])
        gamma = math.atan2(away[1], away[0])
        eu, ev = polar(self.radius, gamma, u, v)
        towards = math.atan2(centre[1] - ev, centre[0] - eu)
        lean = math.cos(math.atan2(cv - ev, cu - eu) - towards)
        if abs(lean) < 1e-6:
            raise self._too_small(block)
        reach = math.hypot(cv - ev, cu - eu) / 2.0 / lean
        centre = polar(reach, towards, eu, ev)
        if self.orientation not in (0, 9):
            self._hold(machine, block, (cu, cv, cw), full)
            self.release(machine)  # the arc alone is still to be ended
            self.corner = (cu, cv)
        sweep = swept((cu, cv), (eu, ev), centre, turn, 0.0)
        self._hold(machine, block, (eu, ev, w), full, centre=centre, turn=turn, sweep=sweep)
        self._stand(machine, eu, ev, full, (u, v))

    def _line_to_arc(
        self, block: Block, centre: tuple[float, float], radius: float, turn: int, theta: float, beta: float
    ) -> tuple[float, float]:
        height = radius * math.sin(beta - _HALF)
        inside = self._inside(turn)
        distance = radius - self.radius if inside else radius + self.radius
        lean = math.asin(self._ratio(block, height + (self.radius if inside else -self.radius), distance))
        if inside:
            angle = theta + (lean if turn > 0 else -lean)
        else:
            angle = theta + math.pi + (-lean if turn > 0 else lean)
        return polar(distance, angle, *centre)

    def _arc_to_arc(self, block: Block, centre: tuple[float, float], radius: float, turn: int) -> tuple[float, float]:
        previous = self.held[0]
        old = math.hypot(previous.centre[0] - previous.end[0], previous.centre[1] - previous.end[1])
        new = radius - self.radius if self._inside(turn) else radius + self.radius
        apart = math.hypot(previous.centre[0] - centre[0], previous.centre[1] - centre[1])
        if old == 0 or apart == 0:
            raise block.refuse("two arcs about one centre meet in a corner; the cutter cannot follow.")
        pull = math.acos(self._ratio(block, old**2 + apart**2 - new**2, 2.0 * old * apart))
        towards = math.atan2(centre[1] - previous.centre[1], centre[0] - previous.centre[0])
        outward = self._inside(previous.turn) == (turn > 0)
        angle = towards + (pull if outward else -pull)
        return polar(old, angle, *previous.centre)
