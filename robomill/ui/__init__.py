"""The screen: what pages are made of. Streamlit is imported here and in ``pages/``, nowhere else.

How to write a page (at most 120 lines)::

    from robomill import ui
    from robomill.viz.deviation import components_figure      # pictures come from viz, numbers from report

    project = ui.begin("Milling")                             # page config, style, project, sidebar
    result = ui.attempt(ui.result, project.setup)             # kept by digest; a refusal, or progress, is shown
    ui.headline("Milling", "The groove is 0.23 mm off.")      # one sentence
    ui.tiles([ui.Tile("Max deviation", "0.25 mm")])           # four tiles
    left, right = ui.thirds()                                 # inputs left, picture right
    with left:
        ui.number("cutter.diameter")                          # bound to project.setup.cutter.diameter
    with right:
        ui.figure(fig, "components", table=lambda: columns)   # keyed, PNG, CSV, table twin

The core is ``project`` (what a person decided), ``session`` (its history and what is kept by name), ``cached`` and
``rendered`` (results, pictures by fingerprint), ``inputs``, ``pieces`` and ``shell``. Rooms of the core: ``entry``
(boxes, choices, uploads, tools), ``work`` (what takes time), ``judged`` (the verdict and what it rests on), ``posed``
(the arm somewhere), ``comparing`` (A and B), ``keeping`` (work is there again), ``sharing`` (it is handed on) and
``serving`` (the server itself). Every page has a room of its own beside them, and no page's room knows another's.

Rules of the house:

- One frozen ``Project`` under one session key is the truth. Inputs are seeded from it and write a replaced project
  back (``session.change`` for the set-up, remembered for undo; ``session.look`` and ``session.see`` for the view and
  the maps). Never read another page's widgets.
- What is no part of the project outlives its page with ``session.keep`` or ``inputs.pick``, never in
  ``st.session_state``. Keys of widgets and of kept values read "page.thing"; a number box adds its unit.
- Numbers are shown through ``format_si`` in the units of ``project.view`` (``view.length``, ``view.feed``,
  ``view.joint_unit``).
- What a person typed and the model refuses stays in its box with the sentence beneath it (``inputs.submit``).
- Figures have a fixed height, a key and a ``revision``; pass ``dark=ui.dark()``. ``ui.kept_figure(name, key, make)``
  builds a figure once for equal keys: plotly takes longer to build one than most results take to compute.
- ``ui.split`` and ``ui.thirds`` are columns that stand under each other in a narrow window; name each once a page.
- Catch ``RobomillError`` only, best with ``ui.attempt``.
- Words are shown as they are: what holds a name, a refusal or a remark goes through ``pieces.error``, ``pieces.said``,
  ``pieces.strong``, ``ui.note``, ``pieces.table`` (``markup`` escapes it there), never into ``st.markdown`` or
  ``st.warning``. HTML is a ``markup.Html``: ``ui.note(pieces.badge("paper"), text)``; an f-string is words again.
"""

from robomill.ui.entry.inputs import number
from robomill.ui.judged.verdict import (
    beside as verdict_beside,
    headline as verdict_headline,
    open_question,
    tip_tile,
    verdict_row,
    verdict_sentence,
)
from robomill.ui.pieces import Tile, attempt, figure, headline, note, split, thirds, tiles
from robomill.ui.project import Project, View
from robomill.ui.shell import begin, dark
from robomill.ui.work.cached import kept_figure
from robomill.ui.work.running import result

__all__ = [
    "Project",
    "Tile",
    "View",
    "attempt",
    "begin",
    "dark",
    "figure",
    "headline",
    "kept_figure",
    "note",
    "number",
    "open_question",
    "result",
    "split",
    "thirds",
    "tiles",
    "tip_tile",
    "verdict_beside",
    "verdict_headline",
    "verdict_row",
    "verdict_sentence",
]
