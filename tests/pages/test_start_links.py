"""Links: a page opened by one shows its project; work of one's own is never lost to it; what is handed on stands on
every page."""

from __future__ import annotations

from conftest import PAGES, go, store, words
from streamlit.testing.v1 import AppTest

from robomill.ui.project import Project, preset_setup
from robomill.ui.session import EDITED
from robomill.ui.sharing import address
from robomill.units import to_si

HEART = Project(preset_setup("heart"), preset="heart")
EDITED_HEART = HEART.replace(setup=HEART.setup.replace(tolerance=to_si(0.47, "mm"), provenance={"tolerance": EDITED}))


def came_by(app: AppTest, **said: str) -> AppTest:
    for key, value in said.items():
        app.query_params[key] = value
    return app.run()


def pressed(app: AppTest, label: str) -> AppTest:
    return next(each for each in app.button if each.label == label).click().run()


def test_a_link_opens_its_project_where_no_work_is_in_force(app: AppTest) -> None:
    said = address.packed(EDITED_HEART)
    assert said is not None
    came_by(app, **said)
    assert not app.exception
    assert store(app).project.digest() == EDITED_HEART.digest()
    assert store(app).project.preset == "heart"
    assert not {*said} & {*app.query_params}
    pressed(app, "Undo")
    assert store(app).project.preset == "paper_flute"


def test_work_of_ones_own_is_kept_until_one_says_so(app: AppTest) -> None:
    own = store(app).project
    mine = own.replace(setup=own.setup.replace(tolerance=to_si(0.41, "mm")))
    store(app).project = mine
    came_by(app, preset="heart")
    assert store(app).project.digest() == mine.digest()
    assert f"The link holds another project, {HEART.setup.name}" in words(app)
    pressed(app, "Keep mine")
    assert "The link holds" not in words(app)
    assert store(app).project.digest() == mine.digest()
    came_by(app, preset="heart")
    pressed(app, "Open it")
    assert store(app).project.digest() == HEART.digest()
    pressed(app, "Undo")
    assert store(app).project.digest() == mine.digest()


def test_a_damaged_link_is_refused_in_a_sentence_and_nothing_is_lost(app: AppTest) -> None:
    before = store(app).project.digest()
    came_by(app, preset="paper_flute", edits="1<script>")
    assert [each.value for each in app.error if "damaged" in each.value] != []
    assert store(app).project.digest() == before
    pressed(app, "OK")
    assert not any("damaged" in each.value for each in app.error)


def test_a_report_and_what_to_share_stand_on_every_page(app: AppTest) -> None:
    for page in PAGES:
        go(app, page)
        assert not app.exception
        assert "Report" in [each.label for each in app.get("download_button")]
        assert "Share" in [each.label for each in app.button]


def test_a_link_a_command_and_python_are_there_to_be_copied(app: AppTest) -> None:
    pressed(app, "Share")
    link, command, python = (each.value for each in app.code[:3])
    assert link.endswith("?preset=paper_flute")
    assert command == "robomill simulate paper_flute"
    assert 'rm.load_setup("paper_flute")' in python


def test_a_page_of_maps_and_load_tests_hands_on_what_it_shows(app: AppTest) -> None:
    for page, verb in (("2_Workspace", "map"), ("3_Compliance", "map"), ("4_Identification", "identify")):
        pressed(go(app, page), "Share")
        _, command, python = (each.value for each in app.code[:3])
        assert command.startswith(f"robomill {verb} slavkovic_5r")
        assert "rm.identify" in python if verb == "identify" else "rm.compliance_map" in python
