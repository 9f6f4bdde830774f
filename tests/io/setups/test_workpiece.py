"""Part zero and stock in a set-up: frames by hand, and what comes back to the last bit."""

from __future__ import annotations

import base64
import struct
import tracemalloc
import zlib

import numpy as np
import pytest

from robomill.errors import ProjectError
from robomill.io.setups.workpiece import part_from_table, part_to_table, stock_from_table, stock_to_table
from robomill.io.tables import Table
from robomill.simulation.given import part_frame
from robomill.surface.stock import Stock
from robomill.units import format_count


def part(**data):
    return part_from_table(Table(data, "setup.toml, [part]"))


def test_a_part_turned_about_z_has_its_x_where_the_turn_says():
    T_MW = part(zero_mm=[100.0, -1300.0, 20.0], rotation_z_deg=30.0)
    x, y, z = T_MW[:3, :3].T
    np.testing.assert_allclose(x, [np.cos(np.pi / 6), 0.5, 0.0], atol=1e-15)
    np.testing.assert_allclose(np.cross(z, x), y, atol=1e-15)
    np.testing.assert_array_equal(z, [0, 0, 1])
    np.testing.assert_allclose(T_MW[:3, 3], [0.1, -1.3, 0.02], rtol=1e-15)
    np.testing.assert_array_equal(part(), np.eye(4))


def test_a_frame_is_three_rows_of_which_the_last_column_is_in_millimetres():
    rows = [[0.0, 0.0, 1.0, 500.0], [1.0, 0.0, 0.0, -250.0], [0.0, 1.0, 0.0, 12.5]]
    T_MW = part(frame=rows)
    np.testing.assert_array_equal(T_MW[:3, :3], np.array(rows)[:, :3])
    np.testing.assert_allclose(T_MW[:, 3], [0.5, -0.25, 0.0125, 1.0], rtol=1e-15)
    with pytest.raises(ProjectError, match="zero_mm: this key is not known here"):
        part(frame=rows, zero_mm=[0, 0, 0])
    for wrong in (rows[:1], rows[:2], rows + rows):
        with pytest.raises(ProjectError, match=f"frame: expected the three rows of a frame, found {len(wrong)}"):
            part(frame=wrong)


@pytest.mark.parametrize("angle", [0.0, 0.3, -2.0, np.pi, np.radians(33.3)])
def test_a_level_part_is_written_as_people_say_it(angle):
    T_MW = part_frame([0.1, -1.3, 0.02], angle)
    table = part_to_table(T_MW)
    assert table["zero_mm"] == [100.0, -1300.0, 20.0]
    assert table["rotation_z_deg"] == pytest.approx(np.degrees(angle), rel=1e-14)
    np.testing.assert_array_equal(part(**table), T_MW)


def test_any_other_part_is_written_as_its_frame():
    rng = np.random.default_rng(1)
    T_MW = np.eye(4)
    T_MW[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    T_MW[:3, 3] = rng.normal(size=3)
    table = part_to_table(T_MW)
    assert set(table) == {"frame"}
    np.testing.assert_allclose(np.array(table["frame"])[:3, 3], T_MW[:3, 3] * 1000, rtol=1e-15)
    np.testing.assert_array_equal(part(**table), T_MW)


def stock(**data):
    return stock_from_table(Table(data, "setup.toml, [stock]"), None)


def test_a_mesh_is_packed_and_unpacked_to_the_last_bit():
    triangles = np.random.default_rng(2).normal(size=(5, 3, 3))
    solid = Stock([-1.0, -2, -3], [1.0, 2, 3], triangles)
    again = stock(**stock_to_table(solid))
    np.testing.assert_array_equal(again.triangles, triangles)
    assert again.digest() == solid.digest()
    packed = base64.b64encode(zlib.compress(struct.pack("<9d", *range(9)))).decode()
    by_hand = stock(lower_mm=[0, 0, 0], upper_mm=[9, 9, 9], triangles=packed)
    np.testing.assert_array_equal(by_hand.triangles, np.arange(9.0).reshape(1, 3, 3))
    assert stock(lower_mm=[0, 0, 0], upper_mm=[9, 9, 9]).triangles is None


@pytest.mark.parametrize("packed", ["", "%%%", base64.b64encode(b"no zlib").decode()])
def test_a_damaged_mesh_is_refused(packed):
    with pytest.raises(ProjectError, match="the packed mesh is damaged"):
        stock(lower_mm=[0, 0, 0], upper_mm=[9, 9, 9], triangles=packed)
    eight = base64.b64encode(zlib.compress(struct.pack("<8d", *range(8)))).decode()
    with pytest.raises(ProjectError, match="the packed mesh is damaged"):
        stock(lower_mm=[0, 0, 0], upper_mm=[9, 9, 9], triangles=eight)


@pytest.mark.parametrize("told", [1, 100_000])
def test_a_packed_mesh_that_inflates_beyond_what_it_says_is_refused_in_little_room(told):
    """A megabyte that inflates to more than one GB."""
    deflating, zeros = zlib.compressobj(1), bytes(1 << 22)
    packed = base64.b64encode(b"".join([deflating.compress(zeros) for _ in range(260)]) + deflating.flush()).decode()
    tracemalloc.start()
    try:
        with pytest.raises(ProjectError, match=f"the packed mesh holds more than {format_count(told)} triangles"):
            stock(lower_mm=[0, 0, 0], upper_mm=[9, 9, 9], triangles=packed, triangles_count=told)
        assert tracemalloc.get_traced_memory()[1] < 5 * len(packed) + 3 * 72 * told
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("count", [0, -1, 1_600_001])
def test_a_mesh_of_no_triangle_or_of_too_many_is_not_unpacked(count):
    packed = base64.b64encode(zlib.compress(struct.pack("<9d", *range(9)))).decode()
    with pytest.raises(ProjectError, match=rf"triangles_count: found {count}, expected 1 to 1.600.000 triangles"):
        stock(lower_mm=[0, 0, 0], upper_mm=[9, 9, 9], triangles=packed, triangles_count=count)
