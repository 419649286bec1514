"""How far pymunk's own solver is off, over its time step and iterations: docs/pymunk.md.

Each mechanism is run by both solvers and compared with the direct solver at a small step: poses at
the end, forces as means over the last 50 ms, CPU time of a step without recording.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.measure import Figure, mechanism
from sandbox.engine.pymunk_draft import to_pymunk
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.errors import SimulationDiverged
from sandbox.figure.panels import Axis, Curve, Panel, save_panels
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

STEPS, ITERATIONS = (1e-3, 5e-4, 2.5e-4), (5, 30, 100)
"""Of pymunk [s]."""
OVER = 0.05
"""Forces are means over this time [s] at the end."""
TIMED = 200
"""Steps whose CPU time is measured."""
PAGE, BEGIN, END = "pymunk.md", "<!-- measured -->\n", "<!-- end -->\n"
"""The page, and the marks around the table that is written into it."""
GROUND = {"name": "ground", "motion": "fixed"}
LINK = {"mass": 0.01, "shapes": [{"type": "capsule", "end": [0.05, 0], "radius": 0.005}]}
DOWN = (0.0, -9.81)


def _chain(count: int = 20) -> dict[str, Any]:
    """Links that fall from a horizontal line, on hinges with some damping."""
    names = ["ground", *(f"link{i}" for i in range(count))]
    return {
        "gravity": DOWN, "run": {"duration": 0.5},
        "bodies": [GROUND, *({**LINK, "name": name, "at": (0.05 * i, 0.0)}
                             for i, name in enumerate(names[1:]))],
        "joints": [{"type": "pin", "name": f"pin{i}", "a": a, "b": b, "on_b": (0, 0),
                    "damping": 1e-4} for i, (a, b) in enumerate(
                        pairwise(names))]}


def _hook() -> dict[str, Any]:
    """A weight of 0.5 kg on a hook of 10 g, which swings on a rod from 30 deg on."""
    x, y = 0.5, -(0.75**0.5)
    return {
        "gravity": DOWN, "run": {"duration": 0.5},
        "bodies": [GROUND, *({"name": name, "mass": mass, "inertia": 1e-4 * mass,
                              "at": (r * x, r * y)}
                             for name, mass, r in (("hook", 0.01, 0.1), ("weight", 0.5, 0.15)))],
        "joints": [{"type": "rod", "name": "rod", "a": "ground", "b": "hook"},
                   {"type": "pin", "name": "pin", "a": "hook", "b": "weight", "on_a": (0, 0)}]}


def _pile(count: int = 8) -> dict[str, Any]:
    """Boxes that fall by 1 mm each onto a floor, one on the other."""
    return {
        "gravity": DOWN, "run": {"duration": 0.5},
        "bodies": [{**GROUND, "at": (0, -0.05), "shapes": [{"type": "box", "size": (1, 0.1)}]},
                   *({"name": f"box{i}", "mass": 0.1, "at": (0, 0.021 + 0.041 * i),
                      "shapes": [{"type": "box", "size": (0.06, 0.04)}]} for i in range(count))]}


@dataclass(frozen=True)
class Case:
    """A mechanism and what is compared of it."""

    title: str
    scene: str | Mapping[str, Any]
    forces: tuple[str, ...]
    """Patterns of quantities."""
    duration: float


CASES: Mapping[str, Case] = {
    "adaptive_grasp": Case("adaptive_grasp", "adaptive_grasp", ("finger?.contact.normal",), 0.8),
    "single_finger": Case("single_finger", "single_finger", ("finger.*.contact.normal",), 0.8),
    "four_bar": Case("four_bar", "four_bar", ("rocker_pin.reaction", "coupler.reaction"), 0.5),
    "chain": Case("chain of 20", _chain(), ("pin0.reaction", "pin10.reaction"), 0.3),
    "hook": Case("0.5 kg on a hook of 10 g", _hook(), ("rod.reaction", "pin.reaction"), 0.5),
    "pile": Case("pile of 8 boxes", _pile(), ("ground.contact.normal", "box7.contact.normal"), 0.5),
}


@dataclass(frozen=True)
class Point:
    """What one solver does with one step and number of iterations."""

    step: float
    iterations: int
    """0 of the direct solver."""
    pose: float
    """Largest error of a body's place [mm]."""
    force: float
    """Largest error of a force, of the largest one [%]."""
    cost: float
    """CPU time of a step [us]."""


def _scene(case: Case, step: float, iterations: int = 0) -> Mechanism:
    return mechanism(case.scene, {
        "run.duration": case.duration, "run.step": step, "run.sample_rate": 1000, **({
            "run.solver": "pymunk", "run.pymunk.substeps": 1,
            "run.pymunk.iterations": iterations} if iterations else {})})


def _answer(case: Case, run: Recording) -> tuple[Array, Array]:
    """Places of bodies at the end [m], and mean forces [N]."""
    end = case.duration - 1e-3
    places = run.arrays["body_pose"][:, :, :2].reshape(len(run), -1)
    late = run.time > end - OVER
    names = sorted({name for word in case.forces for name in run.names(word)})
    return (np.array([np.interp(end, run.time, column) for column in places.T]),
            np.array([run[name][late].mean() for name in names]))


def _cost(scene: Mechanism) -> float:
    """CPU time of a step [us]."""
    if scene.run.solver == "pymunk":
        made = to_pymunk(scene)
        began = time.process_time()
        for _ in range(TIMED):
            made.step()
        return 1e6 * (time.process_time() - began) / TIMED
    simulation = Simulation(scene)
    simulation.step(10)
    began = time.process_time()
    made_steps = simulation.step(10 * TIMED)
    return 1e6 * (time.process_time() - began) / made_steps


def measured(case: Case, steps: Sequence[float], iterations: Sequence[int]) -> list[Point]:
    """All points of a mechanism, the direct solver's first."""
    places, forces = _answer(case, simulate(_scene(case, min(steps) / 5)))
    found = []
    for count in (0, *iterations):
        for step in steps:
            scene = _scene(case, step, count)
            try:
                own_places, own_forces = _answer(case, simulate(scene))
            except SimulationDiverged:
                own_places, own_forces = np.inf * places, np.inf * forces
            off = (own_places - places).reshape(-1, 2)
            found.append(Point(
                step, count, 1e3 * float(np.hypot(*off.T).max()),
                100 * float(np.abs(own_forces - forces).max() / np.abs(forces).max()),
                _cost(scene)))
    return found


@cache
def results(*, quick: bool = False) -> dict[str, list[Point]]:
    """All points by case."""
    steps, iterations = (STEPS[:2], ITERATIONS[:1]) if quick else (STEPS, ITERATIONS)
    cases = {key: CASES[key] for key in ("hook", "pile")} if quick else CASES
    return {key: measured(case, steps, iterations) for key, case in cases.items()}


def figures(*, quick: bool = False) -> list[Figure]:
    """Errors at the smallest step with the most iterations."""
    return [figure for key, points in results(quick=quick).items() for figure in (
        Figure(f"{key}: places", points[-1].pose, "mm"),
        Figure(f"{key}: forces", points[-1].force, "%"),
        Figure(f"{key}: a step", points[-1].cost, "us"))]


def draw(directory: Path, *, quick: bool = False) -> None:
    """A picture for each mechanism, and the table of the page if it is there."""
    found = results(quick=quick)
    for key, points in found.items():
        panels = []
        for field, label in (("pose", "place [mm]"), ("force", "force [%]"),
                             ("cost", "step [µs]")):
            curves = []
            for count in dict.fromkeys(point.iterations for point in points):
                own = [point for point in points if point.iterations == count]
                values = np.maximum([getattr(point, field) for point in own], 1e-7)
                curves.append(Curve(f"{count} iterations" if count else "direct solver",
                                    1e3 * np.array([point.step for point in own]), values,
                                    "joined"))
            panels.append(Panel("", Axis("time step [ms]", log=True), Axis(label, log=True), curves,
                                names="above" if field == "pose" else ""))
        save_panels(directory / f"pymunk_{key}.png", panels, title=CASES[key].title, shared=True)
    page = directory / PAGE
    if page.exists() and not quick:
        head, rest = page.read_text(encoding="utf-8").split(BEGIN)
        page.write_text(head + BEGIN + _table(found) + END + rest.split(END)[1], encoding="utf-8")


def _table(found: Mapping[str, Sequence[Point]]) -> str:
    """Both solvers at 0.5 ms side by side."""
    rows = ["| mechanism | error of places, direct | pymunk | of forces, direct | pymunk "
            "| time of a step, direct | pymunk |", "|---|---|---|---|---|---|---|"]
    for key, points in found.items():
        direct, other = (next(point for point in points if point.step == 5e-4
                              and point.iterations == count) for count in (0, 30))
        rows.append(f"| {CASES[key].title} | " + " | ".join(
            f"{value if value > 1e-5 else 0:.2g} {unit}" for value, unit in (
                (direct.pose, "mm"), (other.pose, "mm"), (direct.force, "%"), (other.force, "%")))
            + f" | {direct.cost:.0f} µs | {other.cost:.0f} µs |")
    return "\n".join(rows) + "\n"
