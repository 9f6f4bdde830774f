"""Every reader against damaged files: only refusals, soon, in little memory.

python tests/properties/fuzz_readers.py 10000 [READER ...]     counts what escapes, the slowest case and the peak
"""

from __future__ import annotations

import io
import random
import re
import resource
import sys
import time
import traceback
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from robomill.errors import RobomillError
from robomill.io.drawing.drawings import drawing_from_bytes
from robomill.io.materials import material_from_toml
from robomill.io.measured.forces import read_forces
from robomill.io.measured.load_tests import read_load_tests, read_measured_map
from robomill.io.measured.profiles import read_profile
from robomill.io.meshes import read_stl_stock
from robomill.io.point_tables import points_from_bytes
from robomill.io.robot.reader import robot_from_toml
from robomill.io.robot.robots import load_robot
from robomill.io.robot.urdf import read_urdf
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup, setup_from_toml, setup_to_toml
from robomill.io.setups.tool_tables import read_tool_table
from robomill.toolpath.apt import read_apt
from robomill.toolpath.gcode import read_gcode
from robomill.toolpath.sketch import Sketch
from robomill.toolpath.sketch_presets import PRESETS, preset
from robomill.toolpath.source import SketchSource

SAMPLES = samples_dir()
NUMBER = re.compile(r"-?\d+\.?\d*(?:[eE][-+]?\d+)?")
ODD = [
    *("nan", "inf", "-inf", "0", "-1", "-0.0", "1e308", "-1e308", "1e-300", "1e400", "1e", "1_0", "−1", "٣"),
    *("9" * 400, "9" * 5000, "0x" + "f" * 5000, "true", '""', '"x"', "[]", "{}", "[[]]", "[1]", "[nan]", "{a = 1}"),
    *("[[1, 2], [3]]", "1979-05-27", '"\\u0000"', '"../../etc/passwd"', '"""', "'" * 3, "\ufeff", "\u2028", "é", '"'),
    *("[" * 5000, "[" * 5000 + "]" * 5000, "a." * 5000 + "a = 1", "[[" + "a." * 3000 + "a]]", "0 1", "x" * 98_000),
    *("_" * 98_000, "1" * 98_000, "," * 98_000, "1;" * 20_000, "(" * 98_000, " " * 98_000 + "x", "a_" * 40_000),
    *("T1e400", "F1e400", "#1=1e400", "GOTO/nan,inf,1e400", "facet normal nan nan nan", "vertex 1e308 1e308 -1e308"),
    *("<a>", "&x;", "</robot>", '"' + "x" * 200_000 + '"', "a," * 1000),
]
HEADS = '<?xml version="1.0"?><!DOCTYPE robot [<!ENTITY x SYSTEM "file:///etc/hostname"><!ENTITY y "&x;&x;">]>'


@dataclass(frozen=True)
class Reader:
    """What reads, and whole files for it to be damaged."""

    read: Callable[[bytes], object]
    seeds: tuple[bytes, ...]
    plain: bool = False  # bytes that are no text


def text_of(data: bytes) -> str:
    return data.decode("utf-8", "replace")


def _urdf(folder: Path, data: bytes) -> object:
    file = folder / "arm.urdf"
    file.write_bytes(data)
    return read_urdf(file)


def _files(pattern: str) -> tuple[bytes, ...]:
    return tuple(path.read_bytes() for path in sorted(SAMPLES.glob(pattern)))


def _setups() -> tuple[bytes, ...]:
    files = sorted(SAMPLES.glob("*/setup*.toml"))
    return (*(path.read_bytes() for path in files), *(setup_to_toml(load_setup(path)).encode() for path in files))


def _sketches() -> tuple[bytes, ...]:
    setup = load_setup(SAMPLES / "paper_flute")
    drawn = [setup.replace(source=SketchSource(preset(name, Sketch(), 8e-3)), stock=None) for name in PRESETS]
    return tuple(setup_to_toml(each).encode() for each in drawn)


def _project(data: bytes) -> object:
    from robomill.ui.project import project_from_toml

    project = project_from_toml(text_of(data))
    return project.digest(), project.setup.toolpath


def _projects() -> tuple[bytes, ...]:
    from robomill.ui.project import Project, View, project_to_toml

    setup = load_setup(SAMPLES / "paper_flute")
    seen = Project(setup, View(theta=(0.1, 0.2, 0.3, 0.4, 0.5)))
    maps = seen.maps.of(setup.robot)
    known = (
        '\n[uncertainty]\nmodel = "joints"\nparameters = [1e-7, 1e-7, 1e-7, 1e-7, 1e-7]\ncovariance = ['
        + ", ".join(str([1e-16 if i == j else 0.0 for j in range(5)]) for i in range(5))
        + "]\ndof = 7\nmodel_error = [0.1, 1e-9, 1e-6]\n"
    )
    plain = project_to_toml(seen.replace(maps=maps))
    return plain.encode(), (plain + known).encode()


def _stls() -> tuple[bytes, ...]:
    import trimesh

    block = trimesh.creation.box(extents=[110.0, 40.0, 10.0])
    return block.export(file_type="stl"), block.export(file_type="stl_ascii").encode()


URDF = "".join(
    f'<joint name="j{i}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/><origin xyz="0 0.{i} 0.5" '
    f'rpy="0 1.57 0.{i}"/><axis xyz="0 {i % 2} {1 - i % 2}"/><limit lower="-2" upper="2" effort="1" velocity="1"/>'
    "</joint>"
    for i in range(4)
)
MESH = '<visual><geometry><mesh filename="file:///etc/hostname"/></geometry></visual>'
LINKS = "".join(f"<link name='l{i}'>{MESH}</link>" for i in range(5))
URDFS = (
    f'<robot name="arm">{LINKS}{URDF}</robot>'.encode(),
    f'{HEADS}<robot name="&x;">{LINKS}{URDF}</robot>'.encode(),
)
FORCES = (
    "t_s,F_feed_N,F_feed_normal_N,F_axial_N\n" + "".join(f"{k / 100},{k},{90 + k},{-k}\n" for k in range(40))
).encode()
PROFILE = ("station_mm;offset_mm\n" + "".join(f"{k},5;0,{k}\n" for k in range(20))).encode()
TABLES = (
    b"T1 P1 D3.0 Z12.5 ; mill\nT2 P2 D6 Z40 Q3\n",
    b"tool,kind,diameter_mm,flutes,length_mm\n1,ball,6,2,62.5\n2,flat,8,3,50\n",
    b'[[tools]]\nnumber = 1\nkind = "ball"\ndiameter_mm = 6\nflutes = 2\nlength_mm = 62.5\n',
)
GCODE = (*_files("*/*.nc"), b"G21 G90 F900 S8000 M3\nT1 M6\nG43 H1\nG0 X0 Y0 Z5\nG1 Z-1\nG2 X9 Y9 I4.5 J4.5\nM2\n")
APT = (
    b"PARTNO/X\nUNITS/MM\nFROM/0,0,5,0,0,1\nFEDRAT/60,MMPM\nSPINDL/900,CLW\nGOTO/1,2,3,0,0.1,1\nRAPID\nGOTO/4,5,6\n",
)


HEIDENHAIN = (
    b"BEGIN PGM A MM\nBLK FORM 0.1 Z X+0 Y+0 Z-20\nBLK FORM 0.2 X+100 Y+100 Z+0\nTOOL CALL 1 Z S3000 F500\n"
    b"L Z+50 R0 FMAX M3\nL X+5 Y+5 FMAX\nL Z-5 F200\nFN 0: Q1 = +3\nLBL 1\nL IX+Q1 F600\nCC X+50 Y+50\nCP IPA+30 DR+\n"
    b"CALL LBL 1 REP 3\nCYCL DEF 200 BOHREN Q200=2 Q201=-10 Q206=150 Q202=5 Q210=0 Q203=+0 Q204=50\n"
    b"L X+10 Y+10 FMAX M99\nM30\nEND PGM A MM\n",
    b"BEGIN PGM B MM\nTOOL CALL 2 Z S3000\nL Z+5 FMAX M3\nCC X+0 Y+0\nLP PR+20 PA+30 F400\nCR X+10 Y+5 R+20 DR-\n"
    b"L X+20 Y+9\nRND R2\nL X+30 Y+0\nCHF 1\nL X+40 Y+2\nFN 0: Q2 = +1\n"
    b"L X+1 Y+1 F100\nL X+9\nL X+9 Y+9\nEND PGM B MM\n",
)
SINUMERIK = (
    b"G17 G90 G71 G54\nT1 D1 M6\nS3000 M3 F600\nDEF REAL TIEF=1.5\nDEF INT ZAHL\nR1=10 R2=R1*2+SIN(30)\nG0 X0 Y0 Z5\n"
    b"FOR ZAHL=1 TO 3\nG1 X=R1*ZAHL Z=-TIEF\nENDFOR\nWHILE R1>5\nR1=R1-1\nENDWHILE\nIF R1==5 GOTOF WEITER\n"
    b"WEITER:\nG1 X=IC(5) Y0\nTRANS X10\nROT RPL=30\nCYCLE81(5,0,2,-10)\nMCALL CYCLE83(5,0,2,-20,,-5,,2,0,0,1,0)\n"
    b"X10 Y10\nMCALL\nM30\n",
)
SVG_HEAD = '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 100 80">'
SVG = (
    "<style>.a{display:inline}</style><defs><g id='p'><rect width='5' height='4' rx='1'/></g></defs><g id='cut' "
    "transform='translate(3,4) rotate(20)'><path class='a' d='M1 2 h3 v4 C1 2 3 4 5 6 s1 1 2 2 Q1 5 9 9 t3 3 "
    "A5 4 20 0 1 9 8 z'/><use href='#p' x='3'/><polyline points='0,0 5,5 9,1'/></g><circle r='3' cx='9'/>"
    "<ellipse rx='3' ry='2'/><text>x</text></svg>"
)
SVGS = (f'<?xml version="1.0" encoding="UTF-8"?><!DOCTYPE svg>{SVG_HEAD}{SVG}'.encode(), f"{SVG_HEAD}{SVG}".encode())


def _dxfs() -> tuple[bytes, ...]:
    import ezdxf

    found = []
    for version in ("R12", "R2010"):
        doc = ezdxf.new(version, units=0)
        if version != "R12":
            doc.header["$INSUNITS"] = 4
        space, block = doc.modelspace(), doc.blocks.new("B")
        block.add_circle((1, 1), 2)
        block.add_arc((1, 1), 2, 10, 80)
        space.add_line((0, 0), (5, 5))
        space.add_blockref("B", (5, 5), dxfattribs={"xscale": 2, "yscale": 3, "rotation": 20})
        space.add_polyline2d([(0, 0, 0.5), (5, 0, 0), (5, 5, -1)], format="xyb", close=True)
        if version != "R12":
            space.add_lwpolyline([(0, 0, 0.5), (5, 0, 0), (5, 5, -1)], format="xyb", close=True)
            space.add_spline([(0, 0), (5, 3), (9, 1)])
            space.add_open_spline([(0, 0), (5, 3), (9, 1), (12, 4)])
            space.add_ellipse((0, 0), (5, 0), 0.5, 0.1, 3.0)
        text = io.StringIO()
        doc.write(text)
        found.append(text.getvalue().encode())
    drawn = found[1].decode()
    short = drawn[: drawn.index("SECTION")] + drawn[drawn.index("SECTION\n  2\nENTITIES") :]
    return (*found, short.encode())


def _parquets() -> tuple[bytes, ...]:
    import pandas

    def packed(rows: int) -> bytes:
        file = io.BytesIO()
        columns = {name: [float(k) for k in range(rows)] for name in ("x_mm", "y_mm", "z_mm", "feed_mm_min")}
        pandas.DataFrame({**columns, "words": ["a"] * rows}).to_parquet(file)
        return file.getvalue()

    return packed(3), packed(400)


POINTS = (
    "X_mm,Y_mm,Z_mm,i,j,k,feed_mm_min,tool,spindle\n" + "".join(f"{k},{-k},-1,0,0,1,{k},1,900\n" for k in range(9))
).encode()


@cache
def readers(folder: Path) -> dict[str, Reader]:
    """Every reader by name; ``folder`` is for those that read files only."""
    arm = load_robot("slavkovic_5r")
    return {
        "project": Reader(_project, _projects()),
        "robot": Reader(lambda data: robot_from_toml(text_of(data)), _files("robots/*.toml")),
        "setup": Reader(lambda data: setup_from_toml(text_of(data)).toolpath, _setups()),
        "urdf": Reader(lambda data: _urdf(folder, data), URDFS),
        "load tests": Reader(lambda data: read_load_tests(text_of(data) + "\n", arm), _files("load_tests/[not]*.csv")),
        "measured map": Reader(
            lambda data: read_measured_map(text_of(data) + "\n", arm), _files("load_tests/nine_points_compliances.csv")
        ),
        "forces": Reader(read_forces, (FORCES,)),
        "profile": Reader(lambda data: read_profile(text_of(data) + "\n"), (PROFILE,)),
        "tool table": Reader(read_tool_table, TABLES),
        "materials": Reader(lambda data: material_from_toml(text_of(data)), _files("materials/*.toml")),
        "gcode": Reader(read_gcode, GCODE),
        "heidenhain": Reader(read_gcode, HEIDENHAIN),
        "sinumerik": Reader(read_gcode, SINUMERIK),
        "apt": Reader(read_apt, APT),
        "dxf": Reader(lambda data: drawing_from_bytes(data, "a.dxf", "mm"), _dxfs()),
        "svg": Reader(lambda data: drawing_from_bytes(data, "a.svg"), SVGS),
        "points": Reader(lambda data: points_from_bytes(data, "a.csv"), (POINTS,)),
        "parquet": Reader(lambda data: points_from_bytes(data, "a.parquet"), _parquets(), True),
        "stl": Reader(read_stl_stock, _stls(), True),
        "sketch": Reader(lambda data: setup_from_toml(text_of(data)).toolpath, _sketches()),
    }


def damaged(data: bytes, r: random.Random, plain: bool) -> bytes:
    """The file with a few things wrong."""
    if plain and r.random() < 0.6:
        raw = bytearray(data)
        for _ in range(r.randint(1, 8)):
            at = r.randrange(len(raw)) if r.random() < 0.5 else r.randrange(min(len(raw), 100))
            raw[at] = r.randrange(256)
        return bytes(raw[: r.randrange(len(raw))]) if r.random() < 0.2 else bytes(raw)
    text = data.decode("utf-8", "surrogateescape")
    for _ in range(r.randint(1, 3)):
        text = _once(text, r)
    if r.random() < 0.02:
        return text.encode("utf-16", "surrogatepass")
    return text.encode("utf-8", "surrogateescape" if plain else "replace")


def _once(text: str, r: random.Random) -> str:
    kind, at = r.random(), r.randrange(len(text) + 1)
    numbers = list(NUMBER.finditer(text))
    lines = text.split("\n")
    row = r.randrange(len(lines))
    if kind < 0.35 and numbers:
        found = r.choice(numbers)
        return text[: found.start()] + r.choice(ODD) + text[found.end() :]
    if kind < 0.55 and "=" in lines[row]:
        lines[row] = lines[row].partition("=")[0] + "= " + r.choice(ODD)
    elif kind < 0.65:
        lines.insert(row, r.choice(ODD))
    elif kind < 0.72:
        del lines[row]
    elif kind < 0.79:
        lines.insert(row, r.choice(lines))
    elif kind < 0.86:
        return text[:at] + r.choice(ODD) + text[at:]
    elif kind < 0.93:
        return text[:at] + text[at + r.randint(1, 40) :]
    else:
        return text[:at] + chr(r.choice([0, 9, 34, 39, 44, 59, 91, 93, 123, 0xD7, 0x2028, 0xFFFF])) + text[at:]
    return "\n".join(lines)


@dataclass
class Found:
    """Of one reader: how many were read, what escaped (where: how often), seconds of the slowest."""

    read: int
    escaped: Counter[str]
    slowest: float
    worst: bytes = b""


def run(reader: Reader, count: int, seed: int) -> Found:
    """``count`` damaged files; the same ``seed`` damages alike."""
    r, found = random.Random(seed), Found(0, Counter(), 0.0)
    for _ in range(count):
        data = damaged(r.choice(reader.seeds), r, reader.plain)
        began = time.process_time()
        try:
            reader.read(data)
            found.read += 1
        except RobomillError:
            pass
        except Exception as exc:
            inner = [f for f in traceback.extract_tb(exc.__traceback__) if "/robomill/" in f.filename] or [None]
            place = f"{Path(inner[-1].filename).name}:{inner[-1].lineno} {inner[-1].name}" if inner[-1] else "?"
            found.escaped[f"{type(exc).__name__} at {place}: {str(exc)[:60]}"] += 1
        spent = time.process_time() - began
        if spent > found.slowest:
            found.slowest, found.worst = spent, data
    return found


def main(words: list[str]) -> None:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        every = readers(Path(folder))
        for name in words[1:] or every:
            began = time.process_time()
            found = run(every[name], int(words[0]), seed=len(name))
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            counted = f"{found.read:6} read, {found.escaped.total():4} escaped, slowest {found.slowest:.2f} s"
            spent = time.process_time() - began
            print(f"{name:13} {counted}, all {spent:.0f} s, peak {peak:.0f} MB", flush=True)
            for words_, times in found.escaped.most_common():
                print(f"    {times:4} {words_}")
            if found.slowest > 2.0:
                print(f"    slow: {found.worst[:200]!r} ... {len(found.worst)} bytes")


if __name__ == "__main__":
    main(sys.argv[1:] or ["10000"])
