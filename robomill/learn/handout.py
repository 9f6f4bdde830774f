"""A hand-out of the lessons for the class, and the teacher's notes, each as one HTML file that prints."""

from __future__ import annotations

import html
from collections.abc import Sequence

from robomill.learn.lesson import MINUTES, Lesson
from robomill.units import format_short

STYLE = """
body { font: 12pt/1.45 Georgia, serif; max-width: 46rem; margin: 2rem auto; padding: 0 1rem;
  color: #111; background: #fff; }
h1 { font-size: 20pt; margin: 0 0 .3rem; } h2 { font-size: 14pt; margin: 1.4rem 0 .2rem; }
section { break-inside: avoid; border-top: 1px solid #999; padding-top: .2rem; }
ul { list-style: none; padding: 0; margin: .3rem 0; } li::before { content: "\\25A1\\00A0\\00A0"; }
li.right { font-weight: bold; } li.right::before { content: "\\25A0\\00A0\\00A0"; }
.line { border-bottom: 1px solid #111; height: 1.7rem; } .small { font-size: 10pt; color: #444; }
table { border-collapse: collapse; width: 100%; }
td, th { text-align: left; padding: .15rem .5rem .15rem 0; vertical-align: top; }
@page { size: A4; margin: 18mm; } @media print { body { margin: 0; max-width: none; padding: 0; } }
"""


def handout(lessons: Sequence[Lesson], where: str) -> str:
    """Questions with their choices and room to write, without an answer. ``where`` says which robot stands where."""
    parts = [f"<h1>Why does a robot bend?</h1><p>{_safe(where)}</p><p>Name: ______________________________</p>"]
    for each in lessons:
        choices = (
            "" if each.typed else f"<ul>{''.join(f'<li>{_safe(choice.text)}</li>' for choice in each.choices)}</ul>"
        )
        parts.append(
            f"<section><h2>{each.number}. {_safe(each.title)}</h2><p>{_safe(each.question)}</p>{choices}"
            "<p class='small'>My prediction, and why:</p><div class='line'></div><div class='line'></div></section>"
        )
    return _page("Hand-out: why does a robot bend?", parts)


def notes(lessons: Sequence[Lesson], where: str) -> str:
    """The teacher's notes: a plan of 50 minutes, and of each lesson the answers, the reason and what to ask."""
    begun, rows = 0, ""
    for each in lessons:
        minutes = MINUTES[each.number - 1]
        rows += f"<tr><td>{begun} to {begun + minutes} min</td><td>{each.number}. {_safe(each.title)}</td></tr>"
        begun += minutes
    parts = [
        f"<h1>Teacher's notes</h1><p>{_safe(where)} Every number below is computed for it.</p>"
        f"<h2>Plan of {begun} minutes</h2><table>{rows}</table>"
        "<p class='small'>Of each lesson: a minute for the question, one for predictions, the reveal, the reason at "
        "the board, and "
        "what is left for trying to break it.</p>"
    ]
    for each in lessons:
        told = [
            f"<li class='{'right' if i == each.right else ''}'>{_safe(choice.text)}<br><span class='small'>"
            f"{_safe(choice.told if i == each.right or choice.told != each.answer else '')}</span></li>"
            for i, choice in enumerate(each.choices)
        ]
        unit = each.typed.unit if each.typed else "1"
        slips = [
            f"<li>{_safe(format_short(slip.value, unit, 3))}<br><span class='small'>{_safe(slip.says)}</span></li>"
            for slip in (each.typed.slips if each.typed else ())
        ]
        parts.append(
            f"<section><h2>{each.number}. {_safe(each.title)} ({MINUTES[each.number - 1]} "
            f"min)</h2><p>{_safe(each.question)}</p>"
            f"<ul>{''.join(told + slips)}</ul><p>{_safe(each.reason)} Eq. {_safe(each.paper)}.</p>"
            f"<p><i>{_safe(each.teacher)}</i></p><p>To break it: {_safe(each.breaking)}</p></section>"
        )
    return _page("Teacher's notes: why does a robot bend?", parts)


def _safe(text: str) -> str:
    return html.escape(text, quote=False)


def _page(title: str, parts: Sequence[str]) -> str:
    head = f"<meta charset='utf-8'><meta name='viewport' content='width=device-width'><title>{_safe(title)}</title>"
    body = "\n".join(parts)
    return f"<!doctype html>\n<html lang='en'><head>{head}<style>{STYLE}</style></head>\n<body>{body}</body></html>\n"
