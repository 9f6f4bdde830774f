"""At which joints links bend, as cross-validation says: none, one or two, each only if it pays on poses left out."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from robomill.arrays import FloatArray, IntArray
from robomill.errors import LoadTestError
from robomill.identification.crossvalidation import Folded, Missed, leave_out
from robomill.identification.fitting import Fitted, fit_system
from robomill.identification.load_test import LoadTests
from robomill.identification.models import Model
from robomill.identification.system import build_system
from robomill.identification.treatment import AUTO, Treatment, with_bending, without_bending
from robomill.robot.model import Robot

MOST = 2  # joints at which links may bend when that is chosen by the tests
PAYS = 0.95  # share of the error on poses left out to which a further spring must bring it


@dataclass(frozen=True, eq=False)
class Candidates:
    """Models of one family, each fitted and folded when it is first asked for.

    fold (m,) of each test; starts: shifts from which points are sought too; kept: what was fitted so far, by the joints
    at which links bend (None: the model as it is named), None where the tests are too few for it.
    """

    robot: Robot
    tests: LoadTests
    model: Model
    treatment: Treatment
    fold: IntArray
    starts: tuple[FloatArray, ...] = ()
    kept: dict[tuple[int, ...], tuple[Model, Fitted, Folded]] = field(default_factory=dict, repr=False)
    chosen: dict[frozenset[int], tuple[int, ...]] = field(default_factory=dict, repr=False)

    def of(self, joints: tuple[int, ...]) -> tuple[Model, Fitted, Folded]:
        """The model with links that bend at ``joints``, its fit and its folds. Raises LoadTestError: too few tests."""
        if joints not in self.kept:
            model = self.model
            if self._open:
                name = with_bending(model.name) if joints else without_bending(model.name)
                model = replace(model, name=name, bending_joints=joints)
            by_size = self.treatment.weights == "size"
            system = build_system(self.robot, self.tests, model, self.treatment.freed, by_size)
            fitted = fit_system(system, self.treatment.robust, self.starts)
            folded = Folded(fitted.small, self.fold[system.test], fitted.weights, self.starts)
            self.kept[joints] = model, fitted, folded
        return self.kept[joints]

    def joints(self, left: frozenset[int]) -> tuple[int, ...]:
        """The joints at which links bend, as the folds but ``left`` say."""
        if not self._open:
            return ()
        if left not in self.chosen:
            best: tuple[int, ...] = ()
            error = self.of(best)[2].score(left)
            for _ in range(MOST):
                scores = {tuple(sorted((*best, j))): None for j in self.robot.joint_numbers if j not in best}
                found = {joints: score for joints in scores if (score := self._score(joints, left)) is not None}
                if not found:
                    break
                joints = min(found, key=found.__getitem__)
                if not found[joints] < PAYS * error:
                    break
                best, error = joints, found[joints]
            self.chosen[left] = best
        return self.chosen[left]

    @property
    def _open(self) -> bool:
        """Whether the tests are to say where links bend."""
        return self.treatment.bending == AUTO and self.model.has("joint")

    def _score(self, joints: tuple[int, ...], left: frozenset[int]) -> float | None:
        try:
            return self.of(joints)[2].score(left)
        except LoadTestError:
            return None

    def best(self) -> tuple[Model, Fitted]:
        """The model that all the folds choose, and its fit."""
        model, fitted, _ = self.of(self.joints(frozenset()))
        return model, fitted

    def missed(self) -> Missed:
        """Every fold predicted by what the others choose and fit."""
        return leave_out(int(self.fold.max()) + 1, lambda left: self.of(self.joints(left))[2])

    def votes(self) -> list[list[int]]:
        """The joints chosen with each fold left out."""
        return [list(self.joints(frozenset({k}))) for k in range(int(self.fold.max()) + 1)]
