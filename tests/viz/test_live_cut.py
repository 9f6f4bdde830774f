"""What the browser is sent of a cut: heights are those of the surface, tips those of the run, the arm bends as told."""

from __future__ import annotations

import base64
import gzip
from typing import Any

import numpy as np
import pytest

from robomill.arrays import FloatArray
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.simulation.enlarged import enlarged, so_far
from robomill.simulation.result import SimulationResult
from robomill.simulation.run import simulate
from robomill.surface.zmap import cut
from robomill.toolpath.source import GCodeSource
from robomill.viz.live_cut import CELLS, JOINED, JUDGED, NO_ERROR, REACHED, Parcel, arm_frames, frames_of, parcel

TIMES = (1.0, 5.0, 10.0, 20.0, 50.0)
Arrays = dict[str, np.ndarray[Any, Any]]


def unpacked(parcel: Parcel) -> Arrays:
    """The arrays of a parcel by name."""
    data = gzip.decompress(base64.b64decode(parcel.blob))
    kinds = {kind: np.dtype(kind).newbyteorder("<") for kind in ("u1", "i1", "u2", "u4", "f4")}
    return {
        name: np.frombuffer(data[at : at + length], dtype=kinds[kind])
        for name, (kind, at, length) in parcel.about["arrays"].items()
    }


def heights(parcel: Parcel, arrays: Arrays, name: str) -> np.ndarray[Any, Any]:
    """Heights, mm, on the parcel's grid."""
    z = parcel.about["low"] + arrays[name].astype(float) * parcel.about["quantum"]
    return z.reshape(parcel.about["grid"][:2])


def replayed(parcel: Parcel, arrays: Arrays, level: int, frame: int) -> np.ndarray[Any, Any]:
    """Heights, mm, as far as the cut has come at a frame, as the browser makes them."""
    about = parcel.about
    z = np.full(int(np.prod(about["grid"][:2])), about["top"])
    for cell, height, at in zip(
        arrays[f"cell.{level}"], arrays[f"height.{level}"], arrays[f"frame.{level}"], strict=True
    ):
        if at <= frame:
            z[cell] = about["low"] + float(height) * about["quantum"]
    done = arrays[f"ready.{level}"] <= frame
    z[done] = heights(parcel, arrays, f"z.{level}").ravel()[done]
    return z.reshape(about["grid"][:2])


def sample(name: str) -> SimulationResult:
    return simulate(load_setup(samples_dir() / name / "setup.toml"))


def to_segments(x: FloatArray, y: FloatArray, ends: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Distance of each point of a grid to the nearest of segments ``ends`` (n, 2, 3), and that segment's height."""
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    best, height = np.full(points.shape[:2], np.inf), np.zeros(points.shape[:2])
    for a, b in ends:
        d = (b - a)[:2]
        t = np.clip(((points - a[:2]) @ d) / max(float(d @ d), 1e-18), 0.0, 1.0)
        off = np.linalg.norm(points - a[:2] - t[..., None] * d, axis=-1)
        closer = off < best
        best[closer], height[closer] = off[closer], (a[2] + t * (b[2] - a[2]))[closer]
    return best, height


def test_heights_are_those_of_the_machined_surface_to_half_a_quantum(result: SimulationResult) -> None:
    sent = parcel(result, TIMES)
    arrays, setup = unpacked(sent), result.setup
    size = setup.stock_block.upper - setup.stock_block.lower
    cell = max(setup.cell, float(np.sqrt(size[0] * size[1] / CELLS)))
    half = 0.5 * sent.about["quantum"] * (1 + 1e-6)
    surface = cut(setup.stock_block, cell, result.tooling, result.p_machined, result.path.k, result.removes)
    assert np.abs(heights(sent, arrays, "z.0") - 1e3 * surface.z).max() <= half
    ideal = cut(setup.stock_block, cell, result.tooling, result.path.p, result.path.k, result.removes)
    assert np.abs(heights(sent, arrays, "ideal") - 1e3 * ideal.z).max() <= half
    assert sent.about["quantum"] < 1e-3


def test_the_slot_is_what_a_disk_along_the_moved_path_leaves(result: SimulationResult) -> None:
    sent = parcel(result, (1.0,))
    z, (nx, ny, x0, y0, dx, dy) = heights(sent, unpacked(sent), "z.0"), sent.about["grid"]
    p, moves = 1e3 * result.p_machined, np.flatnonzero(result.removes)
    off, height = to_segments(x0 + dx * np.arange(nx), y0 + dy * np.arange(ny), np.stack([p[moves - 1], p[moves]], 1))
    inside, outside = off < 4.0 - 1e-3, off > 4.0 + 1e-3
    assert np.abs(z - height)[inside].max() < 2e-3
    assert np.abs(z[outside]).max() < 1e-3


def test_tips_are_path_and_deviation(result: SimulationResult) -> None:
    arrays, frames = unpacked(parcel(result, (1.0,))), frames_of(result)
    p, delta = arrays["p"].reshape(-1, 3), arrays["delta"].reshape(-1, 3)
    R = result.setup.T_MW[:3, :3]
    told = result.path.p[frames] + np.nan_to_num(result.delta[frames]) @ R
    at = result.path.cutting[frames]
    assert np.abs(p + delta - 1e3 * told)[at].max() < 1e-4
    assert np.abs(arrays["s"] - 1e3 * result.path.s[frames]).max() < 1e-4
    assert np.array_equal((arrays["state"] & JUDGED) > 0, result.judged[frames])


@pytest.mark.parametrize("name", ["paper_flute", "pocket_arcs", "two_tools"])
def test_material_goes_as_the_cut_goes(name: str) -> None:
    result = sample(name)
    sent = parcel(result, (1.0, 10.0))
    arrays, frames = unpacked(sent), frames_of(result)
    assert len(sent.blob) < 1_500_000
    shown = enlarged(result, 10.0, CELLS)
    depth = float(np.ptp(shown.drawn.z))
    for part in (0.3, 0.8):
        frame = int(part * len(frames))
        truth = so_far(result, shown, int(frames[frame]))
        off = np.abs(replayed(sent, arrays, 1, frame) - 1e3 * truth.drawn.z)
        assert (off > 0.02 * 1e3 * depth).mean() < 2e-3  # a move straight on is cut as one by the surface
    last = replayed(sent, arrays, 1, len(frames) - 1)
    assert np.abs(last - 1e3 * shown.drawn.z).max() <= 0.5 * sent.about["quantum"] * (1 + 1e-6)


def test_colours_end_at_the_tolerance_and_what_is_not_cut_has_none(result: SimulationResult) -> None:
    arrays, shown = unpacked(parcel(result, TIMES)), enlarged(result, 10.0, CELLS)
    told = arrays["error.2"].reshape(shown.error.shape)
    known = np.isfinite(shown.error)
    assert np.array_equal(told == NO_ERROR, ~known)
    share = np.clip(shown.error[known] / result.setup.tolerance, -1.0, 1.0)
    assert np.abs(told[known] / 127.0 - share).max() <= 0.5 / 127.0 + 1e-9


def test_the_faces_of_walls_have_the_error_that_a_gauge_reads_there(result: SimulationResult) -> None:
    """The slot runs along X and has gone to the left: material stands on its right, too much went on its left."""
    sent = parcel(result, TIMES)
    arrays, (nx, ny, _, y0, _, dy) = unpacked(sent), sent.about["grid"]
    share = result.verdict.wall.value / result.setup.tolerance * 127.0
    for level, times in enumerate(TIMES):
        told = arrays[f"wall.{level}"].reshape(nx, ny)[nx // 2].astype(int)
        y = y0 + dy * np.arange(ny)
        for side in (1.0, -1.0):
            wall = side * 4.0 + times * 1e3 * result.verdict.wall.value
            beside = np.abs(y - wall) < 0.99 * dy
            assert beside.sum() in (1, 2)
            assert np.abs(told[beside] + side * share).max() <= 1.0
        off = np.min([np.abs(y - side * 4.0 - times * 1e3 * result.verdict.wall.value) for side in (1.0, -1.0)], axis=0)
        assert (told[off > 3.0 * dy] == NO_ERROR).all()


def test_the_arm_bends_by_the_shares_of_its_joints(result: SimulationResult) -> None:
    some = np.array([10, 50, 90])
    straight, bent = arm_frames(result, some)
    R = result.setup.T_MW[:3, :3]
    moved = (bent - straight)[:, -1, :3, 3] @ R.T
    assert np.abs(moved - result.delta_joint[some].sum(axis=1)).max() < 1e-3 * np.abs(moved).max()
    assert np.abs(straight[:, -1, :3, 3] - result.path.p[some]).max() < 1e-9


def test_what_is_not_reached_is_told_as_such() -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    far = "G21 G90\nG0 X-40 Y0 Z-2\nG1 X20 F1200\nG1 X2500\n"
    result = simulate(setup.replace(source=GCodeSource(far, "far.nc"), stock=None, cell=0.002, step=0.02))
    assert not result.reached.all()
    assert result.reached.any()
    sent = parcel(result, (1.0, 10.0))
    arrays, frames = unpacked(sent), frames_of(result)
    assert np.array_equal((arrays["state"] & REACHED) > 0, result.reached[frames])
    assert np.isnan(arrays["size"][~result.reached[frames]]).all()
    assert np.isfinite(arrays["arm.o"]).all()
    assert np.abs(arrays["arm.at"]).max() < len(frames)


def test_a_rapid_between_two_cuts_is_no_cut() -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    two = "G21 G90\nG0 X-30 Y-6 Z-1\nG1 X30 F1200\nG0 Z5\nG0 X-30 Y6\nG0 Z-1\nG1 X30\n"
    result = simulate(setup.replace(source=GCodeSource(two, "two.nc"), stock=None))
    state, frames = unpacked(parcel(result, (1.0,)))["state"], frames_of(result)
    apart = np.flatnonzero((state & JOINED) == 0)
    assert len(apart) == 2
    assert not result.path.cutting[frames[apart]].any()
