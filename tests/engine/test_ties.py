"""Elements that break, are released and engaged again, against closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import bisect

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.scene.read.load import load_scene

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


def unlooked(run: Any) -> list[str]:
    return [f"{figure.name}: {figure.why}" for figure in audit(run)
            if figure.verdict == "look" and figure.name != "tendon.slack"]


JOINTS = {
    "rod": {"type": "rod", "on_b": [0, 0]},
    "rope": {"type": "rope", "longest": 0.5},
    "end of a slot": {"type": "slot", "start": [0, -0.5], "end": [0, 0.5]},
    "slot": {"type": "slot", "start": [-1, -0.5], "end": [1, -0.5]},
    "weld": {"type": "weld", "on_a": [0, -0.5]},
    "pin": {"type": "pin", "on_a": [0, -0.5]},
}


@pytest.mark.parametrize("kind", JOINTS)
@pytest.mark.parametrize("h", [1e-3, 0.53e-3])
def test_a_joint_breaks_at_its_load(kind: str, h: float) -> None:
    """It carries m g + GROWS t, so from (LOAD - m g) / GROWS on the weight is free.

    Impulses of a load that is linear in time are exact by the midpoint rule, but for the last one,
    (s - 1/2) h LOAD: between it and the integral of the load lies h^2 GROWS / 2 at most.
    """
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
    assert unlooked(run) == []


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
@pytest.mark.parametrize("h", [1e-3, 0.53e-3])
def test_an_elastic_element_breaks_at_its_load(kind: str, h: float) -> None:
    """m x'' = GROWS t - k x from rest: x = GROWS / k (t - sin(w t) / w), w^2 = k / m.

    Allowed: h^2 times dT/dt at the break, as above, and the leapfrog's own error, which is less.
    """
    holder = {key: [{**each, "breaks_at": LOAD} for each in value]
              for key, value in HOLDERS[kind].items()}
    run = pulled(h, **holder)
    w = math.sqrt(SOFT)
    t = bisect(lambda t: GROWS * (t - math.sin(w * t) / w) - (LOAD - G), 0.0, 1.0)
    end, speed = run.time[-1] + h / 2, GROWS / SOFT * (1 - math.cos(w * t))
    fallen = speed + G * (end - t) + GROWS * (end**2 - t**2) / 2
    assert after(run, h) == pytest.approx(-fallen, abs=2 * h**2 * SOFT * speed + h**2 * GROWS)
    assert unlooked(run) == []


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
        assert unlooked(run) == []
    fallen = G * 0.1**2 / 2
    assert force["natural"] == pytest.approx(G + SOFT * fallen, rel=1e-2)
    assert abs(force["as_is"]) < SOFT * G * 0.1 * 2e-3  # what it falls in two steps


def test_a_released_hinge_takes_its_springs_stops_and_drives_with_it() -> None:
    """Nothing turns two bodies any more: damper, stop, springs, torque, motor, brake have gone."""
    bodies = [weight("a", (0, 0)), weight("b", (0.3, 0))]
    spring = {"type": "rotary", "joint": "hinge", "stiffness": 0.1}
    run = simulate(load_scene(scene(
        bodies, gravity=[0, 0],
        joints=[{"type": "pin", "name": "hinge", "a": "a", "b": "b", "on_a": [0.1, 0],
                 "damping": 0.01, "limits": [-0.01, 0.01]}],
        springs=[{**spring, "name": "soft"}, {**spring, "name": "stiff", "stiffness": 1e6},
                 {**spring, "name": "law", "stiffness": None, "torque": "=0.1 * twist ** 3"}],
        drives=[{"type": "torque", "name": "torque", "joint": "hinge", "value": 0.05},
                {"type": "motor", "name": "motor", "joint": "hinge", "value": 3, "torque": 0.1},
                {"type": "brake", "name": "brake", "joint": "hinge", "value": 0.1}],
        events=[{"name": "cut", "at": 0.1, "release": ["hinge"]}])))
    after = run.time > 0.102
    for body in ("a", "b"):
        for rate in ("omega", "vx", "vy"):
            assert np.ptp(run[f"{body}.{rate}"][after]) < 1e-12
    assert run["hinge.reaction"][50] > 0
    for quantity in ("hinge.reaction", "hinge.damping", "hinge.stop", "soft.torque",
                     "stiff.torque", "law.torque", "motor.torque", "brake.torque"):
        assert not run[quantity][after].any()
    assert unlooked(run) == []


def test_lasting_events_undo_releasing_and_engaging() -> None:
    held = HOLDERS["spring"]["springs"][0]
    run = simulate(load_scene(scene(
        [weight()], springs=[held, {**held, "name": "other", "released": True}],
        events=[{"name": "swap", "at": 0.1, "lasts": 0.2, "release": "held", "take_up": "other"}])))
    off = (run.time > 0.1) & (run.time < 0.3)
    assert (run["held.held"] == ~off).all()
    assert (run["other.held"] == off).all()


@pytest.mark.parametrize("h", [0.25e-3, 0.5e-3, 1e-3, 2e-3])
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


@pytest.mark.parametrize("h", [1e-3, 0.37e-3])
def test_a_hold_drive_gives_the_same_bytes_as_events(h: float) -> None:
    """Released, engaged and released again at the same steps: the same bytes."""
    holder = {"joints": [{"type": "rod", "name": "rod", "a": "frame", "b": "weight",
                          "on_b": [0, 0], "takes_up_in": 0.01}]}
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
    assert not unlooked(by_drive)
    assert by_drive.notes == by_event.notes


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


def test_a_released_element_is_not_reported_as_broken() -> None:
    run = simulate(load_scene({
        "run": {"duration": 0.02}, "bodies": [
            {"name": "frame", "motion": "fixed"},
            {"name": "load", "at": [0, -1], "mass": 1.0, "inertia": 1e-3}],
        "joints": [{"type": "rod", "name": "rod", "a": "frame", "b": "load", "breaks_at": 20.0}],
        "events": [{"name": "go", "at": 0.01, "release": "rod"}]}))
    assert run["rod.held"][-1] == 0
    assert run.notes == []


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
