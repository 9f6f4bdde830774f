"""Which step has made what is read: readings put together from steps that are known beforehand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from robomill.arrays import FloatArray
from robomill.improve.makers import Made, made, only
from robomill.simulation.judging.gauge import Readings

STEP, APART, RADIUS = 1e-3, 6e-3, 4e-3
N = 24  # samples a pass


def passes(seed: int) -> SimpleNamespace:
    """Three passes along X, 6 mm beside each other and each way turned, every sample off by something else."""
    rng = np.random.default_rng(seed)
    x = np.arange(N) * STEP
    p = np.concatenate([np.column_stack([x[:: (-1) ** k], np.full(N, k * APART), np.zeros(N)]) for k in range(3)])
    sign = np.repeat([1.0, -1.0, 1.0], N)
    R = sign[:, None, None] * np.eye(3)
    R[:, 2, 2] = 1.0
    delta = rng.uniform(-0.3e-3, 0.3e-3, (3 * N, 3))
    removes = np.tile(np.arange(N) > 0, 3)
    return SimpleNamespace(
        path=SimpleNamespace(p=p, step_length=np.linalg.norm(np.diff(p, axis=0, prepend=p[:1]), axis=1) * removes),
        R_MF=R,
        delta=delta,
        delta_in_cut=np.einsum("mij,mj->mi", R, delta),
        removes=removes,
        tooling=SimpleNamespace(cutters=(SimpleNamespace(radius=0.5 * RADIUS), SimpleNamespace(radius=RADIUS))),
    )


def reading(run: SimpleNamespace, beside: int, normal: FloatArray, error: float) -> Readings:
    """One error beside a sample, along a normal in {M}."""
    one, rows = np.ones(1), np.zeros((1, 3))
    way = (run.R_MF[beside] @ normal)[None]
    return Readings(np.array([beside]), np.array([error]), one, one, one, way, rows, rows, one)


def between(field: FloatArray, step: int, share: float) -> FloatArray:
    return np.asarray((1.0 - share) * field[step - 1] + share * field[step])


def goes_as(found: Made, run: SimpleNamespace, normal: FloatArray, step: int, share: float) -> bool:
    """Whether the reading goes with any displacements in {M} as the place on that step does, along the normal."""
    field = np.random.default_rng(9).normal(size=run.delta.shape)
    along = found.along(np.einsum("mij,mj->mi", run.R_MF, field))
    return bool(along[0] == pytest.approx(between(field, step, share) @ normal, abs=1e-7))


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("after", [0, 1])
def test_an_error_between_the_ends_of_a_step_beside_its_sample_was_made_there(seed: int, after: int) -> None:
    run, rng = passes(seed), np.random.default_rng(seed)
    i, share = int(rng.integers(2, N - 2)) + N * (seed % 3), float(rng.uniform(0.2, 0.8))
    normal = run.delta[i + after] - run.delta[i + after - 1]
    normal /= np.linalg.norm(normal)
    error = float(between(run.delta, i + after, share) @ normal)
    if after and abs(error - between(run.delta, i, 0.5) @ normal) <= 0.5 * abs(
        (run.delta[i] - run.delta[i - 1]) @ normal
    ):
        after, low, high = 0, *(run.delta[[i - 1, i]] @ normal)  # the step to the sample itself holds it too
        share = (error - low) / (high - low)
    found = made(reading(run, i, normal, error), run)
    assert found.found.all()
    assert found.by.tolist() == [[i + after - 1, i + after]]
    assert goes_as(found, run, normal, i + after, share)


def test_an_error_of_the_sample_itself_goes_with_it() -> None:
    run, normal = passes(1), np.array([0.0, 1.0, 0.0])
    for i in (5, N + 5, 3 * N - 1):
        found = made(reading(run, i, normal, float(run.delta[i] @ normal)), run)
        assert found.found.all()
        assert goes_as(found, run, normal, i, 1.0)


@pytest.mark.parametrize("share", [0.25, 0.7])
@pytest.mark.parametrize(("beside", "step"), [(8, 2 * N - 9), (N + 6, N - 8), (N + 6, 2 * N + 17), (8, 13)])
def test_an_error_that_no_step_beside_it_knows_was_made_by_the_nearest_that_does(
    beside: int, step: int, share: float
) -> None:
    """One of another pass, within a diameter, or further on; on all others the tool is off the other way."""
    run, normal = passes(3), np.array([0.0, 1.0, 0.0])
    run.delta[:, 1] = -np.abs(run.delta[:, 1]) - 0.05e-3
    run.delta[step - 1 : step + 1, 1] = 0.1e-3, 0.2e-3
    run.delta[step + 1 : N * (step // N + 1), 1] = 0.25e-3
    run.delta_in_cut = np.einsum("mij,mj->mi", run.R_MF, run.delta)
    found = made(reading(run, beside, normal, 0.1e-3 * (1.0 + share)), run)
    assert found.found.all()
    assert found.by.tolist() == [[step - 1, step]]
    assert goes_as(found, run, normal, step, share)


def test_of_two_steps_that_know_it_the_nearer_one_has_made_it() -> None:
    run, normal = passes(3), np.array([0.0, 1.0, 0.0])
    run.delta[:, 1] = -0.1e-3
    for step in (16, 13, 2 * N - 9):  # 8, 5 and 6 mm from sample 8
        run.delta[step, 1] = 0.2e-3
    run.delta_in_cut = np.einsum("mij,mj->mi", run.R_MF, run.delta)
    found = made(reading(run, 8, normal, 0.1e-3), run)
    assert 13 in found.by[0]
    assert found.found.all()


@pytest.mark.parametrize(("ahead", "nearest"), [(0.9, 4), (0.7, 13)])
def test_the_nearer_one_is_told_by_the_place_on_it_and_not_by_its_ends(ahead: float, nearest: int) -> None:
    """0.2 of the way from sample 3 to 4, 4.8 mm behind sample 8, or 4 mm and that share ahead of it."""
    run, normal = passes(3), np.array([0.0, 1.0, 0.0])
    run.delta[:, 1] = -0.1e-3
    run.delta[4:12, 1], run.delta[12, 1] = 0.15e-3, 0.15e-3
    run.delta[3, 1] = 0.1e-3 - 0.05e-3 * 0.2 / 0.8
    run.delta[13, 1] = 0.15e-3 - 0.05e-3 / ahead
    run.delta[:3, 1] = run.delta[3, 1]
    run.delta[14:, 1] = run.delta[13, 1]
    run.delta_in_cut = np.einsum("mij,mj->mi", run.R_MF, run.delta)
    found = made(reading(run, 8, normal, 0.1e-3), run)
    assert found.by.tolist() == [[nearest - 1, nearest]]


def test_a_step_on_which_the_tool_is_off_alike_all_along_made_it_at_its_end() -> None:
    """Beside the very last sample, too, after which there is no step."""
    run, normal = passes(3), np.array([0.0, 1.0, 0.0])
    run.delta[:, 1], last = -0.1e-3, 3 * N - 1
    run.delta[last - 4 : last - 2, 1] = 0.1e-3
    run.delta_in_cut = np.einsum("mij,mj->mi", run.R_MF, run.delta)
    found = made(reading(run, last, normal, 0.1e-3), run)
    assert found.found.all()
    assert found.by.tolist() in [[[last - 4, last - 3]], [[last - 3, last - 2]]]
    assert goes_as(found, run, normal, last - 3, 1.0) or goes_as(found, run, normal, last - 2, 0.0)


@pytest.mark.parametrize("why", ["too far", "in the air", "unknown", "none"])
def test_what_no_step_within_a_diameter_explains_goes_with_its_own_sample(why: str) -> None:
    run, normal, beside = passes(3), np.array([0.0, 1.0, 0.0]), 8
    run.delta[:, 1] = -np.abs(run.delta[:, 1]) - 0.05e-3
    step = {"too far": 2 * N + 8, "in the air": 12, "unknown": 12, "none": 0}[why]
    if step:
        run.delta[step, 1] = 0.2e-3
    if why == "in the air":
        run.removes[[step, step + 1]] = False
    if why == "unknown":
        run.delta[[step - 1, step + 1]] = np.nan
    run.delta_in_cut = np.einsum("mij,mj->mi", run.R_MF, run.delta)
    found = made(reading(run, beside, normal, 0.1e-3), run)
    assert not found.found.any()
    assert goes_as(found, run, normal, beside, 1.0)


def test_some_of_the_readings_keep_all_that_is_known_of_them() -> None:
    run = passes(1)
    parts = [reading(run, i, np.eye(3)[i % 3], 1e-4 * i) for i in (3, 4, 5)]
    names = ("sample", "error", "way")
    all_ = Readings(
        *(np.concatenate([getattr(each, name) for each in parts]) for name in Readings.__dataclass_fields__)
    )
    some = only(all_, np.array([True, False, True]))
    for name in names:
        np.testing.assert_array_equal(getattr(some, name), getattr(all_, name)[[0, 2]])
