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
