"""Means over sample intervals, and impacts: against every step of the same run, and momentum."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.elements.arrays import MEAN, MEAN_CONTACT
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

from .machines import G, cord, disc, fixed, mass

FLOOR = fixed("floor", shapes=[{"type": "box", "size": [4, 0.1], "at": [0, -0.05]}],
              material="hard")


def run_of(h: float, rate: float, *, duration: float = 0.6, **elements: Any) -> Recording:
    run = {"duration": duration, "step": h, "sample_rate": rate}
    return simulate(Mechanism.model_validate(
        {"run": run, "gravity": (0, -G), **elements}))


def bouncing() -> dict[str, Any]:
    """A ball that comes from above, spinning, and ends in the air."""
    ball = disc("ball", 0.01, (0, 0.1), velocity=(0.3, 0), angular_velocity=5.0, material="hard")
    return {"bodies": [FLOOR, ball],
            "materials": {"hard": {"friction": 0.2, "restitution": 0.8}}}


def cam(speed: float) -> dict[str, Any]:
    """An eccentric disc that throws its follower, which falls back on it."""
    bodies = [fixed("wall"), disc("cam", 0.02, (0, 0), inertia=1e-4),
              {"name": "rod", "mass": 0.2, "inertia": 1e-4, "at": (0, 0.025),
               "shapes": [{"type": "box", "size": [0.06, 0.01]}]}]
    joints = [{"type": "pin", "name": "shaft", "a": "wall", "b": "cam", "on_b": (-0.005, 0)},
              {"type": "slot", "name": "guide", "a": "wall", "b": "rod", "start": (0, -0.1),
               "end": (0, 0.3), "turns": False}]
    drives = [{"type": "motor", "name": "motor", "joint": "shaft", "value": speed, "torque": 5.0}]
    return {"bodies": bodies, "joints": joints, "drives": drives}


def busy() -> dict[str, Any]:
    """Two arms with a stop, dry friction, a motor and a cord that becomes taut."""
    bodies = [fixed("wall"), mass("arm", 0.2, (0.1, 0)), mass("bob", 0.1, (0.25, 0.02))]
    joints = [{"type": "pin", "name": "hinge", "a": "wall", "b": "arm", "on_b": (-0.1, 0),
               "limits": (-0.1, 2.0), "friction": 0.02},
              {"type": "pin", "name": "elbow", "a": "arm", "b": "bob", "on_a": (0.1, 0),
               "on_b": (-0.05, -0.02)}]
    drives = [{"type": "motor", "name": "motor", "joint": "elbow", "value": 3.0, "torque": 0.05}]
    return {"bodies": bodies, "joints": joints, "drives": drives,
            "tendons": [cord("line", ("wall", (0.3, 0.2)), ("bob", (0, 0)), stiffness=5e3,
                             slack=0.01)]}


def interval_means(values: np.ndarray, every: int) -> np.ndarray:
    """Of the values of all steps [n], around each sample whose interval the run completes."""
    weights = np.ones(2 * (every // 2) + 1)
    weights[[0, -1]] = 1.0 if every % 2 else 0.5
    at = np.arange(every - 1, len(values) - every // 2, every)
    return np.array([weights @ values[i - every // 2:i + every // 2 + 1] / every for i in at])


@pytest.mark.parametrize("rate", [1000, 500])
@pytest.mark.parametrize("h", [5e-4, 2.5e-4])
def test_logged_forces_of_a_bouncing_ball_are_its_change_of_momentum(h, rate):
    run = run_of(h, rate, **bouncing())
    a, ball = run.arrays, run.model.names.body["ball"]
    end = a["body_velocity"][-1, ball] + h / 2 * a["body_acceleration"][-1, ball]
    gained = a["body_mass"][ball] * (end[:2] - [0.3, -G * 0.6])
    logged = np.array([run[f"ball.contact.{name}"].sum() for name in ("fx", "fy")]) / rate
    assert logged == pytest.approx(gained, rel=1e-12)
    assert a["impact_impulse"].sum(axis=0) == pytest.approx(gained, rel=1e-12)
    assert len(a["impact_time"]) == 3
    assert set(a["impact_body"]) == {ball}


@pytest.mark.parametrize("make", [bouncing, lambda: cam(90.0), busy])
@pytest.mark.parametrize("every", [2, 3, 8, 50])
def test_means_are_those_of_all_steps(make, every):
    h, names = 5e-4, ("fx", "fy", "normal", "tangential", "reaction_x", "reaction_y", "stop",
                      "friction", "tension", "torque", "force")
    run, steps = (run_of(h, each, **make()) for each in (1 / (h * every), 1 / h))
    found = [name for name in run.names() if name.rpartition(".")[2] in names]
    if make is busy:
        assert all(np.abs(steps[name]).max() > 1e-3 for name in (
            "hinge.stop", "hinge.friction", "line.tension", "motor.torque"))
    for name in found:
        if name.endswith(("contact.normal", "contact.tangential")):
            continue  # of a mean contact, sizes are those of the mean
        own, truth = run[name], interval_means(steps[name], every)
        scale = np.abs(steps[name]).max() + 1e-9
        assert own[:len(truth)] == pytest.approx(truth, rel=0, abs=1e-12 * scale), name
        assert len(truth) == len(run) - 1
        assert own[-1] == pytest.approx(steps[name][len(run) * every - 1], rel=1e-12, abs=1e-12)


def test_a_contact_between_samples_is_logged_where_it_was():
    """The ball is hit once in 50 steps: no sample's step touches, the log has the contact."""
    run = run_of(5e-4, 40, duration=0.2, **bouncing())
    assert len(run.arrays["contact_gap"]) == 0
    a, rows = run.arrays, run.mean_rows
    assert len(rows["contact_sample"]) == len(a["impact_time"]) == 1
    assert abs(run.time[rows["contact_sample"][0]] - a["impact_time"][0]) <= 0.0125
    assert rows["contact_point"] == pytest.approx(a["impact_point"], abs=1e-15)
    assert rows["contact_normal"].tolist() == [[0.0, 1.0]]
    assert rows["contact_force"] / 40 == pytest.approx(a["impact_impulse"], rel=1e-12)


def test_every_step_has_its_own_forces():
    run = run_of(5e-4, 2000, duration=0.2, **cam(60.0))
    assert run.arrays.keys().isdisjoint({*MEAN, *MEAN_CONTACT})
    assert np.array_equal(run["guide.reaction_x"], run.arrays["joint_force"][:, 1, 0])
    assert np.array_equal(run["rod.contact.fy"], run.contacts.of_body(2, "fy"))


def test_means_and_impacts_are_saved_and_loaded(tmp_path):
    run = run_of(5e-4, 500, **bouncing())
    run.save(tmp_path)
    again = Recording.load(tmp_path)
    assert again.arrays.keys() == run.arrays.keys()
    assert np.array_equal(again["ball.contact.fy"], run["ball.contact.fy"])
    head, *rows = (tmp_path / "impacts.csv").read_text().splitlines()
    assert head == "time_s,body,other,x_m,y_m,px_N_s,py_N_s"
    assert [float(row.split(",")[6]) for row in rows] == pytest.approx(
        run.arrays["impact_impulse"][:, 1].tolist(), rel=1e-11)
    forces = np.genfromtxt(tmp_path / "contacts.csv", delimiter=",", skip_header=1, usecols=(0, 6))
    assert forces[:, 1].sum() == pytest.approx(run["ball.contact.fy"].sum(), rel=1e-9)
    assert set(forces[:, 0]) <= {float(f"{t:.12g}") for t in run.time}


@pytest.mark.parametrize(("first", "last"), [(0, 40), (37, 301)])
def test_a_part_has_its_own_means(first, last):
    run = run_of(5e-4, 500, **cam(90.0))
    part, picked = run.part(first, last), run.pick(np.arange(first, min(last, len(run))))
    for name in ("rod.contact.fy", "guide.reaction_x", "guide.reaction", "motor.torque"):
        assert np.array_equal(part[name], run[name][first:last]), name
        assert np.array_equal(picked[name], run[name][first:last]), name
