"""A simulation that is paused, findings, copied or restarted gives bit-identical results."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox import ControllerFailed, Custom, Interrupted, SceneError, SimulationDiverged, StopRun
from sandbox.elements.quantities import row_of
from sandbox.engine import sampler
from sandbox.engine.inspect_control import Checked
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.errors import RecordingFull
from sandbox.model.catalogue import UnknownQuantityError
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Status, Stop
from sandbox.scene.expand import expand
from sandbox.scene.library import shipped_scenes
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene, read_scene

from .machines import G, H, cable, disc, fixed, mass, mechanism

SCENES = ["adaptive_grasp", "shape_change", "finger_dual_control", "finger_joint_locks"]


def loaded(name: str, duration: float = 0.08) -> Mechanism:
    return expand(load_scene(name, overrides={"run.duration": duration}))


def same(one: Recording, other: Recording) -> bool:
    return set(one.arrays) == set(other.arrays) and all(
        one.arrays[key].tobytes() == other.arrays[key].tobytes() for key in one.arrays)


def weight(**more: object) -> Mechanism:
    """1 kg on a cord that is pulled up against its weight, and a ball that falls on a floor."""
    drives = more.pop("drives", [{"type": "pull", "name": "winch", "tendon": "rope", "value": G}])
    return mechanism(
        gravity=(0.0, -G),
        bodies=[fixed("floor", shapes=[{"type": "box", "size": (1, 0.02)}]),
                mass("load", 1.0, (0.3, 0.1)), disc("ball", 0.01, (0.0, 0.03))],
        tendons=[cable("rope", ("load",), ("floor", (0.3, 1.0)))],
        drives=drives, **more)


@pytest.mark.parametrize("name", SCENES)
def test_pausing_does_not_change_results(name: str) -> None:
    machine = loaded(name)
    simulation = Simulation(machine)
    rng = np.random.default_rng(1)
    while not simulation.finished:
        simulation.step(int(rng.integers(1, 40)))
        if rng.random() < 0.3:
            simulation.recording()
    assert same(simulation.recording(), simulate(machine))


@pytest.mark.parametrize("name", [*SCENES, "finger_antagonist", "rope_differential", "four_bar",
                                  "drums", "belt_drive", "finger_friction", "wheel_in_cord",
                                  "servo_arm", "actuators", "linear_actuator", "hydraulic_lift",
                                  "pneumatic_hand"])
def test_live_quantities_are_those_of_the_recording(name: str) -> None:
    """Each by itself: a quantity that is said to be live must not be read as another one."""
    simulation = Simulation(loaded(name))
    simulation.step(60)
    run, read = simulation.recording(), 0
    for head, element in run.catalogue.elements.items():
        for quantity in (q for q in element.quantities if row_of(element.kind, q).live):
            full = f"{head}.{quantity}" if quantity else head
            assert simulation[full] == pytest.approx(run[full][-1], rel=1e-9, abs=1e-12), full
            read += 1
    assert read > 20


def test_a_set_value_holds_until_it_is_reset() -> None:
    """A pull of twice the weight gives the load +g: v = g t; then its own signal balances it."""
    simulation = Simulation(weight())
    simulation.step(20)
    assert simulation["load.vy"] == pytest.approx(0.0, abs=1e-12)
    simulation.set("winch", 2 * G)
    simulation.step(20)
    assert simulation["winch.value"] == 2 * G
    assert simulation["rope.tension"] == 2 * G
    # the mean of the velocities before and after the last of 20 steps with +g
    assert simulation["load.vy"] == pytest.approx(G * 19.5 * H, rel=1e-9)
    simulation.set("winch", None)
    simulation.step(20)
    assert simulation["winch.value"] == G
    assert simulation["load.vy"] == pytest.approx(G * 20 * H, rel=1e-9)


def test_a_copy_is_independent() -> None:
    first = Simulation(weight())
    first.step(10)
    first.set("winch", 12.0)
    first.step(15)
    second = first.copy()
    assert second.steps == first.steps
    assert same(first.recording(), second.recording())
    first.set("winch", 0.0)
    for simulation in (first, second):
        simulation.run()
    assert first["load.y"] < second["load.y"]
    third = Simulation(weight())
    third.step(10)
    third.set("winch", 12.0)
    third.run()
    assert same(second.recording(), third.recording())


def test_python_controllers_take_part() -> None:
    def hold(t: float, reads: list[float]) -> float:
        return G - 50 * reads[0]

    law = Custom("damp", reads=["load.vy"], writes=["winch"], act=hold)
    simulation = Simulation(weight(), controllers=[law])
    simulation.step(30)
    assert same(simulation.copy().recording(), simulation.recording())
    with pytest.raises(SceneError, match="is set by 'damp'"):
        simulation.set("winch", 1.0)


def test_wrong_quantities_and_values_are_refused() -> None:
    simulation = Simulation(weight())
    with pytest.raises(UnknownQuantityError, match=r"did you mean 'rope\.tension'"):
        simulation["rope.tensio"]
    with pytest.raises(SceneError, match="computed after the run"):
        simulation["rope.work"]
    with pytest.raises(SceneError, match="is not the name of a quantity"):
        simulation[3]  # type: ignore[index]
    with pytest.raises(SceneError, match=r"no drive named 'winsh'.*Did you mean 'winch'"):
        simulation.set("winsh", 1.0)
    with pytest.raises(SceneError, match="finite number"):
        simulation.set("winch", float("nan"))
    with pytest.raises(SceneError, match="-1 is no number of steps"):
        simulation.step(-1)
    assert simulation.steps == 0


@pytest.mark.parametrize("late", [False, True])
@pytest.mark.parametrize("chunk", [1, 7, 40])
def test_an_interrupted_simulation_cannot_continue(
    chunk: int, late: bool, monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Ctrl-C before or after samples are written: each is kept once, and it is over."""
    monkeypatch.setattr(sampler, "CHUNK", chunk)
    simulation = Simulation(weight(duration=0.5))
    write, calls = sampler.Sampler.write, 0

    def interrupted(self: sampler.Sampler) -> None:
        nonlocal calls
        calls += 1
        if calls != 3:
            write(self)
        elif late:
            write(self)
            raise KeyboardInterrupt
        else:
            raise KeyboardInterrupt

    monkeypatch.setattr(sampler.Sampler, "write", interrupted)
    with pytest.raises(Interrupted) as caught:
        simulation.run()
    for going_on in (simulation.run, simulation.step, simulation.copy):
        with pytest.raises(Interrupted):
            going_on()
    whole = simulate(weight(duration=0.5))
    for recording in (caught.value.recording, simulation.recording()):
        assert not recording.complete
        assert recording.info.reason == "interrupted"
        assert len(recording) == 3 * chunk
        np.testing.assert_array_equal(recording["load.y"], whole["load.y"][:3 * chunk])


def test_a_simulation_with_a_failed_controller_cannot_continue() -> None:
    def fails(t: float, reads: list[float]) -> float:
        if t > 0.01:
            raise ValueError("the law's own")
        return G

    law = Custom("law", reads=["load.vy"], writes=["winch"], act=fails)
    simulation = Simulation(weight(), controllers=[law])
    for go_on in (simulation.run, simulation.step):
        with pytest.raises(ControllerFailed, match=r"'law': act\(\) at t = 0\.011 s raised") as f:
            go_on()
    assert isinstance(f.value.__cause__, ValueError)
    whole = simulate(weight(), controllers=[Custom("law", ["load.vy"], ["winch"], lambda t, x: G)])
    for kept in (f.value.recording, simulation.recording()):
        assert kept.info.status is Status.FAILED
        assert "controller 'law'" in kept.info.reason
        assert not kept.complete
        assert 0 < len(kept) < len(whole)
        np.testing.assert_array_equal(kept["load.y"], whole["load.y"][:len(kept)])


def test_a_controller_can_stop_the_run() -> None:
    """At the first sample that is past a height; then no step is made."""
    def enough(t: float, reads: list[float]) -> None:
        if reads[0] < 0.025:
            raise StopRun("low enough", verdict="fail")

    watch = Custom("watch", reads=["ball.y"], writes=[], act=enough, rate=1 / H)
    stopped = simulate(weight(), controllers=[watch])
    assert stopped.complete
    assert stopped.info.stopped == Stop("watch", "fail", stopped.info.stopped.time, "low enough")
    whole = simulate(weight())
    np.testing.assert_array_equal(stopped["ball.y"], whole["ball.y"][:len(stopped)])
    first = int(np.flatnonzero(whole["ball.y"] < 0.025)[0])
    assert len(stopped) == first + 1
    judged = stopped.verdicts[-1]
    assert (judged.quantity, judged.ok, judged.reason) == ("watch", False, "low enough")


def test_a_controller_without_outputs_does_not_change_results() -> None:
    """And accelerations that it reads are those that are recorded, to the last bit."""
    rows = []
    watch = Custom("watch", ["ball.ax", "ball.ay", "ball.alpha"], [],
                   lambda t, x: rows.append(x), rate=1 / H)
    with_it, without = (simulate(weight(), controllers=given) for given in ([watch], []))
    assert same(with_it, without)
    assert rows[0] == [0.0, 0.0, 0.0]  # before the first step
    for i, name in enumerate(watch.reads):
        np.testing.assert_array_equal([row[i] for row in rows[1:]], with_it[name][:len(rows) - 1])
    assert max(abs(with_it["ball.ay"] + G)) > 1  # it hits the floor


def test_an_event_can_stop_the_run() -> None:
    machine = weight(events=[{"name": "enough", "at": 0.01, "stop": "pass"}])
    simulation = Simulation(machine)
    assert simulation.step(3) == 3
    assert simulation.time == pytest.approx(3 * H, rel=1e-15)
    assert simulation.step(1000) == 17
    assert simulation.finished
    assert simulation.recording().complete
    assert same(simulation.recording(), simulate(machine))
    simulation.run()
    assert simulation.step() == 0
    other = simulation.copy()
    assert other.finished
    assert other.recording().info.stopped == simulation.recording().info.stopped


def test_a_recording_that_exceeds_its_limit_is_kept_incomplete() -> None:
    machine = weight(duration=1.0)
    simulation = Simulation(machine, recorded_bytes=150_000)
    with pytest.raises(RecordingFull, match="take more than 150 000 bytes") as caught:
        simulation.run()
    assert "simulate(recorded_bytes=...)" in str(caught.value)
    run = caught.value.recording
    assert run is not None
    assert run.info.status is Status.LIMITED
    assert 0 < len(run) < simulation._clock.samples
    assert simulation.finished
    with pytest.raises(RecordingFull):
        simulation.step()
    whole = simulate(machine)
    assert len(whole) == simulation._clock.samples
    assert np.array_equal(whole.arrays["body_pose"][:len(run)], run.arrays["body_pose"])


def short(name: str, duration: float = 0.03) -> Mechanism:
    return read_scene(shipped_scenes()[name], overrides={
        "run.duration": duration, "expect": [], "events": []}).mechanism


def disturb(simulation: Simulation, steps: int) -> None:
    """Let it have gone elsewhere than a run without interference does."""
    writable = [drive.name for drive in simulation.mechanism.drives
                if not simulation._control.writer(drive.name)]
    for name in writable:
        simulation.set(name, 0.5 * simulation[f"{name}.value"] + 0.01)
    simulation.step(steps)


DAILY = ("adaptive_grasp", "finger_dual_control", "conveyor", "pneumatic_hand", "release",
         "belt_drive", "shape_change")


@pytest.mark.parametrize("name", [
    name if name in DAILY else pytest.param(name, marks=pytest.mark.nightly)
    for name in shipped_scenes() if not name.startswith("object")])
def test_a_restarted_simulation_gives_the_same_bytes(name: str) -> None:
    machine = short(name)
    simulation = Simulation(Checked(machine))
    disturb(simulation, 25)
    simulation.restart()
    assert simulation.steps == 0
    assert simulation.time == 0.0
    simulation.run()
    assert same(simulation.recording(), simulate(machine))


def test_a_diverged_simulation_can_restart() -> None:
    machine = mechanism(bodies=[disc("puck", 0.01, (0.0, 0.0))], gravity=(0.0, 0.0), drives=[
        {"type": "force", "name": "push", "body": "puck", "direction": (1.0, 0.0), "value": 0.0}])
    simulation = Simulation(machine)
    simulation.set("push", 1e300)
    with pytest.raises(SimulationDiverged):
        simulation.run()
    simulation.restart()
    simulation.run()
    assert same(simulation.recording(), simulate(machine))
