"""Sketches: the path they make, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robomill.errors import ToolpathError
from robomill.toolpath.gcode import CHORD_ERROR
from robomill.toolpath.sketch import APPROACH, Element, Sketch, centre_of


def line(*points, depth=2e-3, v_f=0.03):
    return Element("line", np.array(points, dtype=float), depth, v_f)


def level(path, depth):
    """Indices of the moves that cut at full depth (no plunge)."""
    flat = np.append(False, np.abs(np.diff(path.p[:, 2])) < 1e-12)
    return np.flatnonzero(path.cutting & flat & (np.abs(path.p[:, 2] + depth) < 1e-12))


def test_a_slot_is_rapids_plunge_cut_and_retract():
    sketch = Sketch((line([-0.05, 0], [0.05, 0]),), v_plunge=4e-3, clearance=6e-3, n_s=200.0)
    path = sketch.toolpath()
    expected = [[-0.05, 0, 6e-3], [-0.05, 0, APPROACH], [-0.05, 0, -2e-3], [0.05, 0, -2e-3], [0.05, 0, 6e-3]]
    np.testing.assert_allclose(path.p, expected, atol=1e-15)
    assert path.cutting.tolist() == [False, False, True, True, False]
    np.testing.assert_allclose(path.v_f, [0, 0, 4e-3, 0.03, 0], atol=1e-15)
    assert path.block.tolist() == [1] * 5
    assert (path.n_s == 200.0).all()
    assert (path.k == [0, 0, 1]).all()


@pytest.mark.parametrize(
    ("shape", "points", "length"),
    [
        ("rectangle", [[0, 0], [0.06, 0.04]], 0.2),
        ("rectangle", [[-0.03, -0.02], [0.03, 0.02]], 0.2),
        ("rectangle", [[-0.03, 0.02], [0.03, -0.02]], 0.2),
        ("polygon", [[0, 0], [0.03, 0], [0, 0.04]], 0.12),
        ("polyline", [[0, 0], [0.03, 0], [0, 0.04]], 0.08),
        ("circle", [[0.01, 0.02], [0.03, 0.02]], 2 * math.pi * 0.02),
        ("arc", [[0.02, 0], [0, 0.02], [-0.02, 0]], math.pi * 0.02),
        ("arc", [[0.02, 0], [0, -0.02], [-0.02, 0]], math.pi * 0.02),
        ("arc", [[0.02, 0], [0.02 * math.cos(3), 0.02 * math.sin(3)], [0, -0.02]], 1.5 * math.pi * 0.02),
        ("arc", [[0, 0], [0.01, 0], [0.03, 0]], 0.03),
    ],
)
def test_lengths_of_shapes(shape, points, length):
    """Length at full depth against the closed form; chords fall short of an arc by less than (2/3) of 4 e / r."""
    element = Element(shape, np.array(points, dtype=float), 1e-3, 0.02)
    path = Sketch((element,)).toolpath()
    cut = level(path, 1e-3)
    found = path.step_length[cut].sum()
    assert found <= length * (1 + 1e-12)
    assert found == pytest.approx(length, rel=4 * CHORD_ERROR / 0.02)
    if element.shape in ("polygon", "rectangle", "circle"):
        np.testing.assert_allclose(path.p[cut[-1], :2], path.p[cut[0] - 1, :2], atol=1e-15)


@pytest.mark.parametrize("size", [1e-6, 1e-3, 1.0, 1e3])
@pytest.mark.parametrize(
    ("a", "b", "c"), [((1, 2), (3, 2), (1, 4)), ((0, 0), (1, 1e-6), (2, 0)), ((5, 1), (1, 5), (1, 1))]
)
def test_a_circle_has_its_centre_at_every_size(size, a, b, c):
    """As far from one of its points as from the others; points on a line have none, however near or far they are."""
    points = [np.array(each) * size for each in (a, b, c)]
    centre = centre_of(*points)
    radii = [math.dist(centre, each) for each in points]
    assert radii == pytest.approx([radii[0]] * 3, rel=1e-9)
    assert centre_of(*(np.array([k, 2.0 * k]) * size for k in (0.0, 1.0, 3.0))) is None
    assert centre_of(*(np.array([k, 1e-11 * (k == 1)]) * size for k in (0.0, 1.0, 2.0))) is None


@pytest.mark.parametrize("way", [[0.0, 0.02], [0.0, -0.02]])
def test_an_arc_goes_through_its_points_and_stays_on_its_circle(way):
    element = Element("arc", np.array([[0.02, 0], way, [-0.02, 0]], dtype=float), 1e-3, 0.02)
    outline = element.outline()
    radius = np.hypot(*outline.T)
    np.testing.assert_allclose(radius, 0.02, atol=1e-12)
    middle = 0.5 * (outline[1:] + outline[:-1])
    assert (0.02 - np.hypot(*middle.T)).max() <= CHORD_ERROR * (1 + 1e-9)
    assert np.hypot(*(outline - way).T).min() < 0.02 * 2 * math.sqrt(2 * CHORD_ERROR / 0.02)
    np.testing.assert_array_equal(outline[[0, -1]], [[0.02, 0], [-0.02, 0]])


def test_shapes_that_touch_are_cut_without_lifting():
    sketch = Sketch((line([0, 0], [0.01, 0]), line([0.01, 0], [0.01, 0.01]), line([0.01, 0.01], [0, 0.01], depth=3e-3)))
    path = sketch.toolpath()
    assert (~path.cutting).sum() == 3, "start, approach, and the last retract"
    assert path.block.tolist() == [1, 1, 1, 1, 2, 3, 3, 3]
    np.testing.assert_allclose(path.p[3:7, 2], [-2e-3, -2e-3, -3e-3, -3e-3], atol=1e-15)


def test_shapes_apart_are_joined_by_rapids_at_clearance():
    path = Sketch((line([0, 0], [0.01, 0]), line([0.02, 0], [0.03, 0]))).toolpath()
    jump = np.flatnonzero(~path.cutting & (np.abs(np.diff(path.p[:, 0], prepend=0.0)) > 1e-6))
    assert (path.p[jump, 2] == 5e-3).all()
    assert (path.p[jump - 1, 2] == 5e-3).all()
    for i in np.flatnonzero(~path.cutting)[1:]:
        assert path.p[i, 2] > 0, "no rapid ends inside the part"


@pytest.mark.parametrize(
    ("shape", "points", "depth", "v_f", "words"),
    [
        ("blob", [[0, 0], [1, 0]], 1e-3, 0.1, "Sketch, Shape: found 'blob'; expected line, polyline"),
        ("line", [[0, 0]], 1e-3, 0.1, "needs 2 points, found 1"),
        ("line", [[0, 0], [1, 0], [2, 0]], 1e-3, 0.1, "needs 2 points, found 3"),
        ("polygon", [[0, 0], [1, 0]], 1e-3, 0.1, "needs 3 or more"),
        ("line", [[0, 0], [0, 0]], 1e-3, 0.1, "points 1 and 2 of the line are the same"),
        ("polyline", [[0, 0], [1, 0], [1, 0], [2, 0]], 1e-3, 0.1, "points 2 and 3 of the polyline are the same"),
        ("polygon", [[0, 0], [1, 0], [2, 1], [2, 1]], 1e-3, 0.1, "points 3 and 4 of the polygon are the same"),
        ("polygon", [[0, 0], [1, 0], [1, 1], [0, 0]], 1e-3, 0.1, "it closes by itself"),
        ("rectangle", [[0, 0], [0, 1]], 1e-3, 0.1, "on one line"),
        ("rectangle", [[0, 0], [1, 0]], 1e-3, 0.1, "on one line"),
        ("rectangle", [[3, 1], [3, 2]], 1e-3, 0.1, "on one line"),
        ("arc", [[0, 0], [1, 1], [0, 0]], 1e-3, 0.1, "ends where it begins; draw a circle"),
        ("line", [[0, 0], [1, np.nan]], 1e-3, 0.1, "finite"),
        ("line", [[0, 0], [1e4, 0]], 1e-3, 0.1, "found 10000 m"),
        ("line", [[0, 0], [1, 0]], 0.0, 0.1, "Sketch, Depth: found 0 mm; expected more than 0 mm"),
        ("line", [[0, 0], [1, 0]], 1e-3, -0.1, "Feed: found −6000 mm/min"),
        ("line", [[0, 0], [1, 0]], math.inf, 0.1, "Depth: found inf"),
    ],
)
def test_what_cannot_be_cut_is_refused(shape, points, depth, v_f, words):
    with pytest.raises(ToolpathError, match=words.replace("(", r"\(")):
        Element(shape, np.array(points, dtype=float), depth, v_f)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"clearance": 0.0}, "Clearance: found 0 mm; expected 0.5 mm or more"),
        ({"v_plunge": 0.0}, "Plunge feed: found 0 mm/min"),
        ({"n_s": -1.0}, "Spindle: found −60"),
        ({"grid": math.nan}, "Snap: found nan"),
        ({"elements": (line([0, 0], [1, 0]),) * 5001}, "at most 5000 shapes"),
    ],
)
def test_settings_that_make_no_sense_are_refused(change, words):
    with pytest.raises(ToolpathError, match=words):
        Sketch(**change)


def test_an_empty_sketch_says_what_to_do():
    with pytest.raises(ToolpathError, match="empty: draw a line"):
        Sketch().toolpath()


def test_values_are_frozen_and_drawing_settings_do_not_change_the_path():
    sketch = Sketch((line([0, 0], [0.01, 0]),))
    with pytest.raises(ValueError, match="read-only"):
        sketch.elements[0].points[0, 0] = 1.0
    assert sketch.replace(grid=0.0, v_f=0.5, depth=9e-3).toolpath().digest() == sketch.toolpath().digest()


def test_a_sketch_keeps_as_many_shapes_and_points_as_it_says(monkeypatch):
    monkeypatch.setattr("robomill.toolpath.sketch.MAX_ELEMENTS", 3)
    monkeypatch.setattr("robomill.toolpath.sketch.MAX_POINTS", 8)
    short = line([0, 0], [0.05, 0])
    long = Element("polyline", np.array([[0, 0], [0.05, 0], [0.05, 0.05], [0, 0.05]]), 2e-3, 0.03)
    for full in ((short, short, short), (short, short, long), (long, long)):
        assert len(Sketch(full).elements) == len(full)
    for more in ((short,) * 4, (short, long, long)):
        with pytest.raises(ToolpathError, match="at most 3 shapes and 8 points"):
            Sketch(more)
