"""What a page that has been left still says calls it back no more; everything else is asked for as before."""

import asyncio
from types import SimpleNamespace

import pytest
from streamlit.proto.ClientState_pb2 import ClientState
from streamlit.runtime.scriptrunner_utils.script_requests import RerunData

from robomill.ui.project import DEFAULT_PRESET, Project, preset_setup
from robomill.ui.serving.asked import ASKED, awaiting_drawing, hearing_out, heeding_pages
from robomill.ui.session import KEY, Store, Told


def said(page: str, boxes: int = 2, part: str = "", tick: bool = False) -> ClientState:
    """What a browser says: the page it is on, how many boxes stand there, and which part of it is to run."""
    made = ClientState(page_script_hash=page, fragment_id=part, is_auto_rerun=tick)
    for box in range(boxes):
        made.widget_states.widgets.add(id=f"box-{box}", double_value=1.0)
    return made


def link(page: str) -> ClientState:
    """A click on a link: of the boxes of the page that is left nothing is said."""
    return said(page, boxes=0)


class Held(SimpleNamespace):
    """The state of a session, with a store once it has one."""

    store: Store | None = None

    def __contains__(self, key: str) -> bool:
        return key == KEY and self.store is not None

    def __getitem__(self, _: str) -> Store | None:
        return self.store


class Session:
    """The runs that a server was asked for, of a page whose parts are all drawn anew as it comes."""

    def __init__(self, *gone: str) -> None:
        self.runs: list[tuple[str, str, int]] = []
        self.gone = gone
        self.left: set[str] = set()
        self._fragment_storage = self
        self._session_state = Held(_new_widget_state=SimpleNamespace(widget_metadata={}))

    def registration_sequence(self) -> int:
        return 0

    def ids_registered_after(self, _: int) -> set[str]:
        return {"map", "bar", "picture", "table"} - self.left

    def has_fragment(self, part: str) -> bool:
        return part not in self.gone

    def say(self, what: ClientState | None) -> list[tuple[str, str, int]]:
        """The runs after it: page, part, boxes."""
        heeding_pages(lambda session, asked: session.runs.append(told(asked)))(self, what)
        return self.runs


def told(asked: ClientState | None) -> tuple[str, str, int]:
    return (
        ("same", "", 0)
        if asked is None
        else (asked.page_script_hash, asked.fragment_id, len(asked.widget_states.widgets))
    )


def test_a_page_runs_as_it_asks():
    one = Session()
    story = [link(""), said("start"), said("start", part="map"), said("start", part="bar", tick=True), None]
    for what in story:
        one.say(what)
    assert one.runs == [told(what) for what in story]


@pytest.mark.parametrize(
    "late",
    [said("start", part="bar", tick=True), said("start", part="picture"), said("start", part="picture", boxes=0)],
    ids=["a tick", "a picture that looks again", "a part without boxes"],
)
def test_a_part_of_a_page_that_was_left_is_not_run(late: ClientState):
    one = Session()
    one.say(said("start"))
    before = list(one.say(link("robot")))
    assert one.say(late) == before


def test_the_whole_of_a_page_that_was_left_is_the_page_that_was_asked_for():
    """So nobody is left without a page, and what stands in its boxes is heard."""
    one = Session()
    one.say(said("start"))
    one.say(link("robot"))
    assert one.say(said("start", boxes=3))[-1] == ("robot", "", 3)
    assert one.say(said("robot", part="map"))[-1] == ("robot", "map", 2)


def test_what_is_typed_into_a_part_that_is_drawn_anew_is_heard_by_the_whole_page():
    """A tick of such a part is not worth a run."""
    one = Session("map")
    one.say(link("start"))
    assert one.say(said("start", part="map", boxes=3))[-1] == ("start", "", 3)
    assert one.say(said("start", part="table"))[-1] == ("start", "table", 2)
    assert one.say(said("start", part="map", tick=True))[-1] == ("start", "map", 2), "left to Streamlit, which drops it"


def test_back_and_forth():
    one = Session()
    for page in ("start", "robot", "start"):
        assert one.say(link(page))[-1] == (page, "", 0)
    assert one.say(said("start", part="bar", tick=True))[-1] == ("start", "bar", 2)
    before = list(one.runs)
    assert one.say(said("robot", part="bar", tick=True)) == before


def test_a_session_that_nobody_has_asked_anything_yet_runs_what_it_is_told():
    """The first request comes before anybody heeds, or from a page whose server was started again."""
    assert Session().say(said("robot", part="map")) == [("robot", "map", 2)]


def test_sessions_know_only_their_own_page():
    one, other = Session(), Session()
    one.say(link("robot"))
    other.say(link("start"))
    assert other.say(said("start", part="bar", tick=True))[-1] == ("start", "bar", 2)
    assert one.say(said("robot", part="bar", tick=True))[-1] == ("robot", "bar", 2)


def test_a_message_that_names_no_page_goes_through():
    one = Session()
    one.say(link("robot"))
    assert one.say(said("", boxes=1))[-1] == ("", "", 1)


def test_a_part_of_the_page_that_was_left_is_not_run_in_the_new_pages_name_either():
    """Until the browser has put it away, it speaks as if it were of the new page."""
    one = Session()
    one.say(said("start"))
    before = list(one.say(link("robot")))
    one.left = {"picture"}
    assert one.say(said("robot", part="picture")) == before
    assert one.say(said("robot", part="map"))[-1] == ("robot", "map", 2)


@pytest.mark.parametrize(("of", "run"), [(None, ""), ("table", ""), ("map", "map")])
def test_a_click_beside_a_part_that_speaks_in_the_same_instant_is_heard_by_the_page(of: str | None, run: str):
    one = Session()
    one._session_state._new_widget_state.widget_metadata = {"button": SimpleNamespace(fragment_id=of)}
    what = said("start", part="map")
    what.widget_states.widgets.add(id="button", trigger_value=True)
    assert one.say(what)[-1] == ("start", run, 3)


def test_a_click_that_a_tick_brings_is_left_to_its_own_message():
    """Both would have it done: twice."""
    one = Session()
    one._session_state._new_widget_state.widget_metadata = {"button": SimpleNamespace(fragment_id=None)}
    what = said("start", part="bar", tick=True)
    what.widget_states.widgets.add(id="button", trigger_value=True)
    what.widget_states.widgets.add(id="box", double_value=2.0)
    assert one.say(what)[-1] == ("start", "bar", 3)
    assert [box.id for box in what.widget_states.widgets] == ["box-0", "box-1", "box"]


class Runner:
    """A run that has ended (it takes no more), or one that goes on."""

    def __init__(self, ended: bool) -> None:
        self.ended = ended
        self.taken: list[RerunData] = []

    def request_rerun(self, wanted: RerunData) -> bool:
        if not self.ended:
            self.taken.append(wanted)
        return not self.ended


@pytest.mark.parametrize("then", ["nothing", "another run", "a page without it", "another page"])
def test_a_part_waits_for_the_last_words_of_the_run_before_it(then: str):
    """Its own runner would have them dropped. Of what was said before another run, its clicks are news alone."""
    boxes = said("start").widget_states
    boxes.widgets.add(id="button", trigger_value=True)
    part = RerunData(fragment_id="map", page_script_hash="start", widget_states=boxes)
    made: list[RerunData] = []
    session = SimpleNamespace(_scriptrunner=Runner(ended=True), has_fragment=lambda _: then != "a page without it")
    setattr(session, ASKED, "start")
    create = awaiting_drawing(lambda _, wanted: made.append(wanted))
    other = Runner(ended=False)

    async def story() -> None:
        create(session, part)
        await asyncio.sleep(0.05)
        assert made == [], "the last words are still on their way"
        session._scriptrunner = other if then.startswith("another") else None
        if then == "another page":
            setattr(session, ASKED, "robot")
        await asyncio.sleep(0.05)

    asyncio.run(story())
    assert made == ([part] if then == "nothing" else [])
    assert [(run.fragment_id, [box.id for box in run.widget_states.widgets]) for run in other.taken] == (
        [("map", ["button"])] if then == "another run" else []
    )


def test_the_whole_page_waits_for_nobody():
    made: list[object] = []
    page = SimpleNamespace(fragment_id=None)
    awaiting_drawing(lambda _, wanted: made.append(wanted))(SimpleNamespace(_scriptrunner=Runner(ended=True)), page)
    assert made == [page]


@pytest.mark.parametrize(("started", "given"), [(False, []), (True, ["way"])], ids=["not heard yet", "heard"])
def test_a_run_gives_way_only_once_what_was_typed_or_clicked_is_heard(
    started: bool, given: list[str], monkeypatch: pytest.MonkeyPatch
):
    run = SimpleNamespace(has_script_started=started)
    monkeypatch.setattr("robomill.ui.serving.asked.get_script_run_ctx", lambda suppress_warning: run)
    ways: list[str] = []
    hearing_out(ways.append)("way")
    assert ways == given


def test_a_runner_that_has_no_run_yet_gives_way(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("robomill.ui.serving.asked.get_script_run_ctx", lambda suppress_warning: None)
    ways: list[str] = []
    hearing_out(ways.append)("way")
    assert ways == ["way"]


def holding(**boxes: str) -> ClientState:
    """What a browser says whose boxes hold that."""
    made = ClientState(page_script_hash="start")
    for name, text in boxes.items():
        made.widget_states.widgets.add(id=f"$$ID-0-{name}", string_value=text)
    return made


def clicked(what: ClientState) -> ClientState:
    what.widget_states.widgets.add(id="$$ID-1-button", trigger_value=True)
    return what


def ticked(what: ClientState) -> ClientState:
    what.is_auto_rerun = True
    return what


@pytest.mark.parametrize(
    ("said", "new"),
    [
        (holding(feed="3", depth="2"), {"feed"}),
        (clicked(holding(feed="3", depth="2")), {"feed"}),
        (ticked(holding(feed="3", depth="2")), {"feed"}),
        (holding(feed="3", depth="4"), {"feed", "depth"}),
        (clicked(holding(feed="1", depth="2")), set()),
        (ticked(holding(feed="1", depth="2")), set()),
        (holding(feed="1", depth="2"), {"feed", "depth"}),
        (holding(feed="1", depth="5"), {"feed", "depth"}),
        (clicked(holding(feed="1", depth="5")), {"depth"}),
        (ticked(holding(feed="1", depth="5")), {"depth"}),
        (holding(feed="1", depth="2", speed="7"), {"speed"}),
    ],
)
def test_new_is_what_a_browser_last_said_otherwise_or_else_why_it_speaks(said: ClientState, new: set[str]):
    """5 was put into the box of the depth, and 2 stood there before. A message with nothing new but that, and without a
    click, comes for one of its boxes."""
    one = Session()
    one.say(holding(feed="1", depth="2"))
    one._session_state.store = store = Store(Project(preset_setup(DEFAULT_PRESET)))
    store.told["depth"] = Told("5", ("2",), 0.0)
    one.say(said)
    assert set(store.said or {}) == new


def test_what_was_new_stays_so_behind_a_tick():
    """Both may be heard at once."""
    one = Session()
    one._session_state.store = store = Store(Project(preset_setup(DEFAULT_PRESET)))
    one.say(holding(feed="1"))
    one.say(holding(feed="2"))
    before = dict(store.said or {})
    one.say(ticked(holding(feed="2")))
    assert store.said == before != {}
