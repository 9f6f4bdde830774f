"""A set-up refuses what contradicts itself, and puts points where its part zero says."""

from __future__ import annotations

import numpy as np
import pytest

from robomill.compliance.springs.spindle import SpindleSpring
from robomill.cutting.tool import Cutter
from robomill.cutting.tool_table import TableTool, ToolTable
from robomill.errors import SetupError
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.kinematics.transforms import translation
from robomill.surface.stock import BESIDE
from robomill.toolpath.source import GCodeSource

SETUP = load_setup(samples_dir() / "paper_flute" / "setup.toml")


def spring(name):
    return SpindleSpring(lateral=1e-8, name=name)


@pytest.mark.parametrize("names", [("a", "a"), ("a", "b", "a"), ("c", "b", "b")])
def test_springs_are_told_apart_by_their_names(names):
    twice = next(name for name in names if names.count(name) == 2)
    with pytest.raises(SetupError, match=f"there are two named '{twice}'"):
        SETUP.replace(springs=tuple(map(spring, names)))
    assert len(SETUP.replace(springs=(spring("a"), spring("b"))).springs) == 2


def test_what_needs_something_else_is_refused_without_it():
    with pytest.raises(SetupError, match="Sag: no link masses"):
        SETUP.replace(add_sag=True)
    with pytest.raises(SetupError, match="Coupling: the force must follow the engagement"):
        SETUP.replace(coupling=True)


@pytest.mark.parametrize("axes", [np.diag([1.0, 1.0, -1.0]), 1.00001 * np.eye(3), np.diag([1.0, -1.0, 1.0])])
def test_a_part_frame_is_a_rotation(axes):
    T_MW = SETUP.T_MW.copy()
    T_MW[:3, :3] = axes
    with pytest.raises(SetupError, match="not a rotation"):
        SETUP.replace(T_MW=T_MW)


def test_points_are_turned_and_then_shifted():
    T_MW = np.eye(4)
    T_MW[:3, :3] = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    T_MW[:3, 0] *= np.linalg.det(T_MW[:3, :3])
    T_MW[:3, 3] = [0.1, -1.3, 0.02]
    setup = SETUP.replace(T_MW=T_MW)
    p = np.random.default_rng(1).normal(size=(2, 4, 3))
    for at in np.ndindex(2, 4):
        np.testing.assert_allclose(setup.in_base(p)[at], (T_MW @ [*p[at], 1.0])[:3], atol=1e-15)


def test_directions_are_turned_and_turned_back_by_the_inverse():
    yaw, tilt, T_MW = 0.7, -0.4, np.eye(4)
    R_z = [[np.cos(yaw), -np.sin(yaw), 0.0], [np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]]
    R_x = [[1.0, 0.0, 0.0], [0.0, np.cos(tilt), -np.sin(tilt)], [0.0, np.sin(tilt), np.cos(tilt)]]
    T_MW[:3, :3], T_MW[:3, 3] = np.array(R_z) @ R_x, [0.1, -1.3, 0.02]
    setup, T_WM = SETUP.replace(T_MW=T_MW), np.linalg.inv(T_MW)
    v = np.random.default_rng(2).normal(size=(2, 4, 3))
    for at in np.ndindex(2, 4):
        np.testing.assert_allclose(setup.to_base(v)[at], (T_MW @ [*v[at], 0.0])[:3], atol=1e-15)
        np.testing.assert_allclose(setup.to_part(v)[at], (T_WM @ [*v[at], 0.0])[:3], atol=1e-15)


@pytest.mark.parametrize("given", [[2e-4], [2e-4, 1e-4], [2e-4, 1e-4, None, None], {"floor": 1e-4}, [None, 1e-4, 1e-4]])
def test_three_tolerances_are_three_and_the_first_is_needed(given):
    with pytest.raises(SetupError, match=r"Tolerance: found .*three for wall, floor, feed"):
        SETUP.replace(tolerance=given)


@pytest.mark.parametrize("given", [[2e-4, 1e-4, 3e-4], {"feed": 3e-4, "wall": 2e-4, "floor": 1e-4}])
def test_three_tolerances_come_in_their_order_or_by_their_names(given):
    setup = SETUP.replace(tolerance=given)
    assert (setup.tolerance, setup.floor_tolerance, setup.feed_tolerance) == (2e-4, 1e-4, 3e-4)
    only = SETUP.replace(tolerance={"wall": 2e-4})
    assert (only.tolerance, only.floor_tolerance, only.feed_tolerance) == (2e-4, None, None)


def test_without_a_stock_the_block_stands_round_what_the_widest_cutter_that_cuts_makes():
    """Tool 3 is wider, and only moved about; without a table the set-up's own cutter is taken."""
    cutters = (Cutter("flat", 6e-3), Cutter("ball", 10e-3), Cutter("flat", 20e-3))
    table = ToolTable(tuple(TableTool(n, cutter) for n, cutter in enumerate(cutters, 1)))
    for tools, radius in (((1, 2), 5e-3), ((2, 1), 5e-3), ((1,), 3e-3), ((), SETUP.cutter.radius)):
        cuts = [
            line
            for n in tools or (0,)
            for line in (f"T{n} M6" * (n > 0), "G0 X-10 Y2 Z5", "G1 Z-1 F600", "G1 X30", "G0 Z5")
        ]
        text = "\n".join(["G21 G90 S9000 M3", *cuts, "T3 M6" * bool(tools), "G0 X90 Y90", "M2", ""])
        block = SETUP.replace(stock=None, source=GCodeSource(text), tools=table if tools else ToolTable()).stock_block
        np.testing.assert_allclose(block.lower[:2], [-10e-3 - radius - BESIDE, 2e-3 - radius - BESIDE], atol=1e-12)
        np.testing.assert_allclose(block.upper[:2], [30e-3 + radius + BESIDE, 2e-3 + radius + BESIDE], atol=1e-12)
    assert SETUP.stock_block is SETUP.stock


@pytest.mark.parametrize("name", ["tolerance", "floor_tolerance", "feed_tolerance"])
def test_a_tolerance_wider_than_any_part_has_one_is_refused(name):
    """100 um stated as 100 mm, 0.3 mm as 0.3 m; up to 50 mm are taken."""
    for wide in (0.06, 0.1, 0.3):
        with pytest.raises(SetupError, match=r"[Tt]olerance"):
            SETUP.replace(**{name: wide})
    for fits in (1e-5, 0.3e-3, 0.049):
        assert getattr(SETUP.replace(**{name: fits}), name) == fits


def test_what_a_notebook_shows_of_a_set_up_is_in_it() -> None:
    shown = SETUP.replace(stock=None, T_MW=translation([12e-3, -1300e-3, 2.54e-3]))
    facts = dict(shown._facts())
    assert facts["Part zero in {M}"].replace("\u2212", "-").startswith("12.0, -1300.0, 2.5 ")
    assert "Stock" not in facts
    assert {"Robot", "Path", "Cutter", "Force"} <= set(facts)
    assert "Stock" in dict(SETUP._facts())
    assert "0.30" in SETUP._said()
