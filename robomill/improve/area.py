"""Where a part may lie: a box for its zero, a range of yaw, and boxes that its stock must keep out of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from robomill.arrays import NO_NUMBERS, BoolArray, FloatArray, as_floats, brief, check_place
from robomill.errors import SetupError
from robomill.kinematics.asked import longest_reach
from robomill.kinematics.transforms import rotation_z, transform
from robomill.provenance import Finding
from robomill.quantities import Quantity
from robomill.simulation.setup import SimulationSetup
from robomill.spelled import one_of
from robomill.surface.stock import Stock
from robomill.units import SI_NAMES, format_many, from_si, to_si

AROUND = 0.15  # of the arm's length, all links in a row: how far to each side of today's place where no box is given
FULL_TURN = 2.0 * np.pi
COARSE_YAW = to_si(45.0, "deg")
COARSE_Z = 3
LIKE_RADIANS = 3.2  # degrees: a range of yaw as narrow is as likely one in rad, up to half a turn
MOST_CANDIDATES = 100_000
WHO = "Placement"
RANGES = (
    Quantity("x", "mm", "array", shape=(2,), name="x", key="x_mm", slip=20.0, tiny=2e-3),
    Quantity("y", "mm", "array", shape=(2,), name="y", key="y_mm", slip=20.0, tiny=2e-3),
    Quantity("z", "mm", "array", shape=(2,), name="z", key="z_mm", slip=20.0, tiny=2e-3),
    Quantity("yaw", "deg", "array", shape=(2,), name="yaw", key="yaw_deg", slip=4.0 * np.pi, quarters=True),
)
BOXES = Quantity("keep-out boxes", "mm", "array", name="keep_out", key="keep_out_mm", slip=200.0)


@dataclass(frozen=True, eq=False)
class Area:
    """Places (x, y, z m, yaw rad) from ``lower`` (4,) to ``upper`` (4,) of a part whose axes at yaw 0 are R (3, 3) in
    {M}; its block ``stock`` keeps out of boxes ``keep_out`` (b, 2, 3) m in {M}, lower and upper corners."""

    lower: FloatArray
    upper: FloatArray
    R: FloatArray
    stock: Stock
    keep_out: FloatArray
    doubts: tuple[Finding, ...] = ()

    def T_MW(self, places: FloatArray) -> FloatArray:
        """(k, 4, 4) of places (k, 4)."""
        return transform(rotation_z(places[..., 3]) @ self.R, places[..., :3])

    def contains(self, place: FloatArray) -> bool:
        """Whether a place (4,) lies within."""
        return bool((place >= self.lower - 1e-9).all() and (place <= self.upper + 1e-9).all())

    def axes(self, candidates: int) -> list[FloatArray]:
        """Coordinates of a grid of about as many places: x, y, z and yaw, each between its bounds, both included but
        for a full turn."""
        span = self.upper - self.lower
        around = span[3] >= FULL_TURN - 1e-9
        yaws = max(round(span[3] / COARSE_YAW), 1) + (not around and span[3] > 0.0)
        heights = COARSE_Z if span[2] > 0.0 else 1
        in_plane = max(candidates // (yaws * heights), 1)
        wide, high = np.maximum(span[:2], 0.0)
        if wide > 0.0 and high > 0.0:
            columns = int(np.clip(round(np.sqrt(in_plane * wide / high)), 2, max(in_plane // 2, 2)))
            counts = (columns, max(in_plane // columns, 2))
        else:
            counts = (max(in_plane, 2) if wide > 0.0 else 1, max(in_plane, 2) if high > 0.0 else 1)
        axes = [
            np.linspace(low, high, n) if n > 1 else np.array([0.5 * (low + high)])
            for low, high, n in zip(self.lower[:3], self.upper[:3], (*counts, heights), strict=True)
        ]
        turns = np.linspace(self.lower[3], self.upper[3], yaws, endpoint=not around) if yaws > 1 else self.lower[3:]
        return [*axes, turns]

    def meets(self, places: FloatArray) -> BoolArray:
        """(k,) whether the stock's block of a part at places (k, 4) meets a box that it should keep out of.

        Two boxes are apart where they are along an axis of either, or along one across an axis of each.
        """
        T, found = self.T_MW(places), np.zeros(len(places), dtype=bool)
        half = 0.5 * (self.stock.upper - self.stock.lower)
        centre = T[:, :3, :3] @ (0.5 * (self.stock.upper + self.stock.lower)) + T[:, :3, 3]
        for low, high in self.keep_out:
            apart = np.zeros(len(places), dtype=bool)
            between, size = centre - 0.5 * (low + high), 0.5 * (high - low)
            own = np.swapaxes(T[:, :3, :3], 1, 2)  # rows: the axes of the block
            across = np.cross(own[:, :, None], np.eye(3)).reshape(-1, 9, 3)
            for axis in (*np.swapaxes(own, 0, 1), *np.swapaxes(across, 0, 1), *np.eye(3)):
                axis = np.broadcast_to(axis, (len(places), 3))
                reach = np.abs(np.einsum("kai,ki->ka", own, axis)) @ half + np.abs(axis) @ size
                apart |= np.abs(np.einsum("ki,ki->k", between, axis)) > reach + 1e-12
            found |= ~apart
        return found


def today(setup: SimulationSetup) -> FloatArray:
    """(4,) where the part lies: x, y, z m and yaw rad."""
    R = setup.T_MW[:3, :3]
    return np.append(setup.T_MW[:3, 3], np.arctan2(R[1, 0], R[0, 0]))


def turned_back(setup: SimulationSetup) -> FloatArray:
    """(3, 3) the part's axes in {M} at yaw 0."""
    return np.asarray(rotation_z(-today(setup)[3]) @ setup.T_MW[:3, :3])


def area(setup: SimulationSetup, asked: dict[str, Any]) -> Area:
    """The area that is asked for by the names of ``RANGES`` and ``BOXES``: x and y left out are today's, to both sides;
    z and yaw left out stay as they are. Raises SetupError."""
    here = today(setup)
    half = to_si(round(AROUND * longest_reach(setup.robot) / to_si(10.0, "mm")) * 10.0, "mm")
    lower, upper = here.copy(), here.copy()
    lower[:2] -= half
    upper[:2] += half
    for i, declared in enumerate(RANGES):
        plain, in_unit = asked.get(declared.name), asked.get(declared.key)
        if plain is None and in_unit is None:
            continue
        _in_order(declared, *((plain, SI_NAMES[declared.unit]) if in_unit is None else (in_unit, declared.unit)))
        given = one_of(declared, plain, in_unit, SetupError, WHO)
        lower[i], upper[i] = _range(declared, given, plain if in_unit is None else in_unit)
    if max(abs(lower[3]), abs(upper[3])) > 2.0 * FULL_TURN:
        ends = format_many([lower[3], upper[3]], "deg", 0)
        raise SetupError(f"{WHO}, yaw: found {ends}; expected at most two turns to either side.", where="yaw")
    if upper[3] - lower[3] > FULL_TURN:
        upper[3] = lower[3] + FULL_TURN
    doubts = () if asked.get("yaw_deg") is None else _doubts(lower[3], upper[3])
    return Area(lower, upper, turned_back(setup), setup.stock_block, _boxes(asked), doubts)


def _doubts(least: float, most: float) -> tuple[Finding, ...]:
    """What to say of a range of yaw, given in degrees, that hardly turns the part: it may have been meant in rad."""
    widest = float(from_si(max(abs(least), abs(most)), "deg"))
    if not least < most or widest > LIKE_RADIANS:
        return ()
    meant = f"{from_si(widest, 'deg'):.0f}°"
    words = (
        f"The part is turned by no more than {widest:.3g}°: yaw is in degrees. Was {widest:.3g} rad, {meant}, meant?"
    )
    return (Finding("suspicious", words, code="unit-doubt"),)


def _in_order(declared: Quantity, as_given: Any, unit: str) -> None:
    """Refuse two bounds, numbers of ``unit``, that are turned: before their size, which may be right, is looked at."""
    try:
        found = np.asarray(as_given, dtype=np.float64)
    except NO_NUMBERS:
        return  # which is refused as what it is
    if found.shape == (2,) and found[0] > found[1]:
        ends = format_many(to_si(found, unit), unit, 2, " to ")
        raise SetupError(
            f"{WHO}, {declared.name}: the bounds contradict each other, {ends}; give the smaller one first.",
            where=declared.name,
        )


def _range(declared: Quantity, given: Any, as_given: Any) -> FloatArray:
    """Least and largest (2,) of what is ``given`` in SI; one number stands for both."""
    name = f"{WHO}, {declared.name}"
    found = as_floats(given, name, (), error=SetupError)
    if found.ndim == 0:
        found = np.array([found, found])
    if found.shape != (2,):
        raise SetupError(
            f"{name}: expected two numbers, the least and the largest, or one to hold it there; found "
            f"{brief(as_given, 40)}.",
            where=declared.name,
        )
    if declared.unit == "mm":
        check_place(found, name, SetupError)
    return found


def _boxes(asked: dict[str, Any]) -> FloatArray:
    plain, in_unit = asked.get(BOXES.name), asked.get(BOXES.key)
    given: Sequence[Any] = one_of(BOXES, plain, in_unit, SetupError, WHO, default=())
    found = as_floats(given, f"{WHO}, keep_out", (), error=SetupError)
    if found.size == 0:
        return np.zeros((0, 2, 3))
    boxes = as_floats(found, f"{WHO}, keep_out", (2, 3), error=SetupError).reshape(-1, 2, 3)
    for n, (low, high) in enumerate(boxes, 1):
        if (low >= high).any():
            raise SetupError(
                f"{WHO}, keep_out: box {n} has no volume; give its lower and its upper corner in {{M}}.",
                where="keep_out",
            )
    return boxes


def grid(axes: Sequence[FloatArray]) -> FloatArray:
    """(k, 4) all places of coordinates x, y, z and yaw, the last one running first."""
    return np.array(list(product(*axes)))
