"""Elements that break, are released and engaged again, against closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import bisect

from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import load_scene

from .machines import sound

G, GROWS, LOAD = 9.81, 30.0, 15.0


def scene(bodies: list[Any], h: float = 1e-3, end: float = 0.5, **more: Any) -> dict[str, Any]:
    return {"run": {"duration": end, "step": h, "sample_rate": 1 / h}, "gravity": [0, -G],
            "bodies": [{"name": "frame", "motion": "fixed"}, *bodies], **more}


def weight(name: str = "weight", at: tuple[float, float] = (0, -0.5), **more: Any) -> Any:
    return {"name": name, "at": at, "mass": 1, "inertia": 0.01,
            "shapes": [{"type": "circle", "radius": 0.02}], **more}


def pulled(h: float, **holder: Any) -> Any:
    drive = {"type": "force", "name": "pull", "body": "weight", "direction": [0, -1],
             "value": f"={GROWS} * t"}
    return simulate(load_scene(scene([weight()], h, drives=[drive], **holder)))


def after(run: Any, h: float) -> float:
    """The velocity at the end of the last step, under weight and pull alone in its second half."""
    return float(run["weight.vy"][-1] - h / 2 * (G + GROWS * run.time[-1]))


JOINTS = {
    "rod": {"type": "rod", "on_b": [0, 0]},
    "rope": {"type": "rope", "longest": 0.5},
    "end of a slot": {"type": "slot", "start": [0, -0.5], "end": [0, 0.5]},
    "slot": {"type": "slot", "start": [-1, -0.5], "end": [1, -0.5]},
    "weld": {"type": "weld", "on_a": [0, -0.5]},
    "pin": {"type": "pin", "on_a": [0, -0.5]},
}


@pytest.mark.parametrize("kind", JOINTS)
def test_a_joint_breaks_at_its_load(kind: str) -> None:
    """It carries m g + GROWS t, so from (LOAD - m g) / GROWS on the weight is free.

    Impulses of a load that is linear in time are exact by the midpoint rule, but for the last one,
    (s - 1/2) h LOAD: between it and the integral of the load lies h^2 GROWS / 2 at most.
    """
    h = 0.53e-3
    run = pulled(h, joints=[{"name": "held", "a": "frame", "b": "weight", "breaks_at": LOAD,
                             **JOINTS[kind]}])
    end, broke = run.time[-1] + h / 2, (LOAD - G) / GROWS
    fallen = G * (end - broke) + GROWS * (end**2 - broke**2) / 2
    assert after(run, h) == pytest.approx(-fallen, abs=h**2 * GROWS / 2 + 1e-9)
    gone = int(np.argmin(run["held.held"]))
    assert run.time[gone] == pytest.approx(broke, abs=h)
    assert [(one.event, pytest.approx(one.time, abs=1e-9)) for one in run.info.broke] == [
        ("held", broke)]
    assert not run["held.reaction"][gone + 1:].any()
    sound(run, "tendon.slack")


SOFT = 300.0
HOLDERS: dict[str, dict[str, Any]] = {
    "cord": {"tendons": [{"name": "held", "guides": [{"body": "frame"}, {"body": "weight"}],
                          "stiffness": SOFT, "pretension": G}]},
    "spring": {"springs": [{"type": "linear", "name": "held", "a": "frame", "b": "weight",
                            "stiffness": SOFT, "rest_length": 0.5 - G / SOFT}]},
    "law": {"springs": [{"type": "linear", "name": "held", "a": "frame", "b": "weight",
                         "force": f"={SOFT} * stretch", "rest_length": 0.5 - G / SOFT}]},
}


@pytest.mark.parametrize("kind", HOLDERS)
def test_an_elastic_element_breaks_at_its_load(kind: str) -> None:
    """m x'' = GROWS t - k x from rest: x = GROWS / k (t - sin(w t) / w), w^2 = k / m.

    Allowed: h^2 times dT/dt at the break, as above, and the leapfrog's own error, which is less.
    """
    h = 0.53e-3
    holder = {key: [{**each, "breaks_at": LOAD} for each in value]
              for key, value in HOLDERS[kind].items()}
    run = pulled(h, **holder)
    w = math.sqrt(SOFT)
    t = bisect(lambda t: GROWS * (t - math.sin(w * t) / w) - (LOAD - G), 0.0, 1.0)
    end, speed = run.time[-1] + h / 2, GROWS / SOFT * (1 - math.cos(w * t))
    fallen = speed + G * (end - t) + GROWS * (end**2 - t**2) / 2
    assert after(run, h) == pytest.approx(-fallen, abs=2 * h**2 * SOFT * speed + h**2 * GROWS)
    sound(run, "tendon.slack")


@pytest.mark.parametrize("kind", ["cord", "spring"])
def test_an_element_engaged_as_is_begins_without_force(kind: str) -> None:
    """Released at rest and engaged with its present length: no force at first.

    With its natural length it would pull with k (v t + k-stretch) at once.
    """
    events = [{"name": "cut", "at": 0.1, "release": "held"},
              {"name": "again", "at": 0.2, "take_up": "held"}]
    force = {}
    for way in ("natural", "as_is"):
        holder = {key: [{**each, "taken_up": way} for each in value]
                  for key, value in HOLDERS[kind].items()}
        run = simulate(load_scene(scene([weight()], events=events, **holder)))
        name = "held.tension" if kind == "cord" else "held.force"
        first = int(np.argmax(run.time >= 0.2))
        assert not run[name][first - 2:first].any()
        force[way] = run[name][first]
        sound(run, "tendon.slack")
    fallen = G * 0.1**2 / 2
    assert force["natural"] == pytest.approx(G + SOFT * fallen, rel=1e-2)
    assert abs(force["as_is"]) < SOFT * G * 0.1 * 2e-3  # what it falls in two steps


def test_lasting_events_undo_releasing_and_engaging() -> None:
    held = HOLDERS["spring"]["springs"][0]
    run = simulate(load_scene(scene(
        [weight()], springs=[held, {**held, "name": "other", "released": True}],
        events=[{"name": "swap", "at": 0.1, "lasts": 0.2, "release": "held", "take_up": "other"}])))
    off = (run.time > 0.1) & (run.time < 0.3)
    assert (run["held.held"] == ~off).all()
    assert (run["other.held"] == off).all()


@pytest.mark.parametrize("h", [0.5e-3, 2e-3])
def test_equally_loaded_rods_break_in_the_same_step(h: float) -> None:
    """Two rods share a growing load 100 t, and break where each carries 20 N: as one of both would.

    Then the weight, 1 kg, is pulled straight down: vx = 0, v = (F^2 - F_b^2) / (2 m dF/dt).
    """
    run = simulate(load_scene({
        "run": {"duration": 0.5, "step": h, "sample_rate": 1 / h},
        "bodies": [{"name": "frame", "motion": "fixed"},
                   {"name": "load", "at": [0, -1], "mass": 1.0, "inertia": 1e-3}],
        "joints": [{"type": "rod", "name": f"rod{side}", "a": "frame", "b": "load",
                    "on_a": [0.5 * sign, 0], "breaks_at": 20.0}
                   for side, sign in (("L", -1), ("R", 1))],
        "drives": [{"type": "force", "name": "pull", "body": "load", "direction": [0, -1],
                    "value": "=100 * t"}]}))
    broke = 2 * 20.0 / math.sqrt(1.25) / 100.0
    assert np.abs(run["load.vx"]).max() < 1e-12
    assert run["load.vy"][-1] == pytest.approx(
        -50.0 * (run.time[-1] ** 2 - broke**2), abs=100.0 * h**2 / 2)
    words = " ".join(run.notes)
    for rod in ("rodL", "rodR"):
        assert f"{rod} broke at its load of 20 N, t = 0.3" in words


def test_a_hold_drive_gives_the_same_bytes_as_events() -> None:
    """Released, engaged and released again at the same steps: the same bytes."""
    h = 0.37e-3
    holder = {"joints": [{"type": "rod", "name": "rod", "a": "frame", "b": "weight",
                          "on_b": [0, 0], "takes_up_in": 0.01, "breaks_at": 1e6}]}
    times = (0.1, 0.2, 0.35)
    events = [{"name": f"e{i}", "at": at, "take_up" if i == 1 else "release": "rod"}
              for i, at in enumerate(times)]
    drive = {"type": "hold", "name": "coil", "element": "rod",
             "value": {"table": [[0, 1], [times[0], 0], [times[1], 1], [times[2], 0]],
                       "between": "step"}}
    by_event = simulate(load_scene(scene([weight()], h, events=events, **holder)))
    by_drive = simulate(load_scene(scene([weight()], h, drives=[drive], **holder)))
    assert len(np.unique(by_drive["rod.held"])) == 2
    for quantity in ("weight.y", "weight.vy", "rod.tension", "rod.held"):
        assert (by_event[quantity] == by_drive[quantity]).all(), quantity
    sound(by_drive, "tendon.slack")
    assert by_drive.notes == by_event.notes == []  # what is released did not break


def test_a_broken_element_stays_broken_until_its_drive_engages_it_again() -> None:
    """It breaks though the drive wants it held; the drive's next rise takes it up."""
    run = simulate(load_scene(scene(
        [weight()], end=0.6, gravity=[0, 0],
        drives=[{"type": "hold", "name": "coil", "element": "rod",
                 "value": "=0 if 0.4 < t and t < 0.45 else 1"},
                {"type": "force", "name": "pull", "body": "weight", "direction": [0, -1],
                 "value": f"={2 * GROWS} * t if t < 0.3 else 0"}],
        springs=[{"type": "linear", "name": "rod", "a": "frame", "b": "weight", "stiffness": SOFT,
                  "breaks_at": LOAD, "taken_up": "as_is"}])))
    broke = LOAD / (2 * GROWS)
    sways = 1 / math.sqrt(SOFT)  # what it lags and leads by, of a weight of 1 kg
    held = run["rod.held"]
    assert held[run.time < broke - sways].all()
    assert not held[(run.time > broke + sways) & (run.time < 0.449)].any()
    assert held[np.argmax(run.time > 0.4505)] == 1
    assert any("rod broke" in note for note in run.notes)


def test_every_break_of_an_element_is_noted() -> None:
    """Every 16 ms a drive takes it up, and what it carries breaks it: as often in one go."""
    machine = load_scene(scene(
        [weight()], end=0.6, gravity=[0, 0],
        joints=[{"type": "rod", "name": "rod", "a": "frame", "b": "weight", "on_b": [0, 0],
                 "breaks_at": 5.0, "takes_up_in": 0.002}],
        drives=[{"type": "hold", "name": "coil", "element": "rod",
                 "value": "=floor(t * 1000 + 0.25) % 16 < 8"},
                {"type": "force", "name": "pull", "body": "weight", "direction": [0, -1],
                 "value": 10.0}]))
    simulation = Simulation(machine)
    while simulation.step(10):
        pass
    broke = simulation.recording().info.broke
    assert len(broke) > 25
    assert simulate(machine).info.broke == broke


# -- what acts about a hinge goes with it ----------------------------------------------


QUICK, BROKE = 90.0, LOAD / 90.0
"""How fast a pull grows, or a moment [N/s, N m/s]; when it breaks what carries LOAD [s].

Impulses of a load that grows linearly are exact by the midpoint rule. The step of the break gives
(s - 1/2) h of them in place of the integral: of a force F that depends on the load that is wrong by
h^2 dF/dt / 2, of one that does not by as large a share, h^2 QUICK / LOAD F / 2.
"""
INERTIA, TORQUE, SPIN = 0.01, 0.02, 20.0


def body(name: str, at: tuple[float, float] = (0.0, 0.0), **more: Any) -> dict[str, Any]:
    return {"name": name, "at": at, "mass": 1.0, "inertia": INERTIA, **more}


def weightless(h: float, end: float, *bodies: dict[str, Any], **more: Any) -> Recording:
    """A run without weight, every step of it, in which the audit finds nothing."""
    return sound(simulate(load_scene(scene([*bodies], h, end, gravity=[0, 0], **more))),
                 "tendon.slack")


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
        return SPIN - 0.1 * 0.01 * QUICK * t**2 / 2 / INERTIA
    if kind in ("damping", "line"):  # a line falls from its stall torque by TORQUE / 20 rad/s
        return SPIN * math.exp(-1e-3 / INERTIA * t)
    if kind == "spring":
        w = math.sqrt(1e-2 / INERTIA)
        return SPIN * math.cos(w * t)
    return SPIN - TORQUE / INERTIA * t


@pytest.mark.parametrize("kind", ABOUT)
@pytest.mark.parametrize("h", [1e-3, 0.53e-3])
def test_torques_about_a_hinge_act_until_it_breaks(kind: str, h: float) -> None:
    """A wheel that spins in a bearing, which is pulled at until it breaks.

    Left out of its last step, the torque would be missed by up to h TORQUE / 2 of momentum; so is
    one that a drive is set to.
    """
    about = ABOUT[kind]
    pull = {"type": "force", "name": "pull", "body": "wheel", "direction": (0.6, -0.8),
            "value": f"={QUICK} * t"}
    drives = [pull] + [
        {"name": "d", "joint": "pin", **drive} for drive in [about.get("drive")] if drive]
    springs = [{"type": "rotary", "name": "s", "joint": "pin", **spring}
               for spring in [about.get("spring")] if spring]
    made = weightless(h, 0.25, body("wheel", angular_velocity=SPIN), drives=drives, springs=springs,
               joints=[{"type": "pin", "name": "pin", "a": "frame", "b": "wheel", "on_a": (0, 0),
                        "breaks_at": LOAD, **about.get("joint", {})}])
    gone = int(np.argmin(made["pin.held"]))
    assert made.time[gone] == pytest.approx(BROKE, abs=h)
    late = made["wheel.omega"][gone + 2:]
    assert np.ptp(late) < 1e-12
    alpha = max(abs(slowed(kind, BROKE) - slowed(kind, BROKE - 1e-4)) / 1e-4, 1.0)
    # of a torque that changes by itself, too: its rate is no more than its size times 1/s
    assert late[-1] == pytest.approx(
        slowed(kind, BROKE), abs=h**2 * alpha * (QUICK / LOAD + 1.0) / 2 + 1e-9
        + (h * alpha / 2 if kind == "torque" else 0.0))


# -- springs and cords -----------------------------------------------------------------


def test_the_first_break_relieves_the_other_element() -> None:
    """Two rods in line; the load passes the limits of both in one step, of the lower one before.

    Without it the upper one has only its own weight to carry.
    """
    h, steep = 1e-3, 3e4
    made = weightless(h, 0.02, body("upper", (0.0, -0.5)), body("lower", (0.0, -1.0)), drives=[
        {"type": "force", "name": "pull", "body": "lower", "direction": (0, -1),
         "value": f"={steep} * t"}], joints=[
        {"type": "rod", "name": "first", "a": "frame", "b": "upper", "breaks_at": 48.0},
        {"type": "rod", "name": "second", "a": "upper", "b": "lower", "breaks_at": 46.0}])
    # of one step to the next loads grow by 30 N, from 45 to 75 N
    assert made["second.held"][-1] == 0
    assert made["first.held"].all()


def test_an_element_engaged_beyond_its_load_breaks_without_an_impulse() -> None:
    """Released with 5 N of 6 and engaged with 7.5 N: it breaks at once, without a force."""
    made = weightless(1e-3, 0.3, body("weight", (0.0, -0.5)), drives=[
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
    made = weightless(h, 0.2, *bodies, joints=[hook], events=[
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
