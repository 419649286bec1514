"""Soft skin against closed forms, and piles of many bodies against statics and conservation."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulation import Simulation
from sandbox.recording.recording import Recording
from sandbox.scene.library import find_scene
from sandbox.scene.read.load import load_scene
from tests.support.mechanisms import G, Json, cable, fixed, force, pin, simulated

from .case import STEPS, Check, case

M, K = 0.05, 1e3
"""Mass of the box [kg], stiffness of its skin at each of its two corners [N/m]."""


def soft_box(
    step: float, duration: float, *, k: float = K, c: float = 0.0, gap: float = 0.0,
    speed: float = 0.0, g: float = G, floor: Json | None = None, **more: Any,
) -> Recording:
    """A box of 40 x 20 mm with skin over a level floor, whose skin is ``floor`` if it has one."""
    skin = {"friction": 0.5, "skin": {"stiffness": k, "damping": c}}
    return simulated(
        duration, step, every_step=True, g=g,
        materials={"soft": skin, "hard": {"friction": 0.5} if floor is None else floor | {
            "friction": 0.5}},
        bodies=[fixed("floor", material="hard", shapes=[
            {"type": "box", "size": (2.0, 0.05), "at": (0.0, -0.025)}]),
            {"name": "box", "mass": M, "at": (0.0, 0.01 + gap), "velocity": (0.0, -speed),
             "material": "soft", "shapes": [{"type": "box", "size": (0.04, 0.02)}]}], **more)


@case("Box at rest on a soft skin", "d = m g / (2 k)", "two corners, k = 10³ to 10⁷ N/m, h = 1 ms")
def test_indentation() -> Iterator[Check]:
    for k in (1e3, 1e5, 1e7):
        run = soft_box(1e-3, 1.0, k=k, c=0.5 * math.sqrt(2 * k * M))
        depth = M * G / (2 * k)
        yield Check(f"depth, k = {k:.0e} N/m", "m", depth, 0.01 - run["box.y"][-1],
                    2e-13 + 1e-8 * depth, "rounding of places, and impulses held by 1e-10")
    other = {"skin": {"stiffness": 3e3, "damping": 10.0}}
    run = soft_box(1e-3, 1.0, c=5.0, floor=other)
    yield Check("depth of two skins in series", "m", M * G / 2 * (1 / K + 1 / 3e3),
                0.01 - run["box.y"][-1], 1e-8 * M * G / K, "1/k = 1/k₁ + 1/k₂")


@case("Vibration on a soft skin", "ω² = 2 k / m, without loss", "a box pressed in by 10 %, "
      "ten periods, h = 1, 0.5, 0.25 ms")
def test_vibration() -> Iterator[Check]:
    rest, rate, errors = M * G / (2 * K), math.sqrt(2 * K / M), []
    for h in STEPS:
        run = soft_box(h, 0.4, gap=-1.1 * rest)
        y, t = run["box.y"] - 0.01 + rest, run.time
        down = np.flatnonzero((y[:-1] > 0) & (y[1:] <= 0))
        zero = t[down] + h * y[down] / (y[down] - y[down + 1])
        errors.append((zero[10] - zero[0]) / 10 * rate / (2 * math.pi) - 1)
        yield Check(f"period, h = {1e3 * h:g} ms", "", 0.0, errors[-1], (rate * h)**2 / 8,
                    "(h ω)²/12 of the even rule, and half as much to spare")
        late = slice(-round(2 * math.pi / rate / h), None)
        yield Check(f"amplitude, h = {1e3 * h:g} ms", "", 1.0,
                    float(np.abs(y[late]).max()) / (0.1 * rest), 0.02, "no damping; sampling")
    for one, two in pairwise(errors):
        yield Check("order of the period", "", 2.0, math.log2(one / two), 0.1, "second order")


@case("Rebound from a damped skin", "e = exp(− 2 ζ acos ζ / √(1 − ζ²))", "1 m/s without gravity, "
      "ζ = 0.05 to 0.5, h = 0.1 ms")
def test_rebound() -> Iterator[Check]:
    k, h = 5e3, 1e-4
    rate = math.sqrt(2 * k / M)
    for zeta in (0.05, 0.2, 0.5):
        run = soft_box(h, 0.03, k=k, c=zeta * math.sqrt(2 * k * M), speed=1.0, gap=3.3 * h, g=0.0)
        yield Check(f"speed after, ζ = {zeta:g}", "m/s",
                    math.exp(-2 * zeta * math.acos(zeta) / math.sqrt(1 - zeta**2)),
                    run["box.vy"][-1], rate * h, "the instant of the touch is within a step")


@case("Shear of a soft skin", "x = F / (2 · ⅔ k) + F / (8 k), F < μ m g; a = F/m − μ g beyond",
      "a box pushed along the floor, h = 1 ms")
def test_shear() -> Iterator[Check]:
    weight = M * G
    for share in (0.2, 0.6):
        push = share * 0.5 * weight
        run = soft_box(1e-3, 1.2, c=5.0, gap=-weight / (2 * K), drives=[
            force("push", "box", (1.0, 0.0), {"ramp": {"to": push, "over": 0.5}})])
        yield Check(f"displacement at {share:g} μ m g", "m", push / (4 / 3 * K) + push / (8 * K),
                    run["box.x"][-1], 3 * weight / (2 * K) / 0.01 * push / (8 * K),
                    "the push acts 10 mm above the floor, less the depth")
    run = soft_box(1e-3, 1.0, c=5.0, gravity_x=6.0)
    yield Check("acceleration of sliding", "m/s^2", 6.0 - 0.5 * G,
                (run["box.vx"][-1] - run["box.vx"][-101]) / 0.1, 1e-8, "the law itself")


def pile(
    count: int, *, shape: str = "discs", duration: float = 1.0, friction: float = 0.5,
    **more: Any,
) -> Json:
    """Discs of 8 to 12 mm, or boxes, that fall into a box."""
    random = np.random.default_rng(1)
    columns = round(math.sqrt(count))
    width = 0.03 * columns
    walls = [fixed(name, material="m", shapes=[{"type": "box", "size": size, "at": at}])
             for name, size, at in (("floor", (width + 0.2, 0.05), (0.0, -0.025)),
                                    ("left", (0.05, 2.0), (-width / 2 - 0.025, 1.0)),
                                    ("right", (0.05, 2.0), (width / 2 + 0.025, 1.0)))]
    bodies = []
    for i in range(count):
        r = random.uniform(0.008, 0.012)
        kind = ({"type": "circle", "radius": r} if shape == "discs"
                else {"type": "box", "size": (2 * r, 2 * r)})
        bodies.append({
            "name": f"b{i}", "mass": 0.05, "material": "m", "shapes": [kind],
            "at": (-width / 2 + (i % columns + 0.5) * 0.03 + random.uniform(-1e-3, 1e-3),
                   0.015 + i // columns * 0.03)})
    return {"format": 1, "run": {"duration": duration, "step": 1e-3, "sample_rate": 100},
            "gravity": [0.0, -G], "materials": {"m": {"friction": friction}},
            "bodies": [*walls, *bodies], **more}


@case("Pile of discs and of boxes", "N = Σ m g; energy falls; no step unsolved",
      "40 bodies of 50 g fall into a box, h = 1 ms")
def test_pile() -> Iterator[Check]:
    for shape in ("discs", "boxes"):
        simulation = Simulation(load_scene(pile(40, shape=shape, duration=2.0)))
        simulation.run()
        run, found = simulation.recording(), simulation.recording().info.contact_solver
        assert run["solver.residual"].max() == found["residual"] > 0.0
        assert np.diff(run["solver.residual"]).min() < 0.0  # each sample has its own steps
        yield Check(f"largest residual, {shape}", "m/s", 0.0, found["residual"], 1e-8,
                    "the solver's tolerance at 10 m/s and some to spare")
        yield Check(f"force on the floor, {shape}", "N", 40 * 0.05 * G,
                    -run["floor.contact.fy"][-20:].mean() - sum(
                        run[f"{wall}.contact.fy"][-20:].mean() for wall in ("left", "right")),
                    0.02 * 40 * 0.05 * G, "the pile is at rest but for a body that rolls")
        depth = -run.arrays["contact_gap"][run.arrays["contact_sample"] >= 100].min()
        yield Check(f"depth after 1 s, {shape}", "m", 0.0, depth, 2e-5, "a thousandth of a body")


@case("Column of discs", "N_i = (n − i) m g, d_i = N_i / k, h² k G = 40",
      "30 discs of 50 g between walls, h = 1 ms")
def test_column() -> Iterator[Check]:
    n, r, h = 31, 0.01, 1e-3
    bodies = [{"name": f"d{i}", "mass": 0.05, "at": (0.0, r * (1 + 2 * i)), "material": "smooth",
               "shapes": [{"type": "circle", "radius": r}]} for i in range(n)]
    walls = [fixed(name, material="smooth", shapes=[{"type": "box", "size": size, "at": at}])
             for name, size, at in (("floor", (0.2, 0.05), (0.0, -0.025)),
                                    ("left", (0.02, 2.0), (-r - 0.01, 1.0)),
                                    ("right", (0.02, 2.0), (r + 0.01, 1.0)))]
    run = simulated(2.0, h, g=G, materials={"smooth": {"friction": 0.1}}, bodies=[*walls, *bodies])
    yield Check("force on the floor", "N", n * 0.05 * G, -run["floor.contact.fy"][-1],
                1e-6 * n * 0.05 * G, "it sleeps, slower than 1e-10 m/s")
    y = np.array([run[f"d{i}.y"][-1] for i in range(n)])
    k = 40 * 0.05 / h**2 / np.where(np.arange(n) == 0, 1, 2)
    load = 0.05 * G * (n - np.arange(n))
    yield Check("compression of the column", "m", float((load / k).sum()),
                (2 * n - 1) * r - y[-1], 1e-3 * float((load / k).sum()), "statics")


def linked(copies: int) -> Json:
    """Groups of four hinged discs with a tendon and of two loose ones, which fall far apart.

    A motor, a brake, dry friction, gas, drag and a release act on each.
    """
    bodies = [fixed("floor", material="soft", shapes=[
        {"type": "box", "size": (40.0, 0.05), "at": (0.0, -0.025)}])]
    more: dict[str, list[Json]] = {
        key: [] for key in ("joints", "tendons", "drives", "lines", "loads", "events")}
    for c in range(copies):
        places = [(f"link{c}_{i}", 0.03, 0.008, (0.5 * c + 0.04 * i, 0.06)) for i in range(4)]
        places += [(f"low{c}", 0.05, 0.015, (0.5 * c + 0.05, 0.02)),
                   (f"high{c}", 0.05, 0.012, (0.5 * c + 0.09, 0.1))]
        bodies += [{"name": name, "mass": kilograms, "material": "soft", "at": at,
                    "shapes": [{"type": "circle", "radius": r}]}
                   for name, kilograms, r, at in places]
        more["joints"] += [pin(f"pin{c}_{i}", f"link{c}_{i}", f"link{c}_{i + 1}", on_a=(0.02, 0.0),
                               on_b=(-0.02, 0.0)) for i in range(3)]
        more["joints"][-1]["friction"] = 0.003
        more["tendons"].append(cable(
            f"tendon{c}", (f"link{c}_0",), (f"link{c}_3",), stiffness=50.0, damping=0.1,
            breaks_at=1e3, rest_length=0.1))
        more["drives"] += [
            {"type": "motor", "name": f"motor{c}", "joint": f"pin{c}_1", "torque": 0.02,
             "value": {"table": [[0.0, 0.0], [0.2, 6.0], [0.5, -6.0]]}},
            {"type": "brake", "name": f"brake{c}", "joint": f"pin{c}_0", "value": 0.004}]
        more["lines"].append({"name": f"gas{c}", "volume": 1e-6, "gas": 1.4, "chambers": [
            {"type": "vane", "joint": f"pin{c}_{i}", "displacement": 1e-7} for i in (0, 2)]})
        more["loads"].append({
            "type": "drag", "name": f"drag{c}", "bodies": [f"link{c}_1", f"low{c}"],
            "linear": 0.05, "area": 0.01, "coefficient": 1.0, "density": 1000.0})
        more["events"].append({"name": f"let{c}", "at": 0.3, "release": [f"tendon{c}"]})
    return {"format": 1, "run": {"duration": 0.5, "step": 1e-3, "sample_rate": 100},
            "gravity": [0.0, -G], "bodies": bodies, **more,
            "materials": {"soft": {"friction": 0.4, "skin": {"stiffness": 2e4, "damping": 2.0}}}}


@case("Joints, tendons, drives, loads and fluids among many contacts",
      "the same motion, force and law by another solver",
      "four hinged discs and two loose ones with soft skin, alone and twenty times, h = 1 ms")
def test_linked_bodies() -> Iterator[Check]:
    runs = {}
    for copies in (1, 20):
        simulation = Simulation(load_scene(linked(copies)))
        simulation.run()
        runs[copies] = simulation.recording()
    one, many = runs[1], runs[20]
    assert "compliant_steps" not in one.info.contact_solver
    assert one["gas0.pressure"].max() > 1e3
    assert many.info.contact_solver["compliant_steps"] > 300
    for name in ("link0_0", "link0_3", "low0", "high0"):
        for axis in "xy":
            off = np.abs(one[f"{name}.{axis}"] - many[f"{name}.{axis}"]).max()
            yield Check(f"{name}.{axis}, difference", "m", 0.0, float(off), 1e-6,
                        "residuals of 1e-10 m/s, which discs that roll off each other amplify")
    off = np.abs(one["pin0_1.reaction"][-20:] - many["pin0_1.reaction"][-20:]).max()
    yield Check("reaction of a hinge", "N", 0.0, float(off), 1e-3, "the same")
    off = np.abs(one["motor0.torque"] - many["motor0.torque"]).max()
    yield Check("torque of a motor", "N m", 0.0, float(off), 1e-5, "the same")


@case("Discs in a bag of chain", "pins carry Σ m g; joints stay closed", "scene chain_bag")
def test_chain_bag() -> Iterator[Check]:
    simulation = Simulation(load_scene(find_scene("chain_bag")))
    simulation.run()
    run = simulation.recording()
    carried = run["pin0.reaction_y"] - run["pin32.reaction_y"]
    weight = (50 * 0.01 + 32 * 0.002) * G
    yield Check("mean force of both pins", "N", weight, float(carried[-50:].mean()),
                0.01 * weight, "the bag still sways")
    found = run.info.contact_solver
    yield Check("largest residual", "m/s", 0.0, found["residual"], 1e-8, "no step unsolved")
    x, y, angle = (run[f"link15.{q}"] for q in ("x", "y", "angle"))
    gap = np.hypot(x + 0.0125 * np.cos(angle) - run["link16.x"],
                   y + 0.0125 * np.sin(angle) - run["link16.y"])
    yield Check("gap of the lowest pin", "m", 0.0, float(gap.max()), 1e-9, "three closings a step")


def test_a_pile_is_the_same_in_pieces_and_sleeps() -> None:
    scene = load_scene(pile(30, shape="boxes", duration=1.5))
    whole, pieces = Simulation(scene), Simulation(scene)
    whole.run()
    while not pieces.finished:
        pieces.step(137)
    for key, array in whole.recording().arrays.items():
        assert np.array_equal(array, pieces.recording().arrays[key], equal_nan=True), key
    asleep = whole._tables.state.pile_bodies["still"] >= 22
    assert asleep.all()
    assert not whole._world.body[:, 3:].any()
    whole.restart()
    whole.run()
    for key, array in whole.recording().arrays.items():
        assert np.array_equal(array, pieces.recording().arrays[key], equal_nan=True), key


@pytest.mark.parametrize("how", ["force", "body"])
def test_what_sleeps_wakes(how: str) -> None:
    scene = pile(30, shape="boxes", duration=3.0)
    if how == "force":
        scene["drives"] = [force("lift", "b29", (0.0, 1.0), {
            "table": [[0.0, 0.0], [2.0, 2.0]], "between": "step"})]
    else:
        scene["bodies"].append({"name": "late", "mass": 0.05, "material": "m", "at": (0.0, 19.8),
                                "shapes": [{"type": "circle", "radius": 0.01}]})
    run = Simulation(load_scene(scene))
    run.run(1900)
    assert (run._tables.state.pile_bodies["still"][:30] >= 22).all()
    run.run()
    moved = run.recording()
    if how == "force":
        assert moved["b29.y"][-1] > moved["b29.y"][190] + 0.1
    else:
        assert 0.0 < moved["late.y"][-1] < 0.3
        assert any(abs(moved[f"b{i}.y"][-1] - moved[f"b{i}.y"][190]) > 1e-6 for i in range(30))


def test_what_is_hit_in_its_sleep_wakes_within_the_step() -> None:
    """Nothing but the discs takes up momentum: a sleeper that stood still for a step would."""
    discs = [{"name": f"d{i}", "mass": M, "at": (0.02 * (i % 6), 0.02 * (i // 6)), "material": "m",
              "shapes": [{"type": "circle", "radius": 0.01}]} for i in range(36)]
    discs.append(discs[0] | {"name": "late", "at": (-0.06, 0.05), "velocity": (0.4, 0.0)})
    run = simulated(0.2, 1e-3, every_step=True, g=0.0, bodies=discs,
                    materials={"m": {"friction": 0.5}})
    momentum = sum(M * run[f"{disc['name']}.vx"] for disc in discs)
    assert run["d12.vx"][-1] > 0.0
    assert np.abs(momentum / (0.4 * M) - 1).max() < 1e-9
