"""Where the numbers of a changed set-up come from: of the paper's milling test with one thing changed at a time."""

from pathlib import Path

import pytest

import robomill as rm
from robomill.io.samples import samples_dir
from robomill.io.setups.projects import load_setup
from robomill.provenance import GIVEN
from robomill.simulation.origin.assumptions import assumed_of_setup
from robomill.simulation.origin.origins import sources

PAPER = rm.load_setup("paper_flute")
PATH = rm.Toolpath.from_points(p_mm=[[0, 0, -2], [40, 0, -2]], feed_mm_min=1800)
MILL = rm.Cutter("flat", diameter_mm=6, flutes=2, helix_angle_deg=30)
MINE = rm.Provenance("measured", "drawing 12")
FAR = rm.Stock(lower_mm=(-10, -10, -10), upper_mm=(60, 10, 0))
CARRIED = "carried over from 'Reference groove (Slavkovic 2013)': section 5.2: dynamometer"


def changed(setup: rm.SimulationSetup) -> dict[str, str]:
    """The blocks of which something else is said than of the paper's: what kind of number they are now."""
    found = setup.provenance
    return {block: found[block].kind for block in found if found[block] != PAPER.provenance.get(block)}


@pytest.mark.parametrize(
    ("changes", "kinds"),
    [
        ({"tolerance_mm": 0.1}, {"tolerance": "user"}),
        ({"floor_tolerance_mm": 0.1}, {"tolerance": "user"}),
        ({"tolerance_mm": 0.3}, {"tolerance": "user"}),  # an assumption that somebody states
        ({"tolerance": PAPER.tolerance, "cutter": PAPER.cutter, "stock": PAPER.stock}, {}),
        ({"cutter": rm.Cutter("flat", diameter_mm=8, flutes=3, helix_angle_deg=30)}, {}),  # the paper's, built anew
        ({"step_mm": 2.0, "cell_mm": 0.2, "engagement": True, "name": "mine"}, {}),
        ({"force": rm.PathForce(feed_normal=40.0)}, {"force": "user"}),
        ({"source": PATH}, {"path": "user", "force": "assumed"}),
        ({"source": PATH, "force": rm.PathForce(feed_normal=40.0)}, {"path": "user", "force": "user"}),
        ({"cutter": MILL}, {"cutter": "user", "force": "assumed"}),
        ({"cutter": rm.Cutter("flat", diameter_mm=6)}, {"cutter": "assumed", "force": "assumed"}),
        ({"cutter": PAPER.cutter.replace(stick_out_mm=40)}, {"cutter": "user"}),  # pushed as hard as before
        ({"stock": FAR}, {"stock": "user"}),
        ({"stock": None}, {"stock": "computed"}),
        ({"part_zero_mm": (0, -1250, 2)}, {"part": "user"}),
        ({"provenance": {"tolerance": MINE}}, {"tolerance": "measured"}),
        ({"source": PATH, "provenance": {"force": MINE}}, {"path": "user", "force": "measured"}),
    ],
)
def test_what_was_changed_is_of_who_changed_it(changes, kinds) -> None:
    assert changed(PAPER.replace(**changes)) == kinds


def test_a_force_that_was_measured_on_one_cut_is_carried_to_another_once_and_not_back() -> None:
    other = PAPER.replace(source=PATH)
    assert other.provenance["force"].source.startswith(CARRIED)
    assert other.carried_from == ""  # nobody is asked: the person has chosen it
    again = other.replace(source=PAPER.source)
    assert again.provenance["force"] == other.provenance["force"]
    assert again.replace(force=rm.PathForce(feed_normal=40.0)).provenance["force"] == GIVEN


def test_a_force_that_knows_its_source_says_it() -> None:
    row = rm.load_material("al7075_t6_carbide_ref190")
    computed = PAPER.replace(force=rm.process_force(row, PAPER.cutter)).provenance["force"]
    assert computed.kind == "computed"
    assert row.provenance.source in computed.source
    told = rm.PathForce(feed_normal=40.0, provenance=MINE)
    assert PAPER.replace(force=told).provenance["force"] == MINE
    mine = PAPER.replace(force=rm.process_force(row.replace(Ktc=9e8), PAPER.cutter)).provenance["force"]
    assert "given in code" in mine.source


def test_what_was_said_of_one_robot_is_not_said_of_another() -> None:
    told = PAPER.replace(provenance={"limits": MINE, "compliance.table_2": MINE})
    assert "limits" not in told.replace(robot=rm.load_robot("kuka_kr270")).provenance
    turned = told.replace(robot=PAPER.robot.replace(limits_deg=(-100, 100)))
    assert "limits" not in turned.provenance
    assert turned.provenance["compliance.table_2"] == MINE
    assert {row.what: row.provenance for row in sources(turned)}["Joint limits"] == GIVEN


def test_it_reaches_what_is_told_of_a_run_and_the_file(tmp_path: Path) -> None:
    other = PAPER.replace(source=PATH, tolerance_mm=0.1, stock=FAR, cutter=MILL)
    again = rm.load_setup(rm.write_setup(tmp_path / "setup.toml", other))
    assert again.provenance == other.provenance
    what = [each.what for each in assumed_of_setup(again)]
    assert what == ["link lengths a_2, d_4, a_5", "joint limits", "force"]
    assert [each.what for each in assumed_of_setup(PAPER)][-2:] == ["stock", "tolerance"]


def test_a_map_that_was_measured_on_one_arm_is_assumed_on_another() -> None:
    sample = load_setup(samples_dir() / "paper_flute" / "setup_measured_map.toml")
    measured = sample.replace(provenance={"measured_map": MINE})
    softer = measured.replace(robot=measured.robot.replace(C_theta=2 * measured.robot.C_theta))
    longer = measured.replace(robot=measured.robot.replace(a_mm=[0, 1250, 0, 0, 300]))
    assert softer.provenance["measured_map"] == MINE
    assert longer.provenance["measured_map"].kind == "assumed"
    assert "measured_map" not in longer.replace(measured_map=None).provenance


def test_a_block_that_nothing_has_is_told() -> None:
    """A slip of the pen left its number assumed, in silence."""
    said = rm.Provenance("measured", "gauge of 3 May")
    setup = rm.load_setup("paper_flute")
    with pytest.raises(rm.RobomillError, match="no 'tolerence'; did you mean tolerance"):
        setup.replace(provenance={"tolerence": said})
    with pytest.raises(rm.RobomillError, match="no 'foo'; it takes geometry"):
        setup.robot.replace(provenance={"foo": said})
    assert setup.replace(provenance={"geometry": said}).provenance["geometry"] is said


def test_every_tolerance_that_something_is_judged_by_is_told() -> None:
    def told(**changes) -> str:
        return next(row.value for row in sources(PAPER.replace(**changes)) if row.what == "Tolerance")

    given = {"tolerance_mm": 0.25, "floor_tolerance_mm": 0.125, "feed_tolerance_mm": 0.4375}
    for chosen in ([0], [0, 1], [0, 2], [0, 1, 2]):
        some = dict([list(given.items())[i] for i in chosen])
        for key, value in given.items():
            assert (str(value) in told(**some)) == (key in some)
    assert told(tolerance_mm=0.25, floor_tolerance_mm=0.25) == told(tolerance_mm=0.25)
