"""The compiled path never makes anyone wait who did not ask for it, and falls back in the open."""

import time

import numpy as np
import pytest

from robomill.compiled import cache_folder
from robomill.cutting.tool import Cutter
from robomill.errors import SurfaceError
from robomill.surface import compiler
from robomill.surface.stock import Stock
from robomill.surface.zmap import cut


def test_small_work_does_not_load_anything(monkeypatch):
    monkeypatch.setattr(compiler, "_ready", None)
    monkeypatch.setattr(compiler, "_thread", None)
    assert compiler.kernels("auto", 0.1) is None
    assert compiler._thread is None


def test_warm_up_returns_at_once_and_is_ready_after_waiting():
    start = time.perf_counter()
    compiler.warm_up()
    assert time.perf_counter() - start < 0.5
    assert compiler.warm_up(wait=True)
    assert compiler.kernels("auto") is compiler.kernels("compiled")
    assert compiler.kernels("numpy") is None


def test_a_compiler_that_fails_leaves_numpy(monkeypatch):
    monkeypatch.setattr(compiler, "_ready", None)
    monkeypatch.setattr(compiler, "_thread", None)
    monkeypatch.setattr(compiler, "_failed", None)

    def broken(found):
        raise OSError("no place for compiled code")

    monkeypatch.setattr(compiler, "_exercise", broken)
    assert not compiler.warm_up(wait=True)
    assert compiler.kernels("auto", 100.0) is None
    assert "no place for compiled code" in compiler.status()
    with pytest.raises(RuntimeError, match="could not be loaded"):
        compiler.kernels("compiled")


def test_numpy_can_be_insisted_on(monkeypatch):
    monkeypatch.setenv("ROBOMILL_NUMPY", "1")
    monkeypatch.setattr(compiler, "_ready", None)
    assert not compiler.warm_up(wait=True)
    assert compiler.kernels("auto", 100.0) is None
    assert compiler.status() in ("numpy", "compiling")


def test_the_cache_knows_every_source():
    folder = cache_folder(compiler.SOURCES)
    assert folder is not None
    assert cache_folder(compiler.SOURCES[:1]) != folder


def test_axes_are_checked():
    stock, p = Stock((0, 0, -0.01), (0.02, 0.02, 0)), np.array([[0, 0.01, -0.001], [0.02, 0.01, -0.001]])
    for k in ([0.0, 0.0, 2.0], [0.0, 0.0, 0.0], [0.0, np.nan, 1.0], [[0.0, 0.0, 1.0]] * 3):
        with pytest.raises(SurfaceError, match="tool axis|Tool axis"):
            cut(stock, 1e-3, Cutter("flat", 0.008), p, k)
