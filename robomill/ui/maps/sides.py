"""Of which project a map is: of the one in force, A, of the one beside it, B, or by how much B is more; all over the
cells of A's region, none where either does not reach."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from robomill.arrays import FloatArray
from robomill.improve.sensitivity import stiffened
from robomill.robot.model import Robot
from robomill.ui import pieces, session
from robomill.ui.comparing import other
from robomill.ui.entry import inputs
from robomill.ui.maps.board import Planes
from robomill.ui.posed import fields
from robomill.units import format_count, unit_label
from robomill.viz.maps import Scale
from robomill.viz.planes import Codes, ends
from robomill.workspace.quantities import MapQuantity, map_quantities

PLACE = ("X_mm", "Y_mm", "Z_mm")
SIDES = {"a": "A", "b": "B", "apart": "B − A"}
NO_NUMBERS = {name: SIDES[name] for name in ("a", "b")}
WHOSE = {
    "a": "A, the project in force.",
    "b": "B, over the region of A.",
    "apart": "By how much B is more than A; blank where either does not reach.",
}


@dataclass(frozen=True, eq=False)
class Side:
    """What of ``SIDES`` is chosen, and the arms of both; ``b`` is None where nothing is compared."""

    name: str
    a: Robot
    b: Robot | None

    def codes(self, planes: Planes, names: Sequence[str]) -> Mapping[str, Codes]:
        """The quantities as the browser gets them."""
        if self.b is None or self.name == "a":
            return planes.codes(names, self.a)
        if self.name == "b":
            return planes.codes(names, self.b)
        view = planes.region.view
        return fields.coded_differences(self.a, self.b, planes.grid, planes.normal, (view.A, view.B), tuple(names))

    def both(self, planes: Planes, names: Sequence[str]) -> list[Mapping[str, Codes]]:
        """What one scale is for: A's and B's maps, or their difference."""
        if self.name == "apart":
            return [self.codes(planes, names)]
        return [planes.codes(names, each) for each in (planes.region.robot, self.b) if each is not None]

    @property
    def about(self) -> str:
        """Whose map it is, in a sentence; "" where there is one project only."""
        return "" if self.b is None else f"{WHOSE[self.name]} "

    def file(self, name: str) -> str:
        """What the picture is called."""
        return name if self.name == "a" else f"{name}-{self.name}"

    def scale(self, what: MapQuantity, planes: Planes, unit: str) -> Scale:
        """That of one quantity, which A and B share."""
        values = ends([each[what.name] for each in self.both(planes, [what.name])], unit)
        if self.name == "apart":
            return Scale.signed(f"{what.title}, B − A, {unit_label(unit)}", [values])
        return Scale.of(what, values, self.a.joint_numbers, unit)

    def columns(self, planes: Planes, names: Sequence[str], at: float | None = None) -> dict[str, Any]:
        """The table twin of the plane in force, or of that next to ``at``."""
        from robomill.io.maps import map_columns

        def of(arm: Robot) -> dict[str, Any]:
            known = planes.known(arm, at)
            return dict(map_columns([known.field(name) for name in names]))

        if self.b is None or self.name == "a":
            return of(self.a)
        theirs = of(self.b)
        if self.name == "b":
            return theirs
        own = of(self.a)
        return {key: v if key in PLACE else v - own[key] for key, v in theirs.items()}


def looked_at(robot: Robot, factors: FloatArray) -> Robot:
    """The robot with its joints so much stiffer; itself where they are as they are."""
    return stiffened(robot, factors) if (factors != 1.0).any() else robot


def side(a: Robot, names: Mapping[str, str] = SIDES) -> Side:
    """The choice between the two projects, where there are two; ``a`` is the arm of the one in force as it is seen."""
    with other.in_force() as project:
        if project is None:
            return Side("a", a, None)
        robot = project.setup.robot
        b = looked_at(robot, session.maps().stiffening(robot))
    return Side(inputs.pick("Which project", "maps.side", names, "a", inputs.HIDDEN), a, b)


def of_quantity(what: MapQuantity, a: Robot) -> Side:
    """The choice for one quantity: names of joints and reach have no difference, and B's arm may not know it."""
    found = side(a, SIDES if what.colours in ("sequential", "diverging") else NO_NUMBERS)
    if found.b is not None and what.name not in map_quantities(found.b):
        pieces.note(f"B has no {what.title}: its arm has {format_count(found.b.n, 'joint')}.")
        return Side("a", a, None)
    return found
