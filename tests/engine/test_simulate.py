"""Recordings: reproducible, complete, with means over sample intervals and cost estimates."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.elements.arrays import MEAN, MEAN_CONTACT
from sandbox.engine.inputs import make_clock
from sandbox.engine.inspect import look_over
from sandbox.engine.inspect_control import Checked
from sandbox.engine.simulate import simulate
from sandbox.errors import SimulationDiverged
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Status
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.limits import Limits

from .machines import G, H, cable, disc, fixed, mass, mechanism

# -- what a recording holds ----------------------------------------------------------


def test_samples_and_info() -> None:
    run = simulate(mechanism(duration=0.0213, bodies=[mass("m", 0.1, (0, 0))],
                             run={"sample_rate": 1000.0}))
    np.testing.assert_allclose(run.time, (2 * np.arange(1, 22) - 0.5) * H, rtol=1e-14)
    info = run.info
    assert (info.status, info.reason, info.step, info.steps) == (Status.DONE, "", H, 43)
    assert (info.sample_rate, info.seed) == (1000.0, 0)
    assert set(info.wall) == {"build", "simulate"}
    assert set(info.versions) >= {"sandbox", "pymunk", "numpy", "numba", "python"}


def test_progress_rises_to_one() -> None:
    shares: list[float] = []
    simulate(mechanism(duration=1.0, bodies=[mass("m", 0.1, (0, 0))], run={"sample_rate": 7.0}),
             progress=shares.append)
    assert shares == sorted(shares)
    assert shares[0] < 0.2
    assert shares[-1] == 1.0


@pytest.mark.parametrize("bodies", [
    [fixed("wall")], [fixed("wall"), fixed("rail", at=(1.0, 0.0))], [mass("m", 0.1, (0, 0))],
    [{"name": "s", "motion": "scheduled", "path": {"x": 0.0}}],
], ids=["fixed", "two fixed", "no shapes", "scheduled"])
def test_next_to_nothing_runs(bodies: list[dict[str, Any]]) -> None:
    run = simulate(mechanism(duration=0.01, gravity=(0.0, -G), bodies=bodies))
    assert run.info.complete
    assert np.isfinite(run.arrays["body_pose"]).all()
    assert len(run.time) == 20


# -- when it fails -------------------------------------------------------------------


def test_divergence_is_an_error_with_time_culprit_and_recording() -> None:
    """A force that grows by a fifth each step: 25 e^(400 t) m/s are too much within 0.03 s."""
    wild = mechanism(
        duration=1.0, bodies=[mass("calm", 0.1, (0.0, 1.0)), mass("wild", 1e-4, (0.0, 0.1))],
        drives=[{"type": "force", "name": "f", "body": "wild", "direction": (1, 0),
                 "value": "=exp(400 * t)"}])
    with pytest.raises(SimulationDiverged) as caught:
        simulate(Checked(wild))
    error = caught.value
    assert error.culprit == "wild"
    assert 0 < error.time < 0.1
    assert "0.0005 s" in str(error)
    run = error.recording
    assert run is not None
    assert run.info.status is Status.DIVERGED
    assert "wild" in run.info.reason
    assert len(run.time) > 2
    assert run.time[-1] < error.time < run.time[-1] + 2 * H
    assert np.isfinite(run.arrays["body_pose"]).all()
    assert np.isfinite(run.arrays["body_velocity"]).all()


# -- momentum and energy -------------------------------------------------------------


def test_a_free_body_moves_as_it_was_thrown() -> None:
    """x0 + v t, angle0 + w t of the centre of mass, from t = 0 on: no half step lost. Rounding.

    The frame's origin, 30 mm from the centre, goes round it.
    """
    run = simulate(mechanism(duration=1.0, bodies=[
        {"name": "m", "mass": 0.2, "inertia": 1e-4, "at": (0.1, 0.2), "angle": 0.3,
         "centre": (0.03, 0.0), "velocity": (0.7, -0.4), "angular_velocity": 9.0}]))
    t, angle = run.time, 0.3 + 9.0 * run.time
    np.testing.assert_allclose(run["m.angle"], angle, rtol=1e-12)
    x = 0.1 + 0.03 * np.cos(0.3) + 0.7 * t - 0.03 * np.cos(angle)
    y = 0.2 + 0.03 * np.sin(0.3) - 0.4 * t - 0.03 * np.sin(angle)
    np.testing.assert_allclose(run["m.x"], x, atol=1e-12)
    np.testing.assert_allclose(run["m.y"], y, atol=1e-12)
    np.testing.assert_allclose(run["m.vx"], 0.7, rtol=1e-14)
    np.testing.assert_allclose(run["m.omega"], 9.0, rtol=1e-14)
    np.testing.assert_allclose(run.arrays["body_acceleration"], 0.0, atol=1e-9)


@pytest.mark.parametrize(("duration", "step", "rate", "steps", "every"), [
    (1.0, 5e-4, 1000.0, 2000, 2),
    (0.3, 1e-4, 1000.0, 3000, 10),  # 0.3 / 1e-4 is 2999.9999999999995
    (0.7, 1e-4, 1000.0, 7000, 10),  # 0.7 / 1e-4 is 7000.000000000001
    (1.0, 3e-4, 1000.0, 3334, 3),  # no whole number: the run ends after, not before
    (1.0, 2e-3, 1000.0, 500, 1),  # no finer than the steps
    (1e-5, 5e-4, 1000.0, 1, 1),  # at least one step and one sample
    (0.01, 5e-4, 1.0, 20, 20),  # a sample at the end when the rate asks for none
])
def test_counts(duration: float, step: float, rate: float, steps: int, every: int) -> None:
    clock = make_clock(duration, step, rate)
    assert (clock.steps, clock.every) == (steps, every)


def test_sixteen_touching_circles_at_every_microsecond() -> None:
    machine = mechanism(duration=0.9, step=1e-6,
                        bodies=[disc(f"d{i}", 0.01, (0, 0)) for i in range(16)])
    found = look_over(machine).estimate
    assert found.contacts == 120
    assert found.recorded_bytes > 9e9
    (problem,) = found.beyond(Limits())
    assert "11 419 200 000 bytes with 120 contacts in each sample" in problem.message
    assert "'recorded_bytes', raised by --limit recorded_bytes=N" in problem.allowed
    assert list(found.beyond(Limits(recorded_bytes=10**11))) == []


FLOOR = fixed("floor", shapes=[{"type": "box", "size": [4, 0.1], "at": [0, -0.05]}],
              material="hard")


def run_of(h: float, rate: float, *, duration: float = 0.6, **elements: Any) -> Recording:
    run = {"duration": duration, "step": h, "sample_rate": rate}
    return simulate(Mechanism.model_validate({"run": run, "gravity": (0, -G), **elements}))


def bouncing() -> dict[str, Any]:
    """A ball that comes from above, spinning, and ends in the air."""
    ball = disc("ball", 0.01, (0, 0.1), velocity=(0.3, 0), angular_velocity=5.0, material="hard")
    return {"bodies": [FLOOR, ball], "materials": {"hard": {"friction": 0.2, "restitution": 0.8}}}


def arms_with_everything() -> dict[str, Any]:
    """Two arms with a stop, dry friction, a motor and a cord that becomes taut."""
    bodies = [fixed("wall"), mass("arm", 0.2, (0.1, 0)), mass("bob", 0.1, (0.25, 0.02))]
    joints = [{"type": "pin", "name": "hinge", "a": "wall", "b": "arm", "on_b": (-0.1, 0),
               "limits": (-0.1, 2.0), "friction": 0.02},
              {"type": "pin", "name": "elbow", "a": "arm", "b": "bob", "on_a": (0.1, 0),
               "on_b": (-0.05, -0.02)}]
    drives = [{"type": "motor", "name": "motor", "joint": "elbow", "value": 3.0, "torque": 0.05}]
    return {"bodies": bodies, "joints": joints, "drives": drives,
            "tendons": [cable("line", ("wall", (0.3, 0.2)), ("bob", (0, 0)), stiffness=5e3,
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


@pytest.mark.parametrize("make", [bouncing, arms_with_everything])
@pytest.mark.parametrize("every", [2, 3, 8, 50])
def test_means_are_those_of_all_steps(make, every):
    h, names = 5e-4, ("fx", "fy", "normal", "tangential", "reaction_x", "reaction_y", "stop",
                      "friction", "tension", "torque", "force")
    run, steps = (run_of(h, each, **make()) for each in (1 / (h * every), 1 / h))
    found = [name for name in run.names() if name.rpartition(".")[2] in names]
    if make is arms_with_everything:
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
    a, rows = run.arrays, run.mean_contacts
    assert len(rows.sample) == len(a["impact_time"]) == 1
    assert abs(run.time[rows.sample[0]] - a["impact_time"][0]) <= 0.0125
    assert rows.point == pytest.approx(a["impact_point"], abs=1e-15)
    assert rows.direction.tolist() == [[0.0, 1.0]]
    assert rows.force / 40 == pytest.approx(a["impact_impulse"], rel=1e-12)


def test_every_step_has_its_own_forces():
    run = run_of(5e-4, 2000, duration=0.2, **bouncing())
    assert run.arrays.keys().isdisjoint({*MEAN, *MEAN_CONTACT})
    assert np.array_equal(run["ball.contact.fy"], run.contacts.of_body(1, "fy"))


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
