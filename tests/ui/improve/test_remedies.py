"""What the table of remedies says of each."""

import robomill as rm
from robomill.ui.improve.remedies import REMEDIES


def test_a_wall_to_the_right_is_as_large_as_one_to_the_left() -> None:
    """Pushed to -Y the wall error is negative; it is still what is largest at the best place."""
    setup = rm.load_setup("paper_flute").replace(step_mm=5, cell_mm=0.5, force=rm.ConstantForce((0.0, -100.0, 0.0)))
    found = rm.place(setup, x_mm=(-100, 100), y_mm=(-1400, -1300), candidates=20)
    assert found.best.wall < -abs(found.best.floor)
    remedy = next(each for each in REMEDIES if each.name == "place")
    assert remedy.left(found, rm.simulate(setup), "mm").error == f"wall {-found.best.wall * 1e3:.3f} mm"
