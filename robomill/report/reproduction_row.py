"""The reproduction table: what it is computed from, its rows, and the table as columns and as a sentence."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from robomill.cutting.materials import Material
from robomill.identification.result import IdentificationResult
from robomill.lazy import cached_property
from robomill.report.paper import WORDS, Statement
from robomill.robot.model import Robot
from robomill.simulation.origin.assumptions import assumed_of_robot
from robomill.simulation.result import SimulationResult
from robomill.workspace.fields import ComplianceMap, compliance_map
from robomill.workspace.grid import PAPER_BOX, plane_grid

STEP = 0.1  # m: grid of the checks


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the rows are computed from: the paper's robot, its milling test with both tables, and identifications.

    nine: from the (synthetic) nine points; single: from the (synthetic) tests of one joint at a time.
    """

    given: Robot
    flute: SimulationResult
    flute_3: SimulationResult
    nine: IdentificationResult
    single: IdentificationResult
    materials: Sequence[Material]

    @cached_property
    def robot(self) -> Robot:
        """The robot with the paper's Table 2."""
        return self.given.with_compliance_set("table_2")

    @cached_property
    def plane(self) -> ComplianceMap:
        """Its compliances over the plane Z_M = 0 of the paper's box."""
        return compliance_map(self.robot, plane_grid("z", 0.0, *PAPER_BOX, STEP))


class Found(NamedTuple):
    """What robomill finds for a statement, whether that agrees, and the numbers behind it."""

    text: str
    holds: bool
    numbers: Mapping[str, float] = {}


@dataclass(frozen=True)
class Row:
    """A statement of the paper, what robomill finds now, and why they stand as they do.

    ``holds`` is the check behind the status; a test asserts it for every row.
    """

    statement: Statement
    found: str
    holds: bool
    reason: str = field(default="")
    numbers: Mapping[str, float] = field(default_factory=dict)


def columns(rows: Sequence[Row]) -> dict[str, list[str]]:
    """The rows as a table."""
    return {
        "of the paper": [r.statement.where for r in rows],
        "paper": [r.statement.gives for r in rows],
        "robomill": [r.found for r in rows],
        "status": [WORDS[r.statement.status] for r in rows],
        "reason": [r.reason for r in rows],
        "quotation": [" … ".join(r.statement.quotations) for r in rows],
    }


def reproduction_record(rows: Sequence[Row], robot: Robot) -> dict[str, Any]:
    """The rows as JSON carries them; ``holds``: whether every check that stands behind a status does."""
    return {
        "rows": [
            {
                "code": row.statement.code,
                "of_the_paper": row.statement.where,
                "paper": row.statement.gives,
                "robomill": row.found,
                "status": row.statement.status,
                "holds": row.holds,
                "reason": row.reason,
                "quotations": list(row.statement.quotations),
                "numbers": {name: float(value) for name, value in row.numbers.items()},
            }
            for row in rows
        ],
        "holds": all(row.holds for row in rows),
        "summary": summary(rows),
        "assumed": [each.record() for each in assumed_of_robot(robot)],
    }


def summary(rows: Sequence[Row]) -> str:
    """How many of which status, in one sentence."""
    count = {status: sum(r.statement.status == status for r in rows) for status in WORDS}
    return (
        f"{len(rows)} tables, figures and claims: {count['reproduced']} reproduced, {count['assumed']} reproduced "
        f"with the assumed lengths, {count['gap']} with a gap that is named, {count['not computed']} with nothing to "
        "compute."
    )
