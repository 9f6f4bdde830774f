"""How sure the compliances in force are: a value that is kept, saved and undone with the compliances it belongs to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robomill.arguments import made_by
from robomill.arrays import FloatArray, as_floats, digest, frozen
from robomill.compliance.spring import Spring
from robomill.errors import ProjectError
from robomill.identification.fit.model_error import ModelError
from robomill.identification.fit.models import Model
from robomill.identification.result import IdentificationResult
from robomill.robot.model import Robot
from robomill.units import format_count
from robomill.values import Said, Value


@made_by("rm.SimulationSetup(..., knowledge=rm.identify(robot, tests))")
@dataclass(frozen=True, eq=False, repr=False)
class Knowledge(Said, Value):
    """Compliances of a model's springs, and what is not known exactly of them, of the force and of the arm.

    model        the springs
    parameters   (p,) SI; covariance (p, p) of them
    dof          of the fit that gave it; None: known exactly, normal quantiles
    error        what the model misses besides, from poses left out; None: noise only
    F            (3, 3) N^2, covariance of the force, the same along a path; None: certain
    lengths      (2 rows,) m, standard deviations of a_1..a_k, then d_1..d_k; None: certain
    source       from where, in words
    compliances  by which the arm is known that it holds for; "" while it belongs to none

    Examples
    --------
    >>> import robomill as rm
    >>> setup = rm.load_setup("paper_flute")
    >>> found = rm.identify(setup.robot, "nine_points")
    >>> setup.replace(robot=found.applied_to(setup.robot), knowledge=found).known
    <Knowledge joint springs, 5 parameters: identified>
    """

    model: Model
    parameters: FloatArray
    covariance: FloatArray
    dof: int | None = None
    F: FloatArray | None = None
    lengths: FloatArray | None = None
    source: str = ""
    compliances: str = ""
    error: ModelError | None = None

    def __post_init__(self) -> None:
        p = np.shape(self.parameters)[-1] if np.ndim(self.parameters) else 0
        checked = {
            "parameters": ((p,), self.parameters),
            "covariance": ((p, p), self.covariance),
            "F": ((3, 3), self.F),
            "lengths": ((None,), self.lengths),
        }
        for name, (shape, value) in checked.items():
            if value is not None:
                object.__setattr__(self, name, frozen(as_floats(value, name, shape, error=ProjectError)))

    @classmethod
    def of(cls, result: IdentificationResult, robot: Robot, source: str = "") -> Knowledge:
        """What an identification knows of ``result.applied_to(robot)``.

        A joint it did not see keeps the robot's own value there, and counts here as unsure by all of that value.
        """
        parameters, covariance = np.array(result.parameters), np.nan_to_num(result.covariance)
        if result.has_joints:
            unseen = np.flatnonzero(~np.isfinite(result.stderr))
            parameters[unseen] = robot.C_theta[unseen]
            covariance[unseen], covariance[:, unseen] = 0.0, 0.0  # the fit's own value is not the one that is kept
            covariance[unseen, unseen] = robot.C_theta[unseen] ** 2
        error = None if result.band is None else result.band.error
        return cls(result.choice, parameters, covariance, result.dof, source=source, error=error)

    def _said(self) -> str:
        return f"{self.model.title.lower()}, {format_count(len(self.parameters), 'parameter')}: {self.source}"

    def noise_only(self) -> Knowledge:
        """The same as if the model were the arm: too narrow wherever it is not, and said to be so."""
        return replace(self, error=None)

    @property
    def made_of(self) -> str:
        """What a band holds of the compliances' part, in words."""
        if self.error is None:
            return "noise of the fit only"
        return self.error.beside_noise()

    def widened(self, robot: Robot, force: float = 0.0, length: float = 0.0) -> Knowledge:
        """The same with each force component unsure by ``force`` N and each D-H length by ``length`` m (one std)."""
        F = np.eye(3) * force**2 if force > 0 else None
        return replace(self, F=F, lengths=np.full(2 * robot.rows, length) if length > 0 else None)

    def held_by(self, robot: Robot, springs: Sequence[Spring]) -> Knowledge:
        """The same, said to be of these compliances."""
        return replace(self, compliances=compliance_digest(robot, springs))

    def holds_for(self, robot: Robot, springs: Sequence[Spring]) -> bool:
        """Whether exactly the compliances it belongs to are in force: an edit ends that, an undo brings it back."""
        return self.compliances == compliance_digest(robot, springs)


def compliance_digest(robot: Robot, springs: Sequence[Spring]) -> str:
    """SHA-256 over the compliances in force: joints, blocked axes, springs."""
    return digest({"C_theta": robot.C_theta_all, "blocked": robot.blocked, "springs": tuple(springs)})
