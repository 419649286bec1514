"""Write the page "Validation": ``python docs/make_validation.py [FILE]``.

The site build calls :func:`write`. All cases of ``tests/verification`` run, in as many processes as
there are processors, unless the variable ``DRAFT`` is set, which leaves out their results. The page
is not kept in the repository.
"""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from tests.verification.case import Case

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT))

MODULES = sorted(path.stem for path in (ROOT / "tests" / "verification").glob("test_*.py"))
PAGE = Path(__file__).with_name("validation.md")
HEAD = """# Validation

Each case compares the engine with a closed form, an independent integration or published numbers.
It states its equation, its scene and, for every quantity, the tolerance and where that comes from:
tolerances follow from the problem and the scheme, and are not fitted. The test suite runs the same
cases: `pytest tests/verification`.

Equation numbers are those of *An Underactuated Multi-finger Grasping Device*, in the corrected form
that `sandbox.mechanics` documents. Of a quantity over time, the table shows the value with the
largest error by its tolerance.
"""


def cases(module: str) -> list[Case]:
    """The cases that a module of ``tests/verification`` defines."""
    from tests.verification.case import CASES

    import_module(f"tests.verification.{module}")
    return [each for each in CASES.values() if each.module == f"tests.verification.{module}"]


def section(module: str) -> tuple[str, list[str]]:
    """Heading and lines of the cases of a module, all of which run if this is no draft."""
    about = import_module(f"tests.verification.{module}").__doc__ or ""
    title, _, more = about.strip().split("\n")[0].rstrip(".").partition(":")
    lines = [f"{more.strip()[:1].upper()}{more.strip()[1:]}." if more else ""]
    for case in cases(module):
        lines += ["", f"### {case.title}", "", *([f"{case.equation}  "] if case.equation else []),
                  f"Scene: {case.scene}  ",
                  *([f"Source: {case.source}  "] if case.source else []),
                  *([] if "DRAFT" in os.environ else results(case))]
    return title, lines


def results(case: Case) -> list[str]:
    """The verdict on a case, which runs, and a table of its quantities."""
    checks, rows, shares = list(case.run()), [], []
    for check in checks:
        expected, found, allowed = check.worst
        error = abs(found - expected)
        shares.append(error / allowed if allowed else float(error > 0))
        cells = (check.what, check.unit, f"{expected:.6g}", f"{found:.6g}", f"{error:.1e}",
                 f"{allowed:.1e}", check.why)
        rows.append(" | ".join(cell.replace("|", "\\|") for cell in cells))
    verdict = "Passed" if all(each.ok for each in checks) else "**FAILED**"
    return [f"{verdict}, the largest error by its tolerance: {100 * max(shares):.2g} %", "",
            "| quantity | unit | reference | measured | error | tolerance | why |",
            "|---|---|---|---|---|---|---|", *(f"| {row} |" for row in rows)]


def page(modules: Sequence[str] = MODULES) -> str:
    """The page as Markdown, from the cases of modules."""
    with ProcessPoolExecutor() as pool:
        sections = list(pool.map(section, modules))
    versions = (f"numpy {np.__version__}, pymunk {version('pymunk')}, "
                f"Python {platform.python_version()}, {platform.machine()}")
    body = [line for title, lines in sections for line in ("", f"## {title}", "", *lines)]
    return "\n".join([HEAD, f"Computed with {versions}.", *body]) + "\n"


def write(path: Path = PAGE) -> None:
    """Write the page."""
    path.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    write(*map(Path, sys.argv[1:2]))
