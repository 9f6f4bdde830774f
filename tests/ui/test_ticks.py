"""Ticks of a page that has been left ask for nothing; everything else is asked for as before."""

from types import SimpleNamespace

from robomill.ui.ticks import heeding_pages


def asked(page, tick=False):
    return SimpleNamespace(page_script_hash=page, is_auto_rerun=tick)


def test_a_tick_counts_for_the_page_that_was_asked_for_last():
    made = []
    request, session = heeding_pages(lambda _, what: made.append(what)), SimpleNamespace()
    story = [
        (asked(""), True),  # the first page of a browser has no name yet
        (asked("start", tick=True), True),
        (asked("start"), True),
        (asked("start", tick=True), True),
        (asked("robot"), True),  # gone to another page,
        (asked("start", tick=True), False),  # while the old one ticks on
        (asked("robot", tick=True), True),
        (None, True),  # the same once more
        (asked("start"), True),  # and back
        (asked("robot", tick=True), False),
        (asked("start", tick=True), True),
    ]
    for what, counts in story:
        made.clear()
        request(session, what)
        assert made == ([what] if counts else [])


def test_sessions_know_only_their_own_page():
    made = []
    request = heeding_pages(lambda session, what: made.append((session.name, what.page_script_hash)))
    one, other = SimpleNamespace(name="one"), SimpleNamespace(name="other")
    request(one, asked("robot"))
    request(other, asked("start"))
    request(other, asked("start", tick=True))
    assert made == [("one", "robot"), ("other", "start"), ("other", "start")]
