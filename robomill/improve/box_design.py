"""Which joints to stiffen so that a stated force pushes the tip off by no more than a tolerance anywhere in a box."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked, made_by
from robomill.arrays import FloatArray, as_floats, digest, frozen, of_kind
from robomill.compliance.deflection import deflection
from robomill.compliance.spring import extra_contributions
from robomill.errors import SetupError
from robomill.frames import Columns
from robomill.improve.asked_joints import checked_bounds, checked_weight, words_of_joints
from robomill.improve.design import STIFFEST, asked_for, nearest
from robomill.improve.least_cost import Errors, least_cost
from robomill.improve.sensitivity import stiffened
from robomill.kinematics.forward import joint_frames
from robomill.lazy import cached_property
from robomill.simulation.setup import SimulationSetup, check_setup
from robomill.units import format_count, format_limit, format_many, format_short, format_si, from_si
from robomill.values import Tabled
from robomill.workspace.grid import Grid
from robomill.workspace.solve import solve_grid

SMALLEST, LARGEST = 1e-3, 1e6  # N: forces that can be asked for


@made_by("rm.design_box(setup, grid, force)")
@dataclass(frozen=True, eq=False, repr=False)
class BoxDesign(Tabled):
    """The cheapest stiffer joints that keep a tolerance in a box of the workspace, or the best there are.

    setup            the set-up with the stiffer joints; ``tolerance`` m and ``force`` (3,) N in {M} are what was asked
    points           (m, 3) m in {M}: those of the box that are reached, of ``cells`` in all
    given, fixed     (m, 3, n) and (m, 3) m: how far each joint as it was, and all that is no joint, gives way there
    stiffness_ratio  (n,) how many times as stiff each free joint is then; weight (n,), bounds (n, 2) as asked
    reason           why the tolerance is not kept, else ""
    residual         the solver's largest: primal, dual, and how much cheaper any other could be

    Examples
    --------
    >>> import robomill as rm
    >>> grid = rm.box_grid([-0.2, -1.4, 0.0], [0.2, -1.2, 0.0], 0.1)
    >>> rm.design_box(rm.load_setup("paper_flute"), grid, [0, 100, 0], tolerance_mm=0.3)
    <BoxDesign Reference groove (Slavkovic 2013): 15 points keep 0.30 mm with the joints as they are; cost 0>
    """

    setup: SimulationSetup
    tolerance: float
    force: FloatArray
    points: FloatArray
    cells: int
    given: FloatArray
    fixed: FloatArray
    stiffness_ratio: FloatArray
    weight: FloatArray
    bounds: FloatArray
    reason: str
    residual: float

    @property
    def feasible(self) -> bool:
        """Whether the tolerance can be kept at every point that is reached."""
        return not self.reason

    @property
    def C_theta(self) -> FloatArray:
        """(n,) rad/(N m) (m/N of joints that slide) then."""
        return self.setup.robot.C_theta

    @property
    def cost(self) -> float:
        """Sum over the joints of weight times the binary logarithm of the stiffness ratio."""
        return float(self.weight @ np.log2(self.stiffness_ratio))

    @cached_property
    def before(self) -> FloatArray:
        """(m,) m: how far the tip was pushed at the points."""
        return frozen(np.linalg.norm(self.fixed + self.given.sum(axis=2), axis=1))

    @cached_property
    def after(self) -> FloatArray:
        """(m,) m: how far it is then."""
        return frozen(np.linalg.norm(self.fixed + self.given @ (1.0 / self.stiffness_ratio), axis=1))

    @property
    def worst(self) -> int:
        """The point that is pushed furthest then."""
        return int(np.argmax(self.after))

    @property
    def sentence(self) -> str:
        """What to stiffen, or why that does not do."""
        if not self.feasible:
            return f"Cannot be met: {self.reason}."
        words = self._told
        return f"{words[0].upper()}{words[1:]}."

    @property
    def _told(self) -> str:
        limit, count = format_limit(self.tolerance, "mm"), format_count(len(self.points), "point")
        some = words_of_joints(self.setup.robot.joint_numbers, self.stiffness_ratio)
        if not some:
            return f"{count} keep {limit} with the joints as they are"
        return f"{some[0]} as stiff keep{'s' * (some[1] == 1)} {limit} at {count} of the box"

    def columns(self) -> Columns:
        """One row a point: where it is, and how far the tip is pushed there before and after."""
        found: Columns = {f"{axis}_mm": from_si(self.points[:, i], "mm") for i, axis in enumerate("xyz")}
        return found | {"before_mm": from_si(self.before, "mm"), "after_mm": from_si(self.after, "mm")}

    @cached_property
    def _digest(self) -> str:
        return digest((self.setup.digest(), self.points, self.force, self.tolerance, self.weight, self.bounds))

    def _said(self) -> str:
        words = self._told if self.feasible else f"cannot be met: {self.reason}"
        return f"{self.setup.name}: {words}; cost {format_short(self.cost, '1', 2)}"


@asked
def design_box(
    setup: SimulationSetup,
    grid: Grid,
    force: ArrayLike,
    tolerance: float | None = None,
    *,
    tolerance_mm: float | None = None,
    bounds: ArrayLike = (1.0, STIFFEST),
    weight: ArrayLike = 1.0,
) -> BoxDesign:
    """The least cost of stiffening joints at which a force pushes the tip no further than a tolerance in a box.

    Parameters
    ----------
    setup : SimulationSetup
        Whose robot, springs and tolerance are meant; its path and its part play no role.
    grid : Grid
        Points of the box in {M}, see ``rm.box_grid``; those that the upright tool reaches are asked.
    force : array_like, (3,)
        On the tool, N, in {M}: the same at every point.
    tolerance, tolerance_mm : float, optional
        Of the tip's deviation, m or mm; left out: that of the set-up.
    bounds : array_like, (2,) or (n, 2)
        Least and most times as stiff, for all free joints or for each; (1, 1) is a joint that stays.
    weight : float or array_like (n,)
        What making a joint twice as stiff costs.

    Returns
    -------
    BoxDesign
        ``feasible``; the ratios, the cost and what is left, at every point.

    Raises
    ------
    SetupError
        For a box none of which is reached, a force that is none, a measured map, contradictory bounds.

    Notes
    -----
    The deviation C F is the sum of the joints' shares, eqs. (13) to (16), each linear in the joint's compliance: a
    convex program whose optimum is certain, and holds without another run.

    Examples
    --------
    >>> import robomill as rm
    >>> grid = rm.box_grid([-0.2, -1.4, 0.0], [0.2, -1.2, 0.0], 0.1)
    >>> found = rm.design_box(rm.load_setup("paper_flute"), grid, [0, 100, 0], tolerance_mm=0.2)
    >>> found.feasible, round(float(found.after.max()) * 1e3, 4)
    (True, 0.2)
    """
    check_setup(setup)
    of_kind(grid, Grid, "grid", "rm.box_grid(lower, upper, step)", SetupError)
    setup = asked_for(setup, tolerance, tolerance_mm)
    F = as_floats(force, "Force", (3,), error=SetupError)
    size = float(np.linalg.norm(F))
    if not SMALLEST <= size <= LARGEST:
        raise SetupError(f"Force: found {size:g} N, expected {SMALLEST:g} to {LARGEST:g} N.", where="force")
    n = setup.robot.n
    ratios, weights = checked_bounds(bounds, n), checked_weight(weight, n)
    points, given, fixed = _shares(setup, grid, F)
    low, high = 1.0 / ratios[:, 1], 1.0 / ratios[:, 0]
    errors = Errors(fixed, given, np.full(len(points), setup.tolerance))
    found = least_cost(errors, weights, low, high)
    best = nearest(errors, weights, low, high) if found is None else found
    x = np.clip(best.x, low, high)
    reason = "" if found is not None else _reason(errors, points, x, setup)
    stiffer = setup.replace(robot=stiffened(setup.robot, 1.0 / x), provenance=setup.provenance)
    arrays = (frozen(points), grid.cells, frozen(given), frozen(fixed), frozen(1.0 / x), frozen(weights))
    return BoxDesign(stiffer, setup.tolerance, frozen(F), *arrays, frozen(ratios), reason, best.residual)


def _shares(setup: SimulationSetup, grid: Grid, F: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points (m, 3) m of the grid that are reached, what each joint gives way there (m, 3, n) m under F (3,) N, and
    what all else does (m, 3) m."""
    theta, reached, laws = solve_grid(setup.robot, grid, 0.0, 0.0)
    if not reached.any():
        raise SetupError(
            f"Box: none of its {format_count(grid.cells, 'point')} is reached with the tool upright; move it, or make "
            "it larger.",
            where="box",
        )
    J, C_theta = laws.J[reached][:, :3], setup.robot.C_theta
    given = J * (C_theta * np.einsum("mki,k->mi", J, F))[:, None]
    fixed = np.zeros((len(given), 3))
    if setup.springs:
        frames = joint_frames(setup.robot, theta[reached])
        fixed = deflection(extra_contributions(setup.springs, frames), np.tile(F, (len(given), 1))).sum(axis=1)
    return grid.points().reshape(-1, 3)[reached], given, fixed


def _reason(errors: Errors, points: FloatArray, x: FloatArray, setup: SimulationSetup) -> str:
    """Where the most is left, and which joint leaves most of it."""
    q = int(np.argmax(errors.shares(x)))
    left = errors.at(x)[q]
    along = np.append(errors.given[q].T * x[:, None] @ left, errors.fixed[q] @ left) / np.linalg.norm(left)
    most = int(np.argmax(along))
    whose = "what no joint does" if most == len(x) else f"joint {setup.robot.joint_numbers[most]}"
    place = format_many(points[q], "mm")
    return (
        f"{format_si(float(np.linalg.norm(left)), 'mm')} of {format_limit(setup.tolerance, 'mm')} are left at "
        f"({place}) however stiff the joints are within their bounds, {format_si(float(along[most]), 'mm')} of it by "
        f"{whose}"
    )
