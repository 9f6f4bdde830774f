"""Ways down into a cut, corrected: ramps and helices that a level cut goes on from."""

import numpy as np
import pytest

import robomill as rm

SETUP = rm.load_setup("paper_flute/setup_process").replace(tolerance_mm=1.0)
BORE = "G0 X-6 Y0 Z5\nG0 Z{top}\nG3 Z-2.5 I6 J0 F400\nG3 I6 J0 F600\n"


def program(body: str) -> rm.GCodeSource:
    return rm.GCodeSource(f"G21 G90\nS12000 M3\n{body}G0 Z9\nM2\n", "entry.nc")


@pytest.mark.parametrize("top", [0.5, 0.0])
@pytest.mark.parametrize("step", [1.0, 0.25])
def test_a_helical_entry_and_its_circle_are_corrected(top: float, step: float) -> None:
    """The thrust of a way down of 4 degrees ends at once where the circle begins, however finely one looks there."""
    found = rm.compensate(SETUP.replace(source=program(BORE.format(top=top)), step_mm=step))
    assert found.before.max > 0.4e-3
    assert found.after.max < 0.03e-3
    r = np.linalg.norm(found.led.path.p[:, :2], axis=1)
    np.testing.assert_allclose(r[found.led.path.cutting], 6e-3, atol=0.02e-3)  # each sample is told from the bore
    path = rm.simulate(SETUP.replace(source=rm.GCodeSource(found.text.replace("robomill", "x"), "told.nc"))).path
    assert path.p[~path.cutting, 2].min() > -0.05e-3  # no rapid is sent into the part before it touches


@pytest.mark.parametrize("top", [0.0, 0.3])
@pytest.mark.parametrize("slope", [5.0, 8.0, 15.0])
@pytest.mark.parametrize("step", [1.0, 0.5, 0.25])
def test_ramps_are_corrected_from_where_they_touch_to_where_they_end(top: float, slope: float, step: float) -> None:
    depth = 20e-3 * np.tan(np.radians(slope)) - top * 1e-3
    body = f"G0 X-40 Y0 Z5\nG0 Z{top}\nG1 X-20 Z-{depth * 1e3:.4f} F400\nG1 X20 F600\n"
    found = rm.compensate(SETUP.replace(source=program(body), step_mm=step))
    assert found.before.max > 0.7e-3
    assert found.after.max < 0.03e-3
    assert found.lines_out < 30  # and does not go to and fro before it touches


@pytest.mark.parametrize("slope", [1.0, 2.0])
def test_the_end_of_a_gentle_ramp_is_corrected_at_every_step(slope: float) -> None:
    """Told from the path that was meant; beyond the ramp, where nothing depends on it, by the text's own tips, too."""
    depth = 20e-3 * np.tan(np.radians(slope))
    body = f"G0 X-40 Y0 Z5\nG0 Z0\nG1 X-20 Z-{depth * 1e3:.4f} F400\nG1 X20 F600\n"
    setup = SETUP.replace(source=program(body), step_mm=0.25)
    found = rm.compensate(setup)
    run = rm.simulate(setup.replace(source=rm.GCodeSource(found.text.replace("robomill", "x"), "told.nc")))
    tips = run.path.p + run.setup.to_part(run.delta)
    x, y, z = tips[run.path.cutting].T
    level = x > -16e-3
    assert np.abs(z[level] + depth).max() < 5e-6
    assert np.abs(y[level]).max() < 5e-6
    assert found.before.max > 0.7e-3
    assert found.after.max < 0.02e-3
