"""Compiled kernels are what their Python says, are kept on disk, and heal; nothing imports the compiler too soon."""

import importlib
import io
import os
import pickle
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from numba.core import caching

from robomill import compiled, seals

SOURCE = """
from __future__ import annotations
from robomill.compiled import In2, Out1, kernel, part
from scale_of_sums import Scale

@part
def times(x, scale, i):
    return x * scale.by[i] if scale.on[i] else x

@kernel
def total(p: In2, scale: Scale, shift: tuple[float, float], count: int, out: Out1) -> float:
    whole = 0.0
    for i in range(count):
        out[i] = times(p[i, 0] + p[i, 1], scale, i) + shift[0] * shift[1]
        whole += out[i]
    return whole
"""
SCALE = """
from __future__ import annotations
from typing import NamedTuple
from robomill.compiled import In1, InBool1

class Scale(NamedTuple):
    by: In1
    on: InBool1
"""
P, BY = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]), np.array([10.0, 100.0, 1000.0])
ON = np.array([True, False, True])
for array in (BY, ON):
    array.flags.writeable = False
EXPECTED = [30.0 + 6.0, 7.0 + 6.0, 11_000.0 + 6.0]


@pytest.fixture(scope="module", autouse=True)
def _scale(tmp_path_factory):
    place = tmp_path_factory.mktemp("scale")
    (place / "scale_of_sums.py").write_text(SCALE)
    sys.path.insert(0, str(place))
    importlib.import_module("scale_of_sums")
    yield
    sys.path.remove(str(place))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "sums_kernels.py").write_text(SOURCE)
    kept = tmp_path / "kept"
    kept.mkdir()
    monkeypatch.setattr(compiled, "kept_in", lambda: kept)
    monkeypatch.setattr(compiled, "_kept", True)
    compiled._heal.cache_clear()
    monkeypatch.syspath_prepend(tmp_path)
    return kept


def result():
    """What a freshly imported copy of the module answers."""
    sys.modules.pop("sums_kernels", None)
    module = importlib.import_module("sums_kernels")
    out = np.empty(3)
    whole = module.total(P, module.Scale(BY, ON), (2.0, 3.0), 3, out)
    assert whole == pytest.approx(sum(EXPECTED))
    return out, module.total


def test_a_kernel_computes_what_its_python_says_and_is_kept(folder):
    np.testing.assert_allclose(result()[0], EXPECTED)
    kept = sorted(folder.rglob("*.nb?"))
    assert [file.suffix for file in kept] == [".nbc", ".nbi"]
    times = [file.stat().st_mtime_ns for file in kept]
    out, total = result()
    assert sum(total.code.stats.cache_hits.values()) == 1
    assert [file.stat().st_mtime_ns for file in kept] == times
    np.testing.assert_allclose(out, EXPECTED)


def flipped(data):
    """One byte in the middle of the code is another: nothing that the reading of it would notice."""
    return data[: len(data) // 2] + bytes([data[len(data) // 2] ^ 255]) + data[len(data) // 2 + 1 :]


DAMAGES = {
    "empty": lambda data: b"",
    "no pickle": lambda data: b"not a pickle",
    "cut short": lambda data: data[:-40],
    "flipped": flipped,
    "longer": lambda data: data + b"more",
}


@pytest.mark.parametrize("suffix", [".nbi", ".nbc", seals.SEAL])
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_cache_heals_and_says_that_it_compiles(folder, suffix, damage, monkeypatch):
    result()
    (file,) = folder.rglob(f"*{suffix}")
    file.write_bytes(DAMAGES[damage](file.read_bytes()))
    said = []
    monkeypatch.setattr(compiled, "_announced", [said.append])
    monkeypatch.setattr(compiled, "missing", lambda: ())  # it was whole when the program began
    np.testing.assert_allclose(result()[0], EXPECTED)
    assert said == [compiled.WORDS]
    _, total = result()
    assert sum(total.code.stats.cache_hits.values()) == 1
    assert len(said) == 1


@pytest.mark.parametrize("suffix", [".nbi", ".nbc", seals.SEAL])
def test_what_is_lost_or_cannot_be_read_is_made_again(folder, suffix):
    for lose in (Path.unlink, lambda file: (file.unlink(), file.mkdir())):
        result()
        (file,) = folder.rglob(f"*{suffix}")
        lose(file)
        np.testing.assert_allclose(result()[0], EXPECTED)
        assert file.is_file()
        assert sum(result()[1].code.stats.cache_hits.values()) == 1


def test_code_of_another_processor_is_not_run(folder):
    """Another processor's entry under this one's name: the compiler's own index knows for what it compiled."""
    result()
    (index,) = folder.rglob("*.nbi")
    version, rest = pickletools_split(index.read_bytes())
    stamp, overloads = pickle.loads(rest)
    ((signature, (triple, _, features), codes), name) = next(iter(overloads.items()))
    foreign = {(signature, (triple, "another", features), codes): name}
    index.write_bytes(version + pickle.dumps((stamp, foreign)))
    seals.seal(folder, sys.modules["sums_kernels"].total.plain)
    out, total = result()
    np.testing.assert_allclose(out, EXPECTED)
    assert sum(total.code.stats.cache_hits.values()) == 0
    assert sum(result()[1].code.stats.cache_hits.values()) == 1


def pickletools_split(data):
    """The first pickle of ``data``, and what follows it."""
    stream = io.BytesIO(data)
    pickle.load(stream)
    return data[: stream.tell()], data[stream.tell() :]


def test_damage_is_found_before_it_is_needed_and_its_module_counts_as_missing(folder, monkeypatch):
    result()
    names = ("robomill.a.other_kernels", f"x.{folder.parent.name}.sums_kernels")
    monkeypatch.setattr(compiled, "modules", lambda: names)
    (folder / compiled.COMPLETE).write_text("\n".join(names))
    assert compiled.missing() == ()
    (file,) = folder.rglob("*.nbc")
    file.write_bytes(flipped(file.read_bytes()))
    assert compiled.missing() == ()  # looked for once a process
    compiled._heal.cache_clear()
    assert compiled.missing() == names[1:]
    assert not list(folder.rglob("*.nb?"))


@pytest.mark.parametrize("fault", ["full", "shut"])
def test_where_nothing_can_be_kept_code_lives_in_memory_and_that_is_said_once(folder, fault, monkeypatch, caplog):
    def refuse(*_):
        raise OSError(28, "No space left on device")

    place = (caching.IndexDataCacheFile, "_open_for_write")
    monkeypatch.setattr(*(place if fault == "full" else (caching._CacheLocator, "ensure_cache_path")), refuse)
    for _ in range(3):
        np.testing.assert_allclose(result()[0], EXPECTED)
    (record,) = [record for record in caplog.records if record.name == "robomill"]
    assert "cannot be kept" in record.getMessage()
    assert compiled.missing() == ()


def test_two_threads_that_ask_at_the_same_moment_make_one_code(folder, monkeypatch):
    sys.modules.pop("sums_kernels", None)
    total = importlib.import_module("sums_kernels").total
    asked, made = threading.Barrier(2), []

    def slowly(function, keep=True):
        made.append(function)
        time.sleep(0.05)  # whoever did not wait is here by now
        return len(made)

    monkeypatch.setattr(compiled, "_compile", slowly)

    def ask():
        asked.wait()
        return total.code

    with ThreadPoolExecutor(2) as pool:
        answers = [future.result() for future in [pool.submit(ask), pool.submit(ask)]]
    assert answers == [1, 1]
    assert total.code == 1


def test_every_kernel_module_is_found_and_none_is_imported_by_the_core():
    names = compiled.modules()
    assert "robomill.kinematics.kernels" in names
    assert all(name.startswith("robomill.") for name in names)
    core = ["kinematics.inverse", "compliance.cartesian", "workspace.fields", "simulation.run"]
    code = "import sys; " + "; ".join(f"import robomill.{name}" for name in core) + "; print('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "False"


def test_the_word_is_said_once_and_only_where_something_is_missing(folder, monkeypatch):
    said = []
    monkeypatch.setattr(compiled, "_announced", [said.append])
    monkeypatch.setattr(compiled, "_tried", False)
    monkeypatch.setattr(compiled, "build", lambda: said.append("built"))
    (folder / compiled.COMPLETE).write_text("\n".join(compiled.modules()))
    assert compiled.missing() == ()
    result()
    assert said == []
    (folder / compiled.COMPLETE).unlink()
    assert compiled.missing() == compiled.modules()
    result()
    assert said == [compiled.WORDS, "built"]
    monkeypatch.setattr(compiled, "_tried", True)
    result()
    assert len(said) == 2


def test_building_compiles_in_another_process_and_notes_it(tmp_path, monkeypatch):
    """Here into a package of one small kernel."""
    package = tmp_path / "robomill"
    (package / "room").mkdir(parents=True)
    for name in ("compiled.py", "seals.py", "arrays.py", "errors.py", "lazy.py"):
        (package / name).write_text((compiled.PACKAGE / name).read_text())
    (package / "__init__.py").write_text("")
    (package / "room" / "__init__.py").write_text("")
    (package / "room" / "kernels.py").write_text(
        "from robomill.compiled import kernel\n@kernel\ndef twice(x: float) -> float:\n    return 2.0 * x\n"
    )
    code = (
        "import sys; from robomill import compiled; before = compiled.missing(); compiled.build()\n"
        "assert 'numba' not in sys.modules\n"
        "print(before, compiled.missing(), len(list(compiled.kept_in().rglob('*.nbc'))))\n"
        "from robomill.room.kernels import twice; print(twice(4.0), sum(twice.code.stats.cache_hits.values()))"
    )
    env = {**os.environ, "PYTHONPATH": str(tmp_path)}
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, env=env)
    assert found.stdout.split("\n")[:2] == ["('robomill.room.kernels',) () 1", "8.0 1"], found.stderr


def test_one_module_is_built_in_another_process_and_the_others_stay_missing(tmp_path):
    package = tmp_path / "robomill"
    (package / "room").mkdir(parents=True)
    for name in ("compiled.py", "seals.py", "arrays.py", "errors.py", "lazy.py"):
        (package / name).write_text((compiled.PACKAGE / name).read_text())
    for place in (package, package / "room"):
        (place / "__init__.py").write_text("")
    for name, factor in (("kernels.py", 2.0), ("other_kernels.py", 3.0)):
        source = (
            f"from robomill.compiled import kernel\n@kernel\ndef times(x: float) -> float:\n    return {factor} * x\n"
        )
        (package / "room" / name).write_text(source)
    code = (
        "import sys; from robomill import compiled; compiled.build('robomill.room.kernels')\n"
        "assert 'numba' not in sys.modules\n"
        "print(compiled.missing())\n"
        "from robomill.room.kernels import times; print(times(4.0), sum(times.code.stats.cache_hits.values()))\n"
        "compiled.build(); print(compiled.missing())"
    )
    env = {**os.environ, "PYTHONPATH": str(tmp_path)}
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, env=env)
    assert found.stdout.split("\n")[:3] == ["('robomill.room.other_kernels',)", "8.0 1", "()"], found.stderr


@pytest.fixture
def fresh(monkeypatch):
    compiled.kept_in.cache_clear()
    monkeypatch.setattr(compiled.seals, "key", lambda sources: "key")
    yield
    monkeypatch.undo()
    compiled.kept_in.cache_clear()


def test_where_the_package_cannot_be_written_the_users_cache_serves(tmp_path, monkeypatch, fresh):
    shut, home = tmp_path / "shut", tmp_path / "home"
    monkeypatch.setattr(compiled, "_roots", lambda: iter([shut, home]))
    real = compiled._own
    monkeypatch.setattr(compiled, "_own", lambda folder: shut not in folder.parents and real(folder))
    assert compiled.kept_in() == home / "kernels-key"
    assert not list((home / "kernels-key").iterdir())
    # What the installer compiled there is taken along.
    compiled.kept_in.cache_clear()
    (shut / "kernels-key").mkdir(parents=True)
    (shut / "kernels-key" / compiled.COMPLETE).write_text("all")
    assert (compiled.kept_in() / compiled.COMPLETE).read_text() == "all"
    assert compiled.kept_in() == home / "kernels-key"


def test_where_nothing_can_be_written_a_temporary_folder_serves_and_its_child_finds_it(monkeypatch, fresh):
    monkeypatch.setenv(compiled.PLACE, "")
    real = compiled._roots
    shut = list(real())
    own = compiled._own
    monkeypatch.setattr(compiled, "_own", lambda folder: folder.parent not in shut and own(folder))
    folder = compiled.kept_in()
    assert folder.is_dir()
    assert next(real()) == folder.parent


def test_where_not_even_a_temporary_folder_can_be_written_there_is_none(monkeypatch, fresh, caplog):
    monkeypatch.setattr(compiled, "_kept", True)
    monkeypatch.setattr(compiled, "_own", lambda folder: False)
    assert compiled.kept_in() is None
    assert compiled.missing() == ()
    assert len(caplog.records) == 1


def test_a_full_disk_is_seen_though_it_makes_empty_files(tmp_path, monkeypatch):
    class Full(io.BytesIO):
        def write(self, data):
            raise OSError(28, "No space left on device")

    assert compiled._own(tmp_path / "room")
    monkeypatch.setattr(compiled.tempfile, "TemporaryFile", lambda **_: Full())
    assert not compiled._own(tmp_path / "room")


def test_only_a_few_older_folders_are_kept(tmp_path):
    folders = [tmp_path / f"kernels-{i}" for i in range(9)]
    for i, folder in enumerate(folders):
        folder.mkdir()
        os.utime(folder, (i, i))
    compiled._forget_older(folders[0])
    left = sorted(path.name for path in tmp_path.iterdir())
    assert left == ["kernels-0", "kernels-5", "kernels-6", "kernels-7", "kernels-8"]


def test_the_digest_covers_every_source(tmp_path, monkeypatch):
    room = tmp_path / "room"
    room.mkdir()
    first, second = room / "kernels.py", room / "more_kernels.py"
    first.write_text("a")
    second.write_text("b")
    (room / "other.py").write_text("c")
    monkeypatch.setattr(compiled, "PACKAGE", tmp_path)
    assert [Path(name).suffix for name in compiled.modules()] == [".kernels", ".more_kernels"]
    before = compiled.seals.key(compiled._made_from())
    (room / "other.py").write_text("d")
    assert compiled.seals.key(compiled._made_from()) == before
    second.write_text("e")
    assert compiled.seals.key(compiled._made_from()) != before
    # What a kernel module takes from the package counts too: a constant is compiled in.
    second.write_text("from robomill.room.other import LIMIT")
    before = compiled.seals.key(compiled._made_from())
    (room / "other.py").write_text("LIMIT = 2")
    assert compiled.seals.key(compiled._made_from()) != before
    # And what rules take, which are compiled too.
    (room / "some_rules.py").write_text("from robomill.room.law import turned")
    (room / "law.py").write_text("def turned(): ...")
    before = compiled.seals.key(compiled._made_from())
    (room / "law.py").write_text("def turned(): return 1")
    assert compiled.seals.key(compiled._made_from()) != before


@pytest.mark.parametrize("name", ["slavkovic_5r", "kuka_kr500"])
def test_few_rows_run_as_python_where_no_compiler_is_loaded(name):
    """The same source either way: pose, Jacobian, compliance and inverse kinematics agree to rounding."""
    code = f"""
import sys
import numpy as np
import robomill as rm

robot = rm.load_robot({name!r})
theta = np.random.default_rng(3).uniform(*robot.limits.T, (8, robot.n))

def answers(theta):
    T_MT = rm.tool_pose(robot, theta)
    found = rm.inverse_kinematics(robot, T_MT, spin="fixed").theta
    return T_MT, rm.geometric_jacobian(robot, theta), rm.cartesian_compliance(robot, theta), found

few = answers(theta)
print("numba" in sys.modules)
many = answers(np.repeat(theta, 2, axis=0))
print("numba" in sys.modules)
for a, b in zip(few, many):
    np.testing.assert_allclose(a, b[::2], rtol=1e-12, atol=1e-12)
"""
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert found.stdout.split() == ["False", "True"], found.stderr
    assert found.returncode == 0, found.stderr


def test_processes_that_would_each_compile_wait_for_one_build_that_is_announced(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    said: list[str] = []
    for name, value in (
        ("missing", lambda: ("some.kernels",)),
        ("build", lambda: said.append("built")),
        ("_tried", False),
        ("_announced", [said.append]),
    ):
        monkeypatch.setattr(compiled, name, value)
    compiled.prepare()
    assert said == [compiled.WORDS, "built"]
