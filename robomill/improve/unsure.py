"""What of a cut is not known exactly, by how much, and who says so: the inputs of an uncertainty, and draws of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from robomill.arrays import FloatArray, frozen
from robomill.cutting.force import ForceModel
from robomill.errors import SetupError
from robomill.identification.fit.models import Model
from robomill.identification.knowledge import Knowledge
from robomill.kinematics.transforms import rotation_z, transform
from robomill.progress import checkpoint
from robomill.provenance import Provenance
from robomill.quantities import quantities, quantity, settle
from robomill.robot.model import Robot
from robomill.simulation.origin.origins import robot_lengths
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import ran
from robomill.simulation.setup import SimulationSetup
from robomill.simulation.tools import reaching
from robomill.spelled import Replaceable, in_units
from robomill.units import format_percent, format_short, to_si
from robomill.values import ReadOnly, Said, Value

ROUNDS = 100  # of drawing again what cannot be
USUAL = {
    "compliance": 0.1,
    "force": 0.1,
    "lengths": to_si(0.5, "mm"),
    "part": to_si(0.5, "mm"),
    "part_turn": to_si(0.1, "deg"),
    "tool_length": to_si(0.2, "mm"),
}
"""One standard deviation of what nobody has stated: assumed, and said to be so. 10 % is what fitted compliances and
published force coefficients differ by at best; the others are what is reached without measuring again."""


def _spread(label: str, unit: str, hint: str, most: float) -> Any:
    return quantity(label, unit, optional=True, least=0.0, most=most, hint=hint, slip=None if unit == "1" else most)


@in_units(SetupError, "Spread")
@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Spread(Replaceable, Value):
    """How unsure the numbers of a cut are: one standard deviation each; 0 is known exactly.

    What is left out (None) is assumed, and said to be: compliances and force 10 %, lengths and part zero 0.5 mm, the
    part's turn 0.1 degrees, the tool's length 0.2 mm.

    compliance   of every joint's, as a share of it; only where no identification says it
    force        of every coefficient of the force, or of every component that is stated, as a share of it
    lengths      m, of every D-H length a and d that is not zero
    part         m, of part zero along x, y and z of {M}
    part_turn    rad, of the part's turn about z of {M}
    tool_length  m, of where the tip stands along its axis

    Examples
    --------
    >>> import robomill as rm
    >>> rm.Spread(compliance=0.2, part_mm=1.0)
    <Spread compliance 0.2, part 1 mm>
    """

    compliance: float | None = _spread("Compliance", "1", "As a share of it.", 1.0)
    force: float | None = _spread("Force", "1", "As a share of it.", 1.0)
    lengths: float | None = _spread("D-H lengths", "mm", "Of each.", 0.05)
    part: float | None = _spread("Part zero", "mm", "Along each axis.", 0.1)
    part_turn: float | None = _spread("Turn of the part", "deg", "About z of the robot.", to_si(20.0, "deg"))
    tool_length: float | None = _spread("Length of the tool", "mm", "Along its axis.", 0.05)

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            compliance: float | None = ...,
            force: float | None = ...,
            lengths: float | None = ...,
            lengths_mm: float | None = ...,
            part: float | None = ...,
            part_mm: float | None = ...,
            part_turn: float | None = ...,
            part_turn_deg: float | None = ...,
            tool_length: float | None = ...,
            tool_length_mm: float | None = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        settle(self, SetupError, "Spread")

    def _said(self) -> str:
        declared = quantities(Spread)
        given = {name: getattr(self, name) for name in USUAL if getattr(self, name) is not None}
        words = [f"{name} {format_short(value, declared[name].unit)}" for name, value in given.items()]
        return ", ".join(words) or "as assumed"


def _stated(name: str, given: float | None) -> tuple[float, Provenance]:
    """One standard deviation, and who says so."""
    if given is not None:
        return float(given), Provenance("user", "stated")
    return USUAL[name], Provenance("assumed", "not stated: a usual value")


@dataclass(frozen=True, repr=False)
class Input(Said):
    """One number that is not known exactly: ``key`` and ``label``, its ``value`` and standard deviation ``std`` in SI,
    the ``unit`` it is told in, what ``group`` it belongs to, and who says how unsure it is."""

    key: str
    label: str
    group: str
    unit: str
    value: float
    std: float
    provenance: Provenance

    def allows(self, change: FloatArray) -> Any:
        """Where ``value + change`` can be: compliances and coefficients keep their sign."""
        if self.group not in ("compliance", "force"):
            return np.ones(np.shape(change), dtype=bool)
        return (self.value + change) * (1.0 if self.value >= 0.0 else -1.0) >= 0.0

    def _said(self) -> str:
        value, std = (format_short(each, self.unit) for each in (self.value, self.std))
        return f"{self.label}: {value}, std {std} ({self.provenance.kind})"


@dataclass(frozen=True, eq=False)
class Unsure(ReadOnly):
    """The inputs of a cut (p,) with their ``covariance`` (p, p), SI; ``springs`` (k,) are the inputs that are the
    parameters of ``model``, in its order, -1 where one is known exactly."""

    setup: SimulationSetup
    inputs: tuple[Input, ...]
    covariance: FloatArray
    model: Model
    springs: tuple[int, ...]
    known: Knowledge | None = None

    def named(self, *groups: str) -> list[int]:
        """The inputs of some groups."""
        return [i for i, each in enumerate(self.inputs) if each.group in groups]

    @property
    def std(self) -> FloatArray:
        """(p,) SI."""
        return np.array([each.std for each in self.inputs])

    def alone(self, i: int) -> FloatArray:
        """(p,) one standard deviation of input i, what is correlated with it moving along as it is expected to."""
        return np.asarray(self.covariance[:, i] / np.sqrt(self.covariance[i, i]))

    def drawn(self, count: int, seed: int) -> tuple[FloatArray, int]:
        """(count, p) changes, normally distributed, and how many had to be drawn again since they cannot be."""
        rng, std = np.random.default_rng(seed), self.std
        correlation = self.covariance / np.outer(std, std)
        try:
            root = np.linalg.cholesky(correlation + 1e-12 * np.eye(len(std)))
        except np.linalg.LinAlgError:
            raise SetupError("How sure the compliances are: their covariance is none; identify them again.") from None
        change, again = np.empty((count, len(std))), 0
        todo = np.arange(count)
        for _ in range(ROUNDS):
            checkpoint()
            change[todo] = rng.standard_normal((len(todo), len(std))) @ root.T * std
            fine = np.all([each.allows(change[todo, i]) for i, each in enumerate(self.inputs)], axis=0)
            todo = todo[~fine]
            again += len(todo)
            if not len(todo):
                return change, again
        raise SetupError(
            f"Spread: of {format_percent(len(todo) / count)} of the draws a compliance or a coefficient is below zero "
            "again and again; state less of it."
        )

    def run(self, change: FloatArray) -> SimulationResult:
        """The cut in full, with the numbers changed by (p,). What no set-up says (errors of the model, springs that
        bend) stays."""
        setup, by = changed(self, change), {each.key: float(change[i]) for i, each in enumerate(self.inputs)}
        return ran(setup, stronger=1.0 + by.get("force", 0.0))


def changed(unsure: Unsure, change: FloatArray) -> SimulationSetup:
    """The set-up with its numbers changed by (p,)."""
    setup, robot = unsure.setup, unsure.setup.robot
    by = {each.key: float(change[i]) for i, each in enumerate(unsure.inputs)}
    C_theta = [C + by.get(f"C_theta_{n}", 0.0) for n, C in zip(robot.joint_numbers, robot.C_theta, strict=True)]
    a, d = ([v + by.get(f"{s}_{i}", 0.0) for i, v in enumerate(getattr(robot, s), 1)] for s in "ad")
    changes: dict[str, Any] = {"a": a, "d": d} if unsure.named("lengths") else {}
    changes |= {"C_theta": np.maximum(C_theta, 0.0)} if unsure.named("compliance") else {}
    robot = reaching(robot.replace(**changes) if changes else robot, by.get("tool_length", 0.0))
    shift = np.array([by.get(f"part_{axis}", 0.0) for axis in "xyz"])
    T_MW = transform(rotation_z(by.get("part_turn", 0.0)) @ setup.T_MW[:3, :3], setup.T_MW[:3, 3] + shift)
    force = setup.force
    for i in unsure.named("force"):
        force = force.changed(unsure.inputs[i].key, float(change[i]))  # the whole of it the run takes
    return setup.replace(robot=robot, T_MW=T_MW, force=force, provenance=setup.provenance)


def unsure_of(setup: SimulationSetup, spread: Spread, known: Knowledge | None) -> Unsure:
    """Everything that a cut has and that is not known exactly; what is known exactly (0) is not among it."""
    robot = setup.robot
    model = Model() if known is None else known.model
    springs, covariance = _springs(robot, spread, known)
    others = [
        *_numbers(setup.force, *_stated("force", spread.force)),
        *_lengths(robot, *_stated("lengths", spread.lengths)),
    ]
    others += _placed(setup, spread)
    if known is not None and known.error is not None:
        said = Provenance("measured", "errors on poses left out")
        others += [
            Input(f"model_{way}", f"Error of the model, {way}", "model", "1", 0.0, 1.0, said)
            for way in ("feed", "normal", "axial")
        ]
    every = [*springs, *others]
    whole = np.diag([each.std**2 for each in every])
    whole[: len(springs), : len(springs)] = covariance
    keep = [i for i in range(len(every)) if whole[i, i] > 0.0]  # what is too small has no square
    if not keep:
        raise SetupError("Spread: everything is known exactly; state a standard deviation of something.")
    at = {i: n for n, i in enumerate(keep)}
    found = tuple(at.get(i, -1) for i in range(len(springs)))
    return Unsure(setup, tuple(every[i] for i in keep), frozen(whole[np.ix_(keep, keep)]), model, found, known)


def _springs(robot: Robot, spread: Spread, known: Knowledge | None) -> tuple[list[Input], FloatArray]:
    """The compliances with their covariance: as identified, or each by itself."""
    if known is None:
        share, said = _stated("compliance", spread.compliance)
        values, covariance = robot.C_theta, np.diag((share * robot.C_theta) ** 2)
        model = Model()
    else:
        values, covariance, model = known.parameters, known.covariance, known.model
        said = Provenance("measured", known.source or "identified")
    if not model.has("joint"):
        raise SetupError(
            f"How sure the compliances are: it is known of the model {model.title.lower()!r}, which has no joints."
        )
    made = []
    for each, value, variance in zip(model.parameters(robot), values, np.diag(covariance), strict=True):
        key = f"C_theta_{each.at}" if each.joint is not None else each.label.replace(" ", "_")
        label = f"Compliance of {each.label}"
        group = "compliance" if each.joint is not None else "springs"
        made.append(Input(key, label, group, each.unit, float(value), float(np.sqrt(variance)), said))
    return made, np.asarray(covariance)


def _numbers(force: ForceModel, share: float, said: Provenance) -> list[Input]:
    """What the force is computed from; where it is no number of its own, the whole of it."""
    found = [
        Input(each.key, each.label, "force", each.unit, each.value, share * abs(each.value), said)
        for each in force.uncertain
    ]
    return found or [Input("force", "Force", "force", "1", 1.0, share, said)]


def _lengths(robot: Robot, std: float, said: Provenance) -> list[Input]:
    lengths = robot_lengths(robot).items()
    return [Input(key, f"D-H length {key}", "lengths", "mm", value, std, said) for key, value in lengths]


def _placed(setup: SimulationSetup, spread: Spread) -> list[Input]:
    std, said = _stated("part", spread.part)
    at = zip("xyz", setup.T_MW[:3, 3], strict=True)
    found = [Input(f"part_{axis}", f"Part zero, {axis}", "part", "mm", float(v), std, said) for axis, v in at]
    std, said = _stated("part_turn", spread.part_turn)
    found.append(Input("part_turn", "Turn of the part", "part", "deg", 0.0, std, said))
    std, said = _stated("tool_length", spread.tool_length)
    return [*found, Input("tool_length", "Length of the tool", "tool", "mm", 0.0, std, said)]
