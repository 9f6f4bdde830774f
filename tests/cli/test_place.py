"""``robomill place``: its answer for people and programs, the set-up that it writes, and its exit codes."""

import json

import pytest

import robomill as rm
from robomill.cli import main

BOX = ("--x", "-200:200", "--y", "-1400:-1200", "--candidates", "16")


def asked(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, dict]:
    code = main(["place", *words, "--json"])
    return code, json.loads(capsys.readouterr().out)


def test_the_record_tells_the_best_place_and_what_it_is_compared_with(
    capsys: pytest.CaptureFixture[str], tmp_path
) -> None:
    out = tmp_path / "moved.toml"
    code, record = asked(capsys, "paper_flute", *BOX, "--yaw", "-45:45", "--out", str(out))
    assert code == 0
    best, now = record["best"], record["now"]
    run = rm.simulate(rm.load_setup(out))
    assert best["zero_mm"] == pytest.approx(run.setup.T_MW[:3, 3] * 1e3)
    assert best["max_deviation_mm"] == pytest.approx(run.max_deviation * 1e3)
    assert best["wall_mm"] == pytest.approx(abs(run.verdict.wall.value) * 1e3)
    assert best["floor_mm"] == pytest.approx(abs(run.verdict.floor.value) * 1e3)
    assert now["zero_mm"] == pytest.approx([0.0, -1300.0, 2.0])
    assert now["max_deviation_mm"] == pytest.approx(rm.simulate(rm.load_setup("paper_flute")).max_deviation * 1e3)
    assert best["share"] <= now["share"]
    assert best["share"] <= record["median"]["share"] <= record["worst"]["share"]
    assert record["candidates"]["tried"] == record["candidates"]["reached"] > 8
    assert record["files"][0]["path"] == str(out)


def test_a_person_reads_the_best_place_first(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["place", "paper_flute", *BOX, "--measure", "tip"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[:6]] == ["best", "now", "median", "worst", "verdict", "places"]


def test_a_cut_that_stays_out_of_tolerance_exits_1(capsys: pytest.CaptureFixture[str]) -> None:
    code, record = asked(capsys, "two_tools", "--x", "0", "--y", "-1300", "--candidates", "1")
    assert (code, record["best"]["verdict"]) == (1, "out")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--x", "300:-300"), "the bounds contradict each other"),
        (("--x", "1:0"), "the bounds contradict each other"),
        (("--x", "a:b"), "--x: expected low:high or one number, found 'a:b'"),
        (("--x", "1:2:3"), "--x: expected low:high"),
        (("--keep-out", "0,0,0"), "--keep-out: expected X,Y,Z:X,Y,Z"),
        (("--x", "4000:4100", "--candidates", "4"), "fits nowhere"),
        (("--room", "2"), "room: found 2.0"),
    ],
)
def test_what_cannot_be_asked_exits_2_with_a_sentence(
    words: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["place", "paper_flute", *words]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert said in told.err
    assert len(told.err.strip().splitlines()) == 1
