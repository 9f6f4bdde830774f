"""The files of a class: nothing stops the others, and what looks odd is told."""

from __future__ import annotations

import csv
import io
import json
import os
import re
from pathlib import Path

import pytest

from robomill import learn
from robomill.cli import main
from robomill.errors import LearnError
from robomill.io.samples import samples_dir
from robomill.learn.grading import Row
from robomill.learn.personal import TASKS
from robomill.units import from_si

CLASS = samples_dir() / "answers/class"


def right(student: str | int, robot: str = "slavkovic_5r") -> dict[str, str]:
    return {each.id: f"{from_si(each.answer, each.unit):.6g}" for each in learn.exercises(student, robot)}


def put(folder: Path, name: str, student: str | int, **change: str) -> Path:
    path = folder / name
    path.write_text(learn.answers_text(student, right(student) | change, "Ada"), encoding="utf-8")
    return path


def rows(folder: Path) -> dict[str, Row]:
    return {row.file: row for row in learn.grade(folder).rows}


def test_the_sample_is_marked_as_it_was_made() -> None:
    found = rows(CLASS)
    full = found["answers-1234567.toml"]
    assert full.total == 20.0
    kinds = {name: each.kind for name, each in found["answers-2718281.toml"].judged.items() if not each.right}
    assert kinds == {"tip": "sign", "share": "slip", "press": "unit", "regular": "unread", "slot": "slip"}
    assert [each.kind for each in found["answers-3141592.toml"].judged.values()] == ["right"] * 6 + ["missing"] * 4


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("Ada", "Jürgen Ölschläger"),
        lambda text: text.replace('student = "77"', "student = 77"),
        lambda text: text.replace('student = "77"', 'student = " 0077 "'),
        lambda text: text.replace("version = 1\n", ""),
        lambda text: re.sub(r'(\d)\.(\d+)"', r'\1,\g<2>00"', text),
    ],
)
@pytest.mark.parametrize("code", ["utf-8", "utf-8-sig", "utf-16"])
def test_a_file_as_editors_save_it_is_read(change, code: str, tmp_path: Path) -> None:
    text = put(tmp_path, "answers-77.toml", 77).read_text(encoding="utf-8")
    (tmp_path / "answers-77.toml").write_bytes(change(text).encode(code))
    (row,) = learn.grade(tmp_path).rows
    assert row.total == 20.0, row.remarks


def test_umlauts_of_an_old_windows_editor_are_read(tmp_path: Path) -> None:
    path = put(tmp_path, "a.toml", 77)
    path.write_bytes(path.read_text(encoding="utf-8").replace("Ada", "Jürgen").encode("cp1252"))
    (row,) = learn.grade(tmp_path).rows
    assert row.answers is not None
    assert row.answers.name == "Jürgen"


BAD = {
    "empty.toml": b"",
    "binary.toml": bytes(range(256)) * 10,
    "broken.toml": b"format = [",
    "deep.toml": b"a = " + b"[" * 5000,
    "setup.toml": (samples_dir() / "paper_flute/setup.toml").read_bytes(),
    "nobody.toml": b'format = "robomill answers"\n[answers]\n',
    "newer.toml": b'format = "robomill answers"\nversion = 9\nstudent = "1"\n',
    "list.toml": b'format = "robomill answers"\nstudent = [1]\n',
    "words.toml": b'format = "robomill answers"\nstudent = "1"\nanswers = "all right"\n',
    "robot.toml": b'format = "robomill answers"\nstudent = "1"\nrobot = "../../secret"\n',
    "large.toml": b"#" * 1_100_000,
    "report.docx": b"PK\x03\x04",
}


def test_what_cannot_be_marked_keeps_its_row_and_its_reason_and_the_others_are_marked(tmp_path: Path) -> None:
    for name, data in BAD.items():
        (tmp_path / name).write_bytes(data)
    os.mkfifo(tmp_path / "pipe.toml")
    (tmp_path / "gone.toml").symlink_to(tmp_path / "nowhere")
    (tmp_path / ".DS_Store").write_bytes(b"x")
    (tmp_path / "sub").mkdir()
    put(tmp_path / "sub", "answers-5.toml", 5)
    found = rows(tmp_path)
    assert set(found) == {*BAD, "pipe.toml", "gone.toml", "sub/answers-5.toml"}
    assert found.pop("sub/answers-5.toml").total == 20.0
    for name, row in found.items():
        assert row.total is None, name
        assert len(row.remarks) == 1, name
        assert row.remarks[0].startswith("Not marked: "), name
        assert "\n" not in row.remarks[0]
    assert "this is no file of answers" in found["setup.toml"].remarks[0]
    assert "Student number" in found["nobody.toml"].remarks[0]


def test_names_of_files_that_are_no_text_are_written_all_the_same(tmp_path: Path) -> None:
    for name in (b"\xff.toml", b"a\nb.toml", b"<b>.toml"):
        Path(os.fsdecode(os.path.join(os.fsencode(tmp_path), name))).write_text('format = "robomill answers"\n')
    found = learn.grade(tmp_path)
    assert {row.file for row in found.rows} == {"\ufffd.toml", "a\ufffdb.toml", "<b>.toml"}
    assert found.csv().encode("utf-8").count(b"Not marked") == 3
    assert all("\n" not in row.remarks[0] for row in found.rows)


def test_answers_of_other_kinds_and_unknown_names_are_told(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text(
        'format = "robomill answers"\nstudent = "8"\n[answers]\ntip = [1, 2]\nshare = true\npress = nan\nslot = inf\n'
        'torque = ""\ntipp = "3"\n[answers.softest]\nx = 1\n'
    )
    (row,) = learn.grade(tmp_path).rows
    assert {name: each.kind for name, each in row.judged.items() if each.kind != "missing"} == {
        "tip": "unread",
        "share": "unread",
        "press": "unread",
        "slot": "unread",
        "softest": "unread",
    }
    assert row.total == 0.0
    assert row.remarks == ("No exercise is called tipp.",)


def test_the_same_number_twice_is_told_in_both_rows(tmp_path: Path) -> None:
    put(tmp_path, "a.toml", 77)
    put(tmp_path, "b.toml", "0077")
    found = rows(tmp_path)
    assert found["a.toml"].remarks == ("The same student number stands in b.toml.",)
    assert found["b.toml"].remarks == ("The same student number stands in a.toml.",)
    assert found["a.toml"].total == found["b.toml"].total == 20.0


def test_a_student_with_anothers_answers_is_told(tmp_path: Path) -> None:
    put(tmp_path, "answers-77.toml", 77)
    (tmp_path / "answers-78.toml").write_text(learn.answers_text(78, right(77), "Bob"))
    row = rows(tmp_path)["answers-78.toml"]
    assert row.total is not None
    assert row.total <= 4.0
    assert len(row.remarks) == 1
    assert row.remarks[0].endswith("of it are right for student 77.")
    assert rows(tmp_path)["answers-77.toml"].remarks == ()


def test_a_file_called_after_another_number_is_told(tmp_path: Path) -> None:
    put(tmp_path, "answers-99.toml", 77)
    assert rows(tmp_path)["answers-99.toml"].remarks == ("The file is called after 99, and the number in it is 77.",)


def test_answers_for_another_robot_than_the_class_was_given_are_not_marked(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text(learn.answers_text(7, right(7, "planar_2r"), robot="planar_2r"))
    assert learn.grade(tmp_path).rows[0].total == 20.0
    row = learn.grade(tmp_path, "slavkovic_5r").rows[0]
    assert row.remarks == ("Not marked: these are answers for planar_2r, and the class was given slavkovic_5r.",)


def test_the_table_is_one_a_spreadsheet_opens_without_running_anything(tmp_path: Path) -> None:
    path = put(tmp_path, "=cmd.toml", 77, tip='=HYPERLINK("x")')
    path.write_text(path.read_text().replace('"Ada"', '"=1+1, \\"Ü\\""'))
    text = learn.grade(tmp_path).csv()
    assert text.startswith("\ufeffstudent,name,file,robot,total,of,torque,torque_why,")
    (row,) = csv.DictReader(io.StringIO(text.removeprefix("\ufeff"), newline=""))
    assert (row["name"], row["file"]) == ('\'=1+1, "Ü"', "'=cmd.toml")
    assert (row["total"], row["of"], row["tip"]) == ("18", "20", "0")
    assert len(row) == 7 + 2 * len(TASKS)


@pytest.mark.parametrize(("name", "said"), [("none", "there is no such folder"), ("file", "this is a file")])
def test_a_folder_that_is_none_is_refused(name: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(LearnError, match=said):
        learn.grade(tmp_path / name)


def test_an_empty_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LearnError, match="there is no file of answers"):
        learn.grade(tmp_path)
    with pytest.raises(LearnError, match="known are"):
        learn.grade(CLASS, "nobody")


def test_the_verb_writes_the_table_and_says_by_its_code_whether_all_were_marked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    put(tmp_path, "answers-77.toml", 77)
    for _ in range(2):  # the table of the first run is none of the answers
        assert main(["grade", ".", "--out", "marks.csv", "--json"]) == 0
        record = json.loads(capsys.readouterr().out)
    assert (record["marked"], record["unmarked"], record["rows"][0]["total"]) == (1, 0, 20.0)
    assert record["files"][0]["replaced"]
    assert Path("marks.csv").read_text(encoding="utf-8-sig").count("\n") == 2
    Path("notes.txt").write_text("x")
    assert main(["grade", ".", "--out", "marks.csv"]) == 1
    assert "not marked: 1" in capsys.readouterr().out


@pytest.mark.parametrize(
    "words",
    [
        ("none", "--out", "m.csv"),
        (".", "--out", "."),
        (".", "--out", "a.toml"),
        (".", "--out", "m.csv", "--robot", "x"),
    ],
)
def test_the_verb_refuses_in_one_line(
    words: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    put(tmp_path, "answers-77.toml", 77)
    assert main(["grade", *words]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not Path("m.csv").exists()


def test_the_samples_files_can_be_made_again(tmp_path: Path) -> None:
    """An answer of 1234567 that changes here changes for every class that has its exercises."""
    assert (CLASS / "answers-1234567.toml").read_text(encoding="utf-8") == learn.answers_text(
        "1234567",
        {each.id: f"{from_si(each.answer, each.unit):.5g}" for each in learn.exercises("1234567")},
        "Ada Müller",
    )
