"""A scene run at h, h/2 and h/4."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sandbox.convergence import certificate as module
from sandbox.convergence.certificate import Kind, certify, refined
from sandbox.elements.controllers.controller import every
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.errors import SceneError, SimulationDiverged
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.settings import Event
from tests.support.mechanisms import G, fixed, mass, mechanism

STIFF, LOAD, START = 200.0, 0.05, 0.01
OMEGA = np.sqrt(STIFF / LOAD)


def spring(expect: list[dict[str, Any]], duration: float = 0.1, **run: Any) -> Mechanism:
    """A mass on a spring, 10 mm from its rest at 50 mm."""
    return mechanism(
        duration=duration, step=1e-3, run=run,
        bodies=[fixed("wall"), mass("load", LOAD, (0.05 + START, 0.0))],
        springs=[{"type": "linear", "name": "spring", "a": "wall", "b": "load",
                  "stiffness": STIFF, "rest_length": 0.05}], expect=expect)


AT_REST = {"final": "load.x", "is": 0.06, "within": 0.01}
WIDE = {"final": "load.x", "between": (-1000.0, 1000.0)}


@pytest.mark.parametrize("asked", [
    AT_REST, {"quantity": "load.x", "at": 0.0995, "is": 0.06, "within": 0.01}])
def test_a_smooth_motion_converges_with_order_two(asked: dict[str, Any]) -> None:
    """The leapfrog's phase is (omega h)^2 / 24 fast: error x0 omega t sin(omega t) of that.

    The last sample is at 0.0995 s.
    """
    found = certify(spring([asked]))
    trust, = found.quantities
    assert trust.kind is Kind.CONVERGED
    assert trust.order == pytest.approx(2.0, abs=0.1)
    truth = 0.05 + START * np.cos(OMEGA * (0.1 - 0.5e-3))
    assert trust.error == pytest.approx(abs(trust.values[0] - truth), rel=0.1)
    assert trust.limit == pytest.approx(truth, abs=0.05 * trust.error)
    assert found.certified
    assert found.conclusion == "Certified at h = 1 ms: all 1 expected quantities have converged."
    assert found.advice == ()


def test_the_step_that_is_named_does() -> None:
    """After nine periods 0.1 mm of error is left, more than the range, where 6 um are allowed."""
    expect = {"mean": "load.x", "over": (0.965, 0.975), "is": "50.86 mm", "within": "60 um"}
    scene = spring([expect], duration=1.0)
    found = certify(scene)
    trust, = found.quantities
    assert trust.kind is Kind.FAILS
    assert trust.finer == 8
    assert found.advice == (
        f"At these orders h/{trust.finer} is sufficient: --set run.step={1e-3 / trust.finer:.6g}.",)
    finer = scene.run.model_copy(update={"step": 1e-3 / trust.finer})
    again, = certify(scene.model_copy(update={"run": finer})).quantities
    assert trust.allowed / 4 < again.error < trust.allowed


# -- what explodes --------------------------------------------------------------------


def planted(monkeypatch: pytest.MonkeyPatch, change: Callable[[Recording], Any]) -> None:
    """Every run is changed, or gives way to an exception, after it was made."""
    def spoiled(mechanism: Mechanism, **more: Any) -> Recording:
        run = simulate(mechanism, **more)
        return change(run) or run

    monkeypatch.setattr(module, "simulate", spoiled)


def growing(run: Recording) -> Recording:
    """Off by 1 mm at h, and four times as far for every halving of the step."""
    arrays = dict(run.arrays)
    arrays["body_pose"] = run.arrays["body_pose"] + 1e-9 / run.info.step**2
    return Recording(run.mechanism, arrays, run.info)


@pytest.mark.parametrize("expect", [
    WIDE, {"max": "load.x", "below": 1000.0}, {"mean": "load.x", "is": 0, "within": 1000.0}])
def test_an_error_that_grows_as_the_step_shrinks_diverges(
    monkeypatch: pytest.MonkeyPatch, expect: dict[str, Any],
) -> None:
    assert certify(spring([expect])).certified
    planted(monkeypatch, growing)
    found = certify(spring([expect]))
    trust, = found.quantities
    assert trust.kind is Kind.DIVERGES
    assert trust.differences == pytest.approx((3e-3, 12e-3), rel=0.1)
    assert "by 0.003 m, then by 0.012 m: the finer the step, the more" in trust.reason
    assert not found.certified
    assert "cannot be relied on at this step: load.x" in found.conclusion
    assert "no step converges" in "".join(found.advice)


def away(*steps: float) -> Callable[[Recording], None]:
    """Runs with one of these steps run away after 20 ms."""
    def change(run: Recording) -> None:
        if run.info.step not in steps:
            return
        simulation = Simulation(run.mechanism)
        simulation.run(round(0.02 / run.info.step))
        message = "it ran away; a smaller run.step may help"
        error = SimulationDiverged(0.02, "load", message)
        error.recording = simulation.finish(message)
        raise error

    return change


def test_a_run_that_diverges_is_part_of_the_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    planted(monkeypatch, away(1e-3))
    early = {"mean": "load.x", "over": (0.0, 0.01), "above": 0.0}
    found = certify(spring([AT_REST, early]))
    late, soon = found.quantities
    assert late.kind is Kind.DIVERGES
    assert np.isnan(late.values[0])
    assert np.isfinite(late.values[1:]).all()
    assert "at h, before the window ended" in late.reason
    assert soon.kind is Kind.CONVERGED
    assert not found.certified
    assert not certify(spring([early])).certified
    assert [(each.run, each.reason) for each in found.diverged] == [("h", "it ran away")]
    assert "the simulation diverged at h" in found.conclusion
    assert found.advice[0] == (
        "The run at h/4 is complete: check convergence from there, --set run.step=0.00025.")


# -- peaks ----------------------------------------------------------------------------


def impact(expect: dict[str, Any], **run: Any) -> Mechanism:
    """A disc that drops on a plane."""
    return mechanism(
        duration=0.1, step=1e-3, gravity=(0.0, -G), expect=[expect], run=run,
        bodies=[fixed("plane", shapes=[{"type": "box", "size": (1.0, 0.02), "at": (0, -0.01)}]),
                {"name": "disc", "mass": 0.1, "at": (0.0, 0.02),
                 "shapes": [{"type": "circle", "radius": 0.01}]}])


PEAK = 0.1 * np.sqrt(2 * G * 0.01)
"""Momentum of the drop [N s]."""


def blow(step: float) -> float:
    """The larger force of the two steps that share the blow [N].

    Of the step in which it touches the disc makes a share f on its way: it keeps that share of its
    speed, so as to end on the plane, and loses it in the next, in which its weight is carried too.
    Poses belong to the middle of a step, so f is that of t / h + 1/2.
    """
    share = (np.sqrt(2 * 0.01 / G) / step + 0.5) % 1.0
    return float(max(1 - share, share) * PEAK / step)


def test_the_peak_of_an_impact_diverges() -> None:
    """M v / h doubles as the step is halved, but for how it falls on steps: read where it is."""
    found = certify(impact({"max": "disc.contact.normal", "between": [30, 60]}))
    trust, = found.quantities
    assert trust.kind is Kind.DIVERGES
    assert not found.certified
    assert "disc.contact.normal" in found.conclusion
    for value, step in zip(trust.values, (1e-3, 5e-4, 2.5e-4), strict=True):
        assert value == pytest.approx(blow(step), abs=2 * 0.1 * G)  # the weight of two steps
    assert found.advice[0].startswith("The peak force of an impact has no limit")


def test_a_peak_between_two_samples_is_seen() -> None:
    """Sampled every 7 ms the blow is missed; no run of another step is needed to see it."""
    scene = impact({"max": "disc.contact.normal", "below": 10.0}, sample_rate=1 / 7e-3)
    assert simulate(scene)["disc.contact.normal"].max() < 10.0
    trust, = certify(scene).quantities
    assert trust.values[0] == pytest.approx(blow(1e-3), abs=2 * 0.1 * G)
    assert not trust.certified
    assert "between two samples of the scene it is 29.6684, outside its range; halv" in trust.reason


# -- the audits -----------------------------------------------------------------------


def test_the_audit_finds_errors_equal_at_all_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every run gets energy from nowhere, the same at every step: no difference would show it."""
    def change(run: Recording) -> Recording:
        arrays = dict(run.arrays)
        arrays["body_velocity"] = run.arrays["body_velocity"] * (1 + run.time[:, None, None])
        return Recording(run.mechanism, arrays, run.info)

    assert certify(spring([AT_REST])).certified
    planted(monkeypatch, change)
    found = certify(spring([AT_REST]))
    assert found.quantities[0].certified
    assert not found.certified
    assert "energy.created" in {look.figure.name for look in found.looks}


def test_side_by_side_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    mechanism = spring([AT_REST])
    alone = certify(mechanism)
    monkeypatch.setattr(module, "LONG", 0.0)
    shares: list[float] = []
    assert certify(mechanism, progress=shares.append) == alone
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)


# -- the rest -------------------------------------------------------------------------


def test_scenes_that_cannot_be_certified_are_refused() -> None:
    stopped = spring([{"max": "load.x", "below": 1.0}])
    event = Event(name="near", when="=load.x < 0.055", stop="pass")
    with pytest.raises(SceneError, match="an event may stop the run"):
        certify(stopped.model_copy(update={"events": (event,)}))
    with pytest.raises(SceneError, match="expects nothing"):
        certify(spring([]))
    with pytest.raises(SceneError, match="fewer than four steps"):
        certify(spring([{"final": "load.x", "above": 0.0}], duration=2e-3))


def test_controllers_keep_their_rate() -> None:
    """At 0.4 ms the rate next to 1 kHz is 1250 Hz, at 0.2 ms it would be 1 kHz."""
    law = {"type": "schedule", "name": "law", "writes": "push", "value": 1}
    plain = mechanism(
        duration=0.1, step=4e-4, bodies=[mass("load", 1.0, (0, 0))], controllers=[law],
        drives=[{"type": "force", "name": "push", "body": "load", "direction": [1, 0], "value": 0}])
    for parts in (2, 4):
        found = refined(plain, parts)
        assert every(found.controllers[0].rate, found.run.step) == 2 * parts
