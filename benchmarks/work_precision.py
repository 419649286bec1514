"""Error against time: four frictionless fingers on one tree of rockers, here and in MuJoCo.

Each of the four closes on a disc of its own. Two things are looked at: the pose of all hinges
after 0.1 s, when nothing touches yet, and the twelve contact forces at rest. Both engines are
held against a run of sandbox at 0.05 ms, to which both tend. Times are CPU times of the steps
alone, nothing recorded, the least of some rounds. Settings: all defaults here; MuJoCo three times,
as ``sandbox export`` writes it, with contacts that are less hard, which lets it take longer steps,
and with RK4. Its pull is set to what it is in the middle of each step.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.measure import Figure, mechanism
from sandbox.convergence.certificate import at_instants
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.export import export_mechanism
from sandbox.figure.panels import Axis, Curve, Panel, save_panels
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from tests.support.reference import SET_G, SET_G_TABLE

STEPS = (4e-3, 2.5e-3, 1.6e-3, 1e-3, 5e-4, 2.5e-4)
"""Of sandbox [s]."""
REFERENCE = 5e-5
DURATION, RAMP, FREE = 1.5, 0.5, 0.1
"""Until all is at rest; over which the pull rises; until when nothing has touched [s]."""
PULL = 4 * 3.75
PITCH = 0.105
"""Of the fingers [m]."""
WANTED, FINE = (0.05, 1.0), (1e-3, 1e-3)
"""Errors of the free pose [deg] and of the contact forces [%] that are asked for, and small ones
that a study of a hand may want."""
ROUNDS = 12
"""In which all points are measured, one after the other, so that all see the same noise."""
PICTURE = "work_precision"
ENOUGH = 1e-3
"""The step at which sandbox is to have both [s]."""
FINGERS = tuple(f"finger{i}" for i in range(1, 5))
PHALANGES = tuple(f"{f}.{name}" for f in FINGERS for name in ("proximal", "middle", "distal"))
HINGES = tuple(f"{f}.{name}" for f in FINGERS for name in ("mcp", "pip", "dip"))


def hand(step: float, duration: float, sample_rate: float) -> Mechanism:
    """Four Set G fingers, each above a fixed disc of 16 mm, nothing with friction."""
    disc = SET_G_TABLE[0]
    fingers = [{
        "type": "finger", "name": name, "at": [0, -PITCH * i], "material": "smooth",
        "lengths": SET_G.lengths, "radii": SET_G.radii, "masses": SET_G.masses,
        "guides": SET_G.guides, "damping": SET_G.damping, "limits": SET_G.limits,
        "springs": {"stiffness": 300, "from": SET_G.before[0], "to": SET_G.after[0]},
    } for i, name in enumerate(FINGERS)]
    discs = [{
        "name": f"disc{i}", "motion": "fixed", "material": "smooth",
        "at": [disc.centre[0], disc.centre[1] - PITCH * i],
        "shapes": [{"type": "circle", "radius": disc.disc_radius}],
    } for i in range(len(FINGERS))]
    return mechanism({
        "run": {"duration": duration, "step": step, "sample_rate": sample_rate},
        "materials": {"smooth": {"friction": 0.0}}, "bodies": discs,
        "parts": [*fingers, {"type": "rocker_tree", "name": "tree", "pulls": list(FINGERS)}],
        "drives": [{"type": "pull", "name": "actuator", "tendon": "tree",
                    "value": {"ramp": {"to": PULL, "over": RAMP}}}]})


@dataclass(frozen=True)
class Settings:
    """How MuJoCo is run."""

    name: str
    steps: Sequence[float]
    """[s]"""
    integrator: str
    impedance: float | None = None
    """Of contacts, ``solimp``'s first two; as exported (0.9999) by default."""


SETTINGS = (
    Settings("MuJoCo as exported", (1e-3, 5e-4, 2.5e-4, 1e-4, 5e-5), "IMPLICITFAST"),
    Settings("MuJoCo softer contacts", (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1e-4), "IMPLICITFAST",
             0.99),
    Settings("MuJoCo RK4", (1e-3, 5e-4, 2.5e-4), "RK4"),
)
"""Of some 200 combinations of integrator, solver's tolerance, sparsity, cone, time constants and
impedance those that get furthest in least time."""
SANDBOX = "sandbox"


@dataclass(frozen=True)
class Answer:
    """What an engine says, and how long it took."""

    pose: Array
    """Of all hinges at :data:`FREE` [deg]."""
    forces: Array
    """Normal forces of all phalanges at rest [N]."""
    seconds: float


@dataclass(frozen=True)
class Point:
    """What an engine comes to at one step."""

    step: float
    pose: float
    """Largest error of a hinge [deg]."""
    forces: float
    """Largest error of a contact force [%]."""
    seconds: float

    def within(self, wanted: tuple[float, float]) -> bool:
        """Whether both errors are as small as that; never for what is no number."""
        return self.pose <= wanted[0] and self.forces <= wanted[1]


def _at_free(run: Recording) -> Array:
    """Hinges' angles at :data:`FREE` [deg], by the cubic of the nearest samples."""
    return np.degrees([at_instants(run.time, run[f"{hinge}.angle"], np.array([FREE]))[0]
                       for hinge in HINGES])


def ours(step: float) -> Answer:
    """The answer of sandbox."""
    free = simulate(hand(step, FREE + 4 * step, 1 / step))
    simulation = Simulation(hand(step, DURATION, 1 / DURATION))
    began = time.process_time()
    simulation.run()
    spent = time.process_time() - began
    run = simulation.recording()
    forces = np.array([run[f"{body}.contact.normal"][-1] for body in PHALANGES])
    return Answer(_at_free(free), forces, spent)


def second(mujoco: Any, settings: Settings, step: float) -> Answer:
    """The answer of MuJoCo: its ramp is made step by step, the rest in one call."""
    model = mujoco.MjModel.from_xml_string(
        export_mechanism(hand(step, DURATION, 1 / DURATION)).text)
    model.opt.timestep = step
    model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{settings.integrator}")
    if settings.impedance is not None:
        model.pair_solimp[:, :2] = settings.impedance
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    pose, full = np.zeros(0), data.ctrl.copy()
    began = time.process_time()
    for k in range(round(RAMP / step)):
        data.ctrl[:] = full * ((k + 0.5) * step / RAMP)
        mujoco.mj_step(model, data)
        if k + 1 == round(FREE / step):
            mujoco.mj_forward(model, data)
            pose = np.degrees([data.sensor(f"{hinge}.angle").data[0] for hinge in HINGES])
    data.ctrl[:] = full
    mujoco.mj_step(model, data, nstep=round((DURATION - RAMP) / step))
    spent = time.process_time() - began
    mujoco.mj_forward(model, data)
    forces = np.array([data.sensor(f"{body}.contact.normal").data[0] for body in PHALANGES])
    return Answer(pose, forces, spent)


@cache
def reference() -> Answer:
    """The truth, as good as any."""
    return ours(REFERENCE)


def _point(step: float, answer: Answer) -> Point:
    truth = reference()
    return Point(step, float(np.abs(answer.pose - truth.pose).max()),
                 100 * float(np.abs(answer.forces / truth.forces - 1).max()), answer.seconds)


def _asked(quick: bool) -> list[tuple[str, float, Callable[[float], Answer]]]:
    """Name, step and engine of all points; without MuJoCo sandbox's alone."""
    found = [(SANDBOX, step, ours) for step in (STEPS[2:4] if quick else STEPS)]
    try:
        mujoco = import_module("mujoco")
    except ImportError:
        print("MuJoCo is not installed (pip install mujoco): not compared", file=sys.stderr)
        return found
    return found + [(one.name, step, partial(second, mujoco, one)) for one in SETTINGS
                    for step in (one.steps[1:2] if quick else one.steps)]


@cache
def curves(quick: bool) -> dict[str, list[Point]]:
    """All, by name; times are the least of rounds in which all take turns."""
    asked, found = _asked(quick), dict[str, list[Point]]()
    rounds = [[_point(step, answer(step)) for _, step, answer in asked]
              for _ in range(1 if quick else ROUNDS)]
    for (name, _, _), points in zip(asked, zip(*rounds, strict=True), strict=True):
        found.setdefault(name, []).append(min(points, key=lambda point: point.seconds))
    return found


def _least(points: Sequence[Point], wanted: tuple[float, float]) -> float:
    """The least time to errors as small as that [s]."""
    return min((point.seconds for point in points if point.within(wanted)), default=np.inf)


def figures(*, quick: bool = False) -> list[Figure]:
    """All curves, and how much sooner sandbox is there than MuJoCo at its best."""
    found, all_points = [], curves(quick)
    for wanted, target in ((WANTED, 4.0), (FINE, None)):
        said = f"{wanted[0]:g} deg and {wanted[1]:g} %"
        least = {name: _least(points, wanted) for name, points in all_points.items()}
        found += [Figure(f"{name}: time to {said}", 1e3 * seconds, "ms")
                  for name, seconds in least.items() if np.isfinite(seconds)]
        others = [seconds for name, seconds in least.items() if name != SANDBOX]
        if others:
            found.append(Figure(f"  MuJoCo's least time / sandbox's to {said}",
                                min(others) / least[SANDBOX], "", least=target))
    for name, points in all_points.items():
        for point in points:
            label = f"{name} at h = {1e3 * point.step:g} ms"
            wanted_here = WANTED if name == SANDBOX and point.step == ENOUGH else (None, None)
            found += [
                Figure(f"  {label}: free pose off by", point.pose, "deg", most=wanted_here[0]),
                Figure(f"  {label}: contact forces off by", point.forces, "%",
                       most=wanted_here[1]),
                Figure(f"  {label}: time", 1e3 * point.seconds, "ms")]
    return found


def draw(directory: Path, *, quick: bool = False) -> list[Path]:
    """Both errors against time, a picture each; their paths."""
    paths = []
    for i, (name, title, y) in enumerate((
            ("pose", "Four fingers closing freely: pose at 0.1 s", "largest error [deg]"),
            ("forces", "Four fingers on discs: contact forces at rest", "largest error [%]"))):
        shown = [Curve(label, np.array([1e3 * point.seconds for point in points]),
                       np.array([(point.pose, point.forces)[i] for point in points]), "joined")
                 for label, points in curves(quick).items()]
        ends = np.array([min(c.x.min() for c in shown), max(c.x.max() for c in shown)])
        shown.append(Curve("asked for", ends, np.full(2, WANTED[i]), "dashed"))
        paths.append(directory / f"{PICTURE}_{name}.png")
        save_panels(paths[-1], [Panel(title, Axis("CPU time of the run [ms]", log=True),
                                      Axis(y, log=True), shown)])
    return paths
