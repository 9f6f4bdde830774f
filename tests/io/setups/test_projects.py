"""Set-up files: round trip, and one sentence for each thing that can be wrong."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from robomill.arrays import digest
from robomill.compliance.gravity import LinkMasses
from robomill.compliance.springs.joint_bending import JointBending
from robomill.compliance.springs.spindle import SpindleSpring
from robomill.compliance.springs.tool_bending import ToolBending
from robomill.cutting.forces.along_path import PathForce
from robomill.cutting.tool import Cutter
from robomill.cutting.tool_table import TableTool, ToolTable
from robomill.errors import ProjectError, RobomillError
from robomill.identification.measured_field import MeasuredField
from robomill.io.beside import ALONE, Beside
from robomill.io.measured.identified import identify
from robomill.io.programs import program_from_bytes
from robomill.io.robot.robots import load_robot
from robomill.io.robot.writer import robot_to_toml
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup, open_project, setup_from_toml, setup_to_toml
from robomill.io.tables import parse_toml
from robomill.provenance import Provenance
from robomill.simulation.origin.doubts import known_notes
from robomill.study.described import load_study, study_from_toml
from robomill.study.writing import study_to_toml
from robomill.surface.stock import Stock
from robomill.toolpath.sketch import Sketch
from robomill.toolpath.sketch_presets import preset
from robomill.toolpath.source import GCodeSource, LinesSource, SketchSource
from robomill.units import to_si

SAMPLE = samples_dir() / "paper_flute" / "setup.toml"


@pytest.fixture(scope="module")
def setup():
    return load_setup(SAMPLE)


def test_a_saved_setup_is_the_same_setup(setup) -> None:
    assert setup_from_toml(setup_to_toml(setup)).digest() == setup.digest()


def test_edits_survive_saving(setup) -> None:
    T_MW = setup.T_MW.copy()
    T_MW[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    robot = setup.robot.replace(C_theta=setup.robot.C_theta * 0.7)
    lines = LinesSource([[0, 0, 0]], [[to_si(33.3, "mm"), 0, 0]], [to_si(1861.5, "mm/min")], to_si(7404.1, "1/min"))
    edited = setup.replace(robot=robot, source=lines, T_MW=T_MW, stock=None, tolerance=1e-4 / 3)
    again = setup_from_toml(setup_to_toml(edited))
    assert again.digest() == edited.digest()
    assert np.array_equal(again.robot.C_theta, robot.C_theta)


@pytest.mark.parametrize(
    "text", ["G1 X1 F100\n", "(quotes \"\"\" and ''' and \\ back)\nG1 X1 F1\n", "G0 X0\r\nG1 X1 F9\r\n", "\tG1 X1\n\n"]
)
def test_a_program_survives_saving_to_the_letter(setup, text: str) -> None:
    edited = setup.replace(source=GCodeSource(text, "a b.NC"))
    assert setup_from_toml(setup_to_toml(edited)).source == edited.source


def test_every_number_counts_in_the_digest(setup) -> None:
    digests = {setup.digest()}
    C_theta = setup.robot.C_theta.copy()
    C_theta[4] = np.nextafter(C_theta[4], 1)
    changes = [
        {"robot": setup.robot.replace(C_theta=C_theta)},
        {"tolerance": 0.2e-3},
        {"cell": 2e-4},
        {"cutter": setup.cutter.replace(diameter=6e-3)},
        {"source": GCodeSource(setup.source.text + " ", setup.source.name)},
        {"T_MW": setup.T_MW + np.eye(4) * 0 + np.pad([[1e-9]], ((0, 3), (3, 0)))},
    ]
    for change in changes:
        digests.add(setup.replace(**change).digest())
    assert len(digests) == 1 + len(changes)


TEXT = SAMPLE.read_text()
BAD = [
    ("", "format: expected 'robomill-setup', found ''"),
    ("not toml [", "not a readable TOML file"),
    (TEXT.replace("version = 1", "version = 99"), "version: this file is version 99; this robomill reads version 1"),
    (
        TEXT.replace("tolerance_mm = 0.3", 'tolerance_mm = "wide"'),
        "tolerance_mm: expected a number in mm, found 'wide'",
    ),
    (TEXT.replace("tolerance_mm = 0.3", "tolerance_mm = 0"), "Tolerance: found 0 mm; expected more than 0 mm"),
    (TEXT.replace("tolerance_mm = 0.3", "tolerance_mm = nan"), "tolerance_mm: expected a finite number"),
    (
        TEXT.replace("cell_mm = 0.1", "cel_mm = 0.1"),
        "[numerics], cel_mm: this key is not known here; known are: add_sag, cell_mm",
    ),
    (TEXT.replace("diameter_mm = 8.0", ""), "[cutter], diameter_mm: missing; add it"),
    (
        TEXT.replace('name = "slavkovic_5r"', 'file = "arm.toml"'),
        "[robot], file: this key is not known here; known are: compliance_set, definition, name",
    ),
    (TEXT.replace("diameter_mm = 8.0", "diameter_mm = -8.0"), "Cutter, Diameter: found −8 mm"),
    (TEXT.replace('kind = "path"', 'kind = "magic"'), "[force], kind: expected one of path, constant"),
    (TEXT.replace('name = "slavkovic_5r"', 'name = "robbie"'), "robbie"),
    (TEXT.replace('"table_2"', '"table_9"'), "table_9"),
    (TEXT.replace('program = "path.nc"', 'program = "lost.nc"'), "[path], program: lost.nc: cannot be opened"),
    (TEXT.replace("[-46.0, -20.0, -10.0]", "[-46.0, -20.0]"), "lower_mm: expected a list of 3 numbers"),
    (TEXT.replace("[-46.0, -20.0, -10.0]", "[99.0, -20.0, -10.0]"), "Stock in X"),
    (TEXT.replace('kind = "paper"', 'kind = "rumour"', 1), "expected one of paper, measured"),
]


@pytest.mark.parametrize(("text", "sentence"), BAD, ids=[s[:40] for _, s in BAD])
def test_bad_setups_are_refused_in_a_sentence(text: str, sentence: str) -> None:
    assert text != TEXT
    with pytest.raises(RobomillError, match=re.escape(sentence)) as refused:
        setup_from_toml(text, "setup.toml", Beside(SAMPLE.parent))
    assert "\n" not in str(refused.value).strip()


def test_a_broken_project_names_its_file() -> None:
    text = TEXT.replace("diameter_mm = 8.0", "diameter_mm = -8.0")
    with pytest.raises(ProjectError, match=re.escape("mine.toml: ")):
        open_project(parse_toml(text, "mine.toml"), "mine.toml")


@pytest.mark.parametrize(
    ("data", "sentence"),
    [(b"", "the file is empty"), (b" \r\n", "the file is empty"), (b"\x7fELF\0\0", "binary file")],
)
def test_programs_that_are_no_text(data: bytes, sentence: str) -> None:
    with pytest.raises(ProjectError, match=sentence):
        program_from_bytes(data, "part.nc")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_programs_in_other_encodings_are_read(encoding: str) -> None:
    text = "(Nut fräsen)\nG1 X1 F100\n"
    assert program_from_bytes(text.encode(encoding), "part.nc").text == text


def test_a_missing_setup_is_named() -> None:
    with pytest.raises(ProjectError, match="nowhere.toml: cannot be opened"):
        load_setup("nowhere.toml")


def test_a_stock_from_a_mesh_survives_saving(setup, tmp_path) -> None:
    trimesh = pytest.importorskip("trimesh")
    block = trimesh.creation.box(extents=[110.0, 40.0, 10.0])
    block.apply_translation([9.0, 0.0, -5.0])
    block.export(tmp_path / "blank.stl")
    text = re.sub(r"lower_mm = .*\nupper_mm = .*", 'stl = "blank.stl"', TEXT)
    (tmp_path / "setup.toml").write_text(text)
    (tmp_path / "path.nc").write_text((SAMPLE.parent / "path.nc").read_text())
    meshed = load_setup(tmp_path / "setup.toml")
    assert meshed.stock.triangles is not None
    assert meshed.stock.upper == pytest.approx(setup.stock.upper, abs=1e-9)
    assert setup_from_toml(setup_to_toml(meshed)).digest() == meshed.digest()


@pytest.mark.parametrize("given", [0.4e-3, (0.3e-3, 0.1e-3, 0.5e-3), (0.3e-3, None, 0.5e-3), {"wall": 0.3e-3}])
def test_one_tolerance_or_three_come_back_from_their_file(given):
    setup = load_setup(samples_dir() / "paper_flute").replace(tolerance=given)
    again = setup_from_toml(setup_to_toml(setup))
    names = ("tolerance", "floor_tolerance", "feed_tolerance")
    assert [getattr(again, name) for name in names] == pytest.approx([getattr(setup, name) for name in names])
    assert again.digest() == setup.digest()


def test_three_tolerances_are_read_by_name():
    text = setup_to_toml(load_setup(samples_dir() / "paper_flute"))
    three = text.replace("tolerance_mm = 0.3\n", "tolerance_mm = {wall = 0.3, floor = 0.1, feed = 0.5}\n")
    found = setup_from_toml(three)
    assert (found.tolerance, found.floor_tolerance, found.feed_tolerance) == pytest.approx((0.3e-3, 0.1e-3, 0.5e-3))
    for wrong, word in (
        ("{floor = 0.1}", "wall"),
        ("{wall = 0.3, depth = 1}", "depth"),
        ("{wall = -1}", "more than 0"),
    ):
        with pytest.raises(RobomillError, match=word):
            setup_from_toml(text.replace("tolerance_mm = 0.3\n", f"tolerance_mm = {wrong}\n"))
    for wrong in ((1e-3, 2e-3), (None, 1e-3, 1e-3), {"floor": 1e-3}):
        with pytest.raises(RobomillError, match="one number, or three"):
            found.replace(tolerance=wrong)


def test_what_is_no_set_up_is_told_from_one(tmp_path: Path) -> None:
    assert load_setup(SAMPLE.parent).digest() == load_setup(SAMPLE).digest()
    with pytest.raises(ProjectError, match="path.nc: this is a program, not a set-up"):
        load_setup(SAMPLE.parent / "path.nc")
    for ending in ("mpf", "SPF", "min", "eia", "g"):
        program = tmp_path / f"part.{ending}"
        program.write_text("G1 X1 F100\n")
        with pytest.raises(ProjectError, match="this is a program, not a set-up"):
            load_setup(program)
    other = tmp_path / "setup.txt"
    other.write_text("G1 X1 F100\n")
    with pytest.raises(ProjectError) as caught:
        load_setup(other)
    assert "this is a program" not in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("tolerance_mm = 0.3", 'tolerance_mm = 0.3\nspin = "least_motion"\nspin_deg = 5', "given twice"),
        ("tolerance_mm = 0.3", 'tolerance_mm = 0.3\nspin = "backwards"', "spin: expected one of"),
        (
            'program = "path.nc"',
            "",
            "expected one of program, program_text, lines_mm, sketch, points_mm, points_m; found none",
        ),
        ('program = "path.nc"', 'program = "path.nc"\nprogram_text = "M2"', "found ['program', 'program_text']"),
    ],
)
def test_what_excludes_each_other_is_refused(old: str, new: str, sentence: str) -> None:
    with pytest.raises(RobomillError, match=re.escape(sentence)):
        setup_from_toml(TEXT.replace(old, new), "setup.toml", Beside(SAMPLE.parent))


def test_a_robot_beside_the_set_up_is_meant_before_a_preset(tmp_path: Path) -> None:
    other = load_robot("slavkovic_5r").replace(name="mine")
    (tmp_path / "mine.toml").write_text(robot_to_toml(other))
    text = TEXT.replace('name = "slavkovic_5r"', 'name = "mine.toml"').replace('compliance_set = "table_2"', "")
    setup = setup_from_toml(
        text.replace('program = "path.nc"', 'program_text = "G1 X1 F1\\nM2"'), "setup.toml", Beside(tmp_path)
    )
    assert setup.robot.name == "mine"


def test_lines_and_sketches_come_back() -> None:
    base = load_setup(SAMPLE)
    lines = LinesSource(
        [[0, 0, 0], [0.01, 0.0123, 0]], [[0.01, 0, -1e-3], [0.02, 0.03, -0.0015]], [0.01, 0.0305], 123.0
    )
    drawn = SketchSource(preset("fig_8", Sketch(v_f=0.02, depth=1.5e-3), 8e-3))
    for source in (lines, drawn):
        setup = base.replace(source=source)
        again = setup_from_toml(setup_to_toml(setup))
        assert again.digest() == setup.digest()
        np.testing.assert_allclose(again.toolpath.p, setup.toolpath.p, atol=1e-15)


def test_the_first_tool_that_cuts_is_the_cutter_where_none_is_named() -> None:
    setup = load_setup(SAMPLE)
    table = ToolTable((TableTool(1), TableTool(2, Cutter("ball", 6e-3), 0.05), TableTool(3, Cutter("flat", 9e-3))))
    text = setup_to_toml(setup.replace(tools=table))
    without = text[: text.index("[cutter]")] + text[text.index("[force]") :]
    assert setup_from_toml(without).cutter == Cutter("ball", 6e-3)
    assert setup_from_toml(text).cutter == setup.cutter


def test_a_cutter_that_cannot_be_is_refused_with_its_table_and_key():
    text = SAMPLE.read_text(encoding="utf-8").replace('kind = "flat"', 'kind = "drill"', 1)
    with pytest.raises(RobomillError, match=r"^setup.toml, \[cutter\], tip_angle_deg: A drill needs a tip angle"):
        setup_from_toml(text, "setup.toml", Beside(SAMPLE.parent))


CHANGES = {
    "description": 'a long "one"\nin two lines',
    "tolerance": 1e-3 / 7,
    "floor_tolerance": 1e-4 / 3,
    "feed_tolerance": 2e-4 / 3,
    "step": 1e-3 / 3,
    "cell": 0.3e-3,
    "engagement": True,
    "spin": -0.7 / 3,
    "rapid_rate": 0.2 / 3,
    "springs": (ToolBending(8e-3, 0.04 / 3), SpindleSpring(1e-7 / 3), JointBending(3, 1e-7, 2e-7 / 3)),
    "links": LinkMasses(np.arange(1.0, 6.0) / 3, np.arange(15.0).reshape(5, 3) / 7e2, Provenance("measured", "scales")),
    "tools": ToolTable((TableTool(3), TableTool(4, Cutter("ball", 0.857e-3), 16.667e-3, name="small"))),
    "provenance": {"force": Provenance("synthetic", "made up"), "stock": Provenance("measured", "by hand")},
    "measured_map": MeasuredField(
        [[0.03333, -1.3, 0], [0.1, -1.3, 0]],
        [np.eye(3) * 1e-6 / 3, np.diag([1e-6, 2e-6, 5e-6]) / 7],
        np.deg2rad([[10.5, 20.25], [3.0, -7.125]]),
        1 / 3,
        Provenance("synthetic", "made up"),
        np.full((2, 3, 3), 1e-8 / 3),
    ),
}


@pytest.mark.parametrize("names", [*([name] for name in CHANGES), [*CHANGES], []], ids=lambda n: "-".join(n)[:30])
def test_whatever_is_changed_comes_back(setup, names: list[str]) -> None:
    """Each field off its default alone, all of them, and none; and what is written of the copy is the same text."""
    changed = setup.replace(**{name: CHANGES[name] for name in names}, add_sag="links" in names)
    text = setup_to_toml(changed)
    again = setup_from_toml(text)
    assert again.digest() == changed.digest()
    assert (changed.digest() == setup.digest()) == (not {*names} - {"description", "provenance"})
    assert (again.description, again.provenance) == (changed.description, changed.provenance)
    assert setup_to_toml(again) == text


def test_the_spin_is_written_only_where_it_is_chosen(setup) -> None:
    for spin, written in (
        ("least_motion", {}),
        ("least_deviation", {"spin": "least_deviation"}),
        (0.25, {"spin_rad": 0.25}),
    ):
        data = parse_toml(setup_to_toml(setup.replace(spin=spin)), "x")
        assert {key: data[key] for key in data if key.startswith("spin")} == written


def test_what_the_app_saves_beside_the_setup_is_nothing_to_a_run() -> None:
    """Save in the browser, then the command line: the same numbers."""
    text = setup_to_toml(load_setup(SAMPLE)) + '\n[view]\nunits = "in"\n\n[maps]\nrobot = "other"\n'
    assert setup_from_toml(text).digest() == load_setup(SAMPLE).digest()


@pytest.mark.parametrize("table", ["A", "-C", "tool", ""])
def test_what_turns_the_part_is_kept_in_a_project(table: str) -> None:
    setup = load_setup(samples_dir() / "paper_flute" / "setup.toml")
    source = GCodeSource("G21 G0 Z5 A0\nG1 X9 A120 F100\nM2\n", table=table)
    kept = setup_to_toml(setup.replace(source=source))
    assert ("rotary_axis" in kept) == bool(table)
    assert setup_from_toml(kept).source == source


@pytest.mark.parametrize(
    ("sample", "left_out", "said"),
    [
        ("setup.toml", "tolerance_mm = 0.3\n", {"tolerance": "nobody has stated one"}),
        ("setup.toml", "flutes = 3\n", {}),  # a force of fixed numbers does not ask for them
        ("setup_process.toml", "flutes = 3\n", {"cutter": "nobody has stated flutes 2 and helix angle 30°"}),
    ],
)
def test_what_a_file_leaves_out_is_assumed(sample: str, left_out: str, said: dict[str, str]) -> None:
    text = (SAMPLE.parent / sample).read_text()
    assert left_out in text
    text = text[: text.index("[provenance]")].replace(left_out, "")
    found = setup_from_toml(text, "mine", Beside(SAMPLE.parent)).provenance
    assert {block: each.source for block, each in found.items()} == said
    assert {each.kind for each in found.values()} <= {"assumed"}


def test_how_sure_the_compliances_are_is_kept_in_the_file_and_read_from_it(setup) -> None:
    found = identify(setup.robot, "nine_points")
    known = setup.replace(robot=found.applied_to(setup.robot), knowledge=found)
    text = setup_to_toml(known)
    again = setup_from_toml(text)
    assert again.digest() == known.digest()
    assert digest(again.known) == digest(known.known)
    assert "[uncertainty]" not in setup_to_toml(setup)
    assert "[uncertainty]" not in setup_to_toml(known.replace(robot=setup.robot))  # of others than are in the file
    with pytest.raises(ProjectError, match=r"\[uncertainty\].*covariance"):
        setup_from_toml(text.replace("covariance = [", "covariance = [[1.0],"))
    with pytest.raises(ProjectError, match="there is no 'covarianc'|covarianc"):
        setup_from_toml(text.replace("covariance = [", "covarianc = ["))


def test_a_file_whose_compliances_were_changed_by_hand_knows_nothing_of_these(setup) -> None:
    found = identify(setup.robot, "nine_points")
    text = setup_to_toml(setup.replace(robot=found.applied_to(setup.robot), knowledge=found))
    start = text.index("[uncertainty]")
    other = setup_to_toml(setup) + "\n" + text[start:]
    read = setup_from_toml(other)
    assert read.known is None
    assert read.knowledge is not None
    (note,) = known_notes(read)
    assert note.code == "other-compliances"
    assert "of others than are in force" in note.sentence
    assert known_notes(setup) == ()


@pytest.mark.parametrize("seed", range(20))
def test_numbers_of_any_kind_survive_saving(setup, seed: int) -> None:
    """In SI, as code has them: two of a hundred are no number of millimetres that a float holds."""
    rng = np.random.default_rng(seed)
    start, end = rng.uniform(-0.05, 0.05, (2, 9, 3))
    low = rng.uniform(-0.2, -0.1, 3)
    one = setup.replace(
        source=LinesSource(start, end, rng.uniform(0.01, 0.1, 9), rng.uniform(100.0, 300.0)),
        stock=Stock(low, low + rng.uniform(0.1, 0.5, 3)),
        cutter=Cutter("bull", rng.uniform(3e-3, 20e-3), rng.uniform(1e-4, 1e-3), 3),
        force=PathForce(*rng.uniform(-200.0, 200.0, 3)),
        part_zero=rng.uniform(-0.2, 0.2, 3) - [0.0, 1.3, 0.0],
        part_rotation_z=rng.uniform(-3.0, 3.0),
        tolerance=rng.uniform(1e-4, 1e-3),
        springs=(ToolBending(rng.uniform(3e-3, 20e-3), rng.uniform(0.02, 0.1)),),
        links=LinkMasses(rng.uniform(1.0, 500.0, 5), rng.uniform(-0.5, 0.5, (5, 3))),
    )
    text = setup_to_toml(one)
    again = setup_from_toml(text)
    assert again.digest() == one.digest()
    assert setup_to_toml(again) == text
    study = load_study({"setup": one, "parameters": {"cutter.diameter_mm": {"values": [6.0, 8.0]}}})
    assert study_from_toml(study_to_toml(study), "study", ALONE).digest() == study.digest()
