"""Piles of many bodies: time of a step against MuJoCo, residual, growth; a chain among discs."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np

from benchmarks.measure import Figure, mechanism
from sandbox.engine.simulation import Simulation

H, AWAKE = 1e-3, 0.4
"""Step; until when no pile sleeps [s]."""


def discs(count: int) -> dict[str, Any]:
    """Discs of 8 to 12 mm that fall into a bin."""
    return _pile(count, 2.6, lambda r: {"type": "circle", "radius": r})


def boxes(count: int) -> dict[str, Any]:
    """Squares of 16 to 24 mm that fall into a bin."""
    return _pile(count, 3.2, lambda r: {"type": "box", "size": [2 * r, 2 * r]})


def _pile(count: int, pitch: float, shape: Callable[[float], dict[str, Any]]) -> dict[str, Any]:
    random, r = np.random.default_rng(0), 0.01
    columns = max(3, round(math.sqrt(count)))
    width = columns * pitch * r
    bodies: list[dict[str, Any]] = [
        {"name": name, "motion": "fixed", "at": at, "material": "m",
         "shapes": [{"type": "box", "size": size}]}
        for name, at, size in (("floor", [0, -0.025], [width + 0.2, 0.05]),
                               ("left", [-width / 2 - 0.025, 1], [0.05, 2.0]),
                               ("right", [width / 2 + 0.025, 1], [0.05, 2.0]))]
    for i in range(count):
        at = [-width / 2 + (i % columns + 0.5) * pitch * r + random.uniform(-1e-3, 1e-3),
              pitch * r * (0.5 + i // columns) + 0.002]
        bodies.append({"name": f"b{i}", "mass": 0.05, "at": at, "material": "m",
                       "shapes": [shape(r * random.uniform(0.8, 1.1))]})
    return _scene(bodies, 2.0)


def wall(rows: int, columns: int) -> dict[str, Any]:
    """Staggered bricks of 40 x 20 mm at rest."""
    bodies: list[dict[str, Any]] = [
        {"name": "floor", "motion": "fixed", "at": [0, -0.025], "material": "m",
         "shapes": [{"type": "box", "size": [2.0, 0.05]}]}]
    bodies += [{"name": f"b{k}_{c}", "mass": 0.05, "material": "m",
                "at": [(c + 0.5 * (k % 2) - columns / 2) * 0.04, 0.01 + 0.02 * k],
                "shapes": [{"type": "box", "size": [0.04, 0.02]}]}
               for k in range(rows) for c in range(columns - k % 2)]
    return _scene(bodies, 1.0)


def chain(links: int, count: int) -> dict[str, Any]:
    """Discs, and above them a folded chain of links of 20 mm that falls among them."""
    scene, at, turn, column = discs(count), np.array([-0.07, 0.26]), 0.0, 0
    scene["run"]["duration"], scene["joints"] = 1.0, []
    for i in range(links):
        angle = turn if column < 7 else math.pi / 2
        along = 0.02 * np.array([math.cos(angle), math.sin(angle)])
        scene["bodies"].append({
            "name": f"link{i}", "mass": 0.02, "at": (at + along / 2).tolist(), "angle": angle,
            "material": "m", "shapes": [{"type": "box", "size": [0.02, 0.004]}]})
        if i:
            scene["joints"].append({
                "type": "pin", "name": f"pin{i}", "a": f"link{i - 1}", "b": f"link{i}",
                "on_a": [0.01, 0], "on_b": [-0.01, 0]})
        at, column = at + along, column + 1
        if column == 8:
            turn, column = math.pi - turn, 0
    return scene


def _scene(bodies: list[dict[str, Any]], duration: float) -> dict[str, Any]:
    return {"format": 1, "run": {"duration": duration, "step": H, "sample_rate": 50},
            "gravity": [0, -9.81], "materials": {"m": {"friction": 0.5}}, "bodies": bodies}


def sandbox_step(scene: dict[str, Any]) -> tuple[float, float]:
    """Processor time of a step [s], largest residual [m/s]."""
    simulation = Simulation(mechanism(scene))
    simulation.run(1)
    began = time.process_time()
    simulation.run()
    spent = time.process_time() - began
    found = simulation.recording().info.contact_solver
    return spent / simulation.steps, found["residual"]


def mujoco_step(scene: dict[str, Any]) -> float:
    """Processor time of a step of MuJoCo [s]: Newton's method, 1e-10, spheres for discs."""
    import mujoco

    parts = [f'<mujoco><option timestep="{H}" gravity="0 -9.81 0" cone="elliptic" '
             'solver="Newton" iterations="100" tolerance="1e-10" impratio="10"/>'
             '<size memory="500M"/><default><geom friction="0.5 0 0" condim="3" '
             f'solref="{2 * H} 1"/></default><worldbody>']
    for body in scene["bodies"]:
        shape, free = body["shapes"][0], "mass" in body
        mass = f' mass="{body["mass"]}"' if free else ""
        parts.append(f'<body pos="{body["at"][0]} {body["at"][1]} 0">')
        if free:
            parts.append('<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>'
                         '<joint type="hinge" axis="0 0 1"/>')
        parts.append(f'<geom type="sphere" size="{shape["radius"]}"{mass}/>'
                     if shape["type"] == "circle" else
                     f'<geom type="box" size="{shape["size"][0] / 2} {shape["size"][1] / 2} '
                     f'0.01"{mass}/>')
        parts.append("</body>")
    model = mujoco.MjModel.from_xml_string("".join([*parts, "</worldbody></mujoco>"]))
    data, steps = mujoco.MjData(model), round(scene["run"]["duration"] / H)
    began = time.process_time()
    for _ in range(steps):
        mujoco.mj_step(model, data)
    return (time.process_time() - began) / steps


def figures(*, quick: bool = False) -> list[Figure]:
    """Ratios to MuJoCo, residuals, and growth of the time for each disc."""
    scenes = {"40 discs": discs(40), "80 boxes": boxes(80)} if quick else {
        "40 discs": discs(40), "150 discs": discs(150), "300 discs": discs(300),
        "80 boxes": boxes(80), "150 boxes": boxes(150), "wall of 10 x 10": wall(10, 10)}
    for scene in scenes.values():
        scene["run"]["duration"] = 0.1 if quick else scene["run"]["duration"]
    sandbox_step(_scene(discs(20)["bodies"], 0.01))
    found, residuals, own = [], [], {}
    for name, scene in scenes.items():
        own[name], residual = sandbox_step(scene)
        residuals.append(residual)
        found.append(Figure(f"{name}, step", 1e6 * own[name], "us"))
        with suppress(ImportError):
            found.append(Figure(f"{name}, step against MuJoCo", own[name] / mujoco_step(scene), "",
                                most=1.2))
    found.append(Figure("largest residual of all steps", max(residuals), "m/s", most=1e-8))
    if "300 discs" in own:
        spent, residual = sandbox_step(chain(40, 60))
        found += [Figure("chain of 40 links among 60 discs, step", 1e6 * spent, "us", most=3000),
                  Figure("its largest residual", residual, "m/s", most=1e-8)]
        awake = [min(sandbox_step(discs(count) | {"run": {"duration": AWAKE, "step": H}})[0]
                     for _ in range(3)) / count for count in (40, 300)]
        found += [Figure("time for each disc, 300 against 40 discs, none asleep",
                         awake[1] / awake[0], "", most=2.5),
                  Figure("  and until 2 s, when most of the 40 have slept",
                         own["300 discs"] / own["40 discs"] * 40 / 300, "")]
    return found
