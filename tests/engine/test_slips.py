"""Cords that guides hold by friction, and loops, against closed forms (Euler, Eytelwein)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording

from .machines import G, fixed, mass, mechanism

H = 5e-4
STIFF = 1e6


def guide(body: str, at: tuple[float, float] = (0.0, 0.0), radius: float = 0.0,
          side: str = "left", friction: float = 0.0) -> dict[str, Any]:
    return {"body": body, "at": at, "radius": radius, "side": side, "friction": friction}


def sound(run: Recording) -> Recording:
    """A run whose audit finds nothing; slack is no fault here."""
    wrong = {f.name: f.why for f in audit(run) if f.verdict == "look" and f.name != "tendon.slack"}
    assert wrong == {}
    return run


def test_whole_turns_count() -> None:
    """A load of 100 kg, three turns and a half round a bar, is held by m g e^(-mu phi)."""
    mu, r = 0.2, 0.05
    phi = 7 * math.pi
    hand = 100 * G * math.exp(-mu * phi)
    for share, slides in ((1.01, False), (0.99, True)):
        run = sound(simulate(mechanism(
            duration=0.3, step=H, gravity=(0.0, -G),
            bodies=[fixed("ground"), mass("load", 100.0, (r, -1.0))],
            tendons=[{"name": "rope", "stiffness": STIFF, "damping": 5e3, "pretension": 100 * G,
                      "guides": [guide("load"), guide("ground", (0, 0), r, "left", mu) | {
                          "turns": 3}, guide("ground", (-r, -1))]}],
            drives=[{"type": "pull", "name": "pull", "tendon": "rope", "value": share * hand}])))
        assert run["rope.length"][0] == pytest.approx(2.0 + phi * r, rel=1e-6)
        assert (abs(float(run["load.vy"][-1])) > 1e-4) is slides
        if slides:
            ratio = run["rope.tension_0"][-1] / run["rope.tension_1"][-1]
            assert ratio == pytest.approx(math.exp(mu * phi), rel=1e-9)


@pytest.mark.parametrize("stiffness", [2e3, 1e6])
def test_a_cord_that_hangs_is_taken_up_as_a_whole(stiffness: float) -> None:
    """1 kg falls 20 mm onto a slack cord over two guides with friction; nothing is lost of it."""
    run = sound(simulate(mechanism(
        duration=0.4, step=H, gravity=(0.0, -G),
        bodies=[fixed("ground"), mass("load", 1.0, (0.05, -0.5))],
        tendons=[{"name": "rope", "stiffness": stiffness, "slack": 0.02, "guides": [
            guide("load"), guide("ground", (0, 0), 0.05, "left", 0.3),
            guide("ground", (-0.5, 0.05), friction=0.2), guide("ground", (-1, -0.05))]}])))
    hangs = run["rope.tension"] == 0.0
    taken = float(run.time[np.argmin(hangs)])
    assert taken == pytest.approx(math.sqrt(2 * 0.02 / G), abs=2 * H)
    pieces = np.array([run[f"rope.tension_{k}"] for k in range(3)])
    assert (pieces[:, hangs] == 0.0).all()
    assert (pieces[:, ~hangs] > 0.0).all()


def test_a_cord_let_go_slides_until_it_does_not_pull() -> None:
    """A pull that ends leaves no stretch behind a guide that would still hold some."""
    run = sound(simulate(mechanism(
        duration=0.3, step=H, bodies=[fixed("ground"), mass("load", 1.0, (-0.5, 0.0))],
        joints=[{"type": "weld", "name": "held", "a": "ground", "b": "load",
                 "on_b": (0.0, 0.0)}],
        tendons=[{"name": "cord", "stiffness": 1e4, "guides": [
            guide("load"), guide("ground", friction=0.3), guide("ground", (0.0, -0.5))]}],
        drives=[{"type": "pull", "name": "pull", "tendon": "cord",
                 "value": "=20 if abs(t - 0.15) > 0.05 else 0"}])))
    pulls = np.isclose(run["pull.value"], 20.0)
    holds = math.exp(0.3 * math.pi / 2)
    assert run["cord.tension_0"][~pulls] == pytest.approx(np.zeros((~pulls).sum()), abs=1e-9)
    # 20 N e^(-mu phi) again, after just the slip that stretches 0.5 m by it; what slides in the one
    # step makes the span stiffer by the strain, 1.25e-3
    assert run["cord.tension_0"][-1] == pytest.approx(20 / holds, rel=1.3e-3)
    stretched = 20 / holds / (1e4 * 1.0) * 0.5
    assert run["cord.slip_1"][-1] == pytest.approx(stretched, rel=1.3e-3)
    assert run["cord.slip_1"][~pulls][-1] == pytest.approx(0.0, abs=1e-3 * stretched)
