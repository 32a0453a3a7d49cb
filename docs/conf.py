"""The site: ``sphinx-build -W -b html docs docs/_build`` (docs/contributing.md)."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))
sys.path.insert(0, str(HERE / "extensions"))

import granstudy  # noqa: E402

project = "granstudy"
author = "the granstudy developers"
copyright = f"2026, {author}"
version = release = granstudy.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx-mathjax-offline",  # formulas are drawn without a network
    "pages",
]
exclude_patterns = ["_build"]

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4

html_theme = "furo"
html_title = f"granstudy {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sphinx = False

autodoc_typehints = "none"  # the docstrings say types
autodoc_member_order = "bysource"
napoleon_numpy_docstring = True
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True  # attributes are described once, with their class
default_role = "py:obj"  # what docstrings set in single backticks is a name, where it is one

suppress_warnings = ["ref.python"]  # `shape` in a docstring is that of its own class, and no link
copybutton_exclude = ".linenos, .gp, .go"
