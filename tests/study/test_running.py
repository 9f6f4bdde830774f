"""Studies against a plain loop; stopped and gone on with, to the last digit; what is refused and what fails."""

import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import robomill as rm
from robomill.errors import StudyError
from robomill.progress import Cancelled, Progress, watched
from robomill.study import local
from robomill.study.kept import Kept, Row

pq = pytest.importorskip("pyarrow.parquet")

COARSE = rm.load_setup("paper_flute").replace(step=20e-3, cell=8e-4)
KEY = "robot.joint[2].a_mm"


def drawn(count: int = 12, seed: int = 5) -> rm.Study:
    return rm.load_study(
        {
            "setup": COARSE,
            "design": {"kind": "sobol", "points": count, "seed": seed},
            "parameters": {
                KEY: {"distribution": "normal", "mean": 1220.0, "std": 2.0},
                "force.feed_normal_N": {"low": 50.0, "high": 150.0},
            },
            "responses": ["max_deviation_mm", "wall_mm", "share", "verdict"],
        }
    )


def test_rows_are_what_a_plain_loop_over_simulate_gives(tmp_path: Path) -> None:
    study = drawn()
    found = rm.run_study(study, tmp_path / "out", processes=2)
    assert (found.done, found.failed, found.resumed) == (12, 0, 0)
    columns = found.columns()
    for k, (a, force) in enumerate(study.points):
        lengths = COARSE.robot.a.copy()
        lengths[1] = a * 1e-3
        run = rm.simulate(COARSE.replace(robot=COARSE.robot.replace(a=lengths), force=rm.PathForce(feed_normal=force)))
        assert columns["max_deviation_mm"][k] == pytest.approx(run.max_deviation * 1e3, rel=1e-12)
        assert columns["wall_mm"][k] == pytest.approx(run.verdict.wall.value * 1e3, rel=1e-9)
        assert columns["verdict"][k] == run.verdict.level
    table = pq.read_table(tmp_path / "out" / "results.parquet").to_pydict()
    assert table["share"] == columns["share"].tolist()
    assert table[KEY] == [point[0] for point in study.points]


def test_a_killed_study_goes_on_to_the_same_file(tmp_path: Path) -> None:
    """The process is killed, as by a power cut, once some points are written; the others are computed then."""
    study = drawn(160)
    text = f"""
import robomill as rm
from pathlib import Path
setup = rm.load_setup("paper_flute").replace(step=20e-3, cell=8e-4)
rm.run_study({{
    "setup": setup,
    "design": {{"kind": "sobol", "points": 160, "seed": 5}},
    "parameters": {{
        "{KEY}": {{"distribution": "normal", "mean": 1220.0, "std": 2.0}},
        "force.feed_normal_N": {{"low": 50.0, "high": 150.0}},
    }},
    "responses": ["max_deviation_mm", "wall_mm", "share", "verdict"],
}}, {str(tmp_path / "killed")!r}, processes=1)
"""
    process = subprocess.Popen(
        [sys.executable, "-c", text], env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    )
    parts, end = tmp_path / "killed" / "parts", time.monotonic() + 60.0
    while not list(parts.glob("[!.]*.parquet")) and time.monotonic() < end:
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.wait()
    (parts / ".half.part.parquet").write_bytes(b"PAR1")  # what is cut off in the middle of being written
    there = len(Kept(tmp_path / "killed", study).opened())
    assert 0 < there < 160
    resumed = rm.run_study(study, tmp_path / "killed")
    whole = rm.run_study(study, tmp_path / "whole", processes=2)
    assert (resumed.resumed, resumed.done, whole.resumed) == (there, 160, 0)
    assert resumed == whole
    both = [(tmp_path / name / "results.parquet").read_bytes() for name in ("killed", "whole")]
    assert both[0] == both[1]


def test_a_script_needs_no_guard(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "import robomill as rm\n"
        'study = {"setup": "paper_flute", "parameters": {"tolerance_mm": {"values": [0.2, 0.3]}}}\n'
        'print(rm.run_study(study, "out").done)\n'
    )
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    said = subprocess.run([sys.executable, script], cwd=tmp_path, env=env, capture_output=True, text=True, check=True)
    assert said.stdout == "2\n"


def test_points_that_fail_keep_their_reason_and_the_others_go_on(tmp_path: Path) -> None:
    study = rm.load_study(
        {"setup": COARSE, "parameters": {"cutter.diameter_mm": {"values": [8.0, -1.0, 6.0]}}, "responses": ["share"]}
    )
    found = rm.run_study(study, tmp_path)
    assert (found.done, found.failed) == (2, 1)
    assert "Diameter" in found.rows[1].reason
    assert np.isnan(found.columns()["share"]).tolist() == [False, True, False]
    again = rm.run_study(study, tmp_path)
    assert again.resumed == 3
    assert again == found


def test_a_point_that_is_not_reached_is_an_answer(tmp_path: Path) -> None:
    study = rm.load_study({"setup": COARSE, "parameters": {"part.zero_mm[2]": {"values": [-1300.0, -9000.0]}}})
    found = rm.run_study(study, tmp_path)
    assert found.columns()["verdict"].tolist() == ["ok", "unreached"]
    assert np.isnan(found.columns()["max_deviation_mm"][1])


def test_another_study_in_the_folder_is_refused(tmp_path: Path) -> None:
    rm.run_study(drawn(2), tmp_path)
    with pytest.raises(StudyError, match="this folder holds another study"):
        rm.run_study(drawn(2, seed=6), tmp_path)
    (tmp_path / "study.json").write_text("{}")
    with pytest.raises(StudyError, match="does not say which study"):
        rm.run_study(drawn(2), tmp_path)


def test_a_full_disk_loses_nothing_that_was_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study = drawn(6)
    Kept(tmp_path, study).opened()
    Kept(tmp_path, study).add(rm.run_study(study, tmp_path / "other").rows[:2])
    write = pq.write_table

    def full(table: object, place: object) -> None:
        Path(str(place)).write_bytes(b"PAR1")
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(pq, "write_table", full)
    with pytest.raises(StudyError, match="No space left on device.*what was finished before is kept"):
        rm.run_study(study, tmp_path)
    monkeypatch.setattr(pq, "write_table", write)
    found = rm.run_study(study, tmp_path)
    assert (found.resumed, found.done) == (2, 6)


def test_cancelled_work_is_kept(tmp_path: Path) -> None:
    study, seen = drawn(40), []

    def say(now: Progress) -> None:
        seen.append((now.stage, now.share, now.beside))

    with pytest.raises(Cancelled), watched(Progress(stop=lambda: len(seen) > 8 and seen[-1][1] > 0.1, say=say)):
        rm.run_study(study, tmp_path, processes=1)
    there = len(Kept(tmp_path, study).opened())
    assert 4 <= there < 40
    assert any("a second" in beside and "left" in beside for _, _, beside in seen)
    assert rm.run_study(study, tmp_path).resumed == there


def test_a_point_that_ends_its_process_twice_fails_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    study = drawn(3)
    task = local.Task(study.data, tuple(study.keys), study.responses)
    program = "import json, os, sys\nsys.stdin.readline()\nfor line in sys.stdin:\n p, v = json.loads(line)\n"
    program += " os.abort() if p == 1 else print(json.dumps([p, [0, 0, 0, 'ok'], '']), flush=True)\n"
    popen = subprocess.Popen
    monkeypatch.setattr(local.subprocess, "Popen", lambda words, **more: popen([sys.executable, "-c", program], **more))
    rows = [row for some in local.run_locally(task, study.points, [0, 1, 2], 1) for row in some or ()]
    assert {row.point: bool(row.reason) for row in rows} == {0: False, 1: True, 2: False}
    assert next(row.reason for row in rows if row.reason).endswith("ended (signal 6), twice.")


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"out": ""}, "expected the name of a folder"),
        ({"processes": 0}, "processes is 0; expected a whole number from 1"),
        ({"scheduler": "localhost"}, "the scheduler is 'localhost'; expected its address"),
    ],
)
def test_what_cannot_be_is_refused(given: dict, words: str, tmp_path: Path) -> None:
    with pytest.raises(StudyError, match=words):
        rm.run_study(drawn(1), **{"out": tmp_path, **given})


def test_a_part_that_is_damaged_is_named(tmp_path: Path) -> None:
    study = drawn(2)
    Kept(tmp_path, study).opened()
    (tmp_path / "parts" / "x.parquet").write_bytes(b"nothing")
    with pytest.raises(StudyError, match="this part cannot be read .* delete it"):
        rm.run_study(study, tmp_path)


def test_rows_of_later_parts_stand_in_their_place(tmp_path: Path) -> None:
    kept = Kept(tmp_path, drawn(2))
    kept.opened()
    kept.add([Row(1, (1.0, 2.0, 3.0, "ok"))])
    kept.add([Row(0, (4.0, 5.0, 6.0, "out"))])
    assert kept.opened() == {1: Row(1, (1.0, 2.0, 3.0, "ok")), 0: Row(0, (4.0, 5.0, 6.0, "out"))}
