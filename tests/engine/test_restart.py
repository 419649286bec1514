"""A run that goes back to t = 0 is a new one, to the last bit."""

from __future__ import annotations

import pytest

from sandbox.engine.inspect_control import Checked
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.errors import SimulationDiverged
from sandbox.scene.expand import expand
from sandbox.scene.library import shipped_scenes
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene, read_scene

from .machines import disc, mechanism
from .test_simulation import same


def short(name: str, duration: float = 0.03) -> Mechanism:
    return read_scene(shipped_scenes()[name], overrides={
        "run.duration": duration, "expect": [], "events": []}).mechanism


def disturb(simulation: Simulation, steps: int) -> None:
    """Let it have gone elsewhere than a run without interference does."""
    writable = [drive.name for drive in simulation.mechanism.drives
                if not simulation._steering.writer(drive.name)]
    for name in writable:
        simulation.set(name, 0.5 * simulation[f"{name}.value"] + 0.01)
    simulation.step(steps)


DAILY = ("adaptive_grasp", "finger_dual_control", "conveyor", "pneumatic_hand", "release",
         "belt_drive", "shape_change")


@pytest.mark.parametrize("name", [
    name if name in DAILY else pytest.param(name, marks=pytest.mark.nightly)
    for name in shipped_scenes() if not name.startswith("object")])
def test_every_scene_begins_anew(name: str) -> None:
    machine = short(name)
    simulation = Simulation(Checked(machine))
    disturb(simulation, 25)
    simulation.restart()
    assert simulation.steps == 0
    assert simulation.time == 0.0
    simulation.run()
    assert same(simulation.recording(), simulate(machine))


def test_events_happen_again_and_what_was_read_is_read_on() -> None:
    machine = expand(load_scene("release", overrides={"run.duration": 0.6}))
    simulation, whole = Simulation(machine), simulate(machine)
    body = machine.bodies[-1].name
    simulation.run()
    last = simulation[f"{body}.y"]
    for _ in range(2):
        simulation.restart()
        assert simulation[f"{body}.y"] != last
        simulation.run()
        assert simulation[f"{body}.y"] == last
    assert simulation.recording().info.events == whole.info.events
    assert same(simulation.recording(), whole)


def test_one_that_diverged_begins_anew() -> None:
    machine = mechanism(bodies=[disc("puck", 0.01, (0.0, 0.0))], gravity=(0.0, 0.0), drives=[
        {"type": "force", "name": "push", "body": "puck", "direction": (1.0, 0.0), "value": 0.0}])
    simulation = Simulation(machine)
    simulation.set("push", 1e300)
    with pytest.raises(SimulationDiverged):
        simulation.run()
    simulation.restart()
    simulation.run()
    assert same(simulation.recording(), simulate(machine))


def test_a_recording_that_was_given_away_stays() -> None:
    simulation = Simulation(short("single_finger"))
    simulation.run()
    run = simulation.recording()
    before = run["finger.mcp.angle"].copy()
    simulation.restart()
    simulation.set("actuator", 0.0)
    simulation.run()
    assert (run["finger.mcp.angle"] == before).all()
    assert (simulation.recording()["finger.mcp.angle"] != before).any()
