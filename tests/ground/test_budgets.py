"""How much memory there is, as the system, its limits or the owner say; and what work may take of it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np
import pytest

from robomill import budgets
from robomill.errors import RobomillError


@pytest.fixture(autouse=True)
def _fresh() -> Iterator[None]:
    budgets.memory.cache_clear()
    yield
    budgets.memory.cache_clear()


def test_the_owner_says_how_much_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(budgets.PLACE, "2.5")
    assert budgets.memory() == int(2.5 * 2**30)
    for share in (budgets.cells() * budgets.CELL, budgets.map_bytes(), budgets.kept_results()):
        assert 0 < share < budgets.memory() / 4


def test_never_more_than_the_machine_has(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(budgets.PLACE, raising=False)
    pages = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    assert budgets.LEAST <= budgets.memory() <= max(budgets.LEAST, min(1.01 * pages, budgets.MOST))


def test_a_limit_of_the_process_counts() -> None:
    code = (
        "import resource; resource.setrlimit(resource.RLIMIT_AS, (3 << 30, 3 << 30))\n"
        "from robomill import budgets; print(budgets.memory() <= 3 << 30)"
    )
    env = {key: value for key, value in os.environ.items() if key != budgets.PLACE}
    assert subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True).stdout == "True\n"


@pytest.mark.parametrize("nonsense", ["", "much", "nan", "-3", "0", "1e400"])
def test_nonsense_of_the_owner_is_not_taken(monkeypatch: pytest.MonkeyPatch, nonsense: str) -> None:
    monkeypatch.setenv(budgets.PLACE, nonsense)
    assert budgets.LEAST <= budgets.memory() <= budgets.MOST


def test_what_is_too_large_is_refused_with_what_fits_and_that_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    import robomill as rm
    from robomill.simulation.samples import sampled
    from robomill.surface.stock import stock_grid
    from robomill.units import to_si

    monkeypatch.setenv(budgets.PLACE, "2")
    setup = rm.load_setup("samples/paper_flute")
    with pytest.raises(RobomillError, match=r"0\.012 mm needs .* million cells") as refused:
        setup.replace(cell=0.012e-3)
    fits = to_si(float(str(refused.value).split("so use ")[1].split(" mm")[0]), "mm")
    cells = stock_grid(setup.stock_block, fits)
    assert 0.9 * budgets.cells() < cells.nx * cells.ny <= budgets.cells()
    with pytest.raises(RobomillError, match="points; at most") as refused:
        rm.simulate(setup.replace(step=3e-8))
    fits = to_si(float(str(refused.value).split("so use ")[1].split(" mm")[0]), "mm")
    assert 0.8 * budgets.samples() < len(sampled(setup.toolpath, fits)) <= budgets.samples()


def test_steps_that_are_marched_take_more_so_fewer_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    import robomill as rm
    from robomill.simulation.samples import sampled

    setup = rm.load_setup("samples/paper_flute/setup_process.toml")
    assert setup.engagement
    monkeypatch.setattr(budgets, "samples", lambda marched=False: 200 if marched else 10_000)
    with pytest.raises(RobomillError, match="at most 200 fit, so use") as refused:
        rm.simulate(setup.replace(step=1e-4))
    fits = float(str(refused.value).split("so use ")[1].split(" mm")[0]) * 1e-3
    assert len(sampled(setup.toolpath, fits)) <= 200


@pytest.mark.slow
def test_what_is_let_in_finds_room_under_the_limit_of_the_process() -> None:
    """A process that may have 1.5 GiB of addresses runs the finest step and the finest cells that it lets in."""
    code = (
        "import resource; resource.setrlimit(resource.RLIMIT_AS, (3 << 29, 3 << 29))\n"
        "import robomill as rm; from robomill import budgets\n"
        "setup = rm.load_setup('samples/paper_flute'); cells = budgets.cells()\n"
        "x, y, _ = setup.stock_block.size\n"
        "for some in ({'step': 0.1 / (0.95 * budgets.samples())}, {'cell': (x * y / (0.95 * cells)) ** 0.5}):\n"
        "    result = rm.simulate(setup.replace(**some)); print(len(result.path), result.machined.z.size)\n"
    )
    env = {key: value for key, value in os.environ.items() if key != budgets.PLACE}
    ran = subprocess.run(
        [sys.executable, "-c", code], env=env | {"OPENBLAS_NUM_THREADS": "1"}, capture_output=True, text=True
    )
    assert ran.returncode == 0, ran.stderr
    (samples, _), (_, cells) = (map(int, line.split()) for line in ran.stdout.splitlines())
    assert samples > 100_000
    assert cells > 1_200_000


def test_no_more_cores_than_the_process_may_run_on():
    """Told to a process that may run on one core only."""
    alone = "import os; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})"
    code = f"{alone}; from robomill import budgets; print(budgets.cores())"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "1"


def system(monkeypatch: pytest.MonkeyPatch, files: dict[str, str]) -> None:
    """A system whose files say this and no more."""

    def path(name: str) -> SimpleNamespace:
        def read_text() -> str:
            if name not in files:
                raise FileNotFoundError(name)
            return files[name]

        return SimpleNamespace(read_text=read_text)

    monkeypatch.setattr(budgets, "Path", path)
    monkeypatch.delenv(budgets.PLACE, raising=False)
    budgets.memory.cache_clear()
    budgets.cores.cache_clear()


@pytest.mark.parametrize(
    ("machine", "container", "counted"),
    [
        (8, None, 8),
        (8, "max", 8),
        (8, 2, 2),
        (8, 16, 8),
        (0.5, None, 1),
        (8, 0.25, 1),
        (256, None, 64),
        (None, None, 4),
    ],
)
@pytest.mark.parametrize("file", ["/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"])
def test_the_least_of_what_machine_and_container_have_counts(monkeypatch, machine, container, counted, file) -> None:
    """In GiB; believed from one to sixty-four, and four where nothing is said."""
    files = {}
    if machine is not None:
        files["/proc/meminfo"] = f"MemFree: 17 kB\nMemTotal:  {int(machine * 2**20)} kB\nMemAvailable: 9 kB\n"
    if container is not None:
        files[file] = container if isinstance(container, str) else f"{int(container * 2**30)}\n"
    system(monkeypatch, files)
    monkeypatch.setattr("resource.getrlimit", lambda _: (-1, -1))
    assert budgets.memory() == counted * 2**30
    assert budgets.samples() == int(counted * 2**30 / 4 / budgets.SAMPLE)
    assert budgets.samples(marched=True) == int(counted * 2**30 / 4 / (budgets.SAMPLE + budgets.STEP))


@pytest.mark.parametrize(
    ("quota", "cores"), [("max 100000", 8), ("800000 100000", 8), ("150000 100000", 2), ("20000 100000", 1), ("?", 8)]
)
def test_a_container_may_have_a_share_of_the_cores(monkeypatch, quota: str, cores: int) -> None:
    monkeypatch.setattr(budgets.os, "sched_getaffinity", lambda _: set(range(8)), raising=False)
    system(monkeypatch, {"/sys/fs/cgroup/cpu.max": quota})
    assert budgets.cores() == cores
    budgets.cores.cache_clear()


@pytest.mark.parametrize(("machine", "cores"), [(6, 6), (None, 1)])
def test_where_no_process_is_bound_to_cores_the_machine_s_count(monkeypatch, machine, cores: int) -> None:
    monkeypatch.delattr(budgets.os, "sched_getaffinity", raising=False)
    monkeypatch.setattr(budgets.os, "cpu_count", lambda: machine)
    system(monkeypatch, {})
    assert budgets.cores() == cores
    budgets.cores.cache_clear()


def test_arrays_are_weighed_by_their_bytes_and_once() -> None:
    array = np.zeros((1000, 1000))
    assert budgets.weight(array) == 8_000_000
    assert 8_000_000 <= budgets.weight([array, array[::2], array.T, {"again": array}]) < 8_000_000 + 1000
    assert budgets.weight(array[:1]) == 8_000_000  # a view keeps all of its base alive
    assert budgets.weight(b"x" * 1_000_000) >= 1_000_000
