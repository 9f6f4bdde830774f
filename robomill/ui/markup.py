"""Words as they are: what came from a file, a person or a refusal is shown as text, never read as HTML or Markdown."""

from __future__ import annotations

import re

from robomill.report.tags import Html, escaped

# Breaks what Markdown finds in plain words: addresses to link, names of symbols and smileys between colons.
_APART = "\u2060"


def as_html(*parts: str) -> Html:
    """The parts with a space between them, each escaped unless it is HTML."""
    return Html(" ".join(map(escaped, parts)))


# A number and what follows it as its unit, along which axis, how many times, which line or joint: a line never ends
# between the two, nor within a point.
_UNIT = re.compile(
    r"(?<=[\d)]) (?=(?:%|mm|µm|in|thou|N|m|s)(?!\w))|(?<=\bN) (?=m\b)|"
    r"(?<=[×±]) (?=\d)|(?<=\balong) (?=[XYZ]\b)|(?<=\b[XYZ]) (?=[+−]?\d)|(?<=\bline) (?=\d)|(?<=\bjoint) (?=\d)"
)
_POINT = re.compile(r"\([+−]?[\d.]+(?:, [+−]?[\d.]+){1,2}\)")


def unparted(text: str) -> str:
    """``text`` with every number held together with its unit, and every point with itself; HTML stays HTML."""
    held = _POINT.sub(lambda m: m[0].replace(" ", "\u00a0"), _UNIT.sub("\u00a0", text))
    return Html(held) if isinstance(text, Html) else held


def quiet(*parts: str) -> Html:
    """A quiet line of words and badges, as HTML."""
    return Html(f'<p class="rm-note">{unparted(as_html(*parts))}</p>')


def as_markdown(text: str) -> str:
    """One paragraph of Markdown that shows exactly these words: no style, link, picture, formula or foreign address."""
    words = " ".join(text.split())
    words = re.sub(r"[\\`*\[\]<~$|#]|(?<!\w)_|_(?!\w)|&(?=#?\w+;)|:(?=[A-Za-z])", r"\\\g<0>", words)
    words = re.sub(r"^(\d+)([.)])(?= )|^([-+>=])", lambda m: f"{m[1] or ''}\\{m[2] or m[3]}", words)
    # Between the colon and the slashes, and on both sides of an @: within a host's name it would be no end of a link.
    words = re.sub(r":(?=//)|(?i:\bwww)(?=\.)|@|:(?=[\w/+-]+:)", rf"\g<0>{_APART}", words)
    return words.replace("@", f"{_APART}@")
