"""How the deviation along a path goes with every compliance and every D-H length of the arm: its derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomill.arguments import asked, made_by
from robomill.arrays import FloatArray, digest, frozen
from robomill.frames import Columns
from robomill.identification.fit.models import Model
from robomill.improve.expansion import At
from robomill.improve.judged import check_improvable, check_joints_known
from robomill.improve.screening import screen
from robomill.improve.unsure import Input, Unsure
from robomill.lazy import cached_property
from robomill.progress import step
from robomill.provenance import GIVEN
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate, spin_of
from robomill.simulation.setup import SimulationSetup
from robomill.units import format_significant, from_si, to_si
from robomill.values import Tabled

STEP = 1e-5  # m, for the derivative with respect to a length


@made_by("rm.sensitivity(setup)")
@dataclass(frozen=True, eq=False, repr=False)
class PathSensitivity(Tabled):
    """Derivatives of the deviation along a path, by every compliance and then every a and d of the D-H table.

    run      the cut as it is, of m samples
    inputs   (p,) the numbers; their ``std`` is what ``change`` in a table is for: 1 % of a compliance, 1 mm
    delta    (p, m, 3): of the deviation along feed, feed-normal and axis, per rad/(N m) (m/N of joints that slide), or
             per m; NaN where the path is not reached

    Examples
    --------
    >>> import robomill as rm
    >>> found = rm.sensitivity(rm.load_setup("paper_flute"))
    >>> found
    <PathSensitivity Reference groove (Slavkovic 2013): most by compliance of joint 3, 0.00176 mm per 1 %>
    """

    run: SimulationResult
    inputs: tuple[Input, ...]
    delta: FloatArray

    @cached_property
    def max_deviation(self) -> FloatArray:
        """(p,) derivative of the largest deviation; NaN where nothing is judged."""
        i = self.run.worst
        if i < 0:
            return np.full(len(self.inputs), np.nan)
        along = self.run.delta_in_cut[i] / self.run.max_deviation
        return np.asarray(self.delta[:, i] @ along)

    def columns(self) -> Columns:
        """One row a number: its value, and by how much the largest deviation changes with 1 % of a compliance or 1 mm
        of a length."""
        return {
            "input": np.array([each.key for each in self.inputs]),
            "label": np.array([each.label for each in self.inputs]),
            "unit": np.array([each.unit for each in self.inputs]),
            "value": np.array([float(from_si(each.value, each.unit)) for each in self.inputs]),
            "change": np.array([float(from_si(each.std, each.unit)) for each in self.inputs]),
            "max_deviation_changes_mm": from_si(self._changes, "mm"),
        }

    @property
    def _changes(self) -> FloatArray:
        return np.asarray(self.max_deviation * [each.std for each in self.inputs])

    @cached_property
    def _digest(self) -> str:
        return digest((self.run.digest(), self.delta))

    def _said(self) -> str:
        joints = [i for i, each in enumerate(self.inputs) if each.group == "compliance"]
        most = max(joints, key=lambda i: np.nan_to_num(abs(self._changes[i])))
        label, by = self.inputs[most].label, format_significant(from_si(self._changes[most], "mm"), 3)
        return f"{self.run.setup.name}: most by {label[0].lower()}{label[1:]}, {by} mm per 1 %"


@asked
def sensitivity(setup: SimulationSetup) -> PathSensitivity:
    """How the deviation along a path goes with every compliance and every D-H length of the arm.

    Parameters
    ----------
    setup : SimulationSetup
        The cut.

    Returns
    -------
    PathSensitivity
        Derivatives at every sample, and of the largest deviation.

    Raises
    ------
    SetupError
        Where the compliance is a measured map, in which no joint is known.

    Notes
    -----
    The force stays as it is. delta is linear in the compliances: their derivatives are the joints' shares, eq. (15),
    per compliance. Those of the lengths are central differences of 0.01 mm, the joints solved anew for the same poses.

    Examples
    --------
    >>> import robomill as rm
    >>> found = rm.sensitivity(rm.load_setup("paper_flute"))
    >>> dict(zip([each.key for each in found.inputs], (found.max_deviation * 1e3).round(4).tolist()))["a_5"]
    0.6348
    """
    check_improvable(setup)
    check_joints_known(setup, "to ask what each joint does")
    run = simulate(setup)
    inputs = _inputs(setup)
    n, unsure = setup.robot.n, Unsure(setup, inputs, np.eye(len(inputs)), Model(), tuple(range(setup.robot.n)))
    looking = screen(run, most=len(run.path))
    at = At(unsure, looking, spin_of(run.ik), looking.F[None])
    delta = np.empty((len(inputs), len(run.path), 3))
    delta[:n] = at.of(np.zeros(len(inputs)))[1][:, 0]
    for i in range(n, len(inputs)):
        with step(i - n, len(inputs) - n, "How the deviation goes with the lengths"):
            change = STEP * np.eye(len(inputs))[i]
            delta[i] = (at.of(change)[0][0] - at.of(-change)[0][0]) / (2.0 * STEP)
    delta[:, ~run.answered] = np.nan
    return PathSensitivity(run, inputs, frozen(delta))


def _inputs(setup: SimulationSetup) -> tuple[Input, ...]:
    robot = setup.robot
    joints = [
        Input(f"C_theta_{each.at}", f"Compliance of {each.label}", "compliance", each.unit, float(C), 0.01 * C, GIVEN)
        for each, C in zip(Model().parameters(robot), robot.C_theta, strict=True)
    ]
    rows = [(f"{symbol}_{i}", float(v)) for symbol in "ad" for i, v in enumerate(getattr(robot, symbol), 1)]
    lengths = [Input(key, f"D-H length {key}", "lengths", "mm", v, to_si(1.0, "mm"), GIVEN) for key, v in rows]
    return (*joints, *lengths)
