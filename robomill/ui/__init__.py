"""The screen: what pages are made of. Streamlit is imported here and in ``pages/``, nowhere else.

How to write a page (at most 120 lines)::

    from robomill import ui
    from robomill.viz.deviation import components_figure      # pictures come from viz, numbers from report

    project = ui.begin("Milling")                             # page config, style, project, sidebar
    result = ui.attempt(ui.result, project.setup)             # cached by digest; a refusal is shown, then None
    ui.headline("Milling", "The groove is 0.23 mm off.")      # one sentence
    ui.tiles([ui.Tile("Max deviation", "0.25 mm")])           # four tiles
    left, right = ui.thirds()                                 # inputs left, picture right
    with left:
        ui.number("Diameter", "cutter.diameter", "mm")        # bound to project.setup.cutter.diameter
    with right:
        ui.figure(fig, "components", table=lambda: columns)   # keyed, PNG, CSV, table twin

Rules of the house:

- One frozen ``Project`` under one session key is the truth. Widgets are seeded from it (``ui.number``, ``ui.whole``,
  ``ui.choice``, ``ui.slider``) and write a replaced project back (``ui.change`` for the set-up, remembered for undo;
  ``ui.look`` for the view). Never read another page's widgets.
- Numbers are shown through ``format_si`` in the units of ``project.view`` (``view.length``, ``view.feed``,
  ``view.joint_unit``).
- What a person typed and the model refuses stays in its box with the sentence beneath (``ui.refuse``/``ui.accept``).
- Figures have a fixed height, a key and a ``revision``; pass ``dark=ui.dark()``. ``ui.kept_figure(name, key, make)``
  builds a figure once for equal keys: plotly takes longer to build one than most results take to compute.
- ``ui.split`` and ``ui.thirds`` are columns that stand under each other in a narrow window; name each once a page.
- Catch ``RobomillError`` only, best with ``ui.attempt``.
- Provenance: ``ui.badge("paper" | "measured" | "assumed" | "user" | "computed")`` gives HTML for ``ui.note``,
  ``ui.headline`` and ``ui.facts``.
"""

from __future__ import annotations

from robomill.ui.cache import groove, kept_figure, pictured, result
from robomill.ui.editors import table_editor
from robomill.ui.inputs import accept, choice, number, refuse, seed, sentence, slider, whole
from robomill.ui.parts import (
    Tile,
    attempt,
    badge,
    download,
    error,
    facts,
    figure,
    headline,
    matrix,
    note,
    split,
    table_twin,
    thirds,
    tiles,
)
from robomill.ui.render import picture
from robomill.ui.shell import begin, dark
from robomill.ui.state import Project, View, before, change, look, project, redo, replace, store, undo
from robomill.ui.verdict import verdict_sentence, verdict_tiles

__all__ = [
    "Project",
    "Tile",
    "View",
    "accept",
    "attempt",
    "badge",
    "before",
    "begin",
    "change",
    "choice",
    "dark",
    "download",
    "error",
    "facts",
    "figure",
    "groove",
    "headline",
    "kept_figure",
    "look",
    "matrix",
    "note",
    "number",
    "picture",
    "pictured",
    "project",
    "redo",
    "refuse",
    "replace",
    "result",
    "seed",
    "sentence",
    "slider",
    "split",
    "store",
    "table_editor",
    "table_twin",
    "thirds",
    "tiles",
    "undo",
    "verdict_sentence",
    "verdict_tiles",
    "whole",
]
