"""Springs beside the joints, to and from the [[springs]] of a set-up: each by its declared fields."""

from typing import Any

from robomill.compliance.spring import Spring
from robomill.compliance.springs import SPRINGS
from robomill.io.declared import from_table, to_table
from robomill.io.tables import Table


def spring_from_table(table: Table) -> Spring:
    """One [[springs]] entry; its ``kind`` says which."""
    return from_table(table, SPRINGS[table.choice("kind", tuple(SPRINGS))])


def spring_to_table(spring: Spring) -> dict[str, Any]:
    """The spring as a table that ``spring_from_table`` reads back."""
    return {"kind": spring.kind, **to_table(spring)}
