"""The notebook of the docs runs, cell by cell, and what its cells end with shows itself."""

from __future__ import annotations

import ast
import json
from pathlib import Path
from typing import Any

import sandbox

NOTEBOOK = Path(__file__).parent.parent.parent / "docs" / "first_steps.ipynb"
SHOWS = ("_repr_html_", "_repr_png_")


def cells() -> list[str]:
    """The text of every cell of code."""
    data = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    assert all(cell.get("outputs", []) == [] for cell in data["cells"]), "keep it without output"
    return ["".join(cell["source"]) for cell in data["cells"] if cell["cell_type"] == "code"]


def ran(text: str, names: dict[str, Any]) -> Any:
    """Run a cell as a notebook does; what its last expression is worth, or None."""
    tree = ast.parse(text)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, str(NOTEBOOK), "exec"), names)
    if last is None:
        return None
    return eval(compile(ast.Expression(last.value), str(NOTEBOOK), "eval"), names)


def test_its_cells_run_and_show_what_they_end_with() -> None:
    names: dict[str, Any] = {}
    ends = [ran(text, names) for text in cells()]
    shown = [picture for end in ends for how in SHOWS if hasattr(end, how)
             for picture in [getattr(end, how)()] if picture is not None]
    assert len(shown) == 5
    assert all(len(each) > 5000 for each in shown)
    assert [verdict.ok for end in ends if isinstance(end, sandbox.Recording)
            for verdict in end.verdicts] == [True] * 8
    assert names["forces"] == sorted(names["forces"])
    assert ends[-1].because == "halfway down"
