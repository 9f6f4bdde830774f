"""Sketches in set-up files: read back bit by bit, refused by key."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
import tomli_w
from hypothesis import given, settings, strategies as st

from robomill.errors import ProjectError
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup, setup_from_toml, setup_to_toml
from robomill.toolpath.sketch import POINTS, Element, Sketch
from robomill.toolpath.sketch_presets import PRESETS, preset
from robomill.toolpath.source import SketchSource

PAPER = load_setup(samples_dir() / "paper_flute")


def with_sketch(sketch: Sketch):
    return PAPER.replace(source=SketchSource(sketch), stock=None)


@pytest.mark.parametrize("name", PRESETS)
def test_ready_made_sketches_are_read_back_to_the_same_digest(name):
    setup = with_sketch(preset(name, Sketch(grid=0.0, v_f=1 / 60, depth=25.4e-3 / 7), 8e-3))
    again = setup_from_toml(setup_to_toml(setup))
    assert again.digest() == setup.digest()
    assert (again.source.sketch.grid, again.source.sketch.v_f) == (0.0, setup.source.sketch.v_f)


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 10**9), shape=st.sampled_from(sorted(POINTS)), scale=st.sampled_from([1e-3, 1.0, 25.4e-3, 15.0])
)
def test_any_shape_is_read_back_bit_by_bit(seed, shape, scale):
    rng = np.random.default_rng(seed)
    points = rng.uniform(-scale, scale, (max(POINTS[shape][0], POINTS[shape][1] or 6), 2))
    sketch = Sketch((Element(shape, points, *rng.uniform(1e-4, 1e-2, 2)),), *rng.uniform(1e-3, 1e-1, 2))
    setup = with_sketch(sketch)
    assert setup_from_toml(setup_to_toml(setup)).digest() == setup.digest()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"shape": "blob"}, "expected one of line, polyline"),
        ({"points_mm": [[0.0, 0.0]]}, "needs 2 points, found 1"),
        ({"points_mm": [[0.0, 0.0], [1.0]]}, "row 2: expected 2 numbers"),
        ({"depth_mm": 0.0}, "Depth: found 0 mm"),
        ({"feed_mm_min": float("nan")}, "finite"),
        ({"colour": 1}, "not known here"),
    ],
)
def test_what_is_no_sketch_is_refused_by_key(change, words):
    data = tomllib.loads(setup_to_toml(with_sketch(preset("slot", Sketch(), 8e-3))))
    data["path"]["sketch"]["elements"][0].update(change)
    with pytest.raises(ProjectError, match=words) as refusal:
        setup_from_toml(tomli_w.dumps(data), "mine.toml")
    assert str(refusal.value).startswith("mine.toml, [path.sketch")
