"""The improve page: joints ranked, the best one used and undone, an empty state where the cut has no result."""

from __future__ import annotations

import numpy as np
from conftest import go, store, words
from streamlit.testing.v1 import AppTest

from robomill.simulation.run import simulate
from robomill.toolpath.source import GCodeSource


def test_the_best_joint_can_be_used_and_taken_back(app: AppTest) -> None:
    go(app, "7_Improve")
    assert not app.exception
    before = store(app).project.setup
    result = simulate(before)
    left = np.linalg.norm(result.delta[:, None] - 0.5 * result.delta_joint, axis=-1)[result.judged].max(axis=0)
    best = before.robot.joint_numbers[int(left.argmin())]
    assert f"Joint {best} twice as stiff: a wall error of 0.230 mm becomes 0." in words(app)
    assert "Verdict then" in words(app)
    app.button(key=f"improve.use.{best}").click().run()
    assert not app.exception
    assert "of the tolerance is used, 77 % before it" in words(app)
    used = store(app).project.setup
    assert abs(simulate(used).max_deviation - left.min()) < 1e-9 * left.min()
    app.button(key="undo").click().run()
    assert store(app).project.setup.digest() == before.digest()


def test_a_cut_that_is_not_judged_is_not_called_good_with_a_stiffer_joint(app: AppTest) -> None:
    kept = store(app)
    source = GCodeSource("G21 G90 S12000 M3\nG0 X0 Y0 Z5\nG1 Z-2 F300\nG1 X20 F1800\nG0 Z5\nG33 Z-8 K1\nG0 Z5\nM2\n")
    kept.project = kept.project.replace(setup=kept.project.setup.replace(source=source))
    go(app, "7_Improve")
    assert not app.exception
    assert "met with that joint" not in words(app)
    assert "Not judged" in words(app)


def test_a_cut_out_of_reach_has_nothing_to_improve(app: AppTest) -> None:
    kept = store(app)
    T_MW = np.array(kept.project.setup.T_MW)
    T_MW[0, 3] = 50.0
    kept.project = kept.project.replace(setup=kept.project.setup.replace(T_MW=T_MW))
    go(app, "7_Improve")
    assert not app.exception
    assert "There is no cut to improve yet." in words(app)
