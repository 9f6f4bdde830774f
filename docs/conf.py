"""How Sphinx builds these pages: Markdown by MyST, mathematics as MathML, and what is generated, made first."""

import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
sys.path[:0] = [str(DOCS.parent), str(DOCS)]

import robomill  # noqa: E402

project = "robomill"
author = "robomill contributors"
project_copyright = "robomill contributors, MIT licence"
version = release = robomill.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "generators.docstrings",
    "generators.mathml",
    "generators.pages",
]
exclude_patterns = ["_build", "_generated", "scripts"]
nitpicky = False  # shapes and units in docstrings are words, not names to be linked

myst_enable_extensions = ["dollarmath", "deflist", "attrs_inline", "attrs_block"]
myst_heading_anchors = 3
myst_links_external_new_tab = False
html_math_renderer = "mathml"

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the signature shows them; docstrings give shapes and units
autodoc_typehints_format = "short"
autodoc_preserve_defaults = False
python_use_unqualified_type_names = True
add_module_names = False

html_theme = "furo"
html_title = "robomill"
html_static_path = ["_static"]
html_css_files = ["robomill.css"]
html_copy_source = False
html_show_sphinx = False
pygments_style = "friendly"
pygments_dark_style = "monokai"
