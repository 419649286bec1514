"""The loop as a whole: repeatable, honest when it fails, and right in momentum and energy."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.engine.inspect_control import Checked
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import BLOCK
from sandbox.errors import Interrupted, SimulationDiverged
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Status
from sandbox.scene.mechanism import Mechanism

from .machines import G, H, cord, disc, fixed, mass, mechanism


def pile(duration: float = 0.2) -> Mechanism:
    """Discs that fall on each other and on a driven, jointed, tendon-drawn finger of two links."""
    links = [{"name": f"link{i}", "density": 1000.0, "at": (0.04 * i, 0.0),
              "shapes": [{"type": "capsule", "end": (0.04, 0.0), "radius": 0.005}]}
             for i in range(2)]
    return mechanism(
        duration=duration, gravity=(0.0, -G),
        bodies=[fixed("wall", shapes=[{"type": "box", "size": (1.0, 0.02), "at": (0.0, -0.05)}]),
                *links, *(disc(f"d{i}", 0.008, (0.011 * i, 0.05 + 0.004 * i)) for i in range(6)),
                {"name": "paddle", "motion": "scheduled", "at": (0.2, 0.02),
                 "path": {"x": {"expression": "=0.2 + 0.1 * sin(20 * t) "}, "y": 0.02},
                 "shapes": [{"type": "circle", "radius": 0.03}]}],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "link0", "on_b": (0, 0),
                 "limits": (-1.0, 1.0), "damping": 1e-4},
                {"type": "pin", "name": "q", "a": "link0", "b": "link1", "on_b": (0, 0),
                 "limits": (-1.0, 1.0)}],
        springs=[{"type": "rotary", "name": "s", "joint": "q", "stiffness": 0.05,
                  "damping": 1e-4}],
        tendons=[cord("t", ("link1", (0.03, 0.004)), ("link0", (0.03, 0.004), 0.002, "right"),
                      ("wall", (0.0, 0.02)))],
        drives=[{"type": "pull", "name": "pull", "tendon": "t",
                 "value": {"from": 0.0, "to": 3.0, "over": 0.1}}],
        contacts=[{"between": ("link*", "link*"), "collide": False},
                  {"between": ("d*", "wall"), "friction": 0.3}])


def digest(run: Recording) -> str:
    """Of all arrays, bit for bit."""
    total = hashlib.sha256()
    for key in sorted(run.arrays):
        total.update(key.encode() + np.ascontiguousarray(run.arrays[key]).tobytes())
    return total.hexdigest()


# -- repeatable --------------------------------------------------------------------


def test_twice_the_same_in_one_process() -> None:
    first, second = simulate(pile()), simulate(pile())
    assert len(first.arrays["contact_body"]) > 100
    assert digest(first) == digest(second)


def test_the_same_in_other_processes() -> None:
    """Hash seed, language, time zone, home and addresses in memory do not matter."""
    script = ("import sys\nfrom tests.engine.test_simulate import digest, pile, simulate\n"
              "waste = [bytearray(97 * (i + 1)) for i in range(int(sys.argv[1]))]\n"
              "print(digest(simulate(pile())))")
    root = Path(__file__).parents[2]
    paths = os.pathsep.join([str(Path(sandbox.__file__).parents[1]), str(root)])
    places = ({"PYTHONHASHSEED": "1", "LC_ALL": "C", "PYTHONUTF8": "0", "TZ": "Asia/Kathmandu"},
              {"PYTHONHASHSEED": "1001", "LANG": "tr_TR.UTF-8", "HOME": "/nowhere",
               "TMPDIR": "/nowhere"})
    runs = [
        subprocess.Popen(
            [sys.executable, "-P", "-c", script, place["PYTHONHASHSEED"]], stdout=subprocess.PIPE,
            text=True, cwd=root, env={**os.environ, **place, "PYTHONPATH": paths})
        for place in places]
    results = {run.communicate(timeout=600)[0].strip() for run in runs}
    assert results == {digest(simulate(pile()))}


def test_blocks_leave_no_trace(monkeypatch: pytest.MonkeyPatch) -> None:
    """However many steps are made before coming back to Python."""
    def falling() -> Mechanism:
        plain = pile().model_dump()
        plain["bodies"] = [b for b in plain["bodies"] if b["name"] != "paddle"]
        plain["run"]["sample_rate"] = 200.0
        return Mechanism.model_validate(plain)

    whole = digest(simulate(falling()))
    monkeypatch.setattr("sandbox.engine.simulation.BLOCK", 3)
    assert digest(simulate(falling())) == whole


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


def runaway() -> Mechanism:
    """A force that grows by a fifth each step: 25 e^(400 t) m/s are too much within 0.03 s."""
    return mechanism(
        duration=1.0, bodies=[mass("calm", 0.1, (0.0, 1.0)), mass("wild", 1e-4, (0.0, 0.1))],
        drives=[{"type": "force", "name": "f", "body": "wild", "direction": (1, 0),
                 "value": "=exp(400 * t)"}], run={"sample_rate": 2000.0})


def test_divergence_is_told() -> None:
    """Its time, the culprit's name and what was recorded until then: finite to the last row."""
    with pytest.raises(SimulationDiverged) as caught:
        simulate(Checked(runaway()))
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


def test_a_run_that_breaks_in_its_very_last_step_is_not_complete() -> None:
    with pytest.raises(SimulationDiverged) as caught:
        simulate(Checked(runaway()))
    last = round(caught.value.time / H + 0.5)
    machine = runaway()
    shorter = machine.run.model_copy(update={"duration": last * H})
    with pytest.raises(SimulationDiverged):
        simulate(Checked(machine.model_copy(update={"run": shorter})))
    shorter = machine.run.model_copy(update={"duration": (last - 1) * H})
    run = simulate(Checked(machine.model_copy(update={"run": shorter})))
    assert run.info.complete


def test_ctrl_c_keeps_the_recording() -> None:
    def stop(share: float) -> None:
        if share > 0.5:
            raise KeyboardInterrupt

    machine = pile(1.0)
    with pytest.raises(Interrupted) as caught:
        simulate(machine, progress=stop)
    run = caught.value.recording
    assert run is not None
    assert run.info.status is Status.INTERRUPTED
    assert run.info.reason == "interrupted"
    assert caught.value.time == run.time[-1] == pytest.approx(0.5, abs=BLOCK * H)
    whole = simulate(machine)
    np.testing.assert_array_equal(
        run.arrays["body_pose"], whole.arrays["body_pose"][:len(run.time)])
    assert run.arrays["contact_sample"].max() < len(run.time)


def test_ctrl_c_is_heard_amid_contacts() -> None:
    """A real SIGINT, which Python delivers at its next instruction. Were pairs with friction of
    their own answered in Python, that would be within cffi, which prints and drops it.
    """
    script = (
        "import os, signal, threading\n"
        "from sandbox.engine.simulate import simulate\n"
        "from sandbox.errors import Interrupted\n"
        "from tests.engine.machines import G, disc, fixed, mechanism\n"
        "balls = [disc(f'd{i}', 0.01, (0.05 * i, 0.02), velocity=(0.02, 0))\n"
        "         for i in range(16)]\n"
        "floor = fixed('floor', shapes=[{'type': 'box', 'size': (9, 0.02)}])\n"
        "rule = {'between': ('floor', 'd*'), 'friction': 0.3}\n"
        "def machine(duration): return mechanism(duration=duration, gravity=(0, -G),\n"
        "    bodies=[floor, *balls], contacts=[rule], run={'sample_rate': 5.0})\n"
        "simulate(machine(0.01))\n"
        "kill = lambda: os.kill(os.getpid(), signal.SIGINT)\n"
        "threading.Timer(0.1, kill).start()\n"
        "try: simulate(machine(60.0)); print('lost')\n"
        "except Interrupted: print('heard')\n")
    root = Path(__file__).parents[2]
    paths = os.pathsep.join([str(Path(sandbox.__file__).parents[1]), str(root)])
    done = subprocess.run(
        [sys.executable, "-P", "-c", script], capture_output=True, text=True, cwd=root, timeout=600,
        env={**os.environ, "PYTHONPATH": paths}, check=False)
    assert done.stdout.split() == ["heard"], done.stderr


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
