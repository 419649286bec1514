"""Which samples the audit looks at, and what goes with them."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.audit import audit as audit_module
from sandbox.audit import evidence as evidence_module
from sandbox.audit.audit import audit
from sandbox.audit.evidence import CLOSES, Evidence
from sandbox.audit.figures import STILL
from sandbox.engine import rows, solve
from sandbox.engine.simulate import simulate
from tests.audit.still import H, block, machine, still
from tests.engine.machines import mechanism


def pair():
    return machine(block("one"), block("two"))


def test_the_last_sample_is_known_to_be_alone():
    last = Evidence(still(pair(), n=7)).last
    assert (len(last.run), last.every_step) == (1, False)
    assert last.run.time[0] == pytest.approx(6.5 * H)


def test_long_runs_are_thinned_to_so_many_numbers(monkeypatch):
    """Three bodies and 100 numbers: at most 34 samples; of 90 each third, the last among them."""
    monkeypatch.setattr(evidence_module, "NUMBERS", 100)
    machine_ = machine(block("one"), block("two"))
    thin = Evidence(still(machine_, n=90))
    assert thin.thinned
    assert not thin.every_step
    assert np.rint(thin.run.time / H - 0.5).tolist() == list(range(2, 90, 3))
    whole = Evidence(still(machine_, n=33))
    assert (len(whole.run), whole.thinned, whole.every_step) == (33, False, True)
    half = Evidence(still(machine_, n=34))
    assert half.thinned
    assert np.rint(half.run.time / H - 0.5).tolist() == list(range(1, 34, 2))
    assert not Evidence(still(machine(), n=100)).thinned  # a wall alone is one body
    assert Evidence(still(machine(), n=101)).thinned


def test_every_step_is_there_where_samples_are_one_step_apart():
    machine_ = machine(block("one"))
    assert Evidence(still(machine_, n=2)).every_step
    assert not Evidence(still(machine_, n=2, every=2)).every_step
    assert not Evidence(still(machine_, n=1)).every_step
    for off, same in ((1.01e-6, False), (-1.01e-6, False), (0.99e-6, True), (-0.99e-6, True)):
        run = still(machine_, lambda a, off=off: a["time"].__imul__(1 + off), n=3)
        assert Evidence(run).every_step is same


def test_the_figures_of_one_part_may_fail_and_the_others_are_there(monkeypatch):
    def broken(_):
        raise ValueError("odd numbers")
    monkeypatch.setattr(audit_module, "PARTS", (("geometry", broken), *audit_module.PARTS[1:]))
    found = audit(still(pair()))
    assert (found[0].name, found[0].verdict) == ("geometry", "not computed")
    assert found[0].why == "the numbers cannot be used: odd numbers"
    assert "momentum.force" in {figure.name for figure in found}


def test_what_the_engine_leaves_alone_is_what_the_audit_allows():
    assert (CLOSES, STILL) == (rows.CLOSED, (solve.STILL, solve.STILL_TURNING))


def test_gaps_that_a_long_step_leaves_are_sound():
    """Two slow bars at 20 ms: joints are closed to 1e-6 h^2 = 4e-10 m each way, not to 1e-10."""
    h, on = 0.02, (-0.002, 0.5)
    bodies = [{"name": "wall", "motion": "fixed"}, *(
        {"name": f"bar{i}", "mass": 1, "inertia": 0.01, "at": (0.002 * i, -0.5 * i)}
        for i in (1, 2))]
    joints = [{"type": "pin", "name": f"hinge{i}", "a": a, "b": f"bar{i}", "on_a": (0, 0),
               "on_b": on, "damping": 0.3} for i, a in ((1, "wall"), (2, "bar1"))]
    run = simulate(mechanism(duration=3.0, step=h, gravity=(0.0, -9.81), bodies=bodies,
                             joints=joints, run={"sample_rate": 1 / h}))
    figures = {figure.name: figure for figure in audit(run)}
    assert figures["joint.drift"].value > 1.5e-10
    assert [figures[name].verdict for name in ("joint.drift", "poses")] == ["pass", "pass"]
