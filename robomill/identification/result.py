"""What an identification says, and how far to trust it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from robomill.arguments import asked, made_by
from robomill.arrays import FloatArray, IntArray
from robomill.compliance.spring import Spring
from robomill.compliance.springs.joint_bending import JointBending
from robomill.compliance.springs.spindle import SpindleSpring
from robomill.errors import LoadTestError
from robomill.frames import Columns
from robomill.identification.fit.model_error import ModelError
from robomill.identification.fit.models import Model, Parameter
from robomill.identification.fit.suspects import UNASKED, BendingOffer, Inquest
from robomill.identification.fit.treatment import STANDARD, Treatment
from robomill.identification.pull.found_points import FoundPoint, Offer
from robomill.lazy import cached_property
from robomill.provenance import Finding, Kind, Provenance
from robomill.robot.model import Robot
from robomill.units import format_count, format_number, format_percent, format_value, from_si
from robomill.values import Tabled

FAR = 1000.0  # times the usual scatter: by how much farther off a test is, is nothing that anybody needs to know
IDENTIFIED = "compliance.identified"  # the block of a robot's provenance


class Condition(NamedTuple):
    """Condition number of the equations as they are, and after scaling every column to length one."""

    before: float
    after: float


@dataclass(frozen=True)
class Slip:
    """What may have happened to a row: its kind ("sign", "unit", "swapped", "neighbour"), and in words."""

    kind: str
    says: str


@dataclass(frozen=True)
class Outlier:
    """A test that does not fit the others: its row, how many robust standard deviations off, by how much (m), and the
    slips either of which would explain it."""

    row: int
    times: float
    residual: float
    slips: tuple[Slip, ...] = ()

    def sentence(self) -> str:
        """The row and what is wrong with it, "row 5 (18 times the usual scatter: the sign of dx is turned)"."""
        why = " or ".join(slip.says for slip in self.slips)
        times = f"more than {format_number(FAR, 0)}" if self.times > FAR else format_number(self.times, 0)
        return f"row {self.row} ({times} times the usual scatter{': ' * bool(why)}{why})"


@dataclass(frozen=True)
class UnseenJoint:
    """A joint these tests cannot tell from a rigid one, or from others; the sentence says why and what to do."""

    joint: int
    confused_with: tuple[str, ...]
    sentence: str


@dataclass(frozen=True)
class Band:
    """What a prediction misses beyond the fit's noise, and how that was checked: the share of ``components`` left out
    that 95 % bands held, each made without the fold it was checked on."""

    error: ModelError
    held: float
    components: int


@made_by("rm.identify(robot, tests)")
@dataclass(frozen=True, eq=False, repr=False)
class IdentificationResult(Tabled):
    """Fitted compliances with their uncertainty. n joints, p parameters (the joints first, then extra springs).

    C_theta (n,) rad/(N m) (m/N if prismatic), NaN where not seen; stderr (n,), infinite where not seen;
    ci95 (n, 2), cut at zero; correlation and covariance (p, p) of the parameters, NaN where not seen;
    parameters (p,) with which predictions are made; condition before and after column scaling;
    residual (m, 3) m, measured minus predicted, NaN where not measured ((m, 1) rad for tests of single joints), in
    columns called ``components``; kind: the tests' provenance;
    explanations: one sentence a parameter; residual_share (m,) of the measured size; residual_rms m (rad); noise:
    standard deviation of one measured number, m (rad), as the residuals say; cv_relative_error: mean over poses of
    |predicted - measured| / |measured|, each pose predicted without itself: the headline; in_sample_by_pose
    (poses,) with every pose in the fit, which flatters.
    outliers, unseen_joints, active_bounds (labels of parameters held at zero), lumped (extra springs that move
    exactly as another one and are counted with it), findings, row (m,) of each test; treatment: what was chosen;
    points: those that were fitted; band: what predictions miss beyond the fit's noise, None where it is not known;
    offer: points that are worth fitting, where they were not; bends: links that are worth letting bend; inquest: what
    the readings call for besides the model; votes: the joints at which links bend as chosen with
    each fold left out, where that was left to the tests.

    Examples
    --------
    >>> import robomill as rm
    >>> robot = rm.load_robot("slavkovic_5r")
    >>> found = rm.identify(robot, "one_joint_at_a_time")
    >>> found.columns()["parameter"].tolist()
    ['joint 1', 'joint 2', 'joint 3', 'joint 4', 'joint 5']
    """

    choice: Model
    labels: tuple[Parameter, ...]
    parameters: FloatArray
    covariance: FloatArray
    parameter_stderr: FloatArray
    parameter_ci95: FloatArray
    correlation: FloatArray
    n: int
    condition: Condition
    residual: FloatArray
    residual_share: FloatArray
    residual_rms: float
    noise: float
    equations: int
    dof: int
    in_sample_by_pose: FloatArray
    row: IntArray
    share: FloatArray
    components: tuple[str, ...]
    kind: Kind = "measured"
    cv_relative_error: float = float("nan")
    outliers: tuple[Outlier, ...] = ()
    unseen_joints: tuple[UnseenJoint, ...] = ()
    active_bounds: tuple[str, ...] = ()
    explanations: tuple[str, ...] = ()
    lumped: dict[str, str] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()
    treatment: Treatment = STANDARD
    points: tuple[FoundPoint, ...] = ()
    band: Band | None = None
    votes: tuple[tuple[int, ...], ...] = ()
    offer: Offer | None = None
    bends: BendingOffer | None = None
    inquest: Inquest = UNASKED

    @property
    def single(self) -> bool:
        """Whether the tests were of one joint at a time."""
        return len(self.components) == 1

    @property
    def in_sample(self) -> float:
        """Mean over poses of |residual| / |measured| with every pose in the fit; flatters."""
        return float(np.nanmean(self.in_sample_by_pose))

    @property
    def excluded(self) -> tuple[int, ...]:
        """Rows left out."""
        return self.treatment.exclude

    @property
    def model(self) -> str:
        """The name of the model that was fitted."""
        return self.choice.name

    @property
    def has_joints(self) -> bool:
        """Whether the model has the joints' compliances at all."""
        return self.choice.has("joint")

    @cached_property
    def C_theta(self) -> FloatArray:
        """(n,) joint compliances; NaN for a joint that is not seen (or not in the model)."""
        if not self.has_joints:
            return np.full(self.n, np.nan)
        return np.where(np.isfinite(self.parameter_stderr[: self.n]), self.parameters[: self.n], np.nan)

    @cached_property
    def stderr(self) -> FloatArray:
        """(n,) standard errors of C_theta."""
        return np.full(self.n, np.inf) if not self.has_joints else self.parameter_stderr[: self.n]

    @cached_property
    def ci95(self) -> FloatArray:
        """(n, 2) 95 % intervals of C_theta, cut at zero."""
        return np.full((self.n, 2), np.nan) if not self.has_joints else self.parameter_ci95[: self.n]

    @cached_property
    def relative_half(self) -> FloatArray:
        """(p,) half the 95 % interval as a share of the value; infinite where that is not known or zero."""
        known = np.isfinite(self.parameter_stderr) & (self.parameters > 0)
        half = np.ptp(np.where(known[:, None], self.parameter_ci95, 0.0), axis=1) / 2
        return np.where(known, half / np.where(known, self.parameters, 1.0), np.inf)

    def columns(self) -> Columns:
        """One row a parameter: what it is, its value with standard error and 95 % interval in the unit that the row
        names (NaN and infinite where it is not seen), and the part of the displacements that it explains."""
        seen = np.isfinite(self.parameter_stderr)
        numbers = {
            "value": np.where(seen, self.parameters, np.nan),
            "stderr": self.parameter_stderr,
            "ci95_low": self.parameter_ci95[:, 0],
            "ci95_high": self.parameter_ci95[:, 1],
        }
        factor = np.array([from_si(1.0, p.unit) for p in self.labels])
        return {
            "parameter": np.array([p.label for p in self.labels]),
            **{name: values * factor for name, values in numbers.items()},
            "unit": np.array([p.unit for p in self.labels]),
            "share_percent": from_si(self.share, "%"),
        }

    def _said(self) -> str:
        found = self.columns()
        told = zip(found["parameter"], found["value"], found["unit"], strict=True)
        values = ", ".join(f"{name} {format_value(value, unit, missing='not seen')}" for name, value, unit in told)
        missed = format_percent(self.cv_relative_error, 1)
        doubts = sum(each.level not in ("info", "ignored") for each in self.findings)
        put = "puts" if doubts == 1 else "put"
        more = f"; {format_count(doubts, 'finding')} that {put} it in doubt: see .findings" if doubts else ""
        return f"{values}; {format_count(len(self.row), 'test')}, error at poses left out {missed}{more}"

    @property
    def weakest(self) -> int:
        """Index of the joint that is known least."""
        if not self.has_joints:
            raise LoadTestError("The constant model has no joints.")
        with np.errstate(invalid="ignore", divide="ignore"):
            relative = np.where(self.parameters[: self.n] > 0, self.stderr / self.parameters[: self.n], np.inf)
        return int(np.argmax(relative))

    @property
    def weakest_joint(self) -> int:
        """The joint (1-based) with the widest interval for its size."""
        return self.labels[self.weakest].joint or 0

    @asked
    def springs(self, robot: Robot) -> tuple[Spring, ...]:
        """The bending and tool springs found, for ``extra_contributions``; empty for the joints alone."""
        source = Provenance(self.kind, f"identified from {len(self.row)} load tests, model {self.model}")
        values = {(p.kind, p.at, p.axis): float(self.parameters[k]) for k, p in enumerate(self.labels)}
        found: list[Spring] = []
        for index, number in enumerate(robot.joint_numbers, 1):
            x, y = (values.get(("bending", number, axis), 0.0) for axis in "xy")
            if x or y:
                found.append(JointBending(index, x, y, source, self.choice.turned))
        across, along = (values.get(("tool", 0, axis), 0.0) for axis in ("across", "along"))
        if across or along:
            found.append(SpindleSpring(across, along, provenance=source))
        return tuple(found)

    @asked
    def adopted(
        self, robot: Robot, name: str, before: Robot, springs: Sequence[Spring]
    ) -> tuple[Robot, tuple[Spring, ...]]:
        """``robot`` with the compliances found in the tests ``name``, and ``springs`` of ``before`` with those found.

        What stood at the place of a spring found gives way, and so does whatever an earlier identification found: the
        measured and synthetic springs beside a robot ``before`` whose compliances were identified.
        """
        source = f"identified from {len(self.row)} load tests ({name}), {self.choice.title.lower()}"
        applied = self.applied_to(robot)
        kind: Kind = self.kind if self.kind in ("synthetic", "assumed") else "computed"  # made up tests stay so
        marked = {**applied.provenance, IDENTIFIED: Provenance(kind, source)}
        found = self.springs(robot)
        taken = {_place(spring) for spring in found}
        earlier = ("measured", "synthetic") if IDENTIFIED in before.provenance else ()
        kept = tuple(s for s in springs if _place(s) not in taken and s.provenance.kind not in earlier)
        return applied.replace(provenance=marked), kept + found

    @asked
    def explain(self, joint: int) -> str:
        """Why a joint (1-based) is known as well as it is, and what would help."""
        for parameter, text in zip(self.labels, self.explanations, strict=True):
            if parameter.joint == joint:
                return text
        raise LoadTestError(f"Joint {joint}: not among the fitted joints.")

    @property
    def gives(self) -> bool:
        """Whether any joint came out with a compliance above zero."""
        return self.has_joints and bool((np.nan_to_num(self.C_theta) > 0.0).any())

    @asked
    def applied_to(self, robot: Robot) -> Robot:
        """The robot with these compliances ("measured"); joints that were not seen keep the robot's own values."""
        if not self.has_joints:
            raise LoadTestError("The constant model has no joint compliances to give to a robot.")
        if self.dof <= 0 and not np.isfinite(self.parameter_stderr).any():
            raise LoadTestError(
                f"{format_count(self.equations, 'measured number')} for as many unknowns: nothing is left to say how "
                "sure the compliances are, so no robot is given them; measure at more poses or in more directions."
            )
        if not self.gives:
            raise LoadTestError(
                "No joint gives way by these tests: each came out rigid or is not seen, which no arm is; look at the "
                "signs of forces and displacements."
            )
        if robot.n != self.n:
            raise LoadTestError(
                f"These are the compliances of {format_count(self.n, 'joint')}; {robot.name!r} has {robot.n}."
            )
        seen = np.isfinite(self.C_theta)
        kept = [str(robot.joint_numbers[i]) for i in np.flatnonzero(~seen)]
        source = f"identified from {len(self.row)} load tests, model {self.model}"
        if kept:
            source += f"; joint {', '.join(kept)} not seen, value kept from {robot.compliance_set}"
        C_theta = robot.replace(C_theta=np.where(seen, self.C_theta, robot.C_theta)).C_theta_all
        return robot.replace(
            C_theta_all=C_theta,
            compliance_sets={**robot.compliance_sets, "identified": C_theta},
            compliance_set="identified",
            provenance={IDENTIFIED: Provenance(self.kind, source)},
        )


def _place(spring: Spring) -> tuple[str, int]:
    """Which spring of the arm it is: its kind, and its joint where there is one a joint."""
    return spring.kind, getattr(spring, "joint", 0)
