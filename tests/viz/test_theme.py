"""Every figure builds in both themes, names its axes with units and keeps its camera."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from robomill.simulation.enlarged import enlarged
from robomill.simulation.origin.spread import alloy_spread, peak_force
from robomill.simulation.result import SimulationResult
from robomill.viz.arm import arm_figure
from robomill.viz.chart import Chart
from robomill.viz.deviation import components_figure, shares_figure
from robomill.viz.engagement import engagement_figure, force_figure
from robomill.viz.evidence import Claim, evidence_figure
from robomill.viz.metrology import ProfileCurves, histogram_figure, profile_figure
from robomill.viz.sections import section_figure
from robomill.viz.surfaces import surface_figure
from robomill.viz.theme import diverging, joint_colours
from robomill.viz.views import arm_scene, section_drawing


def figures(result: SimulationResult, dark: bool) -> dict[str, Chart]:
    shown = enlarged(result, 10.0)
    groove = result.groove(0.5 * float(result.path.s[-1]))
    return {
        "arm": arm_figure(arm_scene(result, result.worst), dark=dark),
        "components": components_figure(result, "mm", dark=dark, i=result.worst),
        "shares": shares_figure(result, "y", "mm", dark=dark),
        "section": section_figure(section_drawing(groove, "mm"), dark=dark),
        "surface": surface_figure(shown, 0.3e-3, "mm", dark=dark),
    }


@pytest.mark.parametrize("dark", [False, True])
def test_axes_have_units_and_views_are_kept(result: SimulationResult, dark: bool) -> None:
    for name, figure in figures(result, dark).items():
        layout = json.loads(figure.figure.to_json())["layout"]
        assert layout["height"] > 200, name
        assert layout["uirevision"], name
        holder = layout.get("scene", layout)
        if "scene" in layout:
            assert holder["uirevision"], name
            assert holder["camera"]["projection"]["type"] == "orthographic", name
        for axis in ("xaxis", "yaxis"):
            text = holder[axis]["title"]["text"]
            assert any(f", {unit}" in text for unit in ("m", "mm")), (name, text)


def test_two_themes_differ(result: SimulationResult) -> None:
    for name, light in figures(result, False).items():
        assert light.figure.to_json() != figures(result, True)[name].figure.to_json(), name
        break


def test_signed_colours_are_symmetric_about_zero(result: SimulationResult) -> None:
    for dark in (False, True):
        assert [stop for stop, _ in diverging(dark)] == [0.0, 0.25, 0.5, 0.75, 1.0]
        surface = figures(result, dark)["surface"].figure.data[0]
        assert surface.cmin == -surface.cmax


def test_joint_colours_are_distinct() -> None:
    for dark in (False, True):
        assert len(set(joint_colours(7, dark))) == 7


CLAIMS = (Claim("a", "paper", 0.23), Claim("b", "computed", 0.28, 0.2, 0.4))


def milling_figures(result: SimulationResult, dark: bool) -> dict[str, Any]:
    """One figure of each kind."""
    peak = peak_force(result)
    assert peak is not None
    q = np.linspace(0.0, 100.0, 21)
    profile = ProfileCurves(
        q,
        0.2 + 0 * q,
        -0.1 + 0 * q,
        "mm",
        0.3,
        0.4,
        band=np.stack([0.1 + 0 * q, 0.3 + 0 * q]),
        fit=0.2 + 0 * q,
        measured=(q, 0.29 + 0 * q),
    )
    return {
        "force": force_figure(result, alloy_spread(result), peak, "mm", dark=dark, i=result.worst),
        "engagement": engagement_figure(result, "mm", dark=dark),
        "profile": profile_figure(profile, np.arange(21), 50.0, dark=dark),
        "histogram": histogram_figure(
            np.linspace(-0.3, 0.3, 11),
            {"walls": np.full(10, 8.0), "floors": np.full(10, 2.0)},
            np.array([0.3, 0.2]),
            dark=dark,
        ),
        "evidence": evidence_figure(CLAIMS, "mm", dark=dark),
    }


@pytest.mark.parametrize("dark", [False, True])
def test_axes_of_the_milling_figures_have_units(process_result: SimulationResult, dark: bool) -> None:
    for name, made in milling_figures(process_result, dark).items():
        layout = json.loads(made.figure.to_json())["layout"]
        assert layout["uirevision"], name
        titles = [layout[a].get("title", {}).get("text", "") for a in ("xaxis", "yaxis")]
        assert any(f", {unit}" in titles[0] for unit in ("mm", "µm")), (name, titles)
