"""Components (gauges) that scatter unlike: where one is clearly noisier than another, readings count by their scatter.

One noise for all would make the intervals too narrow of whatever the noisier component tells, and call its good rows
outliers. Where the scatters differ by no more than chance, every reading counts alike.
"""

from dataclasses import replace

import numpy as np

from robomill.arrays import FloatArray, IntArray
from robomill.identification.fit.confidence import BISQUARE, MAD
from robomill.identification.fit.fitting import columns, linear_readings
from robomill.identification.fit.least_squares import NULL, robust_fit
from robomill.identification.fit.system import System
from robomill.progress import checkpoint

ROUNDS = 6
FEWEST = 5.0  # readings to spare in a component, from which its scatter can be judged
CHANCE = 4.0  # standard deviations of the logarithm of two scatters by which they must differ
EXACT = 1e-9  # of the readings: a scatter below it is rounding
MOST = 100.0  # the noisiest counts as no more than this many times the quietest


def balanced(system: System, group: IntArray | None = None) -> System:
    """The system with the noise of each component (or ``group`` (e,), from 0) as residuals say, where they differ."""
    group = system.component if group is None else group
    part, own = _distinct(system, group)
    size, spare = _scatters(part, own)
    judged = np.flatnonzero(spare >= FEWEST)
    if len(judged) < 2 or not _differ(size[judged], spare[judged]):
        return system
    factor = np.ones(len(size))
    for _ in range(ROUNDS):
        checkpoint()
        factor[judged] = np.maximum(size[judged], size[judged].max() / MOST)
        typical = float(np.sqrt(np.average(factor[judged] ** 2, weights=spare[judged])))
        factor[judged] /= typical
        size, spare = _scatters(replace(part, noise=part.noise * factor[own]), own)
        if (spare[judged] < FEWEST).any():
            break
        size = size * factor
    return replace(system, noise=system.noise * factor[group])


def _distinct(system: System, group: IntArray) -> tuple[System, IntArray]:
    """The equations each once, and their groups: a copy is no second reading, and makes no scatter surer."""
    first = each_once(system, group)
    if len(first) == len(group):
        return system, group
    names = ("A", "b", "noise", "test", "component", "pose")
    terms = None if system.terms is None else system.terms[first]
    return replace(system, **{name: getattr(system, name)[first] for name in names}, terms=terms), group[first]


def each_once(system: System, group: IntArray) -> IntArray:
    """(k,) the equations of each ``group`` (e,) without copies of earlier ones, in their order."""
    table = np.column_stack([system.A, system.b, system.noise, group])
    told = (table * np.sqrt(np.arange(2.0, table.shape[1] + 2.0))).sum(axis=1)  # one number a row, of copies the same
    if len(np.unique(told)) == len(told):
        return np.arange(len(told))
    return np.sort(np.unique(table, axis=0, return_index=True)[1])


def _differ(size: FloatArray, spare: FloatArray) -> bool:
    """Whether the largest and the smallest scatter differ by more than chance: log s has a variance of 1 / (2 dof)."""
    low, high = int(size.argmin()), int(size.argmax())
    chance = CHANCE * np.sqrt(0.5 / spare[low] + 0.5 / spare[high])
    return bool(np.log(size[high] / size[low]) > chance)


def _scatters(system: System, group: IntArray) -> tuple[FloatArray, FloatArray]:
    """By group of displacements: scatter over the noise, gross readings left out, and how many are to spare.

    None are to spare where what is left over is rounding: a component that nothing moves has no scatter.
    """
    found = system.fit_points()
    now = system.at(found.shift)
    wide = columns(now, found)
    readings, wide = linear_readings(now, found, wide) / now.noise, wide / now.noise[:, None]
    residual = robust_fit(wide, readings).residual
    U, values, _ = np.linalg.svd(wide / np.maximum(np.linalg.norm(wide, axis=0), 1e-300), full_matrices=False)
    leverage = (U[:, values > NULL * values.max(initial=0.0)] ** 2).sum(axis=1)
    least = EXACT * float(np.sqrt(np.mean((now.b / now.noise) ** 2)))
    count = int(group.max()) + 1
    size, spare = np.ones(count), np.zeros(count)
    for k in np.unique(group[now.linear]):
        own = group == k
        left = np.abs(residual[own])
        middle = float(np.median(left)) / MAD
        good = left <= BISQUARE * middle
        free = float(good.sum()) - float(leverage[own][good].sum())
        if middle > least and free > 0.0:
            size[k], spare[k] = np.sqrt((left[good] ** 2).sum() / free), free
    return size, spare
