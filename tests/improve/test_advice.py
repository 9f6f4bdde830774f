"""Other ways to cut, against runs made by hand."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import robomill as rm
from robomill.errors import SetupError
from robomill.improve import advice as module
from robomill.improve.advice import advise
from tests.improve.shoulder import shoulder

SETUP = rm.load_setup("paper_flute/setup_process").replace(step=4e-3, cell=5e-4)


@pytest.fixture(scope="module")
def advice() -> rm.Advice:
    return advise(SETUP)


def way(advice: rm.Advice, name: str):
    return next(each for each in advice.ways if each.name == name)


def test_the_largest_feed_keeps_the_tolerance_and_half_a_hundredth_more_does_not(advice: rm.Advice) -> None:
    found = way(advice, "feed")
    assert found.keeps
    text = SETUP.source.text
    assert "F1800" in text
    for more, kept in ((1.0, True), (1.005, False)):
        run = rm.simulate(
            SETUP.replace(source=rm.GCodeSource(text.replace("F1800", f"F{1800 * found.factor * more:.6f}")))
        )
        assert (run.verdict.share <= 1.0) == kept
    assert found.seconds == pytest.approx(way(advice, "now").seconds / found.factor)
    assert {each.factor for each in advice.ways if each.name != "feed"} == {1.0}


def test_seconds_are_those_at_feed_and_of_dwells(advice: rm.Advice) -> None:
    """20 mm at 600 mm/min are 2 s; a dwell of 1.5 s counts, a rapid does not."""
    text = "G21 G90 S9000 M3\nG0 X-20 Y0 Z5\nG0 Z-1\nG1 X0 F600\nG4 P1.5\nG0 Z5\nM2\n"
    run = rm.simulate(SETUP.replace(source=rm.GCodeSource(text)))
    assert replace(way(advice, "now"), run=run).seconds == pytest.approx(3.5)
    assert np.isnan(replace(way(advice, "now"), run=None).seconds)


def test_two_passes_are_two_programs_lines_one_after_the_other(advice: rm.Advice) -> None:
    p = np.array(
        [[-70, 0, 9], [-70, 0, -1], [20, 0, -1], [20, 0, 9], [-70, 0, 9], [-70, 0, -2], [20, 0, -2]], dtype=float
    )
    lines = SETUP.toolpath.to_dataframe()
    at_feed = lines[lines["cutting"]]
    p[[0, 1, 4, 5], 0] = lines["X_mm"][at_feed.index[0] - 1]
    p[[2, 3, 6], 0] = at_feed["X_mm"].iloc[-1]
    cut = [False, False, True, False, False, False, True]
    path = rm.Toolpath.from_points(p_mm=p, feed_mm_min=1800, spindle_1_min=SETUP.toolpath.n_s.max() * 60, cutting=cut)
    by_hand = rm.simulate(SETUP.replace(source=path, stock=SETUP.stock_block))
    found = way(advice, "2 passes").run
    assert found.verdict.wall.value == pytest.approx(by_hand.verdict.wall.value, rel=1e-6)
    assert found.verdict.floor.value == pytest.approx(by_hand.verdict.floor.value, rel=1e-6)


def test_material_removed_is_that_of_the_groove_in_its_time(advice: rm.Advice) -> None:
    now = way(advice, "now")
    assert now.removal_rate * now.seconds == pytest.approx(now.run.ideal.removed_volume)
    assert way(advice, "2 passes").removal_rate == pytest.approx(now.removal_rate / 2.0, rel=1e-3)


def test_the_best_is_the_quickest_within_tolerance(advice: rm.Advice) -> None:
    kept = [each for each in advice.ways if each.keeps]
    assert advice.best.seconds == min(each.seconds for each in kept)
    strict = advise(SETUP.replace(tolerance=1e-6))
    assert not any(each.keeps for each in strict.ways)
    assert "no feed keeps the tolerance" in way(strict, "feed").title
    assert strict.best.share == min(each.share for each in strict.ways)


def test_a_last_pass_meets_what_the_deflected_one_before_it_has_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two programs written by hand, run with force and deflection coupled; otherwise where a path is too long."""
    passes = "S12000 M3\n" + "".join(f"G0 X-70 Y-32 Z5\nG0 Z{z}\nG1 X70 F1500\nG0 Z20\n" for z in (-4.5, -5.0)) + "M2\n"
    setup = shoulder()
    coupled = {
        name: rm.simulate(setup.replace(source=rm.GCodeSource(text), coupling=True)).verdict
        for name, text in (("allowance", passes), ("once more", passes.replace("-4.5", "-5.0")))
    }
    advice = advise(setup)
    for name, verdict in coupled.items():
        found = way(advice, name)
        assert found.share == pytest.approx(verdict.share, rel=1e-3)
        assert rm.simulate(found.run.setup).verdict.share == found.share
    told = rm.simulate(setup.replace(source=rm.GCodeSource(passes))).verdict.share
    assert told < 0.7 * coupled["allowance"].share
    monkeypatch.setattr(module, "MARCHED", 10)
    other = way(advise(setup), "allowance")
    assert other.title.endswith("(met as it was told)")
    assert other.share == pytest.approx(told, rel=1e-3)


@pytest.mark.parametrize(
    ("setup", "words"),
    [
        (rm.load_setup("paper_flute"), "does not follow the cut"),
        ("paper_flute", "load_setup"),
        (SETUP.replace(part_zero_mm=(0, -9000, 0)), "no number"),
    ],
)
def test_what_another_way_would_not_change_is_refused(setup: rm.SimulationSetup, words: str) -> None:
    with pytest.raises(SetupError, match=words):
        advise(setup)


def layered(*z: float, start: int = -70) -> str:
    """A slot along X in layers at heights ``z`` mm, there and back in turn, begun at X ``start`` mm."""
    goes = "".join(f"G1 Z{at} F1000\nX{-start * (-1) ** n} F1500\n" for n, at in enumerate(z))
    return f"G21 G90 S12000 M3\nG0 X{start} Y0 Z5\n{goes}G0 Z5\nM2\n"


def test_of_a_path_in_layers_no_way_is_told_that_cuts_the_deepest_first_or_no_thinner() -> None:
    """By programs of one's own: deepest first it is far worse, and halves of each layer use about half as much; two
    times the same layers, the first time higher up by half the depth, use as much as they did."""

    def share(text: str) -> float:
        return rm.simulate(SETUP.replace(source=rm.GCodeSource(text))).verdict.share

    found = advise(SETUP.replace(source=rm.GCodeSource(layered(-1.5, -3.0, -4.5))))
    now = way(found, "now").share
    assert share(layered(-4.5, -3.0, -1.5, start=70)) > 1.5 * now
    assert share(layered(-0.75, -1.5, -2.25, -3.0, -3.75, -4.5)) < 0.65 * now
    assert share(layered(-0.75, -2.25, -1.5, -3.0, -4.5)) == pytest.approx(now, rel=0.05)
    for name, why in (("turned round", "deepest one first"), ("2 passes", "1.500 mm already"), ("3 passes", "thinner")):
        assert way(found, name).run is None
        assert why in way(found, name).refused
    thinner = way(found, "4 passes").run
    assert thinner is not None
    met = thinner.conditions
    assert met.a_p[met.engaged & ~met.mostly_axial].max() == pytest.approx(4.5e-3 / 4, rel=1e-3)


def test_cuts_of_two_depths_side_by_side_are_no_layers() -> None:
    text = "G21 G90 S12000 M3\nG0 X-70 Y8 Z5\nG0 Z-1\nG1 X70 F1500\nG0 Z5\nG0 X-70 Y-8\nG0 Z-2\nG1 X70\nG0 Z5\nM2\n"
    found = advise(SETUP.replace(source=rm.GCodeSource(text)))
    assert all(each.run is not None for each in found.ways)


def test_an_arm_that_chooses_its_posture_has_the_same_in_every_way() -> None:
    """Along a path of several passes least motion takes another spin, and what is softer there is none of their doing:
    each way is run again with the spin that the arm has now, which its set-up keeps when it is taken."""
    text = "G21 G90\nS10000 M3\nG0 X-40 Y-20 Z30\nG0 Z2\nG1 Z-4 F900\nG1 X40\nG1 Y20\nG0 Z30\nM2\n"
    cutter = rm.Cutter("flat", diameter_mm=10, flutes=3)
    setup = rm.SimulationSetup(
        robot=rm.load_robot("fanuc_r2000ic"),
        source=rm.GCodeSource(text),
        cutter=cutter,
        force=rm.process_force("al7075_t6_carbide_ref190", cutter),
        stock=rm.Stock(lower_mm=(-110, -60, -20), upper_mm=(110, 60, 0)),
        part_zero_mm=(1700, -400, 500),
        part_rotation_z_deg=50,
        tolerance_mm=0.3,
        step=4e-3,
    )
    found = rm.advise(setup)
    now = found.ways[0].run
    assert now is not None
    (spin,) = set(now.ik.spin.tolist())
    free = 0
    for each in found.ways[1:]:
        again = rm.simulate(each.run.setup.replace(spin=spin))
        assert each.share == pytest.approx(again.verdict.share, rel=1e-12), each.name
        own = rm.simulate(each.run.setup.replace(spin="least_motion"))
        free += own.verdict.share != pytest.approx(each.share, rel=1e-3)
    assert free >= 3, "left to itself the arm would have stood otherwise in some"


def test_the_table_has_the_numbers_of_every_way_in_units_of_the_shop_floor(advice: rm.Advice) -> None:
    table = advice.columns()
    for n, each in enumerate(advice.ways):
        assert table["way"][n] == each.name
        assert table["minutes"][n] == pytest.approx(each.seconds / 60.0, nan_ok=True)
        assert table["removal_cm3_min"][n] == pytest.approx(each.removal_rate * 60e6, nan_ok=True)
        assert table["used_%"][n] == pytest.approx(each.share / 0.01, nan_ok=True)
        if each.run is None:
            assert np.isnan([table[name][n] for name in ("wall_mm", "floor_mm", "max_deviation_mm")]).all()
            assert table["verdict"][n] == ""
            continue
        sizes = [abs(each.run.verdict.wall.value), abs(each.run.verdict.floor.value), each.run.max_deviation]
        found = [table[name][n] for name in ("wall_mm", "floor_mm", "max_deviation_mm")]
        assert found == pytest.approx([size / 1e-3 for size in sizes], nan_ok=True)
        assert table["verdict"][n] == each.run.verdict.level


@pytest.mark.parametrize("most", [0.05, 0.1, 0.13, 0.7, 1.0, 1.3, 3.9, 4.0, 9.0])
def test_the_largest_feed_is_sought_from_a_tenth_of_it_to_four_times_as_much(
    monkeypatch: pytest.MonkeyPatch, most: float
) -> None:
    """By halving, in logarithms, nine times, what is below and above that of the program."""

    def run(factor: float) -> SimpleNamespace:
        return SimpleNamespace(verdict=SimpleNamespace(red=factor > most))

    monkeypatch.setattr(module, "held", lambda now: None)
    monkeypatch.setattr(module, "_way", lambda name, title, _, factor: module.Way(name, title, run(factor), "", factor))
    now = SimpleNamespace(verdict=SimpleNamespace(red=most < 1.0), setup=SimpleNamespace(toolpath=None))
    found = module._feed(now, lambda setup: None)  # type: ignore[arg-type, return-value]
    assert found.name == "feed"
    if most < 0.1 or most >= 4.0:
        assert found.factor == (0.1 if most < 0.1 else 4.0)
        assert ("no feed keeps the tolerance" in found.title, "the most that is tried" in found.title) == (
            most < 0.1,
            most >= 4.0,
        )
        return
    assert found.factor <= most < found.factor * (4.0 if most >= 1.0 else 10.0) ** (1.0 / 2**9) * (1 + 1e-12)
    assert "the most that keeps the tolerance" in found.title


@pytest.mark.parametrize("engagement", [True, False])
def test_ways_are_compared_by_what_they_meet_of_the_stock(engagement: bool) -> None:
    """Be it followed in the set-up or not; nothing else of it is changed."""
    setup, seen = SETUP.replace(engagement=engagement), []

    def run(asked: rm.SimulationSetup) -> rm.SimulationResult:
        seen.append(asked)
        raise SetupError("enough")

    with pytest.raises(SetupError, match="enough"):
        advise(setup, run=run)
    (first,) = seen
    assert first.engagement
    assert first.replace(engagement=engagement) == setup


def test_layers_are_as_thick_as_the_thickest_that_is_cut_at_feed_across_the_tool() -> None:
    """Neither rapids nor what is not met nor plunges say how thick they are, nor how deep the path goes."""
    a_p, z = np.array([1.0, 1.5, 9.0, 9.0, 9.0]) * 1e-3, np.array([-1.0, -2.5, -9.0, -9.0, -9.0]) * 1e-3
    cutting, met = np.array([1, 1, 0, 1, 1], dtype=bool), np.array([1, 1, 1, 0, 1], dtype=bool)
    axial = np.array([0, 0, 0, 0, 1], dtype=bool)

    def layer(off: float, top: float = 0.0) -> float:
        path = SimpleNamespace(cutting=cutting, p=np.column_stack([np.full((5, 2), 7.0), z]))
        conditions = SimpleNamespace(engaged=met, mostly_axial=axial, a_p=a_p)
        return module._layer(SimpleNamespace(path=path, conditions=conditions, max_deviation=off), top)  # type: ignore[arg-type]

    assert layer(0.9e-3) == 1.5e-3
    assert layer(1.1e-3) == np.inf, "all of the depth but what the tip may be off"
    assert layer(1.1e-3, top=1e-3) == 1.5e-3
    axial[:] = True
    assert layer(0.0) == np.inf
