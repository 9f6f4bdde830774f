"""``robomill study``: what it prints, how it ends, and that it goes on from what is there."""

import io
import json
from pathlib import Path

import pytest

from robomill.cli import main

pq = pytest.importorskip("pyarrow.parquet")

STUDY = """
setup = "paper_flute"
responses = ["share", "verdict"]
[parameters."cutter.diameter_mm"]
values = [6.0, 8.0, {third}]
[parameters."numerics.step_mm"]
values = [20.0]
"""


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_its_record_counts_and_spans_and_it_goes_on(capsys: pytest.CaptureFixture[str]) -> None:
    Path("mine.toml").write_text(STUDY.format(third=-1.0))
    assert main(["study", "mine.toml", "--out", "out", "--json", "--processes", "1"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert {name: record[name] for name in ("points", "done", "failed", "resumed")} == {
        "points": 3,
        "done": 2,
        "failed": 1,
        "resumed": 0,
    }
    assert record["seconds"] > 0.0
    assert record["responses"]["verdict"] == {"ok": 2}
    assert "Diameter" in record["reasons"][0]["reason"]
    share = [value for value in pq.read_table("out/results.parquet")["share"].to_pylist() if value == value]
    assert record["responses"]["share"]["largest"] == pytest.approx(max(share))
    assert main(["study", "mine.toml", "--out", "out"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("paper_flute: 2 of 3 points done, 1 failed\n")
    assert "3 were there before" in said


def test_a_study_without_any_answer_exits_1(capsys: pytest.CaptureFixture[str]) -> None:
    """Each switch may stand alone; together they contradict each other."""
    Path("mine.toml").write_text(
        'setup = "paper_flute/setup_process"\n[parameters."numerics.coupling"]\nvalues = [true]\n'
        '[parameters."numerics.engagement"]\nvalues = [false]\n'
    )
    assert main(["study", "mine.toml", "--out", "out"]) == 1
    assert "failed    1 time: Coupling: the force must follow the engagement" in capsys.readouterr().out


def test_what_is_wrong_exits_2_in_a_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    Path("mine.toml").write_text(STUDY.format(third=10.0).replace("diameter_mm", "diametr_mm"))
    assert main(["study", "mine.toml", "--out", "out"]) == 2
    assert "Parameter cutter.diametr_mm" in capsys.readouterr().err
    Path("mine.toml").write_text(STUDY.format(third=10.0))
    assert main(["study", "mine.toml", "--out", "out", "--scheduler", "here"]) == 2
    assert "expected its address, as tcp://host:8786" in capsys.readouterr().err
    assert not Path("out").exists()


def test_standard_input_is_a_study_too(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    class Stream:
        buffer = io.BytesIO(STUDY.format(third=10.0).encode())

    monkeypatch.setattr("sys.stdin", Stream())
    assert main(["study", "-", "--out", "out", "--json", "--processes", "1"]) == 0
    assert json.loads(capsys.readouterr().out)["done"] == 3
