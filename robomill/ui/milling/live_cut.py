"""The cut in the browser: picture, scrubber, play. What only looks is drawn there; what has settled comes back here.

The parcel (heights, history, tool, arm: ``viz.live_cut``) is a component of its own, sent once for a result; the look,
which follows the project, is a small one beside it. Its element says in ``data-drawn`` what stands on the screen, set
after it is drawn: ``station=0.500 x10 iso part`` is the share of the length cut, the exaggeration, the camera (a key of
``CAMERAS``, or ``turned`` once it was turned by hand) and the view (a key of ``VIEWS``), with ``so-far`` while
material stands that is not cut yet; ``none`` without WebGL.
"""

from pathlib import Path
from typing import Any

import streamlit as st

from robomill.arrays import digest
from robomill.simulation.result import SimulationResult
from robomill.ui import pieces, session
from robomill.ui.work import cached
from robomill.units import decimals, format_limit, format_times, from_si, to_si, unit_label
from robomill.viz.live_cut import Parcel, parcel
from robomill.viz.rendered.picture import CAMERAS
from robomill.viz.theme import diverging, palette

KEY, SENT, SEQ = "milling.live", "milling.live.sent", "milling.live.seq"
VIEW, WITH, NO_WEBGL = "milling.picture.view", "milling.picture.with", "milling.picture.no-webgl"
VIEWS = {"part": "Part", "pair": "Beside the ideal", "arm": "Arm"}
SHOWS = {
    "tool": "Tool",
    "plane": "Section plane",
    "away": "Cut open at the section",
    "ghost": "Ideal surface as a ghost",
    "so_far": "Only as far as it is cut",
    "path": "Programmed path",
}
FIRST_SHOWN = ("tool", "plane")
EXAGGERATIONS = {1.0: "true", 5.0: "× 5", 10.0: "× 10", 20.0: "× 20", 50.0: "× 50"}
WITHOUT = "This browser draws no 3-D pictures (WebGL is missing or switched off). A rendered picture stands below."
WORDS = {
    "station": "Position along the cut",
    "play": "▶ Play",
    "pause": "❚❚ Pause",
    "back": "‹ Line",
    "next": "Line ›",
    "back_help": "To the line that cuts before this one",
    "next_help": "To the next line that cuts",
    "worst": "Worst",
    "of": "of",
    "line": "line",
    "tip": "tip off by",
    "unreached": "the arm does not reach this point",
    "unjudged": "not judged here",
    "left": "material left",
    "deep": "cut too deep",
    "true": "True displacement",
    "shown": "Displacement shown",
    "arm": "The bend of the arm is shown",
    "part": "the part",
    "unloaded": "Pale: without load.",
    "thin": "Thin line: the ideal cut.",
    "alt": "The part as it is cut, coloured by the error of its surface.",
    "name": "Tip off its path, along the cut; dashed: as much as the tolerance",
    "curve": "Deviation of the tip along the cut against the tolerance (dashed).",
    "without": WITHOUT,
}
PARTS = Path(__file__).parent / "look"


def _text(*names: str) -> str:
    return "\n".join((PARTS / name).read_text(encoding="utf-8") for name in names)


SCRIPT = _text("parcel.js", "scene.js", "draw.js", "live.js")
_parcel = st.components.v2.component("robomill_cut_parcel", html="<i></i>", css="i { display: none }", js=SCRIPT)
_look = st.components.v2.component("robomill_cut", html=_text("live.html"), css=_text("live.css"), js=SCRIPT)


@cached.shared(lambda result, times: (cached.by_result(result), times), "Picture of the cut")
def _made(result: SimulationResult, times: tuple[float, ...]) -> Parcel:
    return parcel(result, times)


def exaggerations() -> dict[float, str]:
    """What may be chosen, with what is in force."""
    times = session.project().view.exaggeration
    return {t: EXAGGERATIONS.get(t, format_times(t, 6)) for t in sorted({*EXAGGERATIONS, times})}


def panel(result: SimulationResult, dark: bool) -> None:
    """Picture, scrubber and what is looked at. While a parcel is made the last one stays, greyed."""
    times = tuple(exaggerations())
    made = pieces.attempt(_made, result, times)
    name = digest((cached.by_result(result), times)) if made is not None else session.kept(SENT, "")
    if made is not None:
        session.keep(SENT, name)
        sent = {"about": made.about, "blob": made.blob}
        _parcel(key="milling.parcel", data={"digest": name, "parcel": sent}, height=1)
    shown = result.setup.digest() == session.project().setup.digest()
    _show(result.setup.tolerance, name, dark, old=made is None or not shown)


def _show(tolerance: float, name: str, dark: bool, *, old: bool) -> None:
    """The look at the parcel of this name; greyed where the set-up in force is another one."""
    view = session.project().view
    p = palette(dark)
    limit = format_limit(tolerance, view.length)
    colours = {
        "background": p.background,
        "metal": p.metal,
        "stops": [colour for _, colour in diverging(False)],
        "cut": p.metal_edge,
        "line": p.text,
        "ghost": p.accent,
        "plane": p.accent,
        "path": p.muted,
        "lost": p.bad,
        "accent": p.accent,
        "link": p.link,
        "joint": p.joint,
        "straight": p.muted,
        "cutter": p.joint,
        "shank": p.metal_edge,
        "spindle": p.link,
    }
    data: dict[str, Any] = {
        "digest": name,
        "state": state(),
        "seq": int(session.kept(SEQ, 0)),
        "old": old,
        "unit": unit_label(view.length),
        "factor": float(from_si(to_si(1.0, "mm"), view.length)),
        "digits": [decimals(view.length, 1), decimals(view.length, None)],
        "words": WORDS,
        "key": {"most": f"+{limit}", "least": f"−{limit}"},
        "views": list(VIEWS.items()),
        "cameras": list(CAMERAS.items()),
        "exaggerations": list(exaggerations().items()),
        "shows": list(SHOWS.items()),
        "colours": colours,
    }
    _look(key=KEY, data=data, on_look_change=_take)


def state() -> dict[str, Any]:
    """What is looked at, as the browser has it."""
    view = session.project().view
    return {
        "station": view.station,
        "times": view.exaggeration,
        "camera": view.camera,
        "view": session.kept(VIEW, "part"),
        "show": list(session.kept(WITH, FIRST_SHOWN)),
    }


def without_webgl() -> bool:
    """Whether this browser has said that it draws nothing."""
    return bool(session.kept(NO_WEBGL, False))


def _take() -> None:
    # The component's own state: Streamlit puts there what the browser sends.
    taken(st.session_state[KEY].get("look"))


def taken(sent: Any) -> None:
    """Take over what the browser has settled on."""
    if not sent:
        return
    session.keep(SEQ, int(sent["seq"]))
    session.keep(NO_WEBGL, sent.get("webgl") is False)
    session.keep(VIEW, sent["view"] if sent["view"] in VIEWS else "part")
    session.keep(WITH, [code for code in SHOWS if code in sent["show"]])
    camera = sent["camera"] if sent["camera"] in CAMERAS else "iso"
    station = min(max(float(sent["station"]), 0.0), 1.0)
    session.look(station=station, exaggeration=float(sent["times"]), camera=camera)
