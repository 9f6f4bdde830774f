"""Runs along a path beside the one that was meant, told from that."""

from dataclasses import replace

import numpy as np

import robomill as rm
from robomill.cutting.unjudged import Unjudged
from robomill.io.samples import samples_dir
from robomill.progress import Progress, watched
from robomill.simulation.led import against, led_beside

SLOT = rm.load_setup(samples_dir() / "paper_flute")


def test_against_the_wanted_path_a_run_is_off_by_what_its_tip_is() -> None:
    """Told from a slot 0.1 mm beside and 0.05 mm beneath the one that it goes along."""
    text = "G21 G90\nG0 X0 Y0 Z5\nG0 Z-2\nG1 X20 F600\nG0 Z5\nM2\n"
    run = rm.simulate(SLOT.replace(source=rm.GCodeSource(text, "x.nc")))
    beside = np.array([0.0, -0.1e-3, -0.05e-3])
    wanted = rm.Toolpath(
        **{name: getattr(run.path, name) for name in ("k", "v_f", "cutting", "block", "n_s", "tool")},
        p=run.path.p + beside,
    )
    told, to_M = against(run, wanted, run.R_MF), SLOT.T_MW[:3, :3]
    cut = run.path.cutting
    np.testing.assert_allclose(told.delta[cut], (run.delta - to_M @ beside)[cut], atol=1e-15)
    np.testing.assert_allclose(told.ahead[cut], np.tile(-to_M @ beside, (cut.sum(), 1)), atol=1e-15)
    np.testing.assert_allclose(told.p_machined[cut], (run.path.p + run.delta @ to_M)[cut], atol=1e-12)
    assert told.path is wanted


def test_a_link_is_judged_where_the_cut_is_that_it_leads_to() -> None:
    """A link takes what its cut begins with: its number, or that it has none, and no longer its own."""
    text = "G21 G90\nG0 X0 Y0 Z5\nG0 Z-2\nG1 X20 F600\nG0 Z5\nM2\n"
    run = rm.simulate(SLOT.replace(source=rm.GCodeSource(text, "x.nc")))
    cut = np.flatnonzero(run.path.cutting)
    links, open_ = np.zeros(len(run.path), dtype=bool), np.zeros(len(run.path), dtype=bool)
    links[cut[[4, 9]]] = True
    open_[cut[[5, 9]]] = True  # where the first link leads to, and the second link itself
    delta = np.where(open_[:, None], np.nan, run.delta)
    left = replace(run, delta=delta, unjudged=(Unjudged("coupling", open_, "open"),))
    told = against(left, run.path, run.R_MF, links)
    assert np.flatnonzero(told.not_judged).tolist() == cut[[4, 5]].tolist()
    assert np.flatnonzero(~np.isfinite(told.delta[:, 0]) & run.path.cutting).tolist() == cut[[4, 5]].tolist()
    assert not told.missed.any()


def test_every_stage_of_a_corrected_run_is_told_from_its_beginning() -> None:
    text = "G21 G90\nG0 X0 Y0 Z5\nG0 Z-2\nG1 X20 F600\nG0 Z5\nM2\n"
    wanted = rm.GCodeSource(text.replace("Z-2", "Z-2.1"), "wanted.nc")
    first: dict[str, float] = {}
    with watched(Progress(say=lambda told: first.setdefault(told.stage, told.share))):
        rm.simulate(SLOT.replace(source=rm.GCodeSource(text, "x.nc", wanted=wanted)))
    assert "Where the program was meant to go" in first
    assert set(first.values()) == {0.0}


def test_a_later_plunge_into_what_is_opened_meets_nothing_of_the_correction_of_an_earlier_one() -> None:
    """Two holes at one place, the first told 0.1 mm aside to be there: where both are meant to be, the second meets
    nothing. A run of the same text that is told of no other path meets a crescent. Beside it, both meet the same."""
    cut = SLOT.replace(force=rm.process_force("al7075_t6_carbide_ref190", SLOT.cutter), engagement=True)

    def pushed(second: float, wanted: bool) -> np.ndarray:
        text = "G21 G90 S12000 M3\nG0 X0 Y0 Z5\nG0 X{0}\nG1 Z-2 F300\nG0 Z5\nG0 X{1}\nG1 Z-2 F300\nG0 Z5\nM2\n"
        meant = rm.GCodeSource(text.format(0, second), "wanted.nc") if wanted else None
        run = rm.simulate(cut.replace(source=rm.GCodeSource(text.format(0.1, second), "x.nc", wanted=meant)))
        return np.array([np.linalg.norm(run.F[run.path.block == line], axis=1).max() for line in (4, 7)])

    first, again = pushed(0.0, wanted=True)
    assert first > 100.0
    assert again == 0.0
    assert pushed(0.0, wanted=False)[1] > 1.0
    np.testing.assert_allclose(pushed(20.0, wanted=True), first, rtol=1e-6)


def test_a_tool_that_is_sent_back_feeds_as_it_goes_but_on_a_link() -> None:
    """Along x, then along y, with a link of no length between; one step of each leg goes back, and so does the link."""
    p = np.array([[0, 0], [1, 0], [2, 0], [3, 0], [3, 0], [3, 1], [3, 2], [3, 3]], dtype=float) * 1e-3
    path = rm.Toolpath.from_points(np.column_stack([p, np.zeros(8)]), 0.03, cutting=np.arange(8) > 0)
    off = np.array([[0, 0], [0, 0], [-1.5, 0.2], [-1.5, 0.0], [0.0, -0.5], [0, 0], [0.3, -1.2], [0, 0]]) * 1e-3
    sent = path.p + np.column_stack([off, np.zeros(8)])
    found = led_beside(path, sent, (np.full(8, -1), np.zeros(8, dtype=bool)))
    np.testing.assert_array_equal(found.tips, sent)
    np.testing.assert_array_equal(found.meant, path.p)
    told = [[0, 0], [1, 0], [1, 0], [1, 0], [0, 1], [0, 1], [0, 1], [0, 1]]
    for i, way in enumerate(told):
        step = (sent[i] - sent[i - 1])[:2] if i else np.zeros(2)
        back = i in (2, 6)
        assert (step @ way < 0.0) == (back or i == 4)
        expected = step / np.linalg.norm(step) if back else way
        np.testing.assert_allclose(found.way[i, :2], expected, atol=1e-12, err_msg=str(i))
