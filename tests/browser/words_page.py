"""Words that look like markup, each as a refusal, a warning and a bold line."""

from __future__ import annotations

import streamlit as st

from robomill.ui import pieces

WORDS = (
    "found 'http://foreign.example/x'; expected flat",
    "HTTPS://foreign.example and ftp://foreign.example",
    "[click me](http://foreign.example/)",
    "![x](http://foreign.example/x.png)",
    "<http://foreign.example>",
    "www.foreign.example, me@foreign.example, mailto:me@foreign.example, xmpp:me@foreign.example",
    "http:\\//foreign.example http:/\\/foreign.example http&#58;//foreign.example",
    "<img src=http://foreign.example/y.png> <b>bold</b> **bold** `code` $x$ :red[warm] :smile:",
    "http://127.0.0.1:9/x (see http://foreign.example/a_b_c)",
)

for words in WORDS:
    with st.container(key=f"words-{WORDS.index(words)}"):
        pieces.error(words)
        pieces.said("warning", words)
        pieces.strong(words)
