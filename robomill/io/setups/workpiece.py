"""Part zero and stock, to and from the tables of a set-up."""

import base64
import binascii
import zlib
from typing import Any

import numpy as np

from robomill.arrays import FloatArray
from robomill.files import STL
from robomill.io.beside import Beside
from robomill.io.declared import Around, Codec, from_table, to_table
from robomill.io.tables import Table, shown
from robomill.simulation.given import PART_TURN, PART_ZERO, part_frame
from robomill.surface.stock import Stock
from robomill.units import format_count

OF_TRIANGLE = 72  # bytes: three corners of three numbers
MOST_TRIANGLES = STL.most // 50  # a triangle of a binary STL takes 50 bytes


def part_from_table(table: Table) -> FloatArray:
    if table.has("frame"):
        T_MW = np.eye(4)
        frame = table.rows("frame", 4, "1")
        if len(frame) not in (3, 4):
            raise table.refuse("frame", f"expected the three rows of a frame, found {len(frame)}.")
        T_MW[:3] = frame[:3]
        T_MW[:3, 3] = [table.si("frame", row[3], "mm") for row in table.data["frame"][:3]]
    else:
        T_MW = part_frame(
            table.numbers(PART_ZERO.key, 3, PART_ZERO.unit, [0.0] * 3),
            table.number(PART_TURN.key, PART_TURN.unit, 0.0),
        )
    table.finish()
    return T_MW


def part_to_table(T_MW: FloatArray) -> dict[str, Any]:
    zero = [shown(v, "mm") for v in T_MW[:3, 3]]
    turn = float(np.arctan2(T_MW[1, 0], T_MW[0, 0]))
    if np.array_equal(part_frame(T_MW[:3, 3], turn), T_MW):
        return {PART_ZERO.key: zero, PART_TURN.key: shown(turn, "deg")}
    return {"frame": [[*row[:3], z] for row, z in zip(T_MW[:3].tolist(), zero, strict=True)]}


def stock_from_table(table: Table, beside: Beside) -> Stock:
    """A block by its corners (a solid by its packed mesh), or an STL file beside the set-up."""
    if not table.has("stl"):
        return from_table(table, Stock, codecs=MESH)
    from robomill.io.meshes import read_stl_stock  # meshes load only where one is read

    data, name = beside.read(table, "stl", STL)
    stock, _ = read_stl_stock(data, unit=table.text("unit", "mm"), name=name)
    table.finish()
    return stock


def stock_to_table(stock: Stock) -> dict[str, Any]:
    return to_table(stock, MESH)


def _unpacked(table: Table, name: str, around: Around) -> FloatArray | None:
    """(t, 3, 3): as many triangles as are declared and a stock's file holds are inflated, whatever is packed."""
    packed, count = table.text(name), table.whole(f"{name}_count", MOST_TRIANGLES)
    if not 0 < count <= MOST_TRIANGLES:
        raise table.refuse(f"{name}_count", f"found {count}, expected 1 to {format_count(MOST_TRIANGLES)} triangles.")
    try:
        inflating = zlib.decompressobj()
        numbers = inflating.decompress(base64.b64decode(packed, validate=True), count * OF_TRIANGLE + 1)
        if len(numbers) <= count * OF_TRIANGLE:
            if not inflating.eof:
                raise ValueError("it ends too soon")
            return np.frombuffer(numbers, dtype="<f8").reshape(-1, 3, 3)
    except (binascii.Error, zlib.error, ValueError):
        raise table.refuse(name, "the packed mesh is damaged; read the STL file again.") from None
    raise table.refuse(
        name, f"the packed mesh holds more than {format_count(count)} triangles; read the STL file again."
    )


def _packed(name: str, triangles: FloatArray) -> dict[str, Any]:
    packed = base64.b64encode(zlib.compress(triangles.astype("<f8").tobytes())).decode()
    return {name: packed, f"{name}_count": len(triangles)}


MESH: dict[Any, Codec] = {FloatArray | None: Codec(("{name}", "{name}_count"), _unpacked, _packed)}
