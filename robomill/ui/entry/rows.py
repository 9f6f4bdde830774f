"""The material rows that can be picked on any page, and the force that is made of one."""

from __future__ import annotations

from typing import Any

import streamlit as st

from robomill.cutting.force import ForceModel
from robomill.cutting.forces import model_of
from robomill.cutting.materials import Material, alternatives
from robomill.cutting.tool import Cutter
from robomill.io.materials import sample_materials
from robomill.ui import session

OWN = "milling.materials"


@st.cache_resource(show_spinner=False)
def _samples() -> tuple[Material, ...]:
    return tuple(sample_materials())


def rows(kind: str = "") -> dict[str, Material]:
    """Every row of a kind ("mechanistic", "kienzle"; left out: of all): the samples, those of this session, the one
    that a project brings."""
    brought = getattr(session.project().setup.force, "material", None)
    every = (*_samples(), *session.kept(OWN, {}).values(), *([brought] if brought is not None else []))
    return {row.name: row for row in every if kind in ("", row.kind)}


def titles(kind: str = "") -> dict[str, str]:
    """What a list of ``rows`` calls each of them: its title, and which force is not known of it."""
    return {name: f"{row.title}{_lacking(row)}" for name, row in rows(kind).items()}


def _lacking(row: Material) -> str:
    return f" · {' and '.join(row.unknown)} force not known" if row.unknown else ""


def keep(row: Material) -> None:
    """Add or replace a row of this session."""
    session.keep(OWN, {**session.kept(OWN, {}), row.name: row})


def others(row: Material) -> tuple[Material, ...]:
    """The other rows of its alloy: the band."""
    return alternatives(row, rows(row.kind).values())


def force_of(row: Material, cutter: Cutter) -> ForceModel:
    """What pushes a cutter in the material of a row, by the model that takes rows of its kind."""
    model: Any = model_of(row)
    return model(cutter=cutter, material=row, alternatives=others(row))  # type: ignore[no-any-return]
