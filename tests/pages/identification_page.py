"""What the tests of the identification page share: how it is opened, filled in and read."""

from __future__ import annotations

from pathlib import Path

from streamlit.testing.v1 import AppTest

from robomill.ui.bench import Bench
from robomill.ui.identification.laboratory import KEY, Exercise
from robomill.ui.session import KEY as PROJECT

PAGE = Path(__file__).resolve().parents[2] / "pages" / "4_Identification.py"
HEADER = "theta1_deg,theta2_deg,theta3_deg,theta4_deg,theta5_deg,Fx_N,Fy_N,Fz_N,dx_mm,dy_mm,dz_mm"
GOOD = "-20.556045,-41.011425,6.666809,0,34.344616,250,0,0,0.6803,-0.0547,-0.1071"


def opened() -> AppTest:
    """The identification page, opened first and run once."""
    return AppTest.from_file(str(PAGE), default_timeout=60).run()


def bench(page: AppTest) -> Bench:
    return page.session_state[PROJECT].project.bench  # type: ignore[no-any-return]


def exercise(page: AppTest) -> Exercise:
    return page.session_state[PROJECT].values[KEY]  # type: ignore[no-any-return]


def html(page: AppTest) -> str:
    """What stands on the page; a number and its unit are held together on it by a space of their own."""
    return "\n".join(element.proto.body for element in page.get("html")).replace("\u00a0", " ")


def typed(page: AppTest, text: str) -> AppTest:
    return page.text_area(key="identification.rows").set_value(text).run()


def pick(page: AppTest, key: str, value: str) -> AppTest:
    return next(g for g in page.get("button_group") if g.key == key).set_value(value).run()


def click(page: AppTest, key: str) -> AppTest:
    return page.button(key=key).click().run()
