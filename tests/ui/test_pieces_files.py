"""What is taken away carries the project's name, few digits and a sensible size."""

from __future__ import annotations

import io

import numpy as np
import pytest
import streamlit as st
import trimesh

from robomill.csv_text import csv_text, settled
from robomill.io.meshes import FEW_TRIANGLES, mesh_bytes
from robomill.report.records import jsonable, shown
from robomill.simulation.run import simulate
from robomill.ui import pieces, session
from robomill.ui.project import preset_setup


@pytest.mark.parametrize(
    ("name", "file"),
    [
        ("Heart", "heart-surface.stl"),
        ("Reference groove (Slavkovic 2013)", "reference-groove-slavkovic-2013-surface.stl"),
        ("../../etc/passwd", "etc-passwd-surface.stl"),
        ("日本", "project-surface.stl"),
    ],
)
def test_a_file_is_named_after_the_project(monkeypatch: pytest.MonkeyPatch, name: str, file: str) -> None:
    monkeypatch.setattr(st, "session_state", {})
    session.change(name=name)
    assert pieces.named("surface.stl") == file


def test_a_solid_is_below_ten_megabytes_and_keeps_its_volume() -> None:
    machined = simulate(preset_setup("paper_flute")).machined
    few = mesh_bytes(machined, "stl", max_faces=FEW_TRIANGLES)
    assert len(few) < 10e6
    solid = trimesh.load_mesh(io.BytesIO(few), file_type="stl")
    block = preset_setup("paper_flute").stock_block
    left = np.prod(1e3 * (block.upper - block.lower)) - 1e9 * machined.removed_volume
    assert solid.is_watertight
    assert solid.volume == pytest.approx(left, rel=1e-4)


def test_what_is_left_of_two_numbers_that_cancel_is_nought() -> None:
    given = [60.9, -1.65768417e-22, np.nan, 0.0, 1e-9]
    np.testing.assert_array_equal(settled(given), [60.9, 0.0, np.nan, 0.0, 1e-9])
    np.testing.assert_array_equal(settled([3e-22, -1e-22]), [3e-22, -1e-22])  # beside nothing larger, it is a number
    assert settled([]).shape == (0,)


def test_files_hold_numbers_of_twelve_digits() -> None:
    third = 0.1 + 0.2  # 0.30000000000000004
    assert jsonable({"a": [third, 20.3 * 3]}) == {"a": [0.3, 60.9]}
    assert jsonable(np.array([1.0, -1.7e-22])) == [1.0, 0.0]
    assert jsonable(shown([1.0, -1.7e-22], "mm")) == [1000.0, 0.0]
    assert "e-2" not in csv_text({"x": np.array([1.0, -1.7e-22])})
    assert csv_text({"x": np.array([20.3 * 3, -1.7e-22])}, pieces.DIGITS) == "x\n60.9\n0\n"
