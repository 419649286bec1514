"""Difficult mechanisms: long chains, extreme mass ratios, stiff cords, stacks, a free object."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.engine.simulate import simulate
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import load_scene
from tests.support.mechanisms import G, Json, fixed, mass, simulated
from tests.support.reference import SET_G, integrate

from .case import Check, case, hinge, order_check, point


@dataclass(frozen=True)
class Rods:
    """Uniform rods in a row, the first on a pin at the origin, at rest at their start angles [rad].

    In the angles a from the x axis: with B the lengths along which a rod's centre is carried,
    c = B u, u_i = (cos a_i, sin a_i), and K = Bᵀ diag(m) B,
    sum_j K_ij (cos(a_i - a_j) a_j'' + sin(a_i - a_j) a_j'²) + I_i a_i'' = -g (Bᵀ m)_i cos a_i.
    """

    masses: Array
    length: float
    start: Array

    @property
    def carried(self) -> Array:
        n = len(self.masses)
        return np.asarray(self.length * (np.tril(np.ones((n, n)), -1) + np.eye(n) / 2))

    def derivative(self, _: float, state: Array) -> Array:
        angle, rate = np.split(state, 2)
        B, m = self.carried, self.masses
        K = B.T @ (m[:, None] * B)
        apart = angle[:, None] - angle
        force = -(K * np.sin(apart)) @ rate**2 - G * (B.T @ m) * np.cos(angle)
        inertia = np.diag(m * self.length**2 / 12)
        return np.concatenate([rate, np.linalg.solve(K * np.cos(apart) + inertia, force)])

    def angles(self, times: Array) -> Array:
        """Angles at times [s], shape [n, rods]."""
        start = np.concatenate([self.start, np.zeros(len(self.start))])
        return integrate(self.derivative, start, times)[:, :len(self.start)]

    def energy(self, angle: Array, rate: Array) -> Array:
        """Kinetic and potential energy [J] for angles and rates of shape [n, rods]."""
        u = np.exp(1j * angle)
        speed = np.abs((1j * u * rate) @ self.carried.T)
        kinetic = speed**2 @ self.masses / 2 + rate**2 @ self.masses * self.length**2 / 24
        return np.asarray(kinetic + G * (u.imag @ self.carried.T) @ self.masses)

    def run(self, duration: float, step: float, **more: Any) -> Recording:
        """The simulated rods; the frame of each is at its near pin."""
        count = len(self.masses)
        ends = np.concatenate([[0], np.cumsum(self.length * np.exp(1j * self.start))])
        links = [{"name": f"link{i}", "mass": float(self.masses[i]), "at": point(ends[i]),
                  "inertia": float(self.masses[i]) * self.length**2 / 12,
                  "centre": (self.length / 2, 0.0), "angle": float(self.start[i])}
                 for i in range(count)]
        return simulated(duration, step, g=G, bodies=[fixed("wall"), *links], joints=[
            hinge(f"link{i - 1}" if i else "wall", f"link{i}") for i in range(count)], **more)


def read(run: Recording, quantity: str) -> Array:
    """A quantity of all links, shape [n, rods]."""
    return np.stack([run[f"link{i}.{quantity}"] for i in range(len(run.mechanism.joints))], axis=1)


@case("Chain of 20 links", "Lagrange's equations in 20 angles",
      "20 links of 20 mm and 10 g, released level, 0.4 s, against an integration of order 8")
def test_long_chain() -> Iterator[Check]:
    rods = Rods(np.full(20, 0.01), 0.02, np.zeros(20))

    def off(step: float) -> float:
        """Largest error of the tip [m]."""
        run = rods.run(0.4, step, every_step=True)
        ends = rods.length * np.exp(1j * np.stack([read(run, "angle"), rods.angles(run.time)]))
        return float(np.abs(np.diff(ends.sum(axis=2), axis=0)).max())

    coarse, h, k = off(5e-4), 2.5e-4, 1e-4
    yield Check("position of the tip, h = 0.5 ms", "m", 0.0, coarse, 2.5e-4, "requirement")
    yield order_check("the tip", 2.0, h, k, off(h), off(k))


@case("Light link that carries a heavy one", "Lagrange's equations in two angles",
      "a two-link pendulum, 0.1 g that carries 100 g, 2 s, against an integration of order 8")
def test_mass_ratio() -> Iterator[Check]:
    rods = Rods(np.array([1e-4, 0.1]), 0.1, np.array([-0.3, -1.0]))
    errors = []
    for step in (5e-4, 2.5e-4):
        run = rods.run(2.0, step, run={"sample_rate": 1000.0})
        errors.append(float(np.abs(read(run, "angle") - rods.angles(run.time)).max()))
    yield Check("angles, h = 0.5 ms", "rad", 0.0, errors[0], 1.5e-3, "requirement")
    yield order_check("the angles", 2.0, 5e-4, 2.5e-4, *errors)


@case("Energy of a double pendulum over a minute", "T + V = const",
      "two equal links, chaotic, 60 s, h = 0.5 ms")
def test_long_run() -> Iterator[Check]:
    rods = Rods(np.full(2, 0.1), 0.1, np.array([0.5, 1.0]))
    run = rods.run(60.0, 5e-4, run={"sample_rate": 200.0})
    start = rods.energy(rods.start[None], np.zeros((1, 2)))
    energy = (rods.energy(read(run, "angle"), read(run, "omega")) - start) / (
        2 * G * rods.length * rods.masses.sum())
    why = "symplectic scheme, joints closed at the end of the step: energy swings with (ω h)²"
    yield Check("energy by all that weight can give", "1", 0.0, energy, 1e-3, why)
    yield Check("drift from the first to the last ten seconds", "1", energy[run.time < 10].mean(),
                energy[run.time > 50].mean(), 1e-4, why)


@case("Weight under a light hook on a stiff cord", "T = (M + m) g, T ≤ 2 (M + m) g",
      "500 g pinned under 0.5 g on a cord of 10⁵ N/m, straight but not stretched; 2 s")
def test_light_hook() -> Iterator[Check]:
    heavy, light = 0.5, 5e-4
    load = (heavy + light) * G
    for step in (1e-3, 1e-4):
        run = simulated(
            2.0, step, g=G, every_step=True, bodies=[
                fixed("beam"), mass("hook", light, (0.0, -0.1), inertia=light * 1e-4),
                mass("weight", heavy, (0.0, -0.15), inertia=heavy * 1e-3)],
            joints=[{"type": "pin", "name": "pin", "a": "hook", "b": "weight",
                     "on_a": (0.0, -0.01)}],
            tendons=[{"name": "cord", "stiffness": 1e5,
                      "guides": [{"body": "hook"}, {"body": "beam"}]}])
        tension, label = run["cord.tension"] / load, f"h = {1e3 * step:g} ms"
        yield Check(f"mean tension by the load, {label}", "1", 1.0, tension[run.time > 0.5].mean(),
                    1e-3, "requirement")
        yield Check(f"tension at rest by the load, {label}", "1", 1.0,
                    tension[run.time > 1.9].mean(), 1e-6, "the ringing has decayed")
        yield Check(f"peak of the tension above 2, {label}", "1", 0.0,
                    max(float(tension.max()) - 2, 0.0), 1e-3, "T = W (1 − cos ω t)")
        yield Check(f"rise of hook and weight, {label}", "m", 0.0, max(
            run["hook.y"].max() + 0.1, run["weight.y"].max() + 0.15, 0.0), 1e-7,
            "no energy for more; gaps of a millionth of the size")


def box(name: str, kilograms: float, width: float, height: float, bottom: float = 0.0) -> Json:
    return {"name": name, "mass": kilograms, "at": (0.0, bottom + height / 2),
            "shapes": [{"type": "box", "size": (width, height)}]}


def on_floor(duration: float, step: float, *bodies: Json, **more: Any) -> Recording:
    return simulated(duration, step, g=G, every_step=True, bodies=[
        fixed("floor", shapes=[{"type": "box", "size": (1.0, 0.02), "at": (0.0, -0.01)}]),
        *bodies], **more)


@case("Heavy box on a light one", "N = (M + m) g",
      "1 kg on a box of 1 g, or of 1 mg, for 1 s at h = 1 and 0.5 ms")
def test_stacks() -> Iterator[Check]:
    for light in (1e-3, 1e-6):
        for step in (1e-3, 5e-4):
            run = on_floor(1.0, step, box("light", light, 0.04, 0.01),
                           box("heavy", 1.0, 0.04, 0.04, 0.01))
            label = f"on {1e3 * light:g} g, h = {1e3 * step:g} ms"
            yield Check(f"force of the floor by the load, {label}", "1", 1.0,
                        run["light/floor.normal"][run.time > 0.5] / (G * (1 + light)), 1e-6,
                        "every sample once at rest")
            yield Check(f"creep, {label}", "m", 0.0, [
                np.hypot(run["light.x"], run["light.y"] - 0.005).max(),
                np.hypot(run["heavy.x"], run["heavy.y"] - 0.03).max()], 1e-5, "rest")


@case("Where the floor carries a body", "Σ M = 0",
      "an L of two boxes, and a cube of 1 kg that 3 N push at its top; h = 1 and 0.5 ms")
def test_centre_of_pressure() -> Iterator[Check]:
    foot, leg = 0.1 * 0.03, 0.03 * 0.07
    piece = {"name": "body", "mass": 1.0, "shapes": [
        {"type": "box", "size": (0.1, 0.03), "at": (0.05, 0.015)},
        {"type": "box", "size": (0.03, 0.07), "at": (0.015, 0.065)}]}
    push = {"type": "force", "name": "push", "body": "body", "at": (0.0, 0.05),
            "direction": (1.0, 0.0), "value": 3.0}
    for step in (1e-3, 5e-4):
        for label, body, drives, truth in (
                ("L", piece, [], (0.05 * foot + 0.015 * leg) / (foot + leg)),
                ("pushed cube", box("body", 1.0, 0.1, 0.1), [push], 3.0 * 0.1 / G)):
            run = on_floor(0.5, step, body, drives=drives)
            at = run.arrays["contact_point"][run.time[run.arrays["contact_sample"]] > 0.3, 0]
            assert len(at)
            yield Check(f"{label}, h = {1e3 * step:g} ms", "m", truth, at, 1e-5, "moments")


def steady(find: Callable[[Recording], Array], run: Recording) -> float:
    """Largest change of any of the values [n, k] in the last second."""
    return float(np.ptp(find(run)[run.time > run.time[-1] - 1.0], axis=0).max())


def pair_forces(run: Recording) -> Array:
    """Contact forces [N], a column for each pair of bodies, 0 while they are apart."""
    a = run.arrays
    pairs, column = np.unique(a["contact_body"] * len(run.mechanism.bodies) + a["contact_other"],
                              return_inverse=True)
    sizes = np.zeros((len(run), len(pairs)))
    sizes[a["contact_sample"], column] = np.linalg.norm(a["contact_force"], axis=1)
    return sizes


@case("Free square in the grasp of four fingers", "rest",
      "a square, free in the plane, four fingers in planes of their own, the fourth second; "
      "h = 2 and 0.5 ms")
def test_four_fingers() -> Iterator[Check]:
    centre, names = 0.011 - 0.042j, [f"finger{i}" for i in range(1, 5)]
    for step in (2e-3, 5e-4):
        run = simulate(load_scene({
            "run": {"duration": 4.0, "step": step, "sample_rate": 500.0},
            "materials": {"skin": {"friction": 0.5}},
            "parts": [{
                "type": "finger", "name": name, "angle": np.pi / 2 * i, "material": "skin",
                "at": point(-centre * 1j**i), "lengths": SET_G.lengths, "radii": SET_G.radii,
                "masses": SET_G.masses, "guides": SET_G.guides, "damping": SET_G.damping,
                "limits": SET_G.limits,
                "springs": {"stiffness": 300, "from": SET_G.before[0], "to": SET_G.after[0]},
            } for i, name in enumerate(names)],
            "bodies": [{"name": "square", "mass": 0.05, "material": "skin", "at": [0.004, -0.003],
                        "angle": 0.4, "shapes": [{"type": "box", "size": [0.036, 0.036]}]}],
            "drives": [{"type": "pull", "name": f"{name}.pull", "tendon": name,
                        "value": {"ramp": {"to": 3.75, "over": 0.5}}} for name in names],
            "contacts": [{"between": ["finger*", "finger*"], "collide": False}]}))
        label, why = f"h = {1e3 * step:g} ms", "every force is constant at rest"
        yield Check(f"change of contact forces, {label}", "N", 0.0, steady(pair_forces, run), 1e-8,
                    why)
        yield Check(f"change of tensions, {label}", "N", 0.0, steady(
            lambda run: run.arrays["tendon_tension"], run), 1e-8, why)
        yield Check(f"creep of any body, {label}", "m", 0.0, steady(
            lambda run: run.arrays["body_pose"][..., :2].reshape(len(run), -1), run), 1e-8,
            "friction holds")
