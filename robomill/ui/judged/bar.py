"""The bar that stays on every page: what is cut, how far off against the tolerance, the verdict, the force and who says
so, what it was before, and what is running. It says what the tiles say, of the same verdict, in the same words."""

import html
from collections.abc import Sequence

import numpy as np
import streamlit as st

from robomill.errors import RobomillError
from robomill.report.tags import Html
from robomill.simulation.judging.verdict_words import TIGHT_FROM, Verdict, gauge_end
from robomill.simulation.result import SimulationResult
from robomill.simulation.setup import SimulationSetup
from robomill.ui import pieces, session
from robomill.ui.comparing import other
from robomill.ui.entry import inputs
from robomill.ui.judged import verdict
from robomill.ui.pieces import Tile
from robomill.ui.serving.menu import head_for
from robomill.ui.work import job, running
from robomill.ui.work.job import Underway
from robomill.units import format_beside, format_limit, format_share, format_si

ROOM_FOR_ZERO = 35.0  # % of the track: where the tolerance lies nearer, its number stands alone


def show() -> None:
    """The bar of the project in force; its run is begun here where it is not there yet."""
    setup, unit = session.project().setup, session.project().view.length
    session.drop(job.TOLD)
    with st.container(key="bar", horizontal=True, vertical_alignment="center", gap="small"):
        try:
            found = running.computed(setup)
        except Underway as now:
            st.html(words(setup, running.before(setup), unit, "not computed yet"))
            now.show()
            session.keep(job.TOLD, now.place)
        except RobomillError as exc:
            st.html(words(setup, None, unit, str(exc)))
        else:
            running.take(found)
            st.html(words(setup, found, unit))
            _to_worst(found)
    _of_b(unit)


def _of_b(unit: str) -> None:
    """The same of the project that this one is held against, and what can be done with it."""
    found = other.other()
    if found is None:
        return
    with st.container(key="bar-other", horizontal=True, vertical_alignment="center", gap="small"):
        with other.in_force() as project:
            if project is None:
                st.html(Html('<div class="rm-top"><div class="rm-cell">B is the same set-up as A.</div></div>'))
            else:
                _row_of_b(project.setup, unit)
        if project is not None:
            inputs.button("Take B", "other.take", "swap_horiz", other.take, type="tertiary", width="content")
        inputs.button("End", "other.end", "close", other.choose, "", type="tertiary", width="content")


def _row_of_b(setup: SimulationSetup, unit: str) -> None:
    try:
        result = other.result(setup)
    except Underway as now:
        st.html(words(setup, None, unit, "not computed yet", "B"))
        now.show()
    except RobomillError as exc:
        st.html(words(setup, None, unit, str(exc), "B"))
    else:
        st.html(words(setup, result, unit, mark="B"))


def _to_worst(result: SimulationResult) -> None:
    """The way to what the verdict rests on."""
    worst = result.decided.sample
    if worst < 0:
        return
    label = f"Go to worst: line {result.path.block[worst]}"
    inputs.button(label, "bar.worst", "my_location", _go_to, result, worst, type="tertiary", width="content")


def _go_to(result: SimulationResult, i: int) -> None:
    stand_at(result, i)
    head_for("Milling")


def stand_at(result: SimulationResult, i: int) -> None:
    """Move the position along the cut to sample ``i``."""
    total = float(result.path.s[-1])
    if i >= 0 and total > 0:
        session.look(station=min(max(float(result.path.s[i]) / total, 0.0), 1.0))


def words(setup: SimulationSetup, result: SimulationResult | None, unit: str, why: str = "", mark: str = "") -> Html:
    """The bar as HTML; ``why`` says that ``result`` is not that of ``setup``: it is greyed, or left out. ``mark`` is
    the letter of the project, where it is not the one in force."""
    name = _cell(f"{mark} · {setup.source.name}" if mark else setup.source.name, setup.name, "rm-name")
    if result is None:
        parts = [name, _gauge(None, unit), _cell(why, "Not computed", "rm-said")]
        return _bar(parts, "unjudged", mark)
    tone = verdict.tone(result.verdict)
    tiles = verdict.plain_tiles(result, unit)
    shown = [name, _gauge(result.verdict, unit), _verdict(result, tiles["share"], why)]
    shown += [
        _tile(tiles[each], said) for each, said in (("wall", "Wall"), ("floor", "Floor"), ("tip", "Tip off path"))
    ]
    return _bar([*shown, _force(result)], f"{tone} rm-old" if why else tone, mark)


def _bar(parts: Sequence[Html], look: str, mark: str) -> Html:
    of = f"Verdict of {mark}" if mark else "Verdict of the cut"
    return Html(f'<div class="rm-top {look}" role="region" aria-label="{of}">{"".join(parts)}</div>')


def _cell(label: str | Html, value: str | Html, look: str = "") -> Html:
    """Two lines: what it is, small, and what it says."""
    said = "" if isinstance(label, Html) else f' title="{html.escape(label, quote=True)}"'
    small, large = (each if isinstance(each, Html) else html.escape(each) for each in (label, value))
    return Html(f'<div class="rm-cell {look}"{said}><small>{small}</small><b>{large}</b></div>')


def _was(old: str) -> Html:
    return Html(f' <span class="rm-was" title="before the last edit">{html.escape(old)}</span>') if old else Html("")


def _tile(tile: Tile, label: str) -> Html:
    """A tile in short: its name, its value, and the value before the last edit."""
    return _cell(label + _was(tile.was if tile.was != tile.value else ""), tile.value, f"rm-{label.split()[0].lower()}")


def _verdict(result: SimulationResult, tile: Tile, why: str) -> Html:
    old = verdict.previous(result)
    before = "" if old is None else verdict.WORDS[old.verdict.level]
    note = f"{why}; this was before" if why else tile.note
    return _cell(note + _was(before if before != tile.value else ""), tile.value, "rm-said")


def _force(result: SimulationResult) -> Html:
    """How hard it pushes at what the verdict rests on, and who says so."""
    setup, i = result.setup, result.decided.sample
    said = setup.provenance.get("force", setup.force.provenance)
    value = format_si(float(result.force_size[i]), "N", 0) if i >= 0 else "–"
    # A person who said a material has typed no force: it is computed.
    kind = "computed" if (said.kind, setup.force.provenance.kind) == ("user", "computed") else said.kind
    inner = f"<small>Force {pieces.badge(kind)}</small><b>{html.escape(value)}</b>"
    return Html(f'<div class="rm-cell" title="{html.escape(said.source, quote=True)}">{inner}</div>')


def _gauge(found: Verdict | None, unit: str) -> Html:
    """A track from nothing to beyond the tolerance, and how far the worst reading comes on it."""
    rests = None if found is None or found.deciding is None else found.deciding[1]
    if found is None or rests is None or not np.isfinite(found.share):
        return Html(
            '<div class="rm-gauge" role="img" aria-label="Nothing is measured against the tolerance">'
            '<div class="rm-track"></div><div class="rm-scale"><span>0</span></div></div>'
        )
    allowed = format_limit(rests.tolerance, unit)
    value = format_beside(abs(rests.value), rests.tolerance, unit)
    hatched = ", not judged" if found.level == "unjudged" else ""
    said = f"{value} of {allowed} allowed, {format_share(found.share)}{hatched}"
    ends = gauge_end(found.share)
    at = 100 * min(found.share, ends) / ends
    tight, full = (100 * each / ends for each in (TIGHT_FROM, 1.0))
    zero = "0" if full > ROOM_FOR_ZERO else ""
    return Html(
        f'<div class="rm-gauge" role="meter" aria-label="{html.escape(said, quote=True)}" '
        f'title="{html.escape(said, quote=True)}" aria-valuemin="0" aria-valuemax="{100 * ends:.0f}" '
        f'aria-valuenow="{100 * min(found.share, ends):.0f}">'
        f'<div class="rm-track" style="--tight:{tight:.1f}%;--full:{full:.1f}%"><i style="width:{at:.1f}%"></i>'
        f'<b style="left:{at:.1f}%"></b></div>'
        f'<div class="rm-scale"><span>{zero}</span>'
        f'<span style="left:{full:.1f}%">{html.escape(allowed)}</span></div></div>'
    )
