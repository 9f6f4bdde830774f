"""A study and the strategy lab on Improve: what is shown is what the command line computes of the description."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from conftest import go, store, words
from streamlit.testing.v1 import AppTest

import robomill as rm
from robomill.study.described import load_study
from robomill.ui.improve import studied


def settled(app: AppTest, wanted: str) -> None:
    """Run the page until it says ``wanted``."""
    for _ in range(120):
        if wanted in words(app):
            return
        app.run()
    raise AssertionError(f"{wanted!r} never came: {words(app)[-2000:]}")


def test_a_study_of_two_numbers_is_run_and_shown_and_its_file_gives_the_same_rows(app: AppTest, tmp_path: Path) -> None:
    go(app, "7_Improve")
    assert not app.exception
    settled(app, "A study: many runs of this cut")
    store(app).values[studied.KEPT] = studied.Asked(("force.feed_normal_N", "part.zero_mm[2]"), steps=3)
    app.run()
    assert "9 points, about" in words(app)
    app.button(key=f"{studied.KEPT}.ask").click().run()
    settled(app, "9 points done in")
    assert not app.exception
    setup = store(app).project.setup
    offered = {each.key: each for each in studied.usual_parameters(setup)}
    study = studied.described(setup, offered, store(app).values[studied.KEPT])
    place = tmp_path / "study.toml"
    place.write_text(studied.study_to_toml(study), encoding="utf-8")
    found = rm.run_study(load_study(place), tmp_path / "out", processes=1).to_dataframe()
    best = 100.0 * found["share"].min()
    assert f"{best:.0f} %" in words(app)
    lowest = found.loc[found["share"].idxmin()]
    assert np.isclose(lowest["force.feed_normal_N"], 50.0)
    run = rm.simulate(
        setup.replace(force=rm.PathForce(feed_normal=50.0), part_zero_mm=(0.0, float(lowest["part.zero_mm[2]"]), 2.0))
    )
    assert np.isclose(lowest["share"], run.verdict.share, rtol=1e-9)


def test_a_study_that_takes_too_long_beside_a_page_says_how_to_run_it(app: AppTest) -> None:
    store(app).values[studied.KEPT] = studied.Asked(
        ("force.feed_normal_N", "part.zero_mm[2]"), kind="sobol", count=5000
    )
    go(app, "7_Improve")
    settled(app, "A study: many runs of this cut")
    assert "Here a study has at most 1000 points" in words(app)
    assert not [each for each in app.button if each.key == f"{studied.KEPT}.ask"]


def test_ways_to_cut_stand_side_by_side_on_one_scale(app: AppTest) -> None:
    kept = store(app)
    setup = rm.load_setup("paper_flute/setup_process")
    kept.project = kept.project.replace(setup=setup)
    kept.values["improve.remedy"] = "cut"
    go(app, "7_Improve")
    settled(app, "In 2 passes")
    assert not app.exception
    page = "".join(each.proto.body for each in app.get("html"))
    assert page.count("<figure") == 8
    advice = rm.advise(setup)
    for way in advice.ways:
        assert f"{way.seconds:.1f} s" in page
    assert page.count("rm-best") == 1
