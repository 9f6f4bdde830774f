"""The eight lessons on the page: by their address, step by step; the exercises by student number."""

from __future__ import annotations

import pytest
from conftest import go, words
from streamlit.testing.v1 import AppTest

from robomill import learn
from robomill.learn.lesson import COUNT
from robomill.units import from_si

LEARN = "8_Learn"


def at(app: AppTest, **address: str) -> AppTest:
    go(app, LEARN)
    for key, value in address.items():
        app.query_params[key] = value
    app.run()
    assert not app.exception
    return app


def tex(app: AppTest) -> str:
    return "\n".join(each.value for each in app.get("latex")) if app.get("latex") else words(app)


@pytest.mark.parametrize("number", range(1, COUNT + 1))
def test_each_lesson_asks_reveals_gives_its_reason_and_a_try_to_break_it(app: AppTest, number: int) -> None:
    at(app, lesson=str(number))
    assert f"Lesson {number} of 8" in words(app)
    assert "Try to break it.</b>" not in words(app)
    for _ in range(3):
        app.button(key="learn.next").click().run()
        assert not app.exception
    assert app.query_params["step"] in ("4", ["4"])
    assert "Try to break it.</b>" in words(app)
    assert tex(app)
    app.button(key="learn.back").click().run()
    assert "Try to break it.</b>" not in words(app)


def test_a_prediction_is_kept_and_judged_at_the_reveal(app: AppTest) -> None:
    at(app, lesson="2")
    app.radio(key="learn.choice.2").set_value(3).run()
    app.button(key="learn.next").click().run()
    assert "Joint 3 gives 70 % of the displacement." in words(app)
    assert "Look again. You said: Joint 4. Joint 4 gives 0 % of the displacement." in words(app)
    app.radio(key="learn.choice.2").set_value(2).run()
    assert "You are right." in words(app)


def test_a_typed_prediction_is_judged_by_what_is_wrong_with_it(app: AppTest) -> None:
    at(app, lesson="7", step="2")
    app.text_input(key="learn.typed.7").set_value("0,275").run()
    assert "That is all of it, as if nothing had been corrected." in words(app)
    app.text_input(key="learn.typed.7").set_value("46 µm").run()
    assert ">Right.<" in words(app)


@pytest.mark.parametrize(
    "address",
    [
        {"lesson": "0"},
        {"lesson": "9"},
        {"lesson": "-1"},
        {"lesson": "<b>"},
        {"lesson": "1e3"},
        {"lesson": "²"},
        {"step": "3"},
    ],
)
def test_an_address_that_means_nothing_is_the_first_screen(app: AppTest, address: dict[str, str]) -> None:
    at(app, **address)
    assert app.button(key="learn.reveal")


def test_a_step_that_is_none_is_the_first(app: AppTest) -> None:
    at(app, lesson="3", step="99")
    assert app.button(key="learn.next").label == "Show what happens"


def test_the_projector_enlarges_and_leaves_the_menu_away(app: AppTest) -> None:
    at(app, lesson="1", projector="1")
    assert "html { font-size: 140%" in words(app)
    app.button(key="learn.projector").click().run()
    assert "html { font-size: 140%" not in words(app)
    assert "projector" not in app.query_params


def test_the_first_screen_leads_to_the_lessons_and_back(app: AppTest) -> None:
    go(app, LEARN)
    app.button_group(key="learn.row").set_value(4).run()
    assert "Lesson 4 of 8" in words(app)
    app.button_group(key="learn.row").set_value(0).run()
    assert app.button(key="learn.reveal")


def test_exercises_are_those_of_the_library_and_the_file_holds_what_was_typed(app: AppTest) -> None:
    at(app, lesson="exercises")
    app.text_input(key="learn.number").set_value(" 0012 34567 ").run()
    assert not app.exception
    tip = learn.exercise("tip", 1234567)
    shown = "\n".join(each.value for each in app.markdown)
    assert tip.text.split(".")[1].strip() in shown.replace("\\", "")
    key = "learn.answer.tip:slavkovic_5r/1234567/"
    app.text_input(key=key).set_value(f"{from_si(-tip.answer, 'mm'):.5f}").run()
    assert any("the sign is wrong" in each.value for each in app.warning)
    app.text_input(key=key).set_value(f"{from_si(tip.answer, 'mm'):.5f}".replace(".", ",")).run()
    assert any(each.value == "Right." for each in app.success)
    app.button(key="learn.hint.tip:slavkovic_5r/1234567/").click().run()
    assert f"Hint: {tip.hints[0]}" in words(app)


def test_a_student_number_that_is_none_is_refused_in_a_sentence(app: AppTest) -> None:
    at(app, lesson="exercises")
    app.text_input(key="learn.number").set_value("<b>1</b>").run()
    assert any("Student number: found" in each.value for each in app.error)


@pytest.mark.parametrize("robot", ["kuka_kr270", "fanuc_r2000ic", "planar_3r"])
def test_lessons_hold_for_other_arms(app: AppTest, robot: str) -> None:
    go(app, "1_Robot")
    app.selectbox(key="robot.name").set_value(robot).run()
    go(app, LEARN)
    for number in range(1, COUNT + 1):
        app.query_params["lesson"], app.query_params["step"] = str(number), "4"
        app.run()
        assert not app.exception, number


def test_the_code_holds_the_address_of_the_lesson(app: AppTest, monkeypatch: pytest.MonkeyPatch) -> None:
    """A picture of ours, drawn here: what it holds is what segno makes of that address."""
    import segno

    from robomill.ui.learn import steps

    shown: list[str] = []
    monkeypatch.setattr(steps.st, "html", shown.append)
    monkeypatch.setattr(steps.pieces, "note", shown.append)

    class Context:
        url = "http://127.0.0.1:8501/Learn?lesson=2&step=3"

    monkeypatch.setattr(steps.st, "context", Context)
    steps._code(steps.Place(3, 2))
    address = "http://127.0.0.1:8501/Learn?lesson=3"
    assert segno.make(address, error="m").png_data_uri(scale=6, border=4) in shown[0]
    assert shown[1:] == [address, "Only this computer opens that address: serve the app to others with robomill serve."]
