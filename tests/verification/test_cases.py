"""The cases of ``sandbox verify``, each as a test; and the report that is kept with the docs."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from sandbox.verification.benchmarks.page import PICTURE
from sandbox.verification.cases import CASES, Case
from sandbox.verification.cases.case import carry_out
from sandbox.verification.verify import (
    ABLE,
    HEAD,
    INDEX,
    NUMBERS,
    SHOWN,
    conclusion,
    picture,
    report,
    write_report,
)

KEPT = Path(__file__).parents[2] / "docs" / "verification"


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_case_holds(case: Case) -> None:
    result = carry_out(case)
    assert not result.missing
    assert result.checks
    assert [check for check in result.checks if not check.ok] == []
    assert all(check.why for check in result.checks)


def test_names_are_unique() -> None:
    assert len({case.name for case in CASES}) == len(CASES)
    assert len({case.title for case in CASES}) == len(CASES)


def test_every_equation_of_the_paper_has_a_case() -> None:
    """(14)-(16), (24)-(28) and the like are steps on the way, so ranges count."""
    covered: set[int] = set()
    for case in CASES:
        for first, last in re.findall(r"\((\d+)\)(?:–\((\d+)\))?", case.equations):
            covered |= set(range(int(first), int(last or first) + 1))
    assert covered == set(range(1, 34))


def test_kept_report_is_of_these_cases() -> None:
    """Its numbers may differ in the last digits from machine to machine; its verdicts not."""
    kept = json.loads((KEPT / NUMBERS).read_text(encoding="utf-8"))["cases"]
    assert [case["name"] for case in kept] == [case.name for case in CASES], "run sandbox verify"
    assert [case["title"] for case in kept] == [case.title for case in CASES], "run sandbox verify"
    assert all(case["ok"] for case in kept)
    page = (KEPT / INDEX).read_text(encoding="utf-8")
    shown = set(re.findall(r"!\[[^\]]*\]\(([^)]+)\)", page))
    assert shown == {path.name for path in KEPT.glob("*.png")} - {PICTURE}
    heads = set(re.findall(r"^## (.+)$", page, re.MULTILINE))
    assert heads == {case.title for case in CASES}
    name, words = SHOWN
    shown_first = next(case for case in CASES if case.name == name)
    head = f"{ABLE}\n![{shown_first.title}]({picture(shown_first)})\n{words}{HEAD}\n**"
    assert page.startswith(head), "run sandbox verify"
    for anchor in re.findall(r"\]\(#([^)]+)\)", page):
        assert anchor in {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-")
                          for head in heads}


def test_report_of_one_case(tmp_path: Path) -> None:
    case = next(case for case in CASES if case.name == "atwood")
    write_report([carry_out(case)], tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {INDEX, NUMBERS, picture(case)}
    assert "| pass |" in (tmp_path / INDEX).read_text(encoding="utf-8")
    assert (tmp_path / picture(case)).read_bytes()[:4] == b"\x89PNG"


def test_without_scipy_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """Never passed over in silence: neither a pass nor a crash."""
    monkeypatch.setitem(sys.modules, "scipy", None)
    result = carry_out(next(case for case in CASES if case.name == "free_closing"))
    assert not result.ok
    assert result.missing == "not computed: scipy is not installed (pip install scipy)"
    assert result.missing in report([result])
    assert conclusion([result]) == "0 of 1 cases hold; 1 could not be computed."


def test_a_wrong_number_fails() -> None:
    """Every check of the geometry notices a change of 0.01 mm, of statics one of 0.1 %."""
    for name, share in (("tendon", 0.0), ("grasp_forces", 1e-3)):
        case = next(case for case in CASES if case.name == name)
        for check in carry_out(case).checks:
            wrong = check.found + (share * check.expected if share else 1e-5)
            assert not replace(check, found=wrong).ok, check.what
