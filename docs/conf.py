"""The site: ``python -m sphinx -W docs build/site`` writes it; a warning is an error."""

from __future__ import annotations

import sys
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx

import sandbox

sys.path.insert(0, str(Path(__file__).parent))
import make_reference
import make_validation

project = "sandbox"
author = "The sandbox authors"
copyright = author
release = version = sandbox.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton"]
exclude_patterns = ["make_*.py", "*.ipynb"]
templates_path: list[str] = []

myst_heading_anchors = 4
"""Links to headings as GitHub has them."""
suppress_warnings = ["myst.header", "misc.highlighting_failure"]
"""Sections that begin where a generated table stands; printed lines with a single apostrophe."""
copybutton_prompt_text = "$ "
copybutton_line_continuation_character = "\\"

autodoc_member_order = "bysource"
autodoc_type_aliases = {"Array": "Array", "ArrayLike": "ArrayLike"}
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented_params"
python_maximum_signature_line_length = 90

html_theme = "furo"
html_title = f"sandbox {version}"
html_show_sphinx = False
html_static_path, html_css_files = ["_static"], ["site.css"]
pygments_style, pygments_dark_style = "friendly", "github-dark"


def setup(app: Sphinx) -> None:
    """Blocks of the docs have a second word, for the tests; docstrings have plain formulas."""
    app.connect("builder-inited", lambda _app: make_validation.write())
    app.connect("source-read", _fill)
    app.connect("source-read", _one_word)
    app.connect("doctree-read", _fields)
    app.connect("autodoc-process-docstring", _formulas, priority=1)
    app.connect("autodoc-process-docstring", _colons, priority=999)


def _fill(_app: Sphinx, _page: str, source: list[str]) -> None:
    source[0] = make_reference.filled(source[0])


def _one_word(_app: Sphinx, _page: str, source: list[str]) -> None:
    for kind in ("scene", "piece", "broken", "study"):
        source[0] = source[0].replace(f"\n```json {kind}\n", "\n```json\n")


def _fields(_app: Sphinx, tree: nodes.document) -> None:
    """Tables of an element's fields have a class, and those cells that say ``required``."""
    for table in tree.findall(nodes.table):
        cells = list(table.findall(nodes.entry))
        if cells and cells[0].astext() == "key":
            table["classes"].append("fields")
            for cell in cells:
                cell["classes"] += ["required"] if cell.astext() == "required" else []


COLON = "\N{PRESENTATION FORM FOR VERTICAL COLON}"
"""Stands for one while napoleon takes what is before it for a type."""


def _formulas(_app: Sphinx, kind: str, _name: str, _of: object, _how: object,
              lines: list[str]) -> None:
    """Indented paragraphs of a docstring stay as they are; elsewhere a stroke is a stroke."""
    found: list[str] = []
    above, verbatim = "", False
    for line in lines:
        if line.strip():
            indented = line.startswith("    ")
            if indented and found and not found[-1] and not above.startswith("    "):
                found += ["::", ""]
                verbatim = True
            verbatim &= indented
            above = line
        found.append(line if verbatim else _strokes(line))
    if found and kind in ("attribute", "data", "property"):
        found[0] = found[0].replace(":", COLON)
    lines[:] = found


def _colons(_app: Sphinx, _kind: str, _name: str, _of: object, _how: object,
            lines: list[str]) -> None:
    lines[:] = [line.replace(COLON, ":") for line in lines]


def _strokes(line: str) -> str:
    pieces = line.split("``")
    pieces[::2] = [piece.replace("|", "\\|") for piece in pieces[::2]]
    return "``".join(pieces)
