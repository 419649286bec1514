"""The site: ``python -m sphinx -W docs build/site`` writes it; a warning is an error."""

from __future__ import annotations

import sandbox

project = "sandbox"
author = "The sandbox authors"
copyright = author
release = version = sandbox.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton"]
exclude_patterns = ["make_*.py", "*.ipynb"]
templates_path: list[str] = []

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
"""Links to headings as GitHub has them."""
suppress_warnings = ["myst.header", "misc.highlighting_failure"]
"""Sections that begin where a generated table stands; printed lines with a single apostrophe."""
copybutton_prompt_text = "$ "

html_theme = "furo"
html_title = f"sandbox {version}"
html_show_sphinx = False
pygments_style, pygments_dark_style = "friendly", "github-dark"


def setup(app: object) -> None:
    """Blocks of the docs have a second word, for the tests; Sphinx takes the first."""
    app.connect("source-read", _one_word)  # type: ignore[attr-defined]


def _one_word(_app: object, _page: str, source: list[str]) -> None:
    for kind in ("scene", "piece", "broken", "study"):
        source[0] = source[0].replace(f"\n```json {kind}\n", "\n```json\n")
