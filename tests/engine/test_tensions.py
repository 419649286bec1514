"""Tendons in a running simulation: shares, stretch at rest, noise, and hard cases."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

from .machines import G, H, cord, disc, fixed, mass, mechanism


def solved(run: Recording) -> list[int]:
    """Tendons whose tension the network finds: all but the pulled ones."""
    pulled = {drive.tendon for drive in run.mechanism.drives if drive.type == "pull"}
    return [i for i, tendon in enumerate(run.mechanism.tendons) if tendon.name not in pulled]


def at_rest(run: Recording, *, share: float, rtol: float) -> None:
    """Last 0.1 s: tensions as told and without noise; every stretch is T / k.

    Motion has died down to rounding, which 1e5 N/m turns into 1e-11 N.
    """
    late = run.time > run.time[-1] - 0.1
    names = [tendon.name for tendon in run.mechanism.tendons]
    own = solved(run)
    tension = run.arrays["tendon_tension"][late][:, own]
    leaves = [i for i, t in enumerate(own) if names[t].startswith(("leaf", "finger"))]
    np.testing.assert_allclose(tension[:, leaves].mean(axis=0), share, rtol=rtol)
    assert (tension.std(axis=0) < 1e-9 * tension.mean(axis=0)).all()
    stiffness = np.array([run.mechanism.tendons[i].stiffness for i in own])
    stretch = run.arrays["tendon_length"][-1, own] - run.arrays["tendon_rest"][own]
    np.testing.assert_allclose(stretch, tension[-1] / stiffness, rtol=1e-9)


def tree(leaves: int, step: float, duration: float) -> Mechanism:
    """Rockers over rockers over ``leaves`` sliding loads, each on a spring, damped everywhere.

    All hangs from one pull of 1 N a leaf; cords are 0.2 m long and plumb.
    """
    bodies, joints, springs, tendons = [fixed("wall")], [], [], []
    level, width, height = [f"load{i}" for i in range(leaves)], 0.02, 0.0
    x = {name: width * i for i, name in enumerate(level)}
    for i, name in enumerate(level):
        bodies.append(mass(name, 0.01, (x[name], 0.0)))
        joints.append({"type": "slot", "name": f"slot{i}", "a": "wall", "b": name, "turns": False,
                       "start": (x[name], -0.1), "end": (x[name], 0.1)})
        springs.append({"type": "linear", "name": f"spring{i}", "a": "wall", "b": name,
                        "on_a": (x[name], -0.2), "stiffness": 200.0 + 3 * (i % 7), "damping": 2.0})
    hook = dict.fromkeys(level, (0.0, 0.0))
    while len(level) > 1:
        height += 0.2
        above = []
        for a, b in zip(level[::2], level[1::2], strict=True):
            name, half = f"rocker{len(bodies)}", (x[b] - x[a]) / 2
            x[name] = x[a] + half
            bodies.append({"name": name, "mass": 0.005, "inertia": 0.005 * half**2 / 3,
                           "at": (x[name], height)})
            joints.append({"type": "slot", "name": f"{name}.slot", "a": "wall", "b": name,
                           "start": (x[name], height - 0.1), "end": (x[name], height + 0.1)})
            kind = "leaf" if a.startswith("load") else "link"
            for end, body in ((-half, a), (half, b)):
                tendons.append(cord(f"{kind}_{body}", (name, (end, 0.0)), (body, hook[body])))
            above.append(name)
        hook = dict.fromkeys(above, (0.0, 0.0))
        level = above
    tendons.append(cord("main", (level[0],), ("wall", (x[level[0]], height + 0.2))))
    return mechanism(
        duration=duration, step=step, run={"sample_rate": 1000.0}, bodies=bodies, joints=joints,
        springs=springs, tendons=tendons,
        drives=[{"type": "pull", "name": "pull", "tendon": "main", "value": float(leaves)}])


@pytest.mark.parametrize("leaves", [4, 64])
def test_trees_share_equally(leaves: int) -> None:
    """Equal arms: 1 N at each leaf. Rockers tilt by less than 0.05 rad, which turns both arms alike
    and leans the cords by 0.05 * 10 mm * 0.05 / 2 / 200 mm = 6e-5: F / n to 1e-4.
    """
    run = simulate(tree(leaves, 1e-3, 1.5))
    at_rest(run, share=1.0, rtol=1e-4)


@pytest.mark.parametrize("step", [1e-4, 5e-4, 2e-3])
@pytest.mark.parametrize("stiffness", [1e3, 1e7])
def test_a_very_light_and_a_very_heavy_body_on_one_cord(step: float, stiffness: float) -> None:
    """Atwood's machine with 100 kg and 0.1 g: T = 2 m1 m2 g / (m1 + m2), two masses 1e6 apart.

    The damping is critical for the light body on the soft cord, which rings on its own otherwise.
    """
    run = simulate(mechanism(
        duration=0.3, step=step, gravity=(0.0, -G),
        bodies=[fixed("beam"), mass("heavy", 100.0, (0.0, -0.5)), mass("light", 1e-4, (0.1, -0.5))],
        tendons=[cord("cord", ("heavy",), ("beam", (0.0, 0.0)), ("beam", (0.1, 0.0)), ("light",),
                      stiffness=stiffness, damping=2 * np.sqrt(1e3 * 1e-4))]))
    late = (run.time > 0.2) & (run.time < 0.3)
    np.testing.assert_allclose(
        run["cord.tension"][late], 2 * 100 * 1e-4 * G / (100 + 1e-4), rtol=1e-4)


@pytest.mark.parametrize("step", [1e-4, 5e-4, 2e-3])
def test_slack_then_taut(step: float) -> None:
    """A load falls 0.1 m into its cord: no pull before, no more speed after than it came with.

    Overrun: half a period of the cord's own swing reaches v sqrt(m / k) = 1.4 mm at most, or the
    step's travel v h if that is longer.
    """
    run = simulate(mechanism(
        duration=0.6, step=step, gravity=(0.0, -G),
        bodies=[fixed("beam"), mass("m", 0.1, (0, -0.1))],
        tendons=[cord("cord", ("beam",), ("m",), slack=0.1)]))
    free = run.time < np.sqrt(2 * 0.1 / G) - 2 * step
    assert (run["cord.tension"][free] == 0).all()
    assert (run["cord.tension"] >= 0).all()
    speed = np.sqrt(2 * G * 0.1)
    assert run["m.vy"].max() < speed
    assert run["m.y"].min() > -0.2 - 1.1 * speed * max(step, np.sqrt(0.1 / 1e5))
    assert run["cord.tension"].max() > 10 * 0.1 * G


def test_cords_in_parallel_share() -> None:
    """Five like cords side by side, one load: the matrix is all but singular, T = m g / 5 each."""
    run = simulate(mechanism(
        duration=0.5, gravity=(0.0, -G), bodies=[fixed("beam"), mass("m", 0.1, (0.0, -0.2))],
        tendons=[cord(f"leaf{i}", ("beam",), ("m",)) for i in range(5)]))
    np.testing.assert_allclose(run.arrays["tendon_tension"][-1], 0.1 * G / 5, rtol=1e-9)


def test_a_chain_of_ropes() -> None:
    """Forty beads of 1 g on forty cords: the i-th from below carries i beads.

    Damped at 1 N s/m a cord the chain's own swing has died to 1e-3 within 1 s.
    """
    count = 40
    names = [f"m{i}" for i in range(count)]
    run = simulate(mechanism(
        duration=1.0, gravity=(0.0, -G),
        bodies=[fixed("wall"), *(mass(n, 1e-3, (0.0, -0.01 * (i + 1)))
                                 for i, n in enumerate(names))],
        tendons=[cord(f"c{i}", (a,), (b,), damping=1.0)
                 for i, (a, b) in enumerate(zip(["wall", *names[:-1]], names, strict=True))]))
    weights = 1e-3 * G * np.arange(count, 0, -1)
    np.testing.assert_allclose(run.arrays["tendon_tension"][-1], weights, rtol=2e-3)


def test_guides_that_pass_through_one_another_are_harmless() -> None:
    """No direction for an instant, no force, no NaN.

    12 mm lower than it begins the load hangs: it gets lower by the cord's swing at most,
    v sqrt(m / k) = 0.49 mm, and so it does reach the end of the slack.
    """
    run = simulate(mechanism(
        duration=0.3, gravity=(0.0, -G), bodies=[fixed("beam"), mass("m", 0.1, (0.0, 0.002))],
        tendons=[cord("cord", ("beam",), ("m",), slack=0.008, damping=30.0)]))
    assert np.isfinite(run.arrays["body_pose"]).all()
    assert -0.01 - 6e-4 < run["m.y"].min() < -0.01


def test_fixed_ends_only() -> None:
    """Nothing moves; the tension is k times what it is short, at once and for ever."""
    run = simulate(mechanism(
        duration=0.05, bodies=[fixed("a"), fixed("b", at=(0.3, 0.0)), disc("d", 0.01, (9.0, 0.0))],
        tendons=[cord("t", ("a",), ("b",), stiffness=500.0, rest_length=0.28)]))
    np.testing.assert_allclose(run["t.tension"], 10.0, rtol=1e-12)
    assert run["t.length"][0] == pytest.approx(0.3, rel=1e-14)
    assert run.time[0] == H / 2
