"""One simulation as a value: robot, path, part zero, cutter, force, stock, tolerance, numerics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from robomill.arguments import asked, refuse_unknown
from robomill.arrays import FloatArray, Numbers, Rows, as_floats, check_place, frozen, of_kind
from robomill.compliance.gravity import LinkMasses
from robomill.compliance.spring import Spring
from robomill.cutting.force import ForceModel
from robomill.cutting.tool import Cutter
from robomill.cutting.tool_table import ToolTable
from robomill.errors import SetupError
from robomill.identification.knowledge import Knowledge
from robomill.identification.measured_field import MeasuredField
from robomill.identification.result import IdentificationResult
from robomill.kinematics.spin import LEAST_MOTION, RULES
from robomill.lazy import cached_property
from robomill.provenance import Provenance
from robomill.quantities import quantity, settle, switch, told
from robomill.robot.model import Robot
from robomill.simulation import given
from robomill.simulation.origin.sources import changed_sources, stated
from robomill.spelled import Replaceable, in_units
from robomill.surface.stock import Stock, stock_grid
from robomill.toolpath.path import Toolpath
from robomill.toolpath.sketch import Sketch
from robomill.toolpath.source import PathSource, finely, meant_by, wanted_of
from robomill.units import format_limit, format_many, to_si
from robomill.values import Value

FINEST = 1e-6  # m: no robot mills as precisely: was it meant in m?
COARSEST = 0.05  # m: what is off by more is no part: was it meant in um, or in mm as m?
NO_TOOLS = ToolTable()
TOLERANCES = ("wall", "floor", "feed")
ALLOWED = ("tolerance", "floor_tolerance", "feed_tolerance")  # the fields that hold them


def _own_tolerance(label: str, hint: str) -> Any:
    """A tolerance beside the one that holds for walls, with its bounds; left out where none is stated."""
    return quantity(label, "mm", optional=True, slip=COARSEST, tiny=FINEST, above=0.0, most=COARSEST, hint=hint)


@in_units(SetupError, "Set-up", more=given.OTHERS, new=given.stated)
@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class SimulationSetup(Replaceable, Value):
    """Everything ``simulate`` needs, SI units.

    robot       the machine; its C_theta is the one in force
    source      the program, table, sketch or points the path is read from; a Toolpath or a Sketch is taken as it is
    T_MW        (4, 4) where the part zero {W} lies in {M}; instead of it ``part_zero`` (3,) m or ``part_zero_mm``, and
                ``part_rotation_z`` or ``part_rotation_z_deg``, the part's turn about z_M
    cutter, force, stock   stock None: the path's bounds with a margin
    spin        of arms with six axes or more, about the tool axis: an angle in rad by which R_x(A) R_y(B) in the axes
                of the part is turned, or "least_motion" of the joints, or "least_deviation"; one for the whole path
    tools       the tools of the program by number; empty: ``cutter`` for all (and where the program names none)
    tolerance   m, largest accepted deviation of walls, and of floors where ``floor_tolerance`` is None; or three
                numbers (wall, floor, feed), as a sequence or as a mapping by these names
    feed_tolerance   m, along the feed: of the tip on its way and of the ends of cuts (None: told, not judged)
    step        m, longest piece of path between two evaluations
    cell        m, cell size of the surfaces
    engagement  True: the force follows the arc of engagement found from the stock as it stands
    coupling    True: deflection changes the cut, iterated to a fixed point (needs engagement)
    rapid_rate  m/s on rapids, None where not known; only a force recorded over time needs it
    springs     extra compliances beside the joints', each with its own line in the result
    measured_map  compliance measured on a grid, used instead of joints and springs (whose shares are still shown)
    links       link masses for the sag under gravity (None: not computed); ``add_sag`` True adds it to the
                deviation, False only shows it, since parts are zeroed with the arm sagged
    knowledge   how sure the compliances are, as an identification leaves it: what ``rm.identify`` returned, or
                ``known`` of another set-up. No run depends on it; bands and ``rm.uncertainty`` do
    provenance  block name -> where its numbers come from: path, part, cutter, force, stock, tools, tolerance. Of what
                ``replace`` changes it says that it was given in code, unless more is said there of that block

    Raises
    ------
    SetupError
        For what cannot be run, and for numbers that were meant in another unit.

    Examples
    --------
    >>> import robomill as rm
    >>> setup = rm.SimulationSetup(
    ...     robot=rm.load_robot("slavkovic_5r"),
    ...     source=rm.Toolpath.from_points(p_mm=[[0, 0, -2], [40, 0, -2]], feed_mm_min=1800),
    ...     cutter=rm.Cutter("flat", diameter_mm=8, flutes=3),
    ...     force=rm.PathForce(feed_normal=100.0),
    ...     part_zero_mm=(0, -1300, 0),
    ...     tolerance_mm=0.2,
    ... )
    >>> setup
    <SimulationSetup set-up: slavkovic_5r, 8.00 mm flat end mill, 3 flutes, tolerance 0.20 mm>
    """

    name: str = "set-up"
    robot: Robot
    source: PathSource
    T_MW: FloatArray
    cutter: Cutter
    force: ForceModel
    stock: Stock | None = None
    tolerance: float = quantity("Tolerance", "mm", default=0.3e-3, above=0.0, most=COARSEST, slip=COARSEST, tiny=FINEST)
    floor_tolerance: float | None = _own_tolerance(
        "Tolerance of floors", "Along the tool axis. Left out: the one tolerance holds for walls and floors."
    )
    feed_tolerance: float | None = _own_tolerance(
        "Tolerance along the feed",
        "Of the tip on its way, and where a cut begins or ends in the material. Left out: given, but not judged.",
    )
    step: float = quantity("Step along the path", "mm", default=1e-3, above=0.0, slip=0.5, tiny=1.5e-6)
    cell: float = quantity("Surface grid", "mm", default=1e-4, above=0.0, digits=4, slip=0.04, tiny=FINEST)
    engagement: bool = switch(
        "Use the material actually left",
        default=False,
        hint="The arc and depth of each step come from the stock as it stands: no force in air, less in a side cut. "
        "Off: a full slot everywhere. Models with fixed numbers push wherever the path is at feed.",
    )
    coupling: bool = switch(
        "Deflection feeds back on the force",
        default=False,
        hint="Force and deflection are iterated until they agree. Needs a force from the material, and the "
        "material actually left.",
    )
    spin: float | str = LEAST_MOTION
    tools: ToolTable = NO_TOOLS
    rapid_rate: float | None = quantity(
        "Rapid rate",
        "mm/min",
        optional=True,
        slip=20.0,
        tiny=to_si(10.0, "mm/min"),
        above=0.0,
        digits=0,
        hint="How fast the machine goes on rapids: a force recorded over time runs on meanwhile.",
    )
    springs: tuple[Spring, ...] = ()
    measured_map: MeasuredField | None = None
    links: LinkMasses | None = None
    add_sag: bool = switch(
        "Add the sag to the deviation",
        default=False,
        hint="Off: shown only. A part is zeroed with the arm already sagged.",
    )
    knowledge: Knowledge | None = field(default=None, compare=False)
    description: str = field(default="", compare=False)
    provenance: Mapping[str, Provenance] = field(default_factory=dict, compare=False)

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            robot: Robot,
            source: PathSource | Toolpath | Sketch,
            cutter: Cutter,
            force: ForceModel,
            name: str = ...,
            T_MW: Rows = ...,
            part_zero: Numbers = ...,
            part_zero_mm: Numbers = ...,
            part_rotation_z: float = ...,
            part_rotation_z_deg: float = ...,
            stock: Stock | None = ...,
            tolerance: float | Sequence[float | None] | Mapping[str, float] = ...,
            tolerance_mm: float | Sequence[float | None] | Mapping[str, float] = ...,
            floor_tolerance: float | None = ...,
            floor_tolerance_mm: float | None = ...,
            feed_tolerance: float | None = ...,
            feed_tolerance_mm: float | None = ...,
            step: float = ...,
            step_mm: float = ...,
            cell: float = ...,
            cell_mm: float = ...,
            engagement: bool = ...,
            coupling: bool = ...,
            spin: float | str = ...,
            spin_deg: float = ...,
            tools: ToolTable = ...,
            rapid_rate: float | None = ...,
            rapid_rate_mm_min: float | None = ...,
            springs: Sequence[Spring] = ...,
            measured_map: MeasuredField | None = ...,
            links: LinkMasses | None = ...,
            add_sag: bool = ...,
            knowledge: Knowledge | IdentificationResult | None = ...,
            description: str = ...,
            provenance: Mapping[str, Provenance] = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        given.check_kinds(self)
        T_MW = as_floats(self.T_MW, "part zero T_MW", (4, 4), error=SetupError, one=True)
        R = T_MW[:3, :3]
        if np.abs(R @ R.T - np.eye(3)).max() > 1e-9 or np.linalg.det(R) < 0:
            raise SetupError("Part zero: its orientation is not a rotation; give three perpendicular unit axes.")
        check_place(T_MW[:3, 3], "Part zero", SetupError)
        object.__setattr__(self, "T_MW", frozen(T_MW))
        self._take_tolerances()
        self._take_spin()
        object.__setattr__(self, "springs", tuple(self.springs))
        object.__setattr__(self, "knowledge", given.knowledge_of(self.knowledge, self.robot, self.springs))
        settle(self, SetupError)
        # A process force is computed for the cutter that cuts; a changed cutter changes it too.
        object.__setattr__(self, "force", self.force.cut_by(self.cutter).placed(self.T_MW[:3, :3]))
        if self.stock is not None:
            stock_grid(self.stock, self.cell)  # refuses a cell size that would need too many cells
        names = [spring.name for spring in self.springs]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise SetupError(f"Springs: there are two named {twice[0]!r}; keep one of them or rename it.")
        if self.add_sag and self.links is None:
            raise SetupError("Sag: no link masses are given; add them or leave the sag out.")
        if self.coupling and not self.engagement:
            raise SetupError("Coupling: the force must follow the engagement; switch engagement on or coupling off.")

    def _taken(self, changes: dict[str, Any]) -> dict[str, Any]:
        found = given.taken(changes, self.T_MW, self.robot)
        if "source" in found:
            found["source"] = meant_by(found["source"], self.source)
        said = stated(found.get("provenance", {}))
        return {**found, "provenance": {**changed_sources(self, found), **said}}

    def _take_spin(self) -> None:
        """An angle, or one of the rules."""
        if isinstance(self.spin, str) and self.spin in RULES:
            return
        if isinstance(self.spin, str | Mapping) or np.ndim(self.spin) or not np.isfinite(self.spin):
            raise SetupError(
                f"Spin: expected an angle or one of {', '.join(RULES)}; found {self.spin!r:.40}.", where="spin"
            )
        object.__setattr__(self, "spin", float(self.spin))

    def _take_tolerances(self) -> None:
        """One number, or three: wall, floor, feed."""
        given: Any = self.tolerance
        if isinstance(given, Mapping):
            refuse_unknown(given, TOLERANCES, "Tolerance")
            given = [given.get(name) for name in TOLERANCES]
        if np.ndim(given) == 0:
            return
        if len(given) != len(TOLERANCES) or given[0] is None:
            raise SetupError(
                f"Tolerance: found {given!r:.60}; expected one number, or three for {', '.join(TOLERANCES)}.",
                where="tolerance",
            )
        for name, value in zip(ALLOWED, given, strict=True):
            object.__setattr__(self, name, value)

    @cached_property
    def toolpath(self) -> Toolpath:
        """The path read from its source, in {W}."""
        return self.source.read(self.tools)

    @cached_property
    def wanted_path(self) -> Toolpath | None:
        """Of a corrected program the path that was meant, in {W}, where it is told; else None."""
        wanted = wanted_of(self.source)
        return None if wanted is None else finely(wanted, self.tools)

    @cached_property
    def stock_block(self) -> Stock:
        """The stock as given, or a block around what the path cuts (around what was meant, of a corrected program)."""
        if self.stock is not None:
            return self.stock
        path = self.wanted_path or self.toolpath
        used = [self.tools.cutter(int(n)) for n in np.unique(path.tool[path.cutting]) if int(n) in self.tools]
        widest = max(used or [self.cutter], key=lambda cutter: cutter.diameter)
        return Stock.around(path, widest)

    @property
    def tolerances(self) -> dict[str, float | None]:
        """m, by field, as they are given: None where floors or the feed have none of their own."""
        return {name: getattr(self, name) for name in ALLOWED}

    @property
    def limits(self) -> dict[str, float]:
        """m, by what is judged: "wall", "floor", along the "feed", the "end" of a cut, the "tip" where no surface is
        left; what has no tolerance of its own has that of walls."""
        wall = self.tolerance
        floor, feed = (wall if own is None else own for own in (self.floor_tolerance, self.feed_tolerance))
        return {"wall": wall, "floor": floor, "feed": feed, "end": feed, "tip": wall}

    @property
    def known(self) -> Knowledge | None:
        """How sure the compliances in force are; None where nothing is known, or only of others than these."""
        known = self.knowledge
        return known if known is not None and known.holds_for(self.robot, self.springs) else None

    @property
    def carried_from(self) -> str:
        """The set-up for which the force was stated, where nobody has said yet that it holds for this path; else ""."""
        said = self.provenance.get("force")
        return "" if said is None else said.carried_from

    @asked
    def in_base(self, p: ArrayLike) -> FloatArray:
        """Points p (..., 3) m of the part frame {W}, in the robot's frame {M}."""
        return self.to_base(as_floats(p, "Points", (3,), error=SetupError, finite=False)) + self.T_MW[:3, 3]

    @asked
    def to_base(self, v: ArrayLike) -> FloatArray:
        """Directions v (..., 3) of the part frame {W}, in the robot's frame {M}: turned, and not shifted."""
        return np.asarray(as_floats(v, "Directions", (3,), error=SetupError, finite=False) @ self.T_MW[:3, :3].T)

    @asked
    def to_part(self, v: ArrayLike) -> FloatArray:
        """Directions v (..., 3) of the robot's frame {M}, in the part frame {W}."""
        return np.asarray(as_floats(v, "Directions", (3,), error=SetupError, finite=False) @ self.T_MW[:3, :3])

    def _said(self) -> str:
        return f"{self.name}: {self.robot.name}, {self.cutter.title}, tolerance {format_limit(self.tolerance, 'mm')}"

    def _facts(self) -> list[tuple[str, str]]:
        place = format_many(self.T_MW[:3, 3], "mm", 1)
        said = [("Robot", self.robot._said()), ("Path", self.source.name), ("Part zero in {M}", place)]
        said += [("Cutter", self.cutter.title), ("Force", self.force.title)]
        said += [] if self.stock is None else [("Stock", self.stock._said())]
        return said + told(self)


def check_setup(setup: Any) -> None:
    """Raises SetupError for what is no set-up."""
    of_kind(setup, SimulationSetup, "set-up", 'rm.load_setup("setup.toml") or rm.SimulationSetup(...)', SetupError)
