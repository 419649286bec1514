"""The page of a run as a notebook shows it; in a browser: tests/browser/test_report.py."""

from __future__ import annotations

import html
import math
import re
from pathlib import Path
from typing import Any

import pytest

from sandbox.errors import OutputError
from sandbox.model.catalogue import UnknownQuantityError
from sandbox.web.page import FoundOut, report
from tests.draw.conftest import hand


def test_it_is_the_page_in_a_frame_that_reaches_nothing(tmp_path: Path) -> None:
    run = hand()
    made = run.page("finger1.*.angle", height=500)
    assert made.text == report([run], [FoundOut(verdicts=run.verdicts, figures=run.audit)],
                               run.names("finger1.*.angle"))
    shown = made._repr_html_()
    assert re.findall(r'sandbox="([^"]*)"', shown) == ["allow-scripts allow-downloads"]
    assert "height:500px" in shown
    assert html.unescape(re.findall(r'srcdoc="([^"]*)"', shown)[0]) == made.text
    assert repr(made).startswith(f"<RunPage of {run.mechanism.name} in motion, ")
    made.save(tmp_path / "run.html")
    assert (tmp_path / "run.html").read_text(encoding="utf-8") == made.text


def test_what_is_wrong_is_said(tmp_path: Path) -> None:
    run = hand()
    with pytest.raises(UnknownQuantityError, match="finger1"):
        run.page("finger1.mcp.angel")
    wrong: Any
    for wrong in (0, math.nan, "tall", True):
        with pytest.raises(OutputError, match=r"pass 200 to 4000 pixels"):
            run.page(height=wrong)
    with pytest.raises(OutputError, match=r"\.html"):
        run.page().save(tmp_path / "run.pdf")
