"""The pieces pages are made of: tiles, badges, facts, matrices, figures with their tables and downloads, refusals."""

from __future__ import annotations

import html
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import streamlit as st

from robomill.csv_text import csv_text
from robomill.errors import RobomillError
from robomill.provenance import Provenance, kind_word
from robomill.report.tags import Html
from robomill.ui import session
from robomill.ui.markup import as_html, as_markdown, quiet, unparted
from robomill.ui.work import beside, cached
from robomill.ui.work.job import Underway
from robomill.units import split_unit

if TYPE_CHECKING:
    from robomill.viz.chart import Chart

Value = TypeVar("Value")
SHOWN_ROWS = 1500
ROW = 36  # pixels of a row of a table
DIGITS = 12  # of a number in a file: what comes after is rounding
AT_HAND = 2_000_000  # letters of a text: 2 ms to look through
CELL_S = 1e-6  # s that a cell of a table takes to be written
# What a file holds that is taken away, by the end of its name.
MIME = {
    **{
        "csv": "text/csv",
        "nc": "text/plain",
        "toml": "application/toml",
        "urdf": "application/xml",
        "html": "text/html",
        "parquet": "application/vnd.apache.parquet",
    },
    **{"png": "image/png", "gif": "image/gif", "mp4": "video/mp4"},
    **{"stl": "model/stl", "ply": "application/octet-stream", "glb": "model/gltf-binary", "vtp": "application/xml"},
}


@dataclass(frozen=True)
class Tile:
    """One number: ``value`` as formatted text with its unit after a space, ``was`` the value before the last change.

    ``change`` says by how much it moved; both stand in a line of their own beneath ``note``, which they do not replace.
    ``tone`` is "", "ok", "tight", "out" or "unjudged" (an edge; the words carry the meaning), or "open" (hatched);
    ``kind`` is a provenance; ``ranges`` are lines that say between which ends the value may lie instead, and over what.
    ``other`` is the value of the project that this one, A, is held against, B.
    """

    label: str
    value: str
    note: str = ""
    was: str = ""
    change: str = ""
    tone: str = ""
    kind: str = ""
    ranges: Sequence[str] = ()
    other: str = ""


def tiles(items: Sequence[Tile]) -> None:
    """The row of tiles on top of a page (four in a row, two on a narrow screen)."""
    st.html(f'<div class="rm-tiles">{"".join(map(_tile, items))}</div>')


def _tile(tile: Tile) -> str:
    number, unit = split_unit(tile.value)
    value = html.escape(number) + (f"<small>{html.escape(unit)}</small>" if unit else "")
    note, before = unparted(subscripts(tile.note)), ""
    if tile.was and tile.was != tile.value:
        moved = f" · {unparted(html.escape(tile.change))}" if tile.change else ""
        before = f'<div class="rm-sub">was <span class="rm-was">{html.escape(tile.was)}</span>{moved}</div>'
    mark = f"{badge(tile.kind)} " if tile.kind else ""
    look = " rm-long" if "×" in number else ""
    value, beside = (f"<i>A</i>{value}", _of_b(tile.other)) if tile.other else (value, "")
    ranges = "".join(f'<div class="rm-range">{unparted(html.escape(words))}</div>' for words in tile.ranges)
    return (
        f'<div class="rm-tile {html.escape(tile.tone)}"><div class="rm-label">{subscripts(tile.label)}</div>'
        f'<div class="rm-value{look}">{value}</div>{beside}<div class="rm-sub">{mark}{note}</div>{before}{ranges}</div>'
    )


def _of_b(value: str) -> Html:
    return Html(f'<div class="rm-other"><i>B</i>{unparted(html.escape(value))}</div>')


def subscripts(text: str) -> Html:
    """Text as HTML, with the indices of symbols like ``C_yy`` and ``a_2`` set low."""
    return Html(re.sub(r"\b([A-Za-zδθ])_(\w+)", r"\1<sub>\2</sub>", html.escape(text)))


def badge(kind: str, text: str = "") -> Html:
    """A small coloured pill with a word for where a number comes from: published, measured, assumed, user, computed."""
    word = text or kind_word(kind)
    return Html(f'<span class="rm-badge rm-{html.escape(kind)}">{html.escape(word)}</span>')


def sourced(said: Provenance) -> Html:
    """Where a number comes from: the badge and the words."""
    return as_html(badge(said.kind), subscripts(said.source))


def headline(kicker: str, title: str, lead: str = "") -> None:
    """The page's one sentence."""
    lead_html = f'<p class="rm-lead">{unparted(as_html(lead))}</p>' if lead else ""
    said = unparted(html.escape(title))
    st.html(f'<p class="rm-kicker">{html.escape(kicker)}</p><h1 class="rm-title">{said}</h1>{lead_html}')


def note(*parts: str) -> None:
    """A quiet line of words and badges."""
    st.html(quiet(*parts))


def facts(rows: Sequence[tuple[str, str, str]]) -> None:
    """A small table without lines of its own: what, value, remark."""
    table(rows, "qn ")


def table(rows: Sequence[Sequence[str]], kinds: str, head: Sequence[str] = (), strong: int = -1) -> None:
    """A table with a row of titles; ``strong`` is the row in force.

    ``kinds`` has a letter a column: q what is asked (s where that is short), n a number, v a value in words, w text,
    b a bar, a blank for a remark, which stands under its q in a narrow window. Where a table with text (w) has no
    room for its columns, each row is a paragraph in which every cell stands under its title. The last cell of a row
    with fewer cells than columns is a text over the columns that are left.
    """
    titled = "w" in kinds and all(head)
    named = [f' data-title="{html.escape(title, quote=True)}"' if titled else "" for title in head or kinds]

    def row(tag: str, cells: Sequence[str], titles: Sequence[str], style: str = "") -> str:
        over = len(kinds) - len(cells) + 1
        whole = zip(kinds, titles, cells[:-1] if over > 1 else cells, strict=over == 1)
        inner = "".join(
            f'<{tag if cell else "td"} class="{kind}"{title}>{unparted(as_html(cell))}</{tag if cell else "td"}>'
            for kind, title, cell in whole
        )
        inner += f'<td class="w" colspan="{over}">{unparted(as_html(cells[-1]))}</td>' if over > 1 else ""
        return f"<tr{style}>{inner}</tr>"

    body = "".join(row("td", cells, named, ' class="rm-strong"' if i == strong else "") for i, cells in enumerate(rows))
    top = row("th", head, [""] * len(head)) if head else ""
    remarks = " rm-remarks" if kinds[0] == "q" and kinds[-1] == " " else " rm-titled" if titled else ""
    st.html(f'<div class="rm-wide"><table class="rm-facts{remarks}">{top}{body}</table></div>')


def bar(share: float, look: str) -> Html:
    """A bar of ``share`` (of 1) of its cell's width; ``look`` is a colour or the name of a provenance."""
    kind, colour = ("", f";background:{look}") if look.startswith("#") else (f" rm-{html.escape(look)}", "")
    return Html(f'<span class="rm-bar{kind}" style="width:{100 * share:.1f}%{colour}"></span>')


def matrix(rows: Sequence[Sequence[str]], names: Sequence[str], columns: Sequence[str] | None = None) -> None:
    """A small matrix with named rows and columns; where ``columns`` are named as the rows, the diagonal is bold."""
    head = "".join(f"<th>{_low(n)}</th>" for n in columns or names)
    body = "".join(
        f"<tr><th>{_low(name)}</th>"
        + "".join(
            f'<td class="{"d" if columns is None and i == j else ""}">{html.escape(v)}</td>' for j, v in enumerate(row)
        )
        + "</tr>"
        for i, (name, row) in enumerate(zip(names, rows, strict=True))
    )
    table = f'<table class="rm-matrix"><tr><td></td>{head}</tr>{body}</table>'
    st.html(table if columns is None else f'<div style="overflow-x:auto">{table}</div>')


def _low(name: str) -> str:
    """A one-letter symbol with its index set low; words and units as they are."""
    return f"{html.escape(name[0])}<sub>{html.escape(name[1:])}</sub>" if len(name) == 2 else html.escape(name)


def error(exc: RobomillError | str) -> None:
    """A refusal as people read it: one sentence."""
    said("error", str(exc), "error")


def said(level: Literal["error", "warning", "info"], words: str, icon: str = "") -> None:
    """A sentence in its coloured box, shown as it is whatever it quotes; ``icon`` names a symbol."""
    show = {"error": st.error, "warning": st.warning, "info": st.info}[level]
    show(as_markdown(words), icon=f":material/{icon}:" if icon else None)


def strong(words: str) -> None:
    """A bold line, shown as it is."""
    st.markdown(f"**{unparted(as_markdown(words))}**")


def thirds() -> tuple[Any, Any]:
    """The two columns of a page: inputs in the left third, the picture in the right two thirds."""
    left, right = split([1, 2], "page")
    return left, right


def split(spec: Sequence[float], name: str, gap: Any = "medium") -> list[Any]:
    """Columns that stand under each other in a narrow window; ``name`` is unique on its page."""
    with st.container(key=f"split-{name}"):
        return list(st.columns(list(spec), gap=gap))


def attempt(function: Callable[..., Value], *args: Any) -> Value | None:
    """``function(*args)``, or its refusal shown, or how far it is, and None. Anything else is a bug and is raised."""
    try:
        return underway(function, *args)
    except RobomillError as exc:
        error(exc)
        return None


def underway(function: Callable[..., Value], *args: Any) -> Value | None:
    """``function(*args)``, or how far that is and None. Raises its refusal."""
    try:
        return function(*args)
    except Underway as now:
        now.show()
        return None


def figure(
    fig: Chart,
    key: str,
    *,
    table: Callable[[], Mapping[str, Any]] | None = None,
    name: str = "",
    caption: str = "",
    alt: str = "",
    on_pick: Callable[[Mapping[str, Any]], None] | None = None,
) -> None:
    """A plotly figure that keeps its camera, with its table twin and CSV beneath and PNG in its own tool bar.

    ``name`` is the file name of what is taken away (default: the key), ``alt`` what a screen reader says,
    ``on_pick`` gets the point that was clicked, as plotly says it (its x, y and customdata).
    """
    file_name = name or key
    config = {
        "displaylogo": False,
        "displayModeBar": "hover",
        "modeBarButtonsToRemove": [
            "select2d",
            "lasso2d",
            "autoScale2d",
            "zoomIn2d",
            "zoomOut2d",
            "resetCameraLastSave3d",
            "tableRotation",
            "orbitRotation",
            "pan3d",
            "zoom3d",
        ],
        "toImageButtonOptions": {"format": "png", "filename": named(file_name), "scale": 2},
    }
    more: dict[str, Any] = {}
    if on_pick is not None:
        more = {"on_select": partial(_picked, key, on_pick), "selection_mode": "points"}
    from robomill.viz.sent import Sent

    st.plotly_chart(Sent(fig), key=key, theme=None, config=config, alt=alt or None, **more)
    if caption or table is not None:
        with st.container(horizontal=True, vertical_alignment="center", horizontal_alignment="distribute", gap="small"):
            if caption:
                note(caption)
            if table is not None:
                table_twin(table, file_name, key)


def _picked(key: str, take: Callable[[Mapping[str, Any]], None]) -> None:
    # The figure's own state: Streamlit says there which points were clicked.
    said = st.session_state.get(key)
    points = said["selection"]["points"] if said else []
    if points:
        take(points[0])


def rows_high(rows: int, most: int) -> int:
    """Pixels that a table of so many rows needs with its head; at most ``most``, then it scrolls."""
    return min(ROW * (rows + 1) + 2, most)


def table_twin(table: Callable[[], Mapping[str, Any]], name: str, key: str = "") -> None:
    """The numbers behind the figure ``key`` (default: its ``name``), to read and to take away as CSV; made when they
    are opened: figures are redrawn at every edit, their tables are not."""
    popover = st.popover(
        "Table", icon=":material/table:", type="tertiary", key=f"table-of-{key or name}", on_change="rerun"
    )
    if not popover.open:
        return
    with popover:
        import pandas as pd

        frame = pd.DataFrame(dict(table()))
        shown = frame.head(SHOWN_ROWS)
        st.dataframe(shown, hide_index=True, height=rows_high(len(shown), 360), width=640)
        if len(frame) > len(shown):
            note(f"Showing {len(shown)} of {len(frame)} rows; the file has all of them.")

        def about() -> Any:
            return tuple(frame.columns), pd.util.hash_pandas_object(frame).to_numpy()

        making = Making(CELL_S * frame.size, about)
        columns = {str(column): values.to_numpy() for column, values in frame.items()}
        download("CSV", partial(csv_text, columns, DIGITS), named(f"{name}.csv"), f"csv:{name}", making)


def named(file: str) -> str:
    """The name of a file that is taken away, with the project's in front: ``heart-surface.stl``."""
    return f"{called()}-{file}"


def called() -> str:
    """The project's name as files carry it."""
    return re.sub(r"[^A-Za-z0-9]+", "-", session.project().setup.name).strip("-").lower() or "project"


@dataclass(frozen=True)
class Making:
    """How long a file takes to be made, s, about; and what tells it from others, asked only where that is long."""

    seconds: float
    about: Callable[[], Any]


def download(
    label: str,
    data: Callable[[], Any] | Any,
    file_name: str,
    key: str,
    making: Making | None = None,
    **more: Any,
) -> None:
    """A download that is made only when it is asked for; what it holds is told from the end of its name. A text that
    is there already has an address that stays: while a page runs again and again, because something is computed beside
    it, what is made when it is asked for can be asked for at an address of the run before, and never comes.

    Where ``making`` it takes longer than anyone waits, a button has it made beside the page; then it can be taken.
    """
    if making is not None and making.seconds > beside.FIRST_S and not more.get("disabled"):
        data = attempt(cached.asked_for, label, key, making.about(), data)
        if data is None:
            return
        label, more = f"Save {file_name.removeprefix(named(''))}", {"type": "primary"} | more
    more = {"icon": ":material/download:", "on_click": "ignore"} | more
    there = callable(data) or (isinstance(data, str) and len(data) <= AT_HAND)
    made: Any = data if there else lambda: data  # what is long is not looked through at every run
    st.download_button(label, made, file_name, MIME[file_name.rpartition(".")[2]], key, **more)
