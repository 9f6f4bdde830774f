"""At which joints links bend, as cross-validation says: none, one or two, each only if it pays on poses left out.

Whether the axes stay with the link before those joints or with the link after them is chosen with them, and of joints
that a person names, too.
"""

from dataclasses import dataclass, field

from robomill.arrays import FloatArray, IntArray
from robomill.errors import LoadTestError
from robomill.identification.fit.balance import balanced
from robomill.identification.fit.crossvalidation import Folded, Missed, leave_out
from robomill.identification.fit.fitting import Fitted, fit_system
from robomill.identification.fit.models import Model
from robomill.identification.fit.system import build_system
from robomill.identification.fit.treatment import AUTO, Treatment
from robomill.identification.load_test import LoadTests
from robomill.progress import checkpoint
from robomill.robot.model import Robot

MOST = 2  # joints at which links may bend when that is chosen by the tests
Bend = tuple[tuple[int, ...], bool]  # joints, and whether the axes turn with them
NONE: Bend = ((), False)
PAYS = 0.95  # share of the error on poses left out to which a further spring must bring it
EXACT = 1e-9  # of what was read: an error below it is rounding, and nothing pays that makes it smaller


@dataclass(frozen=True, eq=False)
class Candidates:
    """Models of one family, each fitted and folded when it is first asked for.

    fold (m,) of each test; starts: shifts from which points are sought too; kept: what was fitted so far; chosen: where
    links bend by the folds left out.
    """

    robot: Robot
    tests: LoadTests
    model: Model
    treatment: Treatment
    fold: IntArray
    starts: tuple[FloatArray, ...] = ()
    kept: dict[Bend, tuple[Model, Fitted, Folded]] = field(default_factory=dict, repr=False)
    chosen: dict[frozenset[int], Bend] = field(default_factory=dict, repr=False)

    def of(self, bend: Bend) -> tuple[Model, Fitted, Folded]:
        """The model with links that bend there, its fit and its folds. Raises LoadTestError: too few tests."""
        if bend not in self.kept:
            model, (joints, turned) = self.model, bend
            if self._open or joints:
                model = model.bending_at(joints, turned)
            by_size = self.treatment.weights == "size"
            system = balanced(build_system(self.robot, self.tests, model, self.treatment.freed, by_size))
            fitted = fit_system(system, self.treatment.robust, self.starts)
            folded = Folded(fitted.small, self.fold[system.test], fitted.weights, self.starts)
            self.kept[bend] = model, fitted, folded
        return self.kept[bend]

    def bends(self, left: frozenset[int]) -> Bend:
        """Where links bend, as the folds but ``left`` say."""
        if not self._open:
            return self._named(left) if self.model.has("bending") else NONE
        if left not in self.chosen:
            best, error = NONE, self.of(NONE)[2].score(left)
            for _ in range(MOST):
                checkpoint()
                found = {bend: score for bend in self._next(best) if (score := self._score(bend, left)) is not None}
                bend = min(found, key=found.__getitem__, default=NONE)
                if bend == NONE or not pays(found[bend], error):
                    break
                best, error = bend, found[bend]
            self.chosen[left] = best
        return self.chosen[left]

    def _named(self, left: frozenset[int]) -> Bend:
        """The joints that are named, their axes with the link before them unless it pays that they turn."""
        still, turned = (self.model.bending_joints, False), (self.model.bending_joints, True)
        if self.robot.joint_numbers[-1] in still[0]:
            return still
        before, after = (self._score(bend, left) for bend in (still, turned))
        return turned if before is not None and after is not None and pays(after, before) else still

    def _next(self, bend: Bend) -> list[Bend]:
        """The same with one joint more; the last joint moves the tool alone, where a turned axis has no next frame."""
        joints, turned = bend
        more = [tuple(sorted((*joints, j))) for j in self.robot.joint_numbers if j not in joints]
        last = self.robot.joint_numbers[-1]
        both = (turned,) if joints else (False, True)
        return [(each, side) for side in both for each in more if not (side and last in each)]

    @property
    def _open(self) -> bool:
        """Whether the tests are to say where links bend."""
        return self.treatment.bending == AUTO and self.model.has("joint")

    def _score(self, bend: Bend, left: frozenset[int]) -> float | None:
        try:
            return self.of(bend)[2].score(left)
        except LoadTestError:
            return None

    def best(self) -> tuple[Model, Fitted]:
        """The model that all the folds choose, and its fit."""
        model, fitted, _ = self.of(self.bends(frozenset()))
        return model, fitted

    def missed(self) -> Missed:
        """Every fold predicted by what the others choose and fit."""
        return leave_out(int(self.fold.max()) + 1, lambda left: self.of(self.bends(left))[2])

    def votes(self) -> list[list[int]]:
        """The joints chosen with each fold left out."""
        return [list(self.bends(frozenset({k}))[0]) for k in range(int(self.fold.max()) + 1)]


def pays(after: float, before: float) -> bool:
    """Whether an error on poses left out has become so much smaller that it was worth another spring."""
    return before > EXACT and after < PAYS * before
