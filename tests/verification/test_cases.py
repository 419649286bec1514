"""The cases of ``sandbox verify``, each as a test; and the report that is kept with the docs."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from sandbox.verification.cases import CASES, Case
from sandbox.verification.cases.case import carry_out


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_case_holds(case: Case) -> None:
    result = carry_out(case)
    assert not result.missing
    assert result.checks
    assert [check for check in result.checks if not check.ok] == []
    assert all(check.why for check in result.checks)


def test_every_equation_of_the_paper_has_a_case() -> None:
    """(14)-(16), (24)-(28) and the like are steps on the way, so ranges count."""
    covered: set[int] = set()
    for case in CASES:
        for first, last in re.findall(r"\((\d+)\)(?:–\((\d+)\))?", case.equations):
            covered |= set(range(int(first), int(last or first) + 1))
    assert covered == set(range(1, 34))


def test_a_wrong_number_fails() -> None:
    """Every check of the geometry notices a change of 0.01 mm, of statics one of 0.1 %."""
    for name, share in (("tendon", 0.0), ("grasp_forces", 1e-3)):
        case = next(case for case in CASES if case.name == name)
        for check in carry_out(case).checks:
            wrong = check.found + (share * check.expected if share else 1e-5)
            assert not replace(check, found=wrong).ok, check.what
