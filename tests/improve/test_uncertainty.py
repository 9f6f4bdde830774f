"""Monte Carlo against a plain loop over simulate, linear propagation, and probabilities in closed form."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binomtest, norm

import robomill as rm
from robomill.errors import SetupError
from robomill.identification.fit.model_error import ModelError
from robomill.identification.fit.models import Model
from robomill.identification.knowledge import Knowledge
from robomill.improve import uncertainty as module
from robomill.improve.expansion import Expansion
from robomill.improve.screening import share_of
from robomill.simulation.band import deviation_band, size_band
from tests.improve.shoulder import shoulder

NOTHING = dict(compliance=0.0, force=0.0, lengths=0.0, part=0.0, part_turn=0.0, tool_length=0.0)


def spread(**given: float) -> rm.Spread:
    """Nothing is unsure but what is given."""
    return rm.Spread(**NOTHING).replace(**given)


def slot(name: str = "paper_flute") -> rm.SimulationSetup:
    return rm.load_setup(name).replace(step=5e-3, cell=4e-4)


def by_hand(setup: rm.SimulationSetup, inputs: dict[str, float]) -> rm.SimulationResult:
    """The same cut with its numbers set one by one, as anybody would write it."""
    robot, C, a, d = setup.robot, setup.robot.C_theta.copy(), setup.robot.a.copy(), setup.robot.d.copy()
    T_tool, T_MW, force = robot.T_tool.copy(), setup.T_MW.copy(), setup.force
    for key, value in inputs.items():
        name, _, number = key.rpartition("_")
        if name == "C_theta":
            C[robot.joint_numbers.index(int(number))] = value
        elif name in ("a", "d") and number.isdigit():
            {"a": a, "d": d}[name][int(number) - 1] = value
        elif name == "part" and number in "xyz":
            T_MW["xyz".index(number), 3] = value
        elif key == "part_turn":
            c, s = np.cos(value), np.sin(value)
            T_MW[:3, :3] = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ T_MW[:3, :3]
        elif key == "tool_length":
            T_tool[:3, 3] = robot.T_tool[:3, 3] - value * robot.T_tool[:3, 2]
        elif hasattr(force, key):
            force = replace(force, **{key: value})
        else:
            force = replace(force, material=force.material.replace(**{key: value}))
    return rm.simulate(setup.replace(robot=robot.replace(C_theta=C, a=a, d=d, T_tool=T_tool), T_MW=T_MW, force=force))


@pytest.mark.parametrize("name", ["paper_flute", "paper_flute/setup_process", "heart"])
def test_draws_are_what_a_plain_loop_over_simulate_gives(name: str) -> None:
    found = rm.uncertainty(slot(name), samples=40, seed=3)
    values = {each.key: each.value + found.change[:, i] for i, each in enumerate(found.inputs)}
    for k in range(0, 40, 4):
        run = by_hand(found.setup, {key: float(value[k]) for key, value in values.items()})
        assert found.tip[k] == pytest.approx(run.max_deviation, abs=2e-8)
        assert found.wall[k] == pytest.approx(abs(run.verdict.wall.value), abs=0.6e-6)
        assert found.floor[k] == pytest.approx(abs(run.verdict.floor.value), abs=0.6e-6)


def test_a_wall_made_between_two_samples_is_drawn_as_runs_have_it() -> None:
    """Where each draw is all but the cut as it is, each reads what that does; wider ones as a plain loop does."""
    setup = shoulder()
    wall = abs(rm.simulate(setup).verdict.wall.value)
    near = rm.uncertainty(setup, spread(compliance=1e-4), samples=20)
    np.testing.assert_allclose(near.wall, wall, rtol=1e-3)
    found = rm.uncertainty(setup, spread(compliance=0.2), samples=24, seed=5)
    values = {each.key: each.value + found.change[:, i] for i, each in enumerate(found.inputs)}
    for k in range(24):
        verdict = by_hand(setup, {key: float(value[k]) for key, value in values.items()}).verdict
        assert found.share[k] == pytest.approx(verdict.share, abs=0.05)


def test_the_draws_that_decide_are_run_in_full_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draws that are told wrongly only where the tolerance is just kept, and not where errors are largest."""
    setup = slot().replace(tolerance_mm=0.25)
    told = Expansion.errors

    def wrong(self: Expansion, change: np.ndarray) -> dict[str, np.ndarray]:
        found = told(self, change)
        just = np.abs(share_of("verdict", setup, found) - 1.0) < 0.2
        return found | {"wall": np.where(just, 1.05 * found["wall"], found["wall"])}

    monkeypatch.setattr(Expansion, "errors", wrong)
    found = rm.uncertainty(setup, spread(compliance=0.2), samples=400)
    assert module.DIFFERS in [each.code for each in found.findings]


def test_places_of_centimetres_are_still_of_second_order() -> None:
    found = rm.uncertainty(slot(), spread(part_mm=20.0, part_turn_deg=3.0, tool_length_mm=10.0), samples=24)
    for k in range(0, 24, 3):
        run = by_hand(found.setup, {e.key: e.value + found.change[k, i] for i, e in enumerate(found.inputs)})
        assert found.tip[k] == pytest.approx(run.max_deviation, rel=2e-3)


def test_identified_compliances_give_the_spread_of_linear_propagation() -> None:
    """delta is linear in the compliances: its size is so while they differ by per cents."""
    setup = slot()
    C = setup.robot.C_theta
    A = np.eye(5) + 0.5 * np.diag(np.ones(4), 1) - 0.4 * np.diag(np.ones(3), 2)
    correlation = A @ A.T / np.sqrt(np.outer(*[np.diag(A @ A.T)] * 2))
    std = np.array([0.02, 0.03, 0.02, 0.04, 0.03]) * C
    known = Knowledge(Model(), C, correlation * np.outer(std, std), source="a fit")
    found = rm.uncertainty(setup, spread(), known=known, measure="tip", samples=20_000)
    worst = found.run.worst
    band = size_band(found.run, deviation_band(found.run, known, worst), worst) / norm.ppf(0.975)
    assert found.std == pytest.approx(float(band), rel=0.03)
    np.testing.assert_allclose(np.cov(found.change.T) / np.outer(std, std), correlation, atol=0.03)
    assert {each.provenance.kind for each in found.inputs} == {"measured"}


def test_what_the_model_misses_is_in_it_as_in_the_band() -> None:
    setup = slot()
    C, error = setup.robot.C_theta, ModelError(0.1, 0.0, 0.0)
    known = Knowledge(Model(), C, np.diag((0.01 * C) ** 2), error=error)
    found = rm.uncertainty(setup, spread(), known=known, measure="wall", samples=20_000)
    i = found.run.verdict.wall.worst
    normal = deviation_band(found.run, known, i).by_along("model", found.run.R_MF[i][:, 1])
    assert found.std == pytest.approx(float(normal), rel=0.05)
    assert sum(each.group == "model" for each in found.tornado.inputs) == 3
    # What no run in full can say is left out of both where they are compared.
    assert found.checked[0] > 0
    assert found.checked[1] < 1e-3


def test_one_normal_number_gives_the_normal_distribution() -> None:
    """All errors are proportional to the one component of the force: everything is known in closed form."""
    setup = slot().replace(tolerance=0.26e-3, floor_tolerance=None)
    found = rm.uncertainty(setup, spread(force=0.1), samples=40_000)
    share = found.run.verdict.share
    expected = norm.cdf((1.0 / share - 1.0) / 0.1)
    assert found.interval[0] < expected < found.interval[1]
    assert found.probability == pytest.approx(expected, abs=0.01)
    assert found.quantile(0.95, "share") == pytest.approx(share * (1 + 0.1 * norm.ppf(0.95)), rel=5e-3)
    assert found.tornado.part[0] == pytest.approx(1.0, rel=0.03)
    assert found.tornado.high[0] == pytest.approx(share * (1 + 0.1 * norm.ppf(0.975)), rel=1e-6)
    test = binomtest(int(found.meets.sum()), found.samples).proportion_ci(0.95, "exact")
    np.testing.assert_allclose(found.interval, (test.low, test.high), rtol=1e-9)


def test_parts_of_the_variance_add_up_where_the_deviation_is_linear() -> None:
    found = rm.uncertainty(slot(), spread(compliance=0.02, force=0.02), measure="wall", samples=20_000)
    assert found.tornado.part.sum() == pytest.approx(1.0, abs=0.03)
    share = rm.simulate(found.setup).delta_joint
    worst = found.run.verdict.wall.worst
    normal = np.einsum("ni,i->n", share[worst], found.run.R_MF[worst][:, 1])
    alone = dict(zip((each.key for each in found.tornado.inputs), found.tornado.part, strict=True))
    total = (normal**2).sum() + normal.sum() ** 2  # joints each by 2 %, the force by 2 % of all of them
    for number, part in zip(found.setup.robot.joint_numbers, normal**2 / total, strict=True):
        assert alone[f"C_theta_{number}"] == pytest.approx(part, abs=0.02)
    assert alone["feed_normal"] == pytest.approx(normal.sum() ** 2 / total, abs=0.02)


def test_a_coupled_cut_is_drawn_in_full() -> None:
    setup = rm.load_setup("paper_flute/setup_process").replace(step=20e-3, cell=8e-4, engagement=True, coupling=True)
    found = rm.uncertainty(setup, spread(compliance=0.1), samples=6)
    assert [each.code for each in found.findings] == [module.IN_FULL]
    run = by_hand(setup, {e.key: e.value + found.change[2, i] for i, e in enumerate(found.inputs)})
    assert found.tip[2] == run.max_deviation


def test_draws_that_are_not_reached_do_not_keep_the_tolerance() -> None:
    setup = slot()
    far = setup.replace(part_zero_mm=(0.0, -2285.0, 0.0), tolerance_mm=5.0)
    assert rm.simulate(far).reached.all()
    found = rm.uncertainty(far, spread(part_mm=30.0), samples=30)
    lost = np.isnan(found.share)
    assert 0 < lost.sum() < 30
    assert not found.meets[lost].any()
    assert found.probability <= 1.0 - lost.mean()
    assert found.quantile(1.0) == np.inf


def test_walls_that_another_tool_has_made_are_said_to_be_off() -> None:
    """They do not go with the tip: by up to 15 um of 0.5 mm, which the draws in full show."""
    setup = rm.load_setup("two_tools").replace(step=4e-3, cell=4e-4)
    found = rm.uncertainty(setup, samples=400)
    worst = int(np.argmax(found.wall))
    run = by_hand(setup, {each.key: each.value + found.change[worst, i] for i, each in enumerate(found.inputs)})
    differs = abs(abs(run.verdict.wall.value) - found.wall[worst])
    assert differs > 1e-6
    assert found.checked[1] >= differs / setup.tolerance * 0.999


def test_where_a_few_draws_are_off_more_are_run_and_what_is_used_is_compared_too() -> None:
    """Against every draw run by hand: what is said holds for all but the few that were not looked at."""
    setup = rm.load_setup("two_tools").replace(step=4e-3, cell=4e-4)
    found = rm.uncertainty(setup, samples=60)
    runs = [
        by_hand(setup, {each.key: each.value + change[i] for i, each in enumerate(found.inputs)})
        for change in found.change
    ]
    wall = np.abs(np.abs([run.verdict.wall.value for run in runs]) - found.wall) / setup.tolerance
    used = np.abs(np.array([run.verdict.share for run in runs]) - found.share)
    assert 24 <= found.checked[0] <= 36
    assert np.mean(wall <= found.checked[1] * 1.001) >= 0.95
    (told,) = (each.message for each in found.findings if each.code == "draws-differ")
    share = re.search(r"of the tolerance by up to (\d+) %", told)
    assert share is not None
    assert np.mean(used <= (float(share[1]) + 0.5) / 100.0) >= 0.95
    assert float(share[1]) <= 100.0 * used.max() + 0.5
    assert rm.uncertainty(rm.load_setup("paper_flute"), samples=60).checked[0] == 6, "all of them agree"


def test_what_draws_differ_by_is_told_of_the_tolerance_that_the_error_has() -> None:
    """Where floors alone are judged, the tolerance of walls, ten times as wide, changes nothing that is said."""
    wide = spread(part_mm=60.0, lengths_mm=20.0)
    tight = dict(measure="floor", samples=60, seed=2)
    alike = rm.uncertainty(slot().replace(tolerance_mm=0.03), wide, **tight)
    found = rm.uncertainty(slot().replace(tolerance_mm=0.3, floor_tolerance_mm=0.03), wide, **tight)
    assert (found.share == alike.share).all()
    assert found.checked == alike.checked
    assert {each.code for each in found.findings} == {each.code for each in alike.findings}


def test_the_same_seed_gives_the_same_numbers_and_another_others() -> None:
    one, again, other = (rm.uncertainty(slot(), samples=50, seed=seed) for seed in (2**60 + 1, 2**60 + 1, 2**60))
    assert one == again
    assert one != other
    np.testing.assert_array_equal(one.share, again.share)


def test_what_is_left_out_is_assumed_and_said() -> None:
    found = rm.uncertainty(slot(), rm.Spread(force=0.05), samples=10)
    kinds = {each.group: each.provenance.kind for each in found.inputs}
    assert kinds["force"] == "user"
    assert kinds["compliance"] == kinds["lengths"] == kinds["part"] == kinds["tool"] == "assumed"


def test_compliances_that_could_be_negative_are_drawn_again_aloud() -> None:
    found = rm.uncertainty(slot(), spread(compliance=0.9), samples=500)
    assert (found.change >= -np.array([each.value for each in found.inputs])).all()
    assert module.REDRAWN in {each.code for each in found.findings}


def test_a_table_of_the_draws_and_one_of_the_inputs() -> None:
    pytest.importorskip("pandas")
    found = rm.uncertainty(slot(), samples=25)
    frame, bars = found.to_dataframe(), found.tornado.to_dataframe()
    assert len(frame) == 25
    assert frame["a_2"].mean() == pytest.approx(1220.0, abs=1.0)
    assert bars["variance_part"].is_monotonic_decreasing
    assert set(bars["input"]) == {each.key for each in found.inputs}


@pytest.mark.parametrize(
    ("words", "given"),
    [
        ("Spread: everything is known exactly", {"spread": spread()}),
        ("Measure: found 'speed', expected verdict", {"measure": "speed"}),
        ("samples: found 1, expected a whole number", {"samples": 1}),
        ("seed: found -1", {"seed": -1}),
        ("seed: found 18446744073709551616", {"seed": 2**64}),
        ("spread: expected a Spread, found 0.1", {"spread": 0.1}),
    ],
)
def test_what_cannot_be_is_refused(words: str, given: dict) -> None:
    with pytest.raises(SetupError, match=words):
        rm.uncertainty(slot(), **given)


def test_cuts_without_a_number_and_maps_are_refused() -> None:
    with pytest.raises(SetupError, match="There is no number to be sure of"):
        rm.uncertainty(slot().replace(part_zero_mm=(0.0, -5000.0, 0.0)))
    with pytest.raises(SetupError, match="measured map"):
        rm.uncertainty(rm.load_setup("paper_flute/setup_measured_map"))
    with pytest.raises(SetupError, match="Compliance: found 2"):
        rm.Spread(compliance=2.0)
    with pytest.raises(SetupError, match="part_mm"):
        rm.Spread(part=0.5)


def test_a_corrected_programs_draws_are_runs_of_its_text_on_other_arms() -> None:
    """Each by an ordinary run that knows nothing of the correction: the tip beside the slot's line."""
    setup = rm.load_setup("paper_flute")
    found = rm.compensate(setup)
    text = "".join(line for line in found.text.splitlines(keepends=True) if "robomill" not in line)
    spread = rm.Spread(compliance=0.1, force=0.1, lengths=0.0, part=0.0, part_turn=0.0, tool_length=0.0)
    drawn = rm.uncertainty(setup.replace(source=found.source), spread, samples=400)
    table = drawn.columns()
    for i in np.argsort(-drawn.share)[:6]:
        C_theta = [float(table[f"C_theta_{n}"][i]) * 1e-7 for n in setup.robot.joint_numbers]
        other = setup.replace(
            robot=setup.robot.replace(C_theta=C_theta),
            source=rm.GCodeSource(text),
            force=rm.PathForce(feed_normal=float(np.asarray(table["feed_normal"])[i])),
        )
        run = rm.simulate(other)
        tip = (run.path.p + run.delta @ setup.T_MW[:3, :3])[run.path.cutting] - [0.0, 0.0, -2e-3]
        assert drawn.wall[i] == pytest.approx(np.abs(tip[:, 1]).max(), abs=0.3e-6)
    assert drawn.quantile(0.95) < 0.3 * rm.uncertainty(setup, spread, samples=400).quantile(0.95)


def test_what_the_set_up_knows_of_its_compliances_is_used_unless_something_else_is_said() -> None:
    """As ``known=``; a stated spread goes before it, and what is known of other compliances is said not to be used."""
    bare = slot()
    fit = rm.identify(bare.robot, "nine_points")
    arm = fit.applied_to(bare.robot)
    setup = bare.replace(robot=arm, knowledge=fit)
    own, given = rm.uncertainty(setup, samples=50), rm.uncertainty(bare.replace(robot=arm), known=fit, samples=50)
    np.testing.assert_array_equal(own.share, given.share)
    assert {each.provenance.kind for each in own.inputs if each.group == "compliance"} == {"measured"}
    stated = rm.uncertainty(setup, rm.Spread(compliance=0.2), samples=50)
    assert {each.provenance.kind for each in stated.inputs if each.group == "compliance"} == {"user"}
    other = setup.replace(robot=bare.robot)
    found = rm.uncertainty(other, samples=50)
    assert {each.provenance.kind for each in found.inputs if each.group == "compliance"} == {"assumed"}
    assert [each.code for each in found.findings].count("other-compliances") == 1
    assert "other-compliances" not in [each.code for each in (*own.findings, *stated.findings)]
