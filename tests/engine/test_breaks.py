"""Breaking hinges with all that acts about them, and joints engaged on turning bodies.

Up to the break a load grows linearly, GROWS t, so impulses are exact by the midpoint rule. The step
of the break gives (s - 1/2) h of them in place of the integral: of a force F that hangs on the load
that is wrong by h^2 dF/dt / 2, of one that does not by as large a share, h^2 GROWS / LOAD F / 2.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import load_scene

GROWS, LOAD = 90.0, 15.0
"""How fast what pulls does so [N/s, N m/s]; where it breaks [N, N m]."""
BROKE = LOAD / GROWS
INERTIA, TORQUE, SPIN = 0.01, 0.02, 20.0
STEPS = [1e-3, 0.53e-3, 0.29e-3]
FRAME: dict[str, Any] = {"name": "frame", "motion": "fixed"}


def body(name: str, at: tuple[float, float] = (0.0, 0.0), **more: Any) -> dict[str, Any]:
    return {"name": name, "at": at, "mass": 1.0, "inertia": INERTIA, **more}


def run(h: float, end: float, *bodies: dict[str, Any], **more: Any) -> Recording:
    """A run without weight, every step of it, in which the audit finds nothing."""
    made = simulate(load_scene({"run": {"duration": end, "step": h, "sample_rate": 1 / h},
                                "bodies": [FRAME, *bodies], **more}))
    assert [f"{f.name}: {f.why}" for f in audit(made)
            if f.verdict == "look" and f.name != "tendon.slack"] == []
    return made


def pull(name: str, value: str = f"={GROWS} * t", **more: Any) -> dict[str, Any]:
    return {"type": "force", "name": "pull", "body": name, "direction": (0.6, -0.8),
            "value": value, **more}


# -- what acts about a hinge goes with it ----------------------------------------------


ABOUT: dict[str, dict[str, Any]] = {
    "friction": {"joint": {"friction": TORQUE}},
    "journal": {"joint": {"friction_coefficient": 0.1, "pin_radius": 0.01}},
    "damping": {"joint": {"damping": 1e-3}},
    "brake": {"drive": {"type": "brake", "value": TORQUE}},
    "motor": {"drive": {"type": "motor", "value": -500.0, "torque": TORQUE}},
    "line": {"drive": {"type": "motor", "stall": TORQUE, "no_load": 20.0, "value": 0.0}},
    "servo": {"drive": {"type": "servo", "value": -500.0, "torque": TORQUE}},
    "soft servo": {"drive": {"type": "servo", "value": -500.0, "torque": TORQUE,
                             "stiffness": 0.01}},
    "torque": {"drive": {"type": "torque", "value": -TORQUE}},
    "spring": {"spring": {"stiffness": 1e-2}},
    "law": {"spring": {"torque": f"={TORQUE} + 0 * twist"}},
}


def slowed(kind: str, t: float) -> float:
    """The speed [rad/s] that is left of SPIN after t seconds."""
    if kind == "journal":
        return SPIN - 0.1 * 0.01 * GROWS * t**2 / 2 / INERTIA
    if kind in ("damping", "line"):  # a line falls from its stall torque by TORQUE / 20 rad/s
        return SPIN * math.exp(-1e-3 / INERTIA * t)
    if kind == "spring":
        w = math.sqrt(1e-2 / INERTIA)
        return SPIN * math.cos(w * t)
    return SPIN - TORQUE / INERTIA * t


@pytest.mark.parametrize("kind", ABOUT)
@pytest.mark.parametrize("h", STEPS)
def test_torques_about_a_hinge_act_until_it_breaks(kind: str, h: float) -> None:
    """A wheel that spins in a bearing, which is pulled at until it breaks.

    Left out of its last step, the torque would be missed by up to h TORQUE / 2 of momentum; so is
    one that a drive is set to.
    """
    about = ABOUT[kind]
    drives = [pull("wheel")] + [
        {"name": "d", "joint": "pin", **drive} for drive in [about.get("drive")] if drive]
    springs = [{"type": "rotary", "name": "s", "joint": "pin", **spring}
               for spring in [about.get("spring")] if spring]
    made = run(h, 0.25, body("wheel", angular_velocity=SPIN), drives=drives, springs=springs,
               joints=[{"type": "pin", "name": "pin", "a": "frame", "b": "wheel", "on_a": (0, 0),
                        "breaks_at": LOAD, **about.get("joint", {})}])
    gone = int(np.argmin(made["pin.held"]))
    assert made.time[gone] == pytest.approx(BROKE, abs=h)
    late = made["wheel.omega"][gone + 2:]
    assert np.ptp(late) < 1e-12
    alpha = max(abs(slowed(kind, BROKE) - slowed(kind, BROKE - 1e-4)) / 1e-4, 1.0)
    # of a torque that changes by itself, too: its rate is no more than its size times 1/s
    assert late[-1] == pytest.approx(
        slowed(kind, BROKE), abs=h**2 * alpha * (GROWS / LOAD + 1.0) / 2 + 1e-9
        + (h * alpha / 2 if kind == "torque" else 0.0))


# -- springs and cords -----------------------------------------------------------------


def test_the_first_break_relieves_the_other_element() -> None:
    """Two rods in line; the load passes the limits of both in one step, of the lower one before.

    Without it the upper one has only its own weight to carry.
    """
    h, steep = 1e-3, 3e4
    made = run(h, 0.02, body("upper", (0.0, -0.5)), body("lower", (0.0, -1.0)), drives=[
        {"type": "force", "name": "pull", "body": "lower", "direction": (0, -1),
         "value": f"={steep} * t"}], joints=[
        {"type": "rod", "name": "first", "a": "frame", "b": "upper", "breaks_at": 48.0},
        {"type": "rod", "name": "second", "a": "upper", "b": "lower", "breaks_at": 46.0}])
    # of one step to the next loads grow by 30 N, from 45 to 75 N
    assert made["second.held"][-1] == 0
    assert made["first.held"].all()


def test_an_element_engaged_beyond_its_load_breaks_without_an_impulse() -> None:
    """Released with 5 N of 6 and engaged with 7.5 N: it breaks at once, without a force."""
    made = run(1e-3, 0.3, body("weight", (0.0, -0.5)), drives=[
        {"type": "force", "name": "pull", "body": "weight", "direction": (0, -1), "value": 5.0}],
        springs=[{"type": "linear", "name": "held", "a": "frame", "b": "weight",
                  "stiffness": 100.0, "rest_length": 0.45, "breaks_at": 6.0}],
        events=[{"name": "cut", "at": 0.1, "release": "held"},
                {"name": "again", "at": 0.2, "take_up": "held"}])
    assert made["held.force"][50] == pytest.approx(5.0, rel=1e-9)
    assert not made["held.held"][-1]
    assert not made["held.force"][made.time > 0.101].any()


# -- taking up on bodies that turn ------------------------------------------------------


HOOKS: dict[str, dict[str, Any]] = {
    "pin": {"type": "pin", "on_a": (0.2, 0.1), "on_b": (-0.1, 0.05)},
    "slot": {"type": "slot", "start": (-0.3, -0.1), "end": (1.0, 0.4), "on_b": (-0.1, 0.05)},
    "guided slot": {"type": "slot", "start": (-0.3, -0.1), "end": (1.0, 0.4),
                    "on_b": (-0.1, 0.05), "turns": False},
    "rod": {"type": "rod", "on_a": (0.2, 0.1), "on_b": (-0.1, 0.05), "length": 0.4},
    "weld": {"type": "weld", "on_a": (0.2, 0.1), "on_b": (-0.1, 0.05)},
}


TURN = -0.3
"""Of b against a at t = 0, which a couple keeps."""


def gaps(kind: str, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of poses (x, y, angle) [n, 3] of two bodies, [n, what the joint keeps]."""
    hook = HOOKS[kind]

    def at(pose: np.ndarray, point: Any) -> np.ndarray:
        c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
        return np.stack([pose[:, 0] + c * point[0] - s * point[1],
                         pose[:, 1] + s * point[0] + c * point[1]], axis=1)

    there = at(b, hook["on_b"])
    turned = (b[:, 2] - a[:, 2] - TURN)[:, None]
    askew = turned - 2 * math.pi * np.round(turned[:1] / (2 * math.pi))
    if hook["type"] == "slot":
        start, end = at(a, hook["start"]), at(a, hook["end"])
        along = (end - start) / np.hypot(*(end - start).T)[:, None]
        off = there - start
        across = (along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0])[:, None]
        return across if hook.get("turns", True) else np.hstack([across, askew])
    off = there - at(a, hook["on_a"])
    if hook["type"] == "rod":
        return (np.hypot(*off.T) - hook["length"])[:, None]
    return np.hstack([off, askew]) if hook["type"] == "weld" else np.asarray(off)


@pytest.mark.parametrize("kind", HOOKS)
def test_gaps_of_engaged_joints_close_by_the_closed_form(kind: str) -> None:
    """Each of its gaps goes as (d + (u + d / T) t) exp(-t / T), from pose to pose, exactly.

    Until then both bodies fly freely, at constant rates, so that d and u follow from their poses:
    u by a difference over 2 us, good to 1e-9. A couple leaves whole turns alone.
    """
    h, over, caught = 1e-3, 0.02, 0.05
    rates = {"a": (0.3, -0.2, 3.0), "b": (-0.4, 0.5, 150.0)}
    places = {"a": (0.0, 0.0, 0.1), "b": (0.5, 0.3, 0.1 + TURN)}
    bodies = [body(n, places[n][:2], angle=places[n][2], velocity=rates[n][:2],
                   angular_velocity=rates[n][2]) for n in ("a", "b")]
    if kind not in ("weld", "guided slot"):
        bodies[1]["angular_velocity"], rates["b"] = 8.0, (-0.4, 0.5, 8.0)
    hook = {"name": "hook", "a": "a", "b": "b", "released": True, "takes_up_in": over,
            **HOOKS[kind]}
    made = run(h, 0.2, *bodies, joints=[hook], events=[
        {"name": "catch", "at": caught, "take_up": "hook"}])
    k = int(np.argmax(made["hook.held"]))
    pose = {n: np.stack([made[f"{n}.x"], made[f"{n}.y"], made[f"{n}.angle"]], axis=1)
            for n in ("a", "b")}

    def free(t: float) -> np.ndarray:
        """Gaps where they would be, t after the pose at which it is caught."""
        return np.asarray(
            gaps(kind, *(pose[n][k:k + 1] + np.array(rates[n]) * t for n in ("a", "b")))[0])

    d, u = free(0.0), (free(1e-6) - free(-1e-6)) / 2e-6
    t = (made.time[k:] - made.time[k])[:, None]
    foreseen = (d + (u + d / over) * t) * np.exp(-t / over)
    found = gaps(kind, pose["a"][k:], pose["b"][k:])
    assert np.abs(d).max() > 0.05
    assert np.abs(u).max() > 0.5
    assert found == pytest.approx(foreseen, abs=1e-8)
    if kind in ("weld", "guided slot"):
        turned = pose["b"][-1, 2] - pose["a"][-1, 2]
        assert round(turned / (2 * math.pi)) >= 1
