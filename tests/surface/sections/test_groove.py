"""Sections of a groove against what one can work out with a pencil."""

import numpy as np
import pytest

from robomill.cutting.tool import Cutter
from robomill.errors import SurfaceError
from robomill.surface.sections.groove import groove_sections
from robomill.surface.stock import Stock
from robomill.surface.swept import CutPath
from tests.telling import told

FLAT = Cutter("flat", 0.008, flutes=3)
DELTA = np.array([0.0, 0.2295e-3, -0.1024e-3])  # the paper's slot with Table 2, in feed, feed-normal, axial


def groove_section(stock, cutter, p, moved, cutting, block, station, k=None):
    return groove_sections(stock, cutter, CutPath(p, moved, np.asarray(cutting), k, block), [station])[0]


def slot(angle_deg, step=1e-3):
    angle = np.radians(angle_deg)
    feed = np.array([np.cos(angle), np.sin(angle), 0.0])
    left = np.array([-feed[1], feed[0], 0.0])
    p = np.arange(-0.05, 0.05 + 0.5 * step, step)[:, None] * feed
    cutting = np.arange(len(p)) > 0
    stock = Stock(p.min(axis=0) - [0.012, 0.012, 0.008], p.max(axis=0) + np.array([0.012, 0.012, 0.002]))
    return stock, p, cutting, np.stack([feed, left, [0.0, 0.0, 1.0]], axis=1)


@pytest.mark.parametrize("angle", [0.0, 90.0, 37.0, -120.0])
def test_slot_of_the_paper(angle):
    stock, p, cutting, R = slot(angle)
    for station in (0.01, 0.05, 0.0735):
        section = groove_section(stock, FLAT, p, p + R @ DELTA, cutting, None, station)
        assert section.centre_offset == pytest.approx(DELTA[1], abs=1e-11)
        assert section.floor_error == pytest.approx(DELTA[2], abs=1e-12)
        assert section.width == pytest.approx(0.008, abs=1e-11)
        assert section.depth == pytest.approx(0.002 - DELTA[2], abs=1e-12)
        assert (section.wall_left, section.wall_right) == pytest.approx((0.0042295, -0.0037705), abs=1e-11)
        assert (section.wall_left_ideal, section.wall_right_ideal) == pytest.approx((0.004, -0.004), abs=1e-11)
        assert np.degrees([section.wall_left_angle, section.wall_right_angle]) == pytest.approx(90.0, abs=1e-6)
        assert section.wall_left_straightness < 1e-9
        assert section.floor_tilt == pytest.approx(0.0, abs=1e-12)
        assert section.note == ""


def test_deflection_that_varies_along_the_cut():
    """Lateral 0.1 sin: the wall is the envelope of the moved capsules, so its middle follows the tool to 2nd order."""
    stock, p, cutting, _ = slot(0.0, step=5e-4)
    s = p[:, 0] + 0.05
    delta = np.column_stack([np.zeros_like(s), 1e-4 * np.sin(2 * np.pi * s / 0.1), np.zeros_like(s)])
    for section in groove_sections(stock, FLAT, CutPath(p, p + delta, cutting), [0.02, 0.035, 0.05, 0.07]):
        assert section.centre_offset == pytest.approx(1e-4 * np.sin(2 * np.pi * section.station / 0.1), abs=2e-7)
        assert section.width > 0.008


def test_ramped_floor_is_cut_by_the_lowest_pass_of_the_rim():
    stock, p, cutting, _ = slot(0.0)
    fall = np.column_stack([np.zeros(len(p)), np.zeros(len(p)), -0.01 * (p[:, 0] + 0.05)])
    section = groove_section(stock, FLAT, p, p + fall, cutting, None, 0.05)
    assert section.floor_error == pytest.approx(-0.01 * (0.05 + 0.004), abs=1e-12)


def test_ball_groove_width_and_walls():
    ball = Cutter("ball", 0.008)
    stock, p, cutting, R = slot(25.0)
    section = groove_section(stock, ball, p, p + R @ DELTA, cutting, None, 0.05)
    depth = 0.0021024
    half = np.sqrt(2 * 0.004 * depth - depth**2)
    assert section.width == pytest.approx(2 * half, rel=1e-6)
    assert section.centre_offset == pytest.approx(DELTA[1], abs=1e-10)
    assert np.isnan([section.wall_left_angle, section.wall_right_straightness, section.floor_tilt]).all()
    assert "round" in section.why["wall_left_angle"]
    assert "no straight floor" in section.why["floor_tilt"]


def test_chamfer_groove_has_its_cone_as_wall():
    cone = Cutter("chamfer", 0.01, tip_angle=np.radians(60.0))
    stock, p, cutting, _ = slot(-60.0)
    section = groove_section(stock, cone, p, p, cutting, None, 0.04)
    assert np.degrees(section.wall_left_angle) == pytest.approx(120.0, abs=1e-6)
    assert section.width == pytest.approx(2 * 0.002 * np.tan(np.radians(30.0)), rel=1e-6)


def test_two_merged_passes_leave_a_pocket():
    """Two passes 5 mm apart merge: floor between walls further apart than one cutter leaves them."""
    p = np.array([[0, 0, -0.002], [0.05, 0, -0.002], [0.05, 0.005, -0.002], [0, 0.005, -0.002]])
    stock = Stock((-0.01, -0.01, -0.01), (0.06, 0.02, 0.0))
    cutting = np.array([False, True, True, True])
    section = groove_section(stock, FLAT, p, p + np.array([0, 1e-4, 0]), cutting, [1, 2, 3, 4], 0.025)
    assert (section.kind, section.near) == ("pocket", "right")
    assert (section.wall_left, section.wall_right) == pytest.approx((0.0091, -0.0039), abs=1e-9)
    assert (section.wall_left_error, section.wall_right_error) == pytest.approx((1e-4, 1e-4), abs=1e-9)
    assert section.width == pytest.approx(0.013, abs=1e-9)
    assert np.isnan(section.centre_offset)
    assert section.block == 2


def test_side_cut_has_one_wall():
    p = np.array([[0, 0, -0.002], [0.05, 0, -0.002]])
    stock = Stock((-0.01, -0.03, -0.01), (0.06, 0.001, 0.0))
    section = groove_section(stock, FLAT, p, p + np.array([0, 1e-4, -2e-5]), [False, True], None, 0.025)
    assert (section.kind, section.near) == ("step", "right")
    assert np.isnan([section.wall_left, section.centre_offset, section.width]).all()
    assert section.wall_right_error == pytest.approx(1e-4, abs=1e-10)
    assert section.wall_right == pytest.approx(-0.0039, abs=1e-10)
    assert section.floor_error == pytest.approx(-2e-5, abs=1e-12)


def test_what_cannot_be_measured_says_why():
    p = np.array([[0, 0, 0.005], [0, 0, -0.002], [0.05, 0, -0.002], [0.2, 0, -0.002]])
    stock = Stock((-0.01, -0.02, -0.01), (0.1, 0.02, 0.0))
    cutting = [False, True, True, True]
    moved = p + np.array([0, 1e-4, 0])
    plunge, slot_, outside = groove_sections(stock, FLAT, CutPath(p, moved, np.array(cutting)), [0.003, 0.03, 0.2])
    assert "along the tool axis" in plunge.note
    assert np.isnan(plunge.width)
    assert slot_.note == ""
    assert "beside the stock" in outside.note
    moved[2] = np.nan
    assert "does not reach" in groove_section(stock, FLAT, p, moved, cutting, None, 0.03).note
    lost = CutPath(p, moved, np.array(cutting), why=["", "", "not judged here", ""])
    assert groove_sections(stock, FLAT, lost, [0.03])[0].note == "not judged here"
    assert np.isnan(groove_sections(stock, FLAT, lost, [0.03])[0].width)
    high_up = np.array([0, 0, 0.03])
    high = groove_sections(stock, FLAT, CutPath(p + high_up, p + high_up, np.array(cutting)), [0.03])[0]
    assert "above the stock" in high.note
    for lifted, note in ((1.9e-3, ""), (2.1e-3, "the deflected tool cuts nothing here")):
        moved = p + np.array([0, 0, lifted])
        assert groove_section(stock, FLAT, p, moved, cutting, None, 0.03).note == note


def test_metal_that_a_pass_without_a_number_takes_away_is_not_measured():
    """A slot, and one of 3 mm deeper across its middle that has no number: sections through both say so, with no number
    of their own; away from it they are those of the slot alone."""
    p = np.array([[-0.05, 0, 5], [-0.05, 0, -2], [0.05, 0, -2], [0, -0.05, 5], [0, -0.05, -5], [0, 0.05, -5.0]])
    p[:, 2] *= 1e-3
    cutting, shift = np.array([False, True, True, False, False, True]), np.array([0, 1e-4, -2e-5])
    moved = p + shift
    moved[5] = np.nan
    path = CutPath(p, moved, cutting, why=["not judged here"] * 6)
    stock = Stock((-0.03, -0.02, -0.01), (0.03, 0.02, 0.0))
    away, at, beside = groove_sections(stock, FLAT, path, np.array([0.03, 0.05, 0.0545]) + 0.007)
    assert (away.centre_offset, away.floor_error) == pytest.approx((1e-4, -2e-5), abs=1e-9)
    assert np.isnan([at.centre_offset, at.floor_error, at.width]).all()
    assert "without a number goes through here" in at.note
    assert len(at.w) == len(at.z_ideal) == len(at.z_machined) == 0
    assert beside.centre_offset == pytest.approx(1e-4, abs=1e-9)
    with pytest.raises(SurfaceError, match="runs from 0 to 207"):
        groove_section(stock, FLAT, p, moved, cutting, None, 0.3)


def test_tilted_cutter_leaves_a_leaning_wall_and_a_tilted_floor():
    """Axis tilted by B about Y (towards +X), feed along +Y: right of the feed is +X, where the wall opens up."""
    tilt = np.radians(8.0)
    k = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    p = np.array([[0.0, -0.05, -0.003], [0.0, 0.05, -0.003]])
    stock = Stock((-0.02, -0.03, -0.01), (0.02, 0.03, 0.0))
    moved = p + np.array([2e-4, 0.0, -1e-4])
    section = groove_section(stock, FLAT, p, moved, [False, True], None, 0.05, k=k)
    assert section.floor_error == pytest.approx(-1e-4, abs=1e-12)
    assert section.floor_tilt == pytest.approx(tilt, abs=1e-9)  # higher to the left
    assert np.degrees(section.wall_right_angle) == pytest.approx(98.0, abs=1e-6)
    assert np.isnan(section.wall_left_angle)  # seen from above the undercut side is its lip
    assert "under its lip" in section.why["wall_left_angle"]
    # both walls move sideways with the tool, and the cylinder's sides move with its depth along the slope too
    assert section.centre_offset == pytest.approx(-(2e-4 + 1e-4 * np.tan(tilt)), abs=1e-10)


def test_groove_in_a_mesh_stock():
    """A wedge rising across the feed: walls end where its skin is, depth counts from the skin over the tool."""
    pytest.importorskip("trimesh")
    import trimesh

    corners = np.array([[x, y, z] for x in (-0.03, 0.03) for y in (-0.02, 0.02) for z in (-0.01, 0.1 * y)])
    wedge = trimesh.convex.convex_hull(corners)
    stock = Stock(corners.min(axis=0), corners.max(axis=0), wedge.triangles)
    p = np.array([[-0.04, 0, -0.003], [0.04, 0, -0.003]])
    section = groove_section(stock, FLAT, p, p + np.array([0, 1e-4, 0]), [False, True], None, 0.04)
    assert section.depth == pytest.approx(0.003 + 0.1 * 1e-4, abs=1e-12)  # the skin is higher over the moved tool
    assert section.width == pytest.approx(0.008, abs=1e-9)
    assert section.centre_offset == pytest.approx(1e-4, abs=1e-10)
    outside = np.abs(section.w) > 0.0045
    np.testing.assert_allclose(section.z_ideal[outside], 0.1 * section.w[outside], atol=1e-12)


def test_a_path_without_feed_has_no_groove():
    stock, p, _, _ = slot(0.0)
    with pytest.raises(SurfaceError, match="no groove to measure"):
        groove_section(stock, FLAT, p, p, np.zeros(len(p), bool), None, 0.0)


@pytest.mark.parametrize(("first", "second"), [(14e-6, 155e-6), (-0.2e-3, 0.1e-3)])
@pytest.mark.parametrize("step", [1e-3, 60e-3])
def test_of_two_slots_that_touch_each_is_measured_from_its_own_track(first, second, step):
    """8 mm slots at y = 0 and 8 mm, pushed apart: as told nothing stands between them, a thin rib does."""
    x = np.arange(-0.03, 0.0301, step)
    p = np.vstack([np.column_stack([x, 0 * x + y, 0 * x - 0.002]) for y in (0.0, 0.008)])
    cutting = np.tile(np.arange(len(x)) > 0, 2)
    aside = np.repeat([first, second], len(x))[:, None] * [0.0, 1.0, 0.0]
    stock = Stock((-0.02, -0.015, -0.01), (0.02, 0.015, 0.0))
    for section, pushed in zip(
        groove_sections(stock, FLAT, CutPath(p, p + aside, cutting), [0.03, 0.09]), (first, second), strict=True
    ):
        assert section.centre_offset == pytest.approx(pushed, abs=1e-11)
        assert section.width == pytest.approx(0.008, abs=1e-11)
        assert section.note == ""


def test_where_another_pass_took_away_a_wall_that_should_stay_the_middle_is_not_known():
    """A rib of 0.1 mm is told to stay between two slots; pushed together they leave none."""
    x = np.arange(-0.03, 0.0301, 1e-3)
    p = np.vstack([np.column_stack([x, 0 * x + y, 0 * x - 0.002]) for y in (0.0, 0.0081)])
    cutting = np.tile(np.arange(len(x)) > 0, 2)
    aside = np.repeat([1e-4, -2e-4], len(x))[:, None] * [0.0, 1.0, 0.0]
    stock = Stock((-0.02, -0.015, -0.01), (0.02, 0.015, 0.0))
    one, other = groove_sections(stock, FLAT, CutPath(p, p + aside, cutting), [0.03, 0.09])
    for section in (one, other):
        assert np.isnan(section.centre_offset)
        assert "another pass" in section.note
    assert one.wall_right - one.wall_right_ideal == pytest.approx(1e-4, abs=1e-11)
    assert other.wall_left - other.wall_left_ideal == pytest.approx(-2e-4, abs=1e-11)


def test_sections_tell_how_many_of_them_are_made():
    stock, p, cutting, R = slot(0.0)
    shares = told(lambda: groove_sections(stock, FLAT, CutPath(p, p + R @ DELTA, cutting), np.linspace(0.01, 0.09, 5)))
    assert shares["Sections"] == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8])


def test_a_row_of_the_table_is_a_section_in_millimetres_and_degrees():
    """The paper's slot beside a place where nothing is cut: its numbers by hand, NaN there."""
    stock, p, cutting, R = slot(0.0)
    high = np.where(np.arange(len(p))[:, None] < 30, [0.0, 0.0, 0.005], 0.0)
    sections = groove_sections(stock, FLAT, CutPath(p + high, p + high + R @ DELTA, cutting), [0.01, 0.08])
    table = sections.columns()
    assert [section.kind for section in sections] == table["kind"].tolist() == ["nothing", "groove"]
    for name, number in (
        ("station_mm", (10.0, 80.0)),
        ("width_mm", (np.nan, 8.0)),
        ("depth_mm", (np.nan, 2.1024)),
        ("centre_offset_mm", (np.nan, 0.2295)),
        ("floor_error_mm", (np.nan, -0.1024)),
        ("wall_left_angle_deg", (np.nan, 90.0)),
    ):
        np.testing.assert_allclose(table[name], number, atol=1e-6, err_msg=name)
    assert "2 sections: nothing, groove" in repr(sections)
    told = repr(sections[1]).replace("−", "-")
    assert "at 80.0 mm: groove: width 8.000 mm, depth 2.102 mm" in told
    profile = sections[1].columns()
    assert list(profile) == ["w_mm", "z_ideal_mm", "z_machined_mm"]
    np.testing.assert_allclose(profile["z_ideal_mm"], np.where(np.abs(profile["w_mm"]) < 4.0, 0.0, 2.0), atol=1e-9)
    shifted = np.abs(profile["w_mm"] - 0.2295) < 4.0
    np.testing.assert_allclose(profile["z_machined_mm"], np.where(shifted, -0.1024, 2.0), atol=1e-9)


def test_stations_are_one_list_of_lengths():
    stock, p, cutting, R = slot(0.0)
    with pytest.raises(SurfaceError, match=r"expected a list of lengths, found shape .1, 2."):
        groove_sections(stock, FLAT, CutPath(p, p + R @ DELTA, cutting), [[0.01, 0.02]])


def across_x(cutter, *lines, k=None):
    """The section at x = 0 of the first of straight passes along +X, each (y, z) mm, all pushed aside and down."""
    ends = np.array([[[-50.0, y, z], [50.0, y, z]] for y, z in lines]).reshape(-1, 3) * 1e-3
    stock = Stock((-0.03, -0.03, -0.01), (0.03, 0.03, 0.0))
    cutting = np.arange(len(ends)) % 2 == 1
    return groove_section(stock, cutter, ends, ends + np.array([0.0, 1e-4, -5e-5]), cutting, None, 0.05, k=k)


@pytest.mark.parametrize("turn", [0.0, 3.0, -5.0])
@pytest.mark.parametrize("flat", [0.8e-3, 1.2e-3, 1.9e-3])
def test_the_floor_of_a_round_nosed_mill_leans_as_what_its_end_has_of_a_flat(flat, turn):
    """The flat is less than half as wide as the mill: beyond it the nose rises."""
    cutter, t = Cutter("bull", 8e-3, corner_radius=4e-3 - flat), np.radians(turn)
    section = across_x(cutter, (0.0, -3.0), k=np.array([0.0, np.sin(t), np.cos(t)]))
    assert section.floor_tilt == pytest.approx(-t, abs=1e-6)


@pytest.mark.parametrize(("aside", "tilt"), [(6.3, 0.0), (5.7, None), (-6.3, 0.0), (-5.7, None)])
def test_the_lean_of_a_floor_is_that_of_the_half_of_it_about_the_axis(aside, tilt):
    """A deeper pass beside it ends the floor 2.3 mm or 1.7 mm from the axis, outside of that half or within it."""
    section = across_x(FLAT, (0.0, -3.0), (aside, -3.5))
    if tilt is None:
        assert np.isnan(section.floor_tilt)
        assert "not straight across" in section.why["floor_tilt"]
    else:
        assert section.floor_tilt == pytest.approx(tilt, abs=1e-9)
