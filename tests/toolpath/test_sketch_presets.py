"""Ready-made sketches and the stroke font: sizes, coverage of faces, what is refused."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from robomill.errors import ToolpathError
from robomill.toolpath.sketch import Sketch
from robomill.toolpath.sketch_presets import PRESETS, pocket, preset, spiral, zigzag
from robomill.toolpath.stroke_font import GLYPHS, HEIGHT, strokes

D = 8e-3


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_makes_a_path_with_the_sketch_s_feed_and_depth(name):
    path = preset(name, Sketch(v_f=0.02, depth=1.5e-3), D).toolpath()
    assert path.cutting.any()
    assert path.p[:, 2].min() == pytest.approx(-1.5e-3)
    assert path.v_f.max() == pytest.approx(0.02)


def test_the_lines_of_fig_8_span_the_paper_s_plane():
    """Six lines, three a direction, on the borders and through the middle of 1200 x 600 mm."""
    elements = preset("fig_8", Sketch(), D).elements
    assert len(elements) == 6
    low, high = preset("fig_8", Sketch(), D).toolpath().extents
    np.testing.assert_allclose(high[:2] - low[:2], [1.2, 0.6], atol=1e-12)
    lengths = sorted(float(np.linalg.norm(np.diff(e.points, axis=0))) for e in elements)
    np.testing.assert_allclose(lengths, [0.6] * 3 + [1.2] * 3)


@pytest.mark.parametrize("diameter", [4e-3, D, 12e-3])
def test_presets_have_their_sizes_and_neighbouring_passes_overlap_by_less_than_half(diameter):
    """Of the cutter's centre, mm: a slot of 100, a circle and a spiral of 60 across, a face of 80 by 50; a pocket of 60
    by 40 with the cutter. Passes beside each other are 0.6 of the cutter apart at most."""
    cut = {
        name: np.vstack([e.points for e in preset(name, Sketch(), diameter).elements])
        for name in ("slot", "circle", "pocket", "face", "spiral")
    }
    np.testing.assert_allclose(cut["slot"], [[-0.05, 0], [0.05, 0]])
    assert np.linalg.norm(np.diff(cut["circle"], axis=0)) == pytest.approx(0.03)
    np.testing.assert_allclose(np.ptp(cut["pocket"], axis=0) + diameter, [0.06, 0.04])
    np.testing.assert_allclose(np.ptp(cut["face"], axis=0), [0.08, 0.05])
    assert np.hypot(*cut["spiral"].T).max() == pytest.approx(0.03)
    rows = np.diff(np.unique(cut["face"][:, 1].round(9)))
    angle = np.unwrap(np.arctan2(*cut["spiral"][1:].T[::-1]))
    turns = np.ptp(angle) / (2.0 * np.pi) - 1.0  # the last one is the circle
    for apart in (rows.max(), 0.03 / turns):
        assert 0.5 * diameter < apart < 0.65 * diameter


def largest_gap(points, diameter, length, width):
    """How far the worst point of the floor lies from the nearest cutter centre, less the radius (brute force)."""
    at = np.linspace(0, 1, 60)[:, None]
    path = np.vstack([a + at * (b - a) for a, b in itertools.pairwise(points)])
    a, b = 0.5 * (length - diameter), 0.5 * (width - diameter)
    x, y = np.meshgrid(np.linspace(-a, a, 41), np.linspace(-b, b, 31))
    floor = np.column_stack([x.ravel(), y.ravel()])
    return max(np.hypot(*(path - q).T).min() for q in floor) - 0.5 * diameter


@pytest.mark.parametrize(("length", "width"), [(0.06, 0.04), (0.04, 0.06), (0.05, 0.05), (0.012, 0.012)])
def test_a_pocket_has_its_size_and_no_islands(length, width):
    points = pocket(length, width, D)
    np.testing.assert_allclose(np.ptp(points, axis=0) + D, [length, width], atol=1e-12)
    assert largest_gap(points, D, length, width) < 0
    assert (np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-9).all()


def test_a_pocket_too_narrow_for_the_cutter_is_refused():
    with pytest.raises(ToolpathError, match="does not fit"):
        pocket(0.06, 0.007, D)


def test_a_zigzag_leaves_no_ridges():
    points = zigzag(0.08, 0.05, 0.6 * D)
    rows = np.unique(points[:, 1])
    assert np.diff(rows).max() <= 0.6 * D + 1e-12
    assert np.ptp(points[:, 1]) == pytest.approx(0.05)
    assert largest_gap(points, D, 0.08, 0.05) < 0


def test_a_spiral_has_its_pitch_and_ends_in_a_circle():
    points = spiral(0.03, 5e-3)
    r = np.hypot(*points.T)
    assert r[0] == 0
    assert r.max() == pytest.approx(0.03, abs=1e-9)
    assert (np.diff(r) > -1e-12).all()
    turns = np.unwrap(np.arctan2(points[1:, 1], points[1:, 0]))
    assert (turns[-1] - turns[0]) / (2 * np.pi) == pytest.approx(7.0, abs=0.05)


def test_letters_have_their_height_and_go_from_left_to_right():
    found, width = strokes("Hi 12", 0.012)
    every = np.vstack(found)
    assert every[:, 1].min() == 0
    assert every[:, 1].max() == pytest.approx(0.012)
    assert every[:, 0].max() == pytest.approx(width)
    alone, _ = strokes("H", 0.012)
    np.testing.assert_allclose(found[0], alone[0])


@pytest.mark.parametrize("sign", [s for s in GLYPHS if s != " "])
def test_every_glyph_is_on_its_grid_and_every_stroke_moves(sign):
    found, _ = strokes(sign, HEIGHT)
    assert found
    for stroke in found:
        assert len(stroke) >= 2
        assert (np.linalg.norm(np.diff(stroke, axis=0), axis=1) > 0).all()
        assert stroke.min() >= 0
        assert stroke[:, 0].max() <= 4
        assert stroke[:, 1].max() <= 7


def test_a_sign_without_strokes_and_an_empty_word_are_refused():
    with pytest.raises(ToolpathError, match="no strokes for '€'"):
        strokes("5 €", 0.01)
    with pytest.raises(ToolpathError, match="empty"):
        preset("word", Sketch(), D, "  ")
    with pytest.raises(ToolpathError, match="no preset 'moon'"):
        preset("moon", Sketch(), D)


@pytest.mark.parametrize("chord", [5e-6, 1e-4])
def test_a_spiral_is_drawn_within_its_chord_and_ends_in_a_full_circle(chord):
    """Points on r = pitch phi / 2 pi; between two of them the arc stands off by no more than the chord error."""
    radius, pitch = 0.02, 3e-3
    points = spiral(radius, pitch, chord)
    z = points @ [1, 1j]
    phi = np.concatenate([[0.0], np.cumsum(np.angle(z[2:] / z[1:-1]))])
    phi += np.angle(z[1]) if np.angle(z[1]) >= 0 else np.angle(z[1]) + 2 * np.pi
    np.testing.assert_allclose(np.abs(z[1:]), np.minimum(pitch * phi / (2 * np.pi), radius), atol=1e-9)
    step = np.diff(phi).max()
    assert radius * (1 - np.cos(step / 2)) <= chord * 1.0001
    assert radius * (1 - np.cos(step / 2)) > 0.9 * chord
    outside = phi[np.abs(z[1:]) > radius - 1e-9]
    assert np.ptp(outside) == pytest.approx(2 * np.pi)
    on_circle = np.diff(outside).max()
    assert radius * (1 - np.cos(on_circle / 2)) <= chord * 1.0001


SIZES = {  # mm: what the tip covers in X and Y, with a cutter of 8 mm
    "slot": (100, 0),
    "fig_8": (1200, 600),
    "circle": (60, 60),
    "pocket": (52, 32),
    "face": (80, 50),
    "spiral": (60, 60),
}


@pytest.mark.parametrize("name", SIZES)
def test_presets_are_centred_on_the_part_zero_and_as_large_as_they_are(name):
    path = preset(name, Sketch(), D).toolpath()
    cut = path.p[path.cutting]
    np.testing.assert_allclose(np.ptp(cut, axis=0)[:2] * 1e3, SIZES[name], atol=0.01)
    np.testing.assert_allclose((cut.max(axis=0) + cut.min(axis=0))[:2], 0.0, atol=1e-5)


def test_a_word_is_centred_and_as_high_as_it_is():
    points = np.vstack([element.points for element in preset("word", Sketch(), D, " HE ").elements])
    np.testing.assert_allclose(points.max(axis=0) + points.min(axis=0), 0.0, atol=1e-9)
    assert np.ptp(points[:, 1]) == pytest.approx(18e-3)


@pytest.mark.parametrize(
    ("width", "stepover", "rows"), [(0.05, 0.01, 6), (0.05, 0.0125, 5), (0.05, 0.012, 6), (8, 9, 2)]
)
def test_a_zigzag_has_no_more_rows_than_it_needs(width, stepover, rows):
    points = zigzag(0.08, width, stepover)
    assert len(points) == 2 * rows
    np.testing.assert_allclose(np.unique(points[:, 1].round(12)), np.linspace(-width / 2, width / 2, rows), atol=1e-12)
    assert np.abs(points[:, 0]).tolist() == [0.04] * (2 * rows)
    steps = np.diff(points, axis=0)
    assert ((np.abs(steps) > 1e-9).sum(axis=1) == 1).all()  # along x, then up, there and back
    assert points[0, 0] < 0


def test_rings_of_a_pocket_are_as_few_as_they_may_be_and_lie_evenly():
    points = pocket(0.06, 0.04, D)
    heights = np.unique(np.abs(points[:, 1]).round(12))
    assert len(heights) == 1 + np.ceil(0.016 / (0.6 * D))
    np.testing.assert_allclose(np.diff(heights), 0.016 / (len(heights) - 1))
    np.testing.assert_allclose(points[:2], [[-0.01, 0], [0.01, 0]], atol=1e-15)
    square = pocket(0.04, 0.04, D)
    np.testing.assert_array_equal(square[0], [0, 0])
    assert len(square) == 1 + 5 * np.ceil(0.016 / (0.6 * D))
    steps = np.diff(points[2:7], axis=0)
    assert (steps[:-1, 0] * steps[1:, 1] - steps[:-1, 1] * steps[1:, 0] > 0).all()  # counter-clockwise
    for side in (D, 0.99 * D):
        with pytest.raises(ToolpathError, match="of 8 mm does not fit"):
            pocket(0.06, side, D)


def test_signs_stand_a_gap_apart_and_a_blank_has_a_width():
    (one,), width = strokes("I", HEIGHT)[0][:1], strokes("I", HEIGHT)[1]
    two, both = strokes("II", HEIGHT)
    with_blank, long = strokes("I I", HEIGHT)
    assert both - width == pytest.approx(max(width, 2.0) + 2.0)
    assert long - both == pytest.approx(2.0 + 2.0)
    aside = np.array([max(width, 2.0) + 2.0, 0.0])
    np.testing.assert_allclose(two[len(two) // 2], one + aside)
    small, narrow = strokes("I", 0.5 * HEIGHT)
    np.testing.assert_allclose(small[0], 0.5 * one)
    assert narrow == pytest.approx(0.5 * width)
