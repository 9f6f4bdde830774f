"""Corrected corners: what is made of them by hand, what the tip springs by at them, and where it goes between."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import robomill as rm
from robomill.improve.compensation import Compensation
from robomill.simulation.meant import LINK
from tests.improve.corrected import SLOT, tip_of


def test_a_pockets_text_runs_as_an_ordinary_program_along_the_path_that_was_meant(pocket: Compensation) -> None:
    """Where it goes down as the arm is pushed up, no end of the tool cuts. At sharp corners the tip goes round in the
    links between two corrections, some tenths of a millimetre long."""
    tip, run = tip_of(pocket.setup, pocket.text)
    path = pocket.wanted.path
    begin, way = path.p[:-1][path.cutting[1:]], np.diff(path.p, axis=0)[path.cutting[1:]]
    square = np.maximum(np.einsum("ni,ni->n", way, way), 1e-30)
    x = tip[run.path.cutting & (run.path.p[:, 2] < -1e-3)]
    share = np.clip(np.einsum("mni,ni->mn", x[:, None] - begin, way) / square, 0.0, 1.0)
    off = np.linalg.norm(x[:, None] - begin - share[..., None] * way, axis=2).min(axis=1) / pocket.before.max
    assert np.median(off) < 0.01
    assert np.percentile(off, 95) < 0.05
    assert (off > 0.1).mean() < 0.03


def test_at_the_corners_of_a_zigzag_nothing_is_cut_deeper_than_elsewhere() -> None:
    """Where the tool just leaves a wall, the push ends at once: it is not sent down against it there."""
    text = "G0 X-20 Y-8 Z10\nG0 Z-2\nG1 X20 F600\nY-4\nX-20\nY0\nX20\nG0 Z20\nM2\n"
    setup = rm.load_setup(SLOT / "setup_process.toml").replace(source=rm.GCodeSource(f"G21 G90\nS12000 M3\n{text}"))
    found = rm.compensate(setup)
    tip, run = tip_of(setup, found.text)
    assert found.before.floor[0] > 0.09e-3
    assert tip[run.path.cutting, 2].min() > -2.02e-3


def test_what_the_tip_springs_by_at_corners_is_told_apart_as_a_run_of_the_text_alone_has_it(
    pocket: Compensation,
) -> None:
    """Feed moves of under 0.6 mm that turn off sharply between two cuts: there the tip is nowhere else as far off."""
    link, touch = pocket.sprung
    assert (link.kind, touch.kind, touch.count) == ("link", "touch", 1)
    tip, run = tip_of(pocket.setup, pocket.text)
    worst = off_lines(tip, pocket.wanted.path)[run.path.cutting & run.conditions.engaged]
    assert link.size == pytest.approx(worst.max(), rel=1e-6)
    jump = np.linalg.norm(np.diff(pocket.c, axis=0), axis=1)
    path = pocket.wanted.path
    there = (np.diff(path.p, axis=0) == 0.0).all(axis=1) & path.cutting[1:] & path.cutting[:-1] & (jump > 20e-6)
    assert abs(there.sum() - link.count) <= 1  # one is as short as a step of its own
    sentences = [each.sentence for each in pocket.findings if each.code.startswith("springs")]
    assert f"at {link.count} corners" in sentences[0]
    assert f"by up to {1e3 * link.size:.3f} mm" in sentences[0]
    assert "no program can take that away" in sentences[1]


def off_lines(x: np.ndarray, path: rm.Toolpath) -> np.ndarray:
    """(m,) m: how far points x (m, 3) m are off the feed moves of a path."""
    begin, way = path.p[:-1][path.cutting[1:]], np.diff(path.p, axis=0)[path.cutting[1:]]
    square = np.maximum(np.einsum("ni,ni->n", way, way), 1e-30)
    share = np.clip(np.einsum("mni,ni->mn", x[:, None] - begin, way) / square, 0.0, 1.0)
    return np.linalg.norm(x[:, None] - begin - share[..., None] * way, axis=2).min(axis=1)


RECTANGLE = [(-66, -30), (30, -30), (30, 20), (-30, 20), (-30, -30), (-10, -30)]


def around(places: list[tuple[float, float, float]]) -> rm.GCodeSource:
    """A program through places, mm."""
    (x, y, z), *others = places
    lines = [
        f"G0 X{x:.4f} Y{y:.4f} Z5",
        f"G0 Z{z:.4f}",
        *(f"G1 X{x:.4f} Y{y:.4f} Z{z:.4f} F1800" for x, y, z in others),
    ]
    return rm.GCodeSource("\n".join(["G21 G90 G17", "S12000 M3", *lines, "G0 Z20", "M2"]), "rectangle.nc")


@pytest.mark.parametrize("step_mm", [0.25, 1.0])
def test_a_rectangle_is_corrected_at_its_corners_as_by_hand(step_mm: float) -> None:
    """By hand: each leg is moved by what undoes the deflection in its middle, with straight lines across at corners."""
    stock = rm.Stock(lower_mm=(-60, -60, -20), upper_mm=(60, 60, 0))
    setup = rm.load_setup("paper_flute").replace(
        source=around([(x, y, -2.0) for x, y in RECTANGLE]), stock=stock, step_mm=step_mm
    )
    run, places = rm.simulate(setup), []
    for (x0, y0), (x1, y1) in pairwise(RECTANGLE):
        middle = np.array([x0 + x1, y0 + y1]) / 2.0
        i = int(np.argmin(np.linalg.norm(run.path.p[:, :2] * 1e3 - middle, axis=1)))
        d = run.delta[i] @ setup.T_MW[:3, :3] * 1e3
        d[0 if x0 != x1 else 1] = 0.0  # not along the feed
        places += [(x0 - d[0], y0 - d[1], -2.0 - d[2]), (x1 - d[0], y1 - d[1], -2.0 - d[2])]
    by_hand = rm.simulate(setup.replace(source=replace(around(places), wanted=setup.source)))
    found = rm.compensate(setup)
    assert abs(run.verdict.wall.value) > 0.2e-3
    assert abs(by_hand.verdict.wall.value) < 0.012e-3
    assert found.after.max < 0.001e-3
    tip, plain = tip_of(setup, found.text)
    legs = plain.path.cutting & (plain.path.step_length > 0.5e-3 * min(step_mm, 1.0))
    legs &= np.abs(plain.R_MF[:, :2, 0]).max(axis=1) > 1.0 - 1e-3  # not on the links across
    x, y, z = tip[legs].T * 1e3
    off = np.min([np.abs(y + 30), np.abs(x - 30), np.abs(y - 20), np.abs(x + 30)], axis=0)
    assert off.max() < 0.002
    assert np.median(np.abs(z + 2.0)) < 0.001


def test_rectangles_one_in_another_are_corrected_with_a_force_that_follows_the_cut() -> None:
    """A pocket: the way out to each larger rectangle goes on in the direction in which it came."""
    lines = ["G21 G90 G17", "S12000 M3", "G0 X0 Y0 Z5", "G1 Z-2 F200"]
    for x, y in ((2.0, 1.4), (7.0, 4.9), (12.0, 8.4)):
        lines += [f"G1 X{x} Y{-y} F1500", f"Y{y}", f"X{-x}", f"Y{-y}", f"X{x}"]
    source = rm.GCodeSource("\n".join([*lines, "G0 Z20", "M2"]), "pocket.nc")
    flute = rm.load_setup("paper_flute")
    setup = flute.replace(
        source=source,
        stock=rm.Stock(lower_mm=(-60, -60, -20), upper_mm=(60, 60, 0)),
        force=rm.process_force("al7075_t6_carbide_ref190", flute.cutter),
        engagement=True,
        step_mm=1.0,
    )
    found = rm.compensate(setup)
    assert found.before.max > 0.2e-3
    assert found.after.max < 0.005e-3
    tip, plain = tip_of(setup, found.text)
    legs = plain.path.cutting & (plain.path.step_length > 0.4e-3) & (np.abs(plain.R_MF[:, :2, 0]).max(axis=1) > 0.999)
    x, y, _ = np.abs(tip[legs & (np.abs(tip[:, :2]) > [6e-3, 4e-3]).any(axis=1)].T) * 1e3
    off = np.min([np.abs(x - 7.0), np.abs(x - 12.0), np.abs(y - 4.9), np.abs(y - 8.4)], axis=0)
    assert np.median(off) < 0.002


@pytest.mark.parametrize("stiffer", [7.0, 10.0, 15.0])
@pytest.mark.parametrize("height", [1.2, 3.1])
def test_a_step_up_between_two_floors_is_corrected_along_its_height(stiffer: float, height: float) -> None:
    """Nothing pushes on the way up, and the floor on which it ends asks for less aside than a link is made for: the
    correction fades in along the last part of the way, and the tip keeps to its lines."""
    slot = rm.load_setup(SLOT / "setup_process.toml")
    slot = slot.replace(robot=slot.robot.replace(C_theta=slot.robot.C_theta / stiffer), engagement=False)
    text = f"G21 G90\nS12000 M3\nG0 X-60 Y0 Z5\nG0 Z-4\nG1 X0 F900\nZ{height - 4}\nX30\nG0 Z20\nM2\n"
    found = rm.compensate(slot.replace(source=rm.GCodeSource(text)))
    tip, run = tip_of(found.setup, found.text)
    off = off_lines(tip, found.wanted.path)[run.path.cutting & run.conditions.engaged]
    assert found.after.max < LINK
    assert np.median(off) < 0.1 * found.before.max
