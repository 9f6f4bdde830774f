"""Springs beside the joints and link masses, to and from the tables of a set-up."""

from __future__ import annotations

from typing import Any

import numpy as np

from robomill.compliance.gravity import LinkMasses
from robomill.compliance.springs import JointBending, SpindleSpring, Spring, ToolBending
from robomill.io.tables import Table
from robomill.units import from_si

BENDING = "1e-7 rad/(N m)"


def spring_from_table(table: Table) -> Spring:
    """One [[springs]] entry: kind tool_bending, spindle or joint_bending."""
    kind = table.text("kind")
    given: dict[str, Any] = {}
    if table.has("source"):
        given["provenance"] = table.provenance("source")
    if kind == "tool_bending":
        spring: Spring = ToolBending(
            table.number("diameter_mm", "mm"),
            table.number("stick_out_mm", "mm"),
            table.number("E_N_mm2", "N/mm2", ToolBending.E),
            table.number("core", "1", ToolBending.core),
            **given,
        )
    elif kind == "spindle":
        spring = SpindleSpring(table.number("lateral_um_N", "um/N"), table.number("axial_um_N", "um/N", 0.0), **given)
    elif kind == "joint_bending":
        C_x, C_y = (table.number(f"{axis}_1e-7_rad_per_Nm", BENDING, 0.0) for axis in ("C_x", "C_y"))
        spring = JointBending(table.whole("joint"), C_x, C_y, **given)
    else:
        raise table.refuse("kind", f"expected tool_bending, spindle or joint_bending, found {kind!r:.40}.")
    table.finish()
    return spring


def spring_to_table(spring: Spring) -> dict[str, Any]:
    """The spring as a table that ``spring_from_table`` reads back."""
    source = {"source": {"kind": spring.provenance.kind, "source": spring.provenance.source}}
    if isinstance(spring, ToolBending):
        return {
            "kind": "tool_bending",
            "diameter_mm": from_si(spring.diameter, "mm"),
            "stick_out_mm": from_si(spring.stick_out, "mm"),
            "E_N_mm2": from_si(spring.E, "N/mm2"),
            "core": spring.core,
            **source,
        }
    if isinstance(spring, SpindleSpring):
        lateral, axial = (from_si(v, "um/N") for v in (spring.lateral, spring.axial))
        return {"kind": "spindle", "lateral_um_N": lateral, "axial_um_N": axial, **source}
    if isinstance(spring, JointBending):
        C_x, C_y = (from_si(v, BENDING) for v in (spring.C_x, spring.C_y))
        return {
            "kind": "joint_bending",
            "joint": spring.joint,
            "C_x_1e-7_rad_per_Nm": C_x,
            "C_y_1e-7_rad_per_Nm": C_y,
            **source,
        }
    raise TypeError(f"no table for a spring of type {type(spring).__name__}")


def links_from_table(table: Table) -> LinkMasses:
    """[links]: mass_kg one a joint, centre_mm a row of three a joint."""
    centre = table.rows("centre_mm", 3, "mm")
    mass = table.numbers("mass_kg", len(centre), "kg")
    given = {"provenance": table.provenance("source")} if table.has("source") else {}
    table.finish()
    return LinkMasses(np.array(mass), centre, **given)


def links_to_table(links: LinkMasses) -> dict[str, Any]:
    source = {"kind": links.provenance.kind, "source": links.provenance.source}
    return {"mass_kg": links.mass.tolist(), "centre_mm": from_si(links.centre, "mm").tolist(), "source": source}
