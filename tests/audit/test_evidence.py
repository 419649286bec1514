"""Which samples the audit looks at, and what goes with them."""

from __future__ import annotations

import numpy as np

from sandbox.audit import audit as audit_module
from sandbox.audit import evidence as evidence_module
from sandbox.audit.audit import audit
from sandbox.audit.evidence import Evidence
from tests.audit.still import H, block, machine, still


def pair():
    return machine(block("one"), block("two"))


def test_long_runs_are_thinned_to_so_many_numbers(monkeypatch):
    """Three bodies and 100 numbers: at most 34 samples; of 90 each third, the last among them."""
    monkeypatch.setattr(evidence_module, "NUMBERS", 100)
    machine_ = machine(block("one"), block("two"))
    thin = Evidence(still(machine_, n=90))
    assert not thin.every_step
    assert np.rint(thin.run.time / H - 0.5).tolist() == list(range(2, 90, 3))
    whole = Evidence(still(machine_, n=33))
    assert (len(whole.run), whole.every_step) == (33, True)
    half = Evidence(still(machine_, n=34))
    assert np.rint(half.run.time / H - 0.5).tolist() == list(range(1, 34, 2))
    assert len(Evidence(still(machine(), n=100)).run) == 100  # a wall alone is one body
    assert len(Evidence(still(machine(), n=101)).run) < 101


def test_one_check_may_fail_and_the_others_are_computed(monkeypatch):
    def broken(*_):
        raise ValueError("odd numbers")
    checks = audit_module.CHECKS
    monkeypatch.setattr(audit_module, "CHECKS", {
        **checks, "poses": checks["poses"]._replace(compare=broken)})
    found = audit(still(pair()))
    assert (found[0].name, found[0].verdict) == ("poses", "not computed")
    assert found[0].why == "the numbers cannot be used: odd numbers"
    assert [figure.name for figure in found] == list(checks)
