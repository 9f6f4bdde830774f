"""Where a correction is good enough to be given out, by the length of the cut that it does for."""

from dataclasses import replace

import numpy as np
import pytest

import robomill as rm
from robomill.errors import CompensationError
from robomill.improve.correction import Correction
from robomill.improve.trusted import check_found, check_reached

RUN = rm.simulate(rm.load_setup("paper_flute").replace(step_mm=1))


@pytest.mark.parametrize(("mm", "given_out"), [(0, True), (4, True), (6, False), (50, False)])
def test_no_more_than_a_twentieth_of_the_cut_is_without_a_correction_that_settled(mm: int, given_out: bool) -> None:
    """The slot is 100 mm long, in samples of a millimetre."""
    x = RUN.path.p[:, 0] * 1e3
    held = RUN.path.cutting & (x > 0.5) & (x < mm + 0.5)
    assert held.sum() == mm
    found = Correction(RUN, np.zeros_like(RUN.path.p), RUN, (1e-9,), held)
    if given_out:
        check_found(found, RUN)
        return
    with pytest.raises(CompensationError, match="line 7"):
        check_found(found, RUN)


@pytest.mark.parametrize(("coupled", "cure"), [(False, "couple the force"), (True, "make the arm stiffer")])
def test_nobody_is_told_to_couple_a_force_that_is_coupled(coupled: bool, cure: str) -> None:
    setup = rm.load_setup("paper_flute/setup_process").replace(coupling=coupled, step_mm=10, cell_mm=0.4)
    wanted = rm.simulate(setup)
    restless = Correction(wanted, np.zeros_like(wanted.path.p), wanted, (1e-3,), np.zeros(len(wanted.path), dtype=bool))
    with pytest.raises(CompensationError, match=f"cut less at once, or {cure}"):
        check_found(restless, wanted)


@pytest.mark.parametrize("joint", range(RUN.setup.robot.n))
@pytest.mark.parametrize(("degrees", "stands"), [(4.9, True), (-4.9, True), (5.1, False), (-90.0, False)])
def test_no_joint_stands_elsewhere_on_the_corrected_path(joint: int, degrees: float, stands: bool) -> None:
    """One joint at one place is enough; a corrected path differs by hundredths of a degree."""
    theta = RUN.theta.copy()
    at = int(np.flatnonzero(RUN.path.cutting)[7])
    theta[at, joint] += np.radians(degrees)
    turned = replace(RUN, ik=replace(RUN.ik, theta=theta))
    if stands:
        check_reached(turned, RUN)
        return
    with pytest.raises(CompensationError, match=f"line {RUN.path.block[at]}.* the arm would stand otherwise"):
        check_reached(turned, RUN)
    with pytest.raises(CompensationError, match="the arm would stand otherwise"):
        check_reached(RUN, turned)


@pytest.mark.parametrize("held", ["reached", "delta"])
def test_what_is_not_reached_or_has_no_force_on_the_corrected_path_is_refused(held: str) -> None:
    """But for what was out of reach before, and for forces on rapids."""
    at, rapid = int(np.flatnonzero(RUN.path.cutting)[7]), int(np.flatnonzero(~RUN.path.cutting)[-1])
    reached, delta = RUN.reached.copy(), RUN.delta.copy()
    delta[rapid] = np.nan
    (reached if held == "reached" else delta)[at] = False if held == "reached" else np.nan
    lost = replace(RUN, ik=replace(RUN.ik, reached=reached), delta=delta)
    with pytest.raises(CompensationError, match="out of reach" if held == "reached" else "no force is known"):
        check_reached(lost, RUN)
    if held == "reached":
        check_reached(replace(lost, delta=RUN.delta), lost)


@pytest.mark.parametrize(("mm", "trusted"), [(1.99, True), (2.01, False)])
def test_a_tool_that_would_be_sent_further_than_two_millimetres_is_not_sent(mm: float, trusted: bool) -> None:
    c, at = np.full_like(RUN.path.p, 1e-4), int(np.flatnonzero(RUN.path.cutting)[7])
    c[at] = 1e-3 * mm * np.array([0.6, 0.0, -0.8])
    found = Correction(RUN, c, RUN, (1e-9,), np.zeros(len(c), dtype=bool))
    if trusted:
        check_found(found, RUN)
        return
    with pytest.raises(CompensationError, match=rf"line {RUN.path.block[at]} the tool would be sent 2\.01"):
        check_found(found, RUN)
