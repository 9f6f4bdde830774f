"""A component of the page that is written for the browser: its files stand beside the module that shows it."""

from pathlib import Path
from typing import Any

import streamlit as st


def component(name: str, module: str, **parts: Any) -> Any:
    """The component of ``module`` (its file): the .css, .js and .html beside it, unless ``parts`` say them."""
    files = {kind: Path(module).with_suffix(f".{kind}") for kind in ("html", "css", "js") if kind not in parts}
    texts: Any = {kind: file.read_text(encoding="utf-8") for kind, file in files.items()}
    return st.components.v2.component(name, **texts, **parts)
