"""What may have happened to a row that does not fit the others: the one slip whose mending makes it fit them.

A sign turned, a unit or a decimal point, columns swapped, something of the row above or below. Each is undone and the
row held against what the others predict for it; a slip is named where the row then fits within their scatter, and two
of them where both do.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations

import numpy as np

from robomill.arrays import FloatArray
from robomill.compliance.gravity import GRAVITY
from robomill.identification.diagnostics import MANY, scatter
from robomill.identification.fit.fitting import Fitted
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import measured_terms
from robomill.identification.load_test import JointTests, LoadTests
from robomill.identification.pull.points import at_shift
from robomill.identification.result import Outlier, Slip
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.units import format_count, to_si
from robomill.wording import listed

TIMES = {1000.0: "a unit's prefix", to_si(1.0, "in") / to_si(1.0, "mm"): "inches", -GRAVITY[2]: "kilogram-force"}
TIMES |= dict.fromkeys((10.0, 100.0), "a decimal point")
MOST = 12  # rows that are looked into
NAMED = 6  # rows that a sentence names
WORSE = 9.0  # in squared standard deviations: how much worse another slip must fit to be left unnamed
Trial = tuple[Slip, FloatArray, FloatArray]  # what is undone, the row's readings then, and what is predicted for them


def with_slips(
    robot: Robot, tests: LoadTests | JointTests, choice: Model, fitted: Fitted, found: tuple[Outlier, ...]
) -> tuple[Outlier, ...]:
    """Outliers with the slips that would explain them."""
    if not found:
        return ()
    others = _Others(robot, tests, choice, fitted)
    return tuple(replace(o, slips=_Row(others, o.row).slips()) if k < MOST else o for k, o in enumerate(found))


class _Others:
    """What all rows but the gross ones say: residuals, scatter, the limit in units of it, and the springs x (p,)."""

    def __init__(self, robot: Robot, tests: LoadTests | JointTests, choice: Model, fitted: Fitted) -> None:
        self.robot, self.tests, self.choice, self.fitted = robot, tests, choice, fitted
        system = fitted.system
        self.residual, self.scatter, self.limit = scatter(system)
        w = np.where(np.abs(self.residual) > self.limit * self.scatter, 0.0, 1.0 / system.noise)
        self.x = np.linalg.lstsq(system.A * w[:, None], system.b * w, rcond=None)[0]


class _Row:
    """One row: its readings, what the others predict for them, and the size of their scatter."""

    def __init__(self, others: _Others, row: int) -> None:
        self.others, self.tests = others, others.tests
        system = others.fitted.system
        self.at = int(np.flatnonzero(self.tests.row == row)[0])
        self.here = np.flatnonzero(system.test == self.at)
        self.read, self.scatter = system.b[self.here], others.scatter[self.here]
        self.predicted = self.read - others.residual[self.here]

    def slips(self) -> tuple[Slip, ...]:
        """What makes the row fit, the likeliest first, at most two."""
        cost: dict[Slip, float] = {}
        for slip, read, predicted in self._trials():
            off = np.abs(read - predicted) / self.scatter
            if off.max() <= self.others.limit:
                cost[slip] = min(float(off @ off), cost.get(slip, np.inf))
        best = min(cost.values(), default=0.0)
        return tuple(sorted((s for s, c in cost.items() if c <= best + WORSE), key=cost.__getitem__))[:2]

    def _trials(self) -> Iterator[Trial]:
        read, here = self.read, self.predicted
        what = "the angle or the torque" if self.tests.single else "the reading or the force"
        yield Slip("sign", f"the sign of {what} is turned"), -read, here
        for factor, meant in TIMES.items():
            number = f"{factor:.3g}" if factor % 1 else f"{factor:.0f}"
            yield Slip("unit", f"the reading is {number} times too large ({meant}?)"), read / factor, here
            yield Slip("unit", f"the reading is {number} times too small ({meant}?)"), read * factor, here
        names = self._names()
        if len(read) > 1:
            for k, name in enumerate(names):
                yield (
                    Slip("sign", f"the sign of {name} is turned"),
                    np.where(np.arange(len(read)) == k, -read, read),
                    here,
                )
        for order in list(permutations(range(len(read))))[1:]:
            yield Slip("swapped", f"{_order(names, order)}"), read[list(order)], here
        if not self.tests.single:
            yield from self._others()

    def _names(self) -> list[str]:
        if self.tests.single:
            return ["the angle"]
        component = self.others.fitted.system.component[self.here]
        linear = [f"d{a}" for a in "xyz"] if self.tests.gauges is None else list(self.tests.components)
        return [(*linear, "rx", "ry", "rz")[c] for c in component]

    def _others(self) -> Iterator[Trial]:
        """Slips of the force, and what may have come from the row above or below."""
        tests = self.tests
        assert isinstance(tests, LoadTests)
        assert tests.theta is not None
        own = tests.select([self.at])
        F = own.wrench[0, :3]
        names = ["Fx", "Fy", "Fz"]
        for order in list(permutations(range(3)))[1:]:
            yield Slip("swapped", _order(names, order)), self.read, self._of(own, F[list(order)])
        for k, name in enumerate(names):
            turned = np.where(np.arange(3) == k, -F, F)
            yield Slip("sign", f"the sign of {name} is turned"), self.read, self._of(own, turned)
        for j in (self.at - 1, self.at + 1):
            if not 0 <= j < len(tests):
                continue
            other = tests.select([j])
            row = int(tests.row[j])
            yield Slip("neighbour", f"the reading is that of row {row}"), self.read, self._of(other)
            yield (
                Slip("neighbour", f"the force of row {row} belongs here"),
                self.read,
                self._of(own, other.wrench[0, :3]),
            )
            moved = replace(own, theta=other.theta)
            yield Slip("neighbour", f"the pose of row {row} belongs here"), self.read, self._of(moved)

    def _of(self, test: LoadTests, F: FloatArray | None = None) -> FloatArray:
        """What the others predict for this row's readings, were it ``test``, under another force."""
        wrench = test.wrench if F is None else np.concatenate([F, test.wrench[0, 3:]])[None]
        read = self.tests.displacement[[self.at]]  # type: ignore[union-attr]
        test = replace(test, wrench=wrench, displacement=read)
        others = self.others
        freed = others.fitted.system.freed
        terms = measured_terms(others.robot, test, others.choice, freed)[0]
        return np.asarray(at_shift(terms, others.fitted.found.shift, freed) @ others.x)


def _order(names: list[str], order: tuple[int, ...]) -> str:
    moved = [name for k, name in enumerate(names) if order[k] != k]
    return f"{listed(moved)} are swapped" if len(moved) == 2 else f"{listed(moved)} stand in another order"


def outlier_findings(found: tuple[Outlier, ...], tests: int) -> tuple[Finding, ...]:
    """Rows that do not fit, each with what may have happened to it."""
    if not found:
        return ()
    named = "; ".join(each.sentence() for each in found[:NAMED])
    more = f"; and {len(found) - NAMED} more" if len(found) > NAMED else ""
    text = f"{format_count(len(found), 'test')} {'do' if len(found) > 1 else 'does'} not fit the others: {named}{more}."
    if len(found) > MANY * tests:
        text += " So many speak against the model rather than against the readings."
    else:
        text += " Such rows are used until you leave them out (exclude)."
    return (Finding("warning", text, found[0].row, count=len(found), code="outliers", place=""),)
