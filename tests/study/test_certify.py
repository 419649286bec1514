"""A scene run at h, h/2, h/4 and with twice the iterations."""

from __future__ import annotations

from typing import Any

import pytest

from sandbox.scene.elements.events import Event
from sandbox.scene.mechanism import Mechanism
from sandbox.study import certify as module
from sandbox.study.certify import certify
from sandbox.study.convergence import Kind
from sandbox.study.plain_mechanisms import G, fixed, mass, mechanism

STIFF, LOAD, START = 200.0, 0.05, 0.01


def spring(expect: list[dict[str, Any]], duration: float = 0.1) -> Mechanism:
    """A mass on a spring, 10 mm from its rest at 50 mm."""
    return mechanism(
        duration=duration, step=1e-3,
        bodies=[fixed("wall"), mass("load", LOAD, (0.05 + START, 0.0))],
        springs=[{"type": "linear", "name": "spring", "a": "wall", "b": "load",
                  "stiffness": STIFF, "rest_length": 0.05}], expect=expect)


def test_a_smooth_motion_converges_with_order_two() -> None:
    """The leapfrog's phase is (omega h)^2 / 24 fast: error x0 omega t sin(omega t) of that."""
    import numpy as np

    expect = {"final": "load.x", "is": 0.06, "within": 0.01}
    found = certify(spring([expect]))
    trust, = found.quantities
    assert trust.kind is Kind.CONVERGED
    assert trust.order == pytest.approx(2.0, abs=0.1)
    omega, t = np.sqrt(STIFF / LOAD), 0.1 - 0.5e-3
    truth = 0.05 + START * np.cos(omega * t)
    assert trust.error == pytest.approx(abs(trust.values[0] - truth), rel=0.1)
    assert found.certified
    assert found.conclusion == "Certified at h = 1 ms: all 1 expected quantities have converged."


def test_constant_acceleration_is_exact() -> None:
    """Velocity of a fall is linear in time: the scheme has it to rounding at every step."""
    fall = mechanism(duration=0.05, step=1e-3, gravity=(0.0, -G),
                     bodies=[mass("load", 1.0, (0, 0))],
                     expect=[{"final": "load.vy", "is": -0.4856, "within": "1 %"}])
    trust, = certify(fall).quantities
    assert trust.kind is Kind.EXACT


def impact(expect: dict[str, Any]) -> Mechanism:
    """A disc that drops on a plane."""
    return mechanism(
        duration=0.1, step=1e-3, gravity=(0.0, -G), expect=[expect],
        bodies=[fixed("plane", shapes=[{"type": "box", "size": (1.0, 0.02), "at": (0, -0.01)}]),
                {"name": "disc", "mass": 0.1, "at": (0.0, 0.02),
                 "shapes": [{"type": "circle", "radius": 0.01}]}])


def test_the_peak_of_an_impact_depends_on_the_step() -> None:
    """M v / h of one step doubles as the step is halved; m v is 44 mN s. Read at the coarse run's
    instants, beside the peak, at least half of it is left.
    """
    found = certify(impact({"max": "disc.contact.normal", "between": [30, 60]}))
    trust, = found.quantities
    assert trust.kind is Kind.STEP
    assert not found.certified
    assert "disc.contact.normal" in found.conclusion
    assert trust.values[2] > 2 * trust.values[0]


def test_rest_after_an_impact_is_certified() -> None:
    found = certify(impact({"mean": "disc.contact.normal", "over": (-0.01, None), "is": 0.1 * G}))
    assert found.certified


def test_a_failing_expectation() -> None:
    found = certify(spring([{"final": "load.x", "above": 1.0}]))
    assert found.quantities[0].kind is Kind.FAILS
    assert not found.certified


def test_patterns_give_one_verdict_each() -> None:
    found = certify(spring([{"max": "load.?", "below": 1.0}]))
    assert [trust.quantity for trust in found.quantities] == ["load.x", "load.y"]


def test_side_by_side_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    mechanism = spring([{"final": "load.x", "is": 0.06, "within": 0.01}])
    alone = certify(mechanism)
    monkeypatch.setattr(module, "LONG", 0.0)
    shares: list[float] = []
    assert certify(mechanism, progress=shares.append) == alone
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)


def test_what_cannot_be_certified() -> None:
    stopped = spring([{"max": "load.x", "below": 1.0}])
    event = Event(name="near", when="=load.x < 0.055", stop="pass")
    with pytest.raises(ValueError, match="an event may stop the run"):
        certify(stopped.model_copy(update={"events": (event,)}))
    with pytest.raises(ValueError, match="expects nothing"):
        certify(spring([]))
    with pytest.raises(ValueError, match="fewer than four steps"):
        certify(spring([{"final": "load.x", "above": 0.0}], duration=2e-3))
