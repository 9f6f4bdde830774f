"""What --help says, that its examples run, and what shells complete."""

from __future__ import annotations

import argparse
import io
import os
import shlex
import subprocess
import sys
from contextlib import redirect_stdout
from pathlib import Path

import argcomplete
import pytest

from robomill.cli import main, serve
from robomill.cli.parser import VERBS as RECORDS, make_parser
from robomill.cli.verb_options import SHELLS
from robomill.console import speak_plainly
from robomill.io.samples import sample_names

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = {each.name: each.example for each in RECORDS}
VERBS = next(a for a in make_parser()._actions if isinstance(a, argparse._SubParsersAction)).choices


def ran(words: list[str]) -> tuple[int, str]:
    """Exit code and output on a console of ASCII alone."""
    stream = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    speak_plainly(stream)
    with redirect_stdout(stream):
        try:
            code = main(words)
        except SystemExit as left:
            code = int(left.code or 0)
    stream.flush()
    return code, stream.buffer.getvalue().decode("ascii")


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_help_with_its_example_for_every_console(verb: str) -> None:
    code, said = ran([verb, "--help"])
    assert code == 0
    assert f"example:\n  {EXAMPLES[verb]}\n" in said
    assert max(map(len, said.splitlines())) <= 120


@pytest.mark.parametrize("verb", EXAMPLES)
def test_every_example_runs_in_an_empty_folder(verb, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(serve, "_become", lambda command, environment: 0)
    monkeypatch.setattr(serve, "_can_listen", lambda address, port: None)
    words = shlex.split(EXAMPLES[verb])
    assert words[:2] == ["robomill", verb]
    code, said = ran(words[1:])
    assert code == 0
    assert said or verb == "serve"


def test_the_exit_codes_stand_in_the_help() -> None:
    assert "130 interrupted" in " ".join(ran(["--help"])[1].split())
    said = " ".join(ran(["simulate", "--help"])[1].split())
    assert "Exits 1 where the verdict is red, and where nothing or not all can be judged" in said


def completed(line: str) -> set[str]:
    """What a shell is told for a line that ends at its cursor."""
    finder = argcomplete.CompletionFinder(make_parser(), always_complete_options="long")
    words = shlex.split(line)
    before, prefix = (words, "") if line.endswith(" ") else (words[:-1], words[-1])
    return {word.strip() for word in finder._get_completions(before, prefix, "", None)}


def test_shells_complete_verbs_options_samples_and_robots(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "heather.toml").write_text("")
    assert {"simulate", "samples"} <= completed("robomill s")
    assert completed("robomill simulate he") == {"heart", "heather.toml"}
    assert completed("robomill pose sl") == {"slavkovic_5r"}
    assert set(sample_names("load tests")) <= completed("robomill identify slavkovic_5r ")
    assert completed("robomill simulate heart --robot kuka_kr5") == {"kuka_kr500"}
    assert "--program" in completed("robomill simulate --pr")


@pytest.mark.parametrize("verb", ["simulate", "report", "advise", "design", "place", "turn", "compensate"])
def test_a_verb_that_takes_a_set_up_is_offered_samples_and_files(verb: str, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "paper.toml").write_text("")
    assert {"paper_flute", "paper_flute/setup_process", "paper.toml"} <= completed(f"robomill {verb} paper")
    assert not completed(f"robomill {verb} al70")


@pytest.mark.parametrize("verb", VERBS)
def test_every_option_of_a_verb_is_offered(verb: str) -> None:
    taken = {option for action in VERBS[verb]._actions for option in action.option_strings if option[:2] == "--"}
    assert completed(f"robomill {verb} --") == taken


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("identify slavkovic_5r nine_points --model joints+b", {"joints+bending", "joints+bending+tool"}),
        ("identify slavkovic_5r nine_points --fit-points ", {"none", "force", "gauge", "both"}),
        ("identify slavkovic_5r nine_points --weights ", {"equal", "size"}),
        ("identify slavkovic_5r nine_points --leave-out ", {"pose", "neighbours"}),
        ("gcode heart --dialect s", {"sinumerik"}),
        ("grade answers --robot slav", {"slavkovic_5r"}),
        ("gcode heart --dialect ", {"auto", "linuxcnc", "fanuc", "grbl", "sinumerik", "heidenhain"}),
        ("pose slavkovic_5r --compliance-set ", {"table_2", "table_3"}),
        ("simulate paper_flute --compliance-set table_3", {"table_3"}),
        ("map slavkovic_5r --quantity det", {"det_J"}),
        ("map slavkovic_5r --quantity C_yy,det", {"C_yy,det_J"}),
        ("pose not_a_robot --compliance-set ", set()),
    ],
)
def test_shells_complete_the_words_of_an_option_and_no_files(line, words, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "some_file.nc").write_text("")
    assert completed(f"robomill {line}") == words


@pytest.mark.parametrize("shell", SHELLS)
def test_each_shell_gets_a_script_that_asks_robomill(shell: str, capsys) -> None:
    assert main(["completion", shell]) == 0
    said = capsys.readouterr().out
    assert "robomill" in said
    assert "_ARGCOMPLETE" in said


def test_a_shell_that_asks_is_answered_before_anything_else(tmp_path: Path) -> None:
    answer = tmp_path / "answer"
    told = {"_ARGCOMPLETE": "1", "_ARGCOMPLETE_IFS": "\n", "_ARGCOMPLETE_STDOUT_FILENAME": str(answer)}
    told |= {"COMP_LINE": "robomill simulate hea", "COMP_POINT": "21", "COMP_TYPE": "9", "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "robomill", "simulate", "hea"]
    subprocess.run(command, env={**os.environ, **told}, cwd=tmp_path, timeout=60, check=True)
    assert answer.read_text().split() == ["heart"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["SIMULATE", "paper_flute"], "there is no 'SIMULATE'; did you mean 'simulate'?"),
        (["simulat", "paper_flute"], "did you mean 'simulate'?"),
        (["simulate", "paper_flute", "--tol", "0,1"], "expected a number, found '0,1'; write 0.1"),
        (["simulate", "paper_flute", "--tol", "0.1mm"], "expected a number, found '0.1mm'"),
    ],
)
def test_what_is_typed_wrongly_is_told_in_words(words: list[str], said: str, capsys) -> None:
    with pytest.raises(SystemExit) as ended:
        make_parser().parse_args(words)
    assert ended.value.code == 2
    assert said in capsys.readouterr().err


def test_a_tolerance_goes_by_one_name_in_every_verb() -> None:
    parse = make_parser().parse_args
    for option in ("--tol", "--tolerance-mm"):
        assert parse(["simulate", "paper_flute", option, "0.2"]).tol == 0.2
        assert parse(["design", "paper_flute", option, "0.2"]).tolerance_mm == 0.2


def test_what_help_states_of_libraries_is_what_they_declare() -> None:
    """The parser loads none of them, so that help and completion are quick; defaults in words, too."""
    from inspect import signature

    from robomill.cli.design import EVERY
    from robomill.improve import compensation, design, judged, placement, screening, turning
    from robomill.io import point_tables
    from robomill.io.compensated import compensate
    from robomill.io.drawing import drawings
    from robomill.io.setups import tool_tables
    from robomill.toolpath import drawing, sketch
    from robomill.units import format_short

    def option(verb: str, name: str) -> argparse.Action:
        return next(each for each in VERBS[verb]._actions if name in each.option_strings)

    choices = {
        ("design", "--measure"): judged.MEASURES,
        ("place", "--measure"): screening.ASKED,
        ("turn", "--measure"): screening.ASKED,
        ("gcode", "--tools-unit"): tool_tables.UNITS,
        ("gcode", "--unit"): point_tables.ASKED,
        ("simulate", "--unit"): point_tables.ASKED,
        ("drawing", "--unit"): drawings.ASKED,
        ("drawing", "--origin"): drawing.ORIGINS,
    }
    for at, words in choices.items():
        assert tuple(option(*at).choices or ()) == tuple(words), at
    assert option("place", "--candidates").default == signature(placement.place).parameters["candidates"].default
    assert option("compensate", "--bound-um").default == compensation.BOUND * 1e6
    components = signature(compensate).parameters["components"].default
    assert option("compensate", "--components").default == ",".join(components)
    own = sketch.Sketch()
    for at, words in {
        ("place", "--candidates"): option("place", "--candidates").default,
        ("place", "--room"): placement.ROOM,
        ("design", "--most"): format_short(design.STIFFEST, "1"),
        ("design", "--every"): f"{EVERY:g}",
        ("turn", "--rate"): format_short(turning.RATE, "deg/mm").removesuffix("°/mm").strip(),
        ("drawing", "--plunge"): format_short(own.v_plunge, "mm/min").removesuffix(" mm/min"),
        ("drawing", "--clearance"): format_short(own.clearance, "mm").removesuffix(" mm"),
    }.items():
        assert (option(*at).help or "").endswith(f"({words})"), at
