"""The milling page on process data: models, materials, springs, stock, scrubber, metrology, refusals."""

from __future__ import annotations

import dataclasses
import html
import json
import re

import numpy as np
import pytest
from conftest import errors, go, looked, number, store, words
from streamlit.testing.v1 import AppTest

from robomill.compliance.springs.joint_bending import JointBending
from robomill.compliance.springs.spindle import SpindleSpring
from robomill.compliance.springs.tool_bending import ToolBending
from robomill.cutting.forces.kienzle import KienzleForce
from robomill.cutting.forces.measured import MeasuredForce
from robomill.cutting.forces.mechanistic import MechanisticForce
from robomill.cutting.process import ProcessForce
from robomill.errors import CuttingError, RobotError
from robomill.io.materials import load_material
from robomill.toolpath.source import GCodeSource
from robomill.ui.milling import materials as material_panel, metrology as metrology_panel, springs as springs_panel
from robomill.ui.milling.body import QUESTION
from robomill.ui.milling.force import FILE as FORCE_FILE


def milling(app: AppTest, question: str = "part") -> AppTest:
    """The milling page with one of its questions open."""
    store(app).values[QUESTION] = question
    return go(app, "6_Milling")


def mechanistic(app: AppTest) -> AppTest:
    """The paper's slot with the force from process data."""
    return app.selectbox(key="force.kind").set_value("mechanistic").run()


@pytest.mark.parametrize("question", ["force", "tip", "part"])
def test_every_question_answers_without_an_exception(app: AppTest, question: str) -> None:
    milling(app, question)
    assert not app.exception
    assert errors(app) == []
    assert len(app.get("plotly_chart")) == {"force": 3, "tip": 5, "part": 4}[question]


def test_process_data_give_the_papers_numbers_with_their_band(app: AppTest) -> None:
    mechanistic(milling(app, "force"))
    assert not app.exception
    assert isinstance(store(app).project.setup.force, MechanisticForce)
    assert store(app).project.setup.engagement
    text = words(app)
    assert "feed-normal +110.4 N, axial −23.3 N" in text
    assert "The groove is 0.28 mm off in Y" in text
    assert re.search(r"\d to \d[\d.]*: published coefficients", html.unescape(text))
    assert "Peak of a turn" in text


def test_axial_pull_can_be_left_out(app: AppTest) -> None:
    mechanistic(milling(app, "force"))
    app.toggle(key="force.axial").set_value(False).run()
    assert not app.exception
    assert "The groove is 0.26 mm off in Y" in words(app)


def test_coupling_says_what_it_did_and_needs_the_material(app: AppTest) -> None:
    milling(app, "force")
    assert app.toggle(key="coupling").disabled
    mechanistic(app)
    app.toggle(key="coupling").set_value(True).run()
    assert not app.exception
    text = words(app)
    assert "evaluations" in text
    assert "Against one pass" in text
    app.selectbox(key="force.kind").set_value("constant").run()
    assert not app.exception
    assert not store(app).project.setup.coupling


def test_kienzle_row_and_back(app: AppTest) -> None:
    milling(app, "force")
    app.selectbox(key="force.kind").set_value("kienzle").run()
    assert not app.exception
    assert isinstance(store(app).project.setup.force, KienzleForce)
    assert "gives no radial and no axial force" in words(app)
    assert "rm-tile ok" not in words(app)
    for part in ("radial", "axial"):  # the boxes stand where the row does not give it
        app.text_input(key=f"force.{part}_share").set_value("0,3").run()
    assert not app.exception
    assert store(app).project.setup.force.row.unknown == ()
    assert "assumed 0.3 of the tangential one" in words(app)
    app.selectbox(key="force.kind").set_value("path").run()
    assert not app.exception
    assert number(app, "force.feed_normal:N").value > 0


def test_a_row_of_ones_own_joins_the_band(app: AppTest) -> None:
    mechanistic(milling(app, "force"))
    app.text_input(key="milling.material.name").set_value("My 7075").run()
    app.button(key="milling.material.add").click().run()
    assert "where its numbers come from" in errors(app)[0]
    assert app.text_input(key="milling.material.name").value == "My 7075"
    app.text_input(key="milling.material.source").set_value("our dynamometer").run()
    app.button(key="milling.material.add").click().run()
    assert not app.exception
    force = store(app).project.setup.force
    assert isinstance(force, ProcessForce)
    assert force.material.name == "my_7075"
    assert force.material.provenance.kind == "user"
    assert "al7075_t6_carbide_ref190" in [m.name for m in force.alternatives]


def test_edited_coefficients_are_the_users_and_refusals_name_them() -> None:
    row = load_material("al7075_t6_carbide_ref190")
    frame = material_panel.coefficient_frame(row)
    assert frame["value"].tolist() == pytest.approx([767.01e6, 27.7e3, 168.8e6, 26.6e3, 222.0e6, 0.7e3])
    frame.loc[0, "value"] = 800e6
    edited = material_panel.with_coefficients(row, frame)
    assert edited.Ktc == pytest.approx(800e6)
    assert edited.provenance.kind == "user"
    assert "edited" in edited.title
    frame.loc[5, "value"] = None
    with pytest.raises(CuttingError, match="Kac is given without Kae"):
        material_panel.with_coefficients(row, frame)
    frame.loc[5, "value"] = 0.7e3
    frame.loc[0, "value"] = -5e6
    with pytest.raises(CuttingError, match="Ktc: found −5 N/mm²"):
        material_panel.with_coefficients(row, frame)


def test_springs_have_their_own_lines(app: AppTest) -> None:
    milling(app, "tip")
    before = store(app).project.setup
    app.toggle(key="springs.tool_bending").set_value(True).run()
    app.toggle(key="springs.spindle").set_value(True).run()
    assert not app.exception
    assert [type(s) for s in store(app).project.setup.springs] == [ToolBending, SpindleSpring]
    text = words(app)
    assert "tool bending" in text
    assert "spindle and holder" in text
    number(app, "springs.spindle.lateral:um/N").set_value(-1.0).run()
    assert len(errors(app)) == 1
    assert "Spindle and holder, Across: found −1 µm/N" in errors(app)[0]
    number(app, "springs.spindle.lateral:um/N").set_value(0.1).run()
    assert errors(app) == []
    number(app, "cutter.diameter:mm").set_value(10.0).run()
    assert app.button(key="springs.tool_bending.same").label == "It bends as 8.0 mm: take the cutter's diameter"
    app.button(key="springs.tool_bending.same").click().run()
    (bending,) = [spring for spring in store(app).project.setup.springs if isinstance(spring, ToolBending)]
    assert bending.diameter == pytest.approx(10e-3)
    number(app, "cutter.diameter:mm").set_value(8.0).run()
    app.toggle(key="springs.tool_bending").set_value(False).run()
    app.toggle(key="springs.spindle").set_value(False).run()
    assert store(app).project.setup.digest() == before.digest()


def test_bending_and_weight_tables_to_springs_and_back() -> None:
    frame = springs_panel.joint_frame(JointBending, 5, {})
    assert springs_panel.joint_springs(JointBending, frame) == []
    frame.loc[1, "about y"] = 3e-7
    (spring,) = springs_panel.joint_springs(JointBending, frame)
    assert (spring.joint, spring.C_x, spring.C_y) == (2, 0.0, pytest.approx(3e-7))
    assert springs_panel.joint_frame(JointBending, 5, {2: spring}).loc[1, "about y"] == 3e-7
    turned = springs_panel.joint_frame(JointBending, 5, {2: dataclasses.replace(spring, turned=True)})
    assert [each.turned for each in springs_panel.joint_springs(JointBending, turned)] == [True]
    weight = springs_panel.weight_frame(5, None)
    assert springs_panel.weight_from(weight) is None
    weight.loc[2, ["kg", "x mm"]] = 40.0, 0.25
    links = springs_panel.weight_from(weight)
    assert links is not None
    assert links.mass[2] == 40.0
    assert links.centre[2, 0] == pytest.approx(0.25)
    weight.loc[3, "y mm"] = np.nan
    with pytest.raises(RobotError, match="joint 4: y mm is missing"):
        springs_panel.weight_from(weight)


def test_cutter_lengths_warn_and_may_be_left_out(app: AppTest) -> None:
    milling(app, "force")
    app.text_input(key="cutter.flute_length:mm").set_value("1").run()
    assert not app.exception
    assert any("beyond the flute length" in w.value for w in app.warning)
    app.text_input(key="cutter.stick_out:mm").set_value("0.5").run()
    assert "longer than the stick-out" in errors(app)[0]
    app.text_input(key="cutter.stick_out:mm").set_value("").run()
    assert errors(app) == []
    assert store(app).project.setup.cutter.stick_out is None


def test_worst_point_and_lines_move_the_scrubber(app: AppTest) -> None:
    milling(app, "tip")
    mechanistic(app)
    looked(app, station=0.2)
    assert "(−30.00, 0.00, −2.00)" in words(app)
    app.button(key="bar.worst").click().run()
    assert not app.exception
    assert store(app).project.view.station == pytest.approx(1.0)
    assert "▸ 7" in words(app)


def test_the_papers_numbers_stand_on_one_chart(app: AppTest) -> None:
    milling(app)
    charts = [json.loads(c.proto.spec) for c in app.get("plotly_chart")]
    chart = next(c for c in charts if "Sideways error" in json.dumps(c["layout"].get("xaxis")))
    text = " ".join(a["text"] for a in chart["layout"]["annotations"])
    for value in ("0.23 mm", "0.264 mm", "0.29 mm", "about 0.30 mm", "0.277 mm", "0.321 mm"):
        assert value in text, text


FORCE_HEAD = "t_s,F_feed_normal_N\n"
GOOD = FORCE_HEAD + "".join(f"{0.002 * k:.3f},{100 + (k % 2):d}\n" for k in range(20_000))
BAD_FORCES = [
    (
        FORCE_HEAD + "0,1\n0.1,two\n0.2,3\n0.3,4\n0.4,5\n",
        "row 3, column F_feed_normal_N: found 'two', expected a number",
    ),
    (
        FORCE_HEAD + "0,1\n0.1,nan\n0.2,3\n0.3,4\n0.4,5\n",
        "row 3, column F_feed_normal_N: found 'nan', expected a finite",
    ),
    (FORCE_HEAD + "0,1\n0.2,2\n0.1,3\n0.3,4\n0.4,5\n", "row 4, column t_s"),
    (FORCE_HEAD + "0,1\n0.1,2\n0.1,3\n0.3,4\n0.4,5\n", "row 4, column t_s"),
    (FORCE_HEAD + "".join(f"{k},{100}\n" for k in [0, 1, 2, 3, 4, 5, 30, 31, 32]), "a gap from 5 to 30"),
    (GOOD.replace(",10", ",0.10"), "is it in kN"),
    (FORCE_HEAD + "".join(f"{0.002 * k:.3f},100\n" for k in range(50)), "the path cuts from"),
    ("x,y\n1,2\n1,2\n1,2\n1,2\n1,2\n", "row 1: no column is known among x, y; expected a header such as t_s"),
]


def test_a_bad_force_record_is_one_sentence_and_the_force_stays(app: AppTest) -> None:
    milling(app, "tip")
    before = store(app).project.setup.digest()
    app.selectbox(key="force.kind").set_value("measured").run()
    assert not app.exception
    for text, sentence in BAD_FORCES:
        give(app, "milling.force.file", "record.csv", text.encode())
        assert not app.exception
        assert len(errors(app)) == 1
        assert sentence in errors(app)[0]
        assert app.selectbox(key="force.kind").value == "measured"
    assert store(app).project.setup.digest() == before


def test_a_force_record_is_filtered_and_laid_on_the_path(app: AppTest) -> None:
    milling(app, "tip")
    app.selectbox(key="force.kind").set_value("measured").run()
    give(app, "milling.force.file", "record.csv", GOOD.encode())
    assert not app.exception
    assert errors(app) == []
    force = store(app).project.setup.force
    assert isinstance(force, MeasuredForce)
    assert force.cutoff == 50.0
    assert "low-pass 50 Hz, zero phase" in words(app)
    assert "The groove is 0.23 mm off in Y" in words(app)
    assert store(app).values[FORCE_FILE][1] == "record.csv"
    number(app, "force.cutoff:Hz").set_value(0.0).run()
    assert len(errors(app)) == 1
    assert number(app, "force.cutoff:Hz").value == 0.0
    number(app, "force.cutoff:Hz").set_value(20.0).run()
    number(app, "force.start:s").set_value(1.5).run()
    app.toggle(key="force.filter").set_value(False).run()
    assert not app.exception
    force = store(app).project.setup.force
    assert (force.cutoff, force.start) == (None, 1.5)
    assert "force.cutoff:Hz" not in {n.key for n in app.text_input}
    assert "unfiltered" in words(app)
    app.toggle(key="force.filter").set_value(True).run()
    assert store(app).project.setup.force.cutoff == 50.0


def test_a_record_is_read_again_when_its_reading_changes(app: AppTest) -> None:
    milling(app, "tip")
    app.selectbox(key="force.kind").set_value("measured").run()
    give(app, "milling.force.file", "record.csv", GOOD.encode())
    app.button_group(key="milling.force.side").set_value("part").run()
    assert not app.exception
    on_tool = store(app).project.setup.force.record.F[:, 1].mean()
    assert on_tool == pytest.approx(-100.5, abs=0.01)


def give(app: AppTest, key: str, name: str, data: bytes) -> None:
    """Put a file into the uploader whose key begins with ``key``."""
    (uploader,) = [u for u in app.file_uploader if str(u.key).startswith(key)]
    uploader.set_value((name, data, "text/plain")).run()


def box(scale: float = 1.0, open_: bool = False) -> bytes:
    """The paper's blank as an STL."""
    trimesh = pytest.importorskip("trimesh")
    solid = trimesh.creation.box(extents=[110, 40, 10])
    solid.apply_translation([9, 0, -5])
    solid.apply_scale(scale)
    if open_:
        solid.update_faces(np.arange(len(solid.faces)) > 0)
    return bytes(solid.export(file_type="stl"))


def test_stock_from_stl_in_its_own_unit(app: AppTest) -> None:
    milling(app, "tip")
    app.button_group(key="milling.stock").set_value("stl").run()
    give(app, "milling.stock.file", "blank.stl", box(1e-3))
    assert not app.exception
    assert any("if they are metres" in w.value for w in app.warning)
    app.button_group(key="milling.stock.unit").set_value("m").run()
    assert not app.exception
    assert errors(app) == []
    stock = store(app).project.setup.stock
    assert stock is not None
    np.testing.assert_allclose(stock.upper - stock.lower, [0.11, 0.04, 0.01])
    assert "The groove is 0.23 mm off in Y" in words(app)
    app.button_group(key="milling.stock").set_value("path").run()
    assert store(app).project.setup.stock is None
    app.button_group(key="milling.stock").set_value("block").run()
    assert not app.exception


def test_a_bad_stock_is_one_sentence_and_the_stock_stays(app: AppTest) -> None:
    milling(app, "tip")
    before = store(app).project.setup.digest()
    app.button_group(key="milling.stock").set_value("stl").run()
    for data, sentence in ((b"", "is empty"), (b"no mesh at all", "STL"), (box(open_=True), "not watertight")):
        give(app, "milling.stock.file", "blank.stl", data)
        assert not app.exception
        assert len(errors(app)) == 1
        assert sentence in errors(app)[0]
    assert store(app).project.setup.digest() == before


def test_a_measured_profile_lies_over_the_prediction(app: AppTest) -> None:
    milling(app)
    give(app, "milling.profile.file:0", "cmm.csv", b"station_mm,offset_mm\n10,0.29\n50,0.30\n90,0.29\n")
    assert not app.exception
    text = words(app)
    assert "cmm.csv" in text
    assert "it gives 78 % of what was measured" in text
    give(app, "milling.profile.file:0", "cmm.csv", b"station_mm,offset_mm\n10,0.29\nfifty,0.30\n")
    assert not app.exception
    assert "cmm.csv, row 3, column station_mm" in errors(app)[0]
    assert "cmm.csv" in words(app), "the good profile stays"


def test_a_stopped_spindle_and_no_feed_are_refused_with_their_line(app: AppTest) -> None:
    mechanistic(milling(app))
    kept = store(app)
    source = kept.project.setup.source
    assert isinstance(source, GCodeSource)
    stopped = dataclasses.replace(source, text=source.text.replace("N20 S12000 M3\n", ""))
    kept.project = dataclasses.replace(kept.project, setup=kept.project.setup.replace(source=stopped))
    app.run()
    assert not app.exception
    assert len(errors(app)) == 1
    assert "spindle stands still" in errors(app)[0]


def test_inputs_of_every_panel_are_still_there_when_nothing_can_be_computed(app: AppTest) -> None:
    milling(app)
    number(app, "stock.lower[2]:mm").set_value(-1.0).run()
    assert not app.exception
    keys = {n.key for n in app.text_input}
    assert {"cutter.diameter:mm", "tolerance:mm", "stock.lower[2]:mm"} <= keys


def test_form_error_is_apart_from_the_shift(app: AppTest) -> None:
    milling(app)
    text = words(app)
    assert "Form error" in text
    assert "Walls out of tolerance" in text
    assert "Left wall" in text


def test_titles_and_names_cover_every_kind() -> None:
    assert metrology_panel.STATIONS % 2 == 1
