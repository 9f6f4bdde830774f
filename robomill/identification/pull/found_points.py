"""The load point and the gauge point as the fit found them, in the tool's and in the flange's frame, and how surely."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arrays import FloatArray, frozen
from robomill.identification.fit.confidence import LEVEL, half_width
from robomill.identification.load_test import LoadTests
from robomill.identification.pull.points import Point, PointFit
from robomill.provenance import Finding
from robomill.robot.model import Robot
from robomill.units import format_si

TITLES: dict[Point, str] = {"force": "load point", "gauge": "gauge point"}
NEAREST = 2e-3  # m: a shift below this is none
FLAT = 1.0  # m: a half interval from which a direction counts as not known


def beyond_chance(shift: FloatArray, covariance: FloatArray, dof: int, level: float) -> bool:
    """Whether a shift (3,) m is more than chance makes of three coordinates together, with their covariance (3, 3) m^2
    by a fit with ``dof``, in a share ``level`` of the fits."""
    from scipy.special import fdtri

    far = float(shift @ np.linalg.pinv(covariance) @ shift)
    return far > 3.0 * float(fdtri(3, max(dof, 1), level))


@dataclass(frozen=True, eq=False)
class FoundPoint:
    """A point of the tool that was fitted.

    shift (3,) m from the stated one in {T}, covariance (3, 3) m^2, NaN where not seen; stated (3,) m in {T}, the mean
    where the rows state several; T_FT the tool in the flange; dof of the fit.
    """

    point: Point
    shift: FloatArray
    covariance: FloatArray
    stated: FloatArray
    T_FT: FloatArray
    dof: int

    @property
    def in_tool(self) -> FloatArray:
        """(3,) m in {T}, from the tip: what FPx_mm, FPy_mm, FPz_mm (MPx_mm ...) of a file say."""
        return self.stated + self.shift

    @property
    def in_flange(self) -> FloatArray:
        """(3,) m in the frame of the flange."""
        return np.asarray(self.T_FT[:3, :3] @ self.in_tool + self.T_FT[:3, 3])

    @property
    def ci95(self) -> FloatArray:
        """(3, 2) m, the interval of each coordinate in the flange; infinite where it is not seen."""
        R = self.T_FT[:3, :3]
        half = self._half(np.diag(R @ self.covariance @ R.T))
        return np.stack([self.in_flange - half, self.in_flange + half], axis=-1)

    @property
    def off(self) -> float:
        """m from the stated point."""
        return float(np.linalg.norm(self.shift))

    @property
    def off_half(self) -> float:
        """m, half the 95 % interval of the distance from the stated point, along it; infinite where it is not seen."""
        along = self.shift / self.off if self.off > 0.0 else np.zeros(3)
        return float(self._half(along @ self.covariance @ along))

    @property
    def is_off(self) -> bool:
        """Whether it lies elsewhere than stated: by more than ``NEAREST``, and by more than chance makes of three
        coordinates together in 95 of 100 fits."""
        if self.off <= NEAREST or not np.isfinite(self.covariance).all():
            return False
        return beyond_chance(self.shift, self.covariance, self.dof, LEVEL)

    @property
    def flat(self) -> FloatArray | None:
        """(3,) unit direction in {T} along which these tests hardly hold the point, None where all do."""
        if not np.isfinite(self._half(np.diag(self.covariance))).all():
            return np.full(3, np.nan)
        values, vectors = np.linalg.eigh(self.covariance)
        return np.asarray(vectors[:, -1]) if self._half(values[-1]) > FLAT else None

    def _half(self, variance: ArrayLike) -> FloatArray:
        """(...) m, half the interval for variances (...) m^2; infinite where they are not known."""
        return half_width(np.sqrt(np.nan_to_num(variance, nan=np.inf)), self.dof)

    def sentence(self) -> str:
        """How far the point is from the stated one."""
        title = TITLES[self.point]
        if self.flat is not None:
            return f"The {title} is not held by these tests in every direction: load and measure along others too."
        half = format_si(self.off_half, "mm", 0) if self.off_half >= 1e-3 else format_si(self.off_half, "mm", 2)
        stated = "the one that is stated" if self.stated.any() else "the tip of the tool, taken where none is stated"
        return f"Your {title} seems {format_si(self.off, 'mm', 0)} (± {half}, 95 %) off {stated}."


@dataclass(frozen=True, eq=False)
class Offer:
    """Points that are worth fitting: ``fit_points``, what they would be, and the error on poses left out before, after.

    Errors are shares of the displacement, both from the same tests.
    """

    fit_points: str
    points: tuple[FoundPoint, ...]
    before: float
    after: float

    def finding(self) -> Finding:
        """The offer as it is said."""
        off = " ".join(point.sentence() for point in self.points)
        was, now = format_si(self.before, "%", 1), format_si(self.after, "%", 1)
        text = f"{off} Fitted, it takes the error on poses left out from {was} to {now}."
        return Finding("warning", text, count=len(self.points), code=f"fit-{self.fit_points}")


def found_points(
    robot: Robot, tests: LoadTests, freed: tuple[Point, ...], found: PointFit, moved: FloatArray | None = None
) -> tuple[FoundPoint, ...]:
    """The points that were fitted, in the order of ``freed``; the force point was ``moved`` (m, 3) m before the fit."""
    p = len(found.fit.x) - 3 * len(freed)
    stated = {"force": tests.force_point, "gauge": tests.measuring_point}
    result = []
    for i, point in enumerate(freed):
        before = moved[0] if moved is not None and point == "force" else 0.0
        own = slice(p + 3 * i, p + 3 * i + 3)
        result.append(
            FoundPoint(
                point,
                frozen(found.shift[3 * i : 3 * i + 3] + before),
                frozen(found.fit.covariance[own, own]),
                frozen(stated[point].mean(axis=0)),
                robot.T_tool,
                found.fit.dof,
            )
        )
    return tuple(result)


def point_findings(points: tuple[FoundPoint, ...]) -> tuple[Finding, ...]:
    """Said of fitted points that the tests hold in no or not every direction."""
    loose = [point for point in points if point.flat is not None]
    return tuple(Finding("warning", point.sentence(), code=f"{point.point}-point-not-held") for point in loose)
