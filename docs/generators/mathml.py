"""Mathematics as MathML, by docutils' own converter: every current browser draws it, and nothing is fetched for it."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from docutils.utils.math import MathError, latex2mathml
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_html_math_renderer("mathml", inline_renderers=(_inline, None), block_renderers=(_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _inline(writer: Any, node: nodes.math) -> None:
    writer.body.append(_markup(node, as_block=False))
    raise nodes.SkipNode


def _block(writer: Any, node: nodes.math_block) -> None:
    number = f'<span class="eqno">({node["number"]})</span>' if node.get("number") else ""
    writer.body.append(f'<div class="math">{number}{_markup(node, as_block=True)}</div>\n')
    raise nodes.SkipNode


def _markup(node: nodes.Element, as_block: bool) -> str:
    tex = node.astext()
    try:
        markup = latex2mathml.tex2mathml(tex, as_block=as_block)
    except MathError as exc:
        raise ExtensionError(f"{tex!r} is not mathematics that docutils can convert: {exc}") from exc
    return re.sub(r"\n\s*", "", str(markup))
