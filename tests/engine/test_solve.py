"""Time steps of random mechanisms against an independent dense solution (dense.py)."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from sandbox.engine.rows import CLOSED
from sandbox.scene.mechanism import Mechanism

from .dense import Disc, Step
from .machines import Bench, G, H, cord, fixed, mechanism

RADIUS = 0.01


class Made:
    """A random mechanism of four bodies: a chain on a wall and what else the dice give."""

    def __init__(self, seed: int, *, contacts: int = 0, speed: float = 0.3) -> None:
        self.rng = rng = np.random.default_rng(seed)
        self.bodies: list[dict[str, Any]] = [fixed("wall"), {
            "name": "mover", "motion": "scheduled", "at": (0.3, 0.2), "path": {"x": 0.3}}]
        self.at = {"wall": np.zeros(3), "mover": np.array([0.3, 0.2, 0.0])}
        self.elements: dict[str, list[dict[str, Any]]] = {
            "joints": [], "springs": [], "tendons": [], "drives": [], "contacts": [
                {"between": ("*", "*"), "collide": False}]}
        self.drive: list[float] = []
        for i in range(4):
            pose = np.array([*rng.uniform(-0.2, 0.2, 2), rng.uniform(-3, 3)])
            self.at[f"b{i}"] = pose
            weight = 10 ** rng.uniform(-2, 0)
            self.bodies.append({
                "name": f"b{i}", "mass": weight, "inertia": weight * 10 ** rng.uniform(-4, -2.5),
                "at": pose[:2].tolist(), "angle": pose[2],
                "centre": rng.uniform(-0.02, 0.02, 2).tolist(),
                "velocity": (speed * rng.uniform(-1, 1, 2)).tolist(),
                "angular_velocity": 10 * speed * rng.uniform(-1, 1)})
        self.floors: list[tuple[str, float, float]] = []
        self.joint("pin", "wall", "b0", damping=self.maybe(1e-3), positive=self.sense())
        self.joint("pin", "b0", "b1", damping=self.maybe(1e-3), positive=self.sense())
        for i in range(contacts):
            self.floor(f"b{2 + i}")

    def maybe(self, value: float) -> float:
        return float(self.rng.choice([0.0, value * 10 ** self.rng.uniform(-1, 1)]))

    def sense(self) -> str:
        return str(self.rng.choice(["clockwise", "counterclockwise"]))

    def spot(self) -> list[float]:
        return self.rng.uniform(-0.05, 0.05, 2).tolist()

    def local(self, body: str, world: np.ndarray) -> list[float]:
        """A place in the world as a point of a body's frame."""
        x, y, angle = self.at[body]
        c, s = np.cos(angle), np.sin(angle)
        dx, dy = world - [x, y]
        return [c * dx + s * dy, c * dy - s * dx]

    def world(self, body: str, point: list[float]) -> np.ndarray:
        """A point of a body's frame in the world at t = 0."""
        x, y, angle = self.at[body]
        c, s = np.cos(angle), np.sin(angle)
        return np.array([x + c * point[0] - s * point[1], y + s * point[0] + c * point[1]])

    def spring(self, a: str, b: str, stiffness: float) -> None:
        """Short or long by up to 2 mm."""
        on_a, on_b = self.spot(), self.spot()
        length = np.hypot(*(self.world(b, on_b) - self.world(a, on_a)))
        self.add("springs", type="linear", a=a, b=b, on_a=on_a, on_b=on_b, stiffness=stiffness,
                 damping=self.maybe(1.0),
                 rest_length=float(length + self.rng.uniform(-2e-3, 2e-3)))

    def cord(self, *bodies: str, stiffness: float) -> None:
        """Stretched or slack by 1 mm, more than a step's way."""
        guides = [(body, self.spot()) for body in bodies]
        length = sum(np.hypot(*(self.world(*a) - self.world(*b)))
                     for a, b in itertools.pairwise(guides))
        self.elements["tendons"].append(cord(
            f"t{len(self.elements['tendons'])}", *guides, stiffness=stiffness,
            damping=self.maybe(1.0),
            rest_length=float(length + self.rng.choice([-1e-3, 1e-3], p=[0.7, 0.3]))))

    def add(self, what: str, **element: Any) -> str:
        name = f"{what[0]}{len(self.elements[what])}"
        self.elements[what].append({"name": name, **element})
        return name

    def joint(self, kind: str, a: str, b: str, **more: Any) -> str:
        where = {"on_a": self.spot()}
        if kind == "slot":  # through b's origin
            middle = self.local(a, self.at[b][:2])
            along = self.rng.uniform(-0.1, 0.1, 2)
            share = self.rng.uniform(0.1, 0.9)
            where = {"start": (middle - share * along).tolist(),
                     "end": (middle + (1 - share) * along).tolist()}
        if kind in ("rod", "rope"):
            where["on_b"] = self.spot()
        return self.add("joints", type=kind, a=a, b=b, **where, **more)

    def floor(self, body: str) -> None:
        """A floor under a disc of the body, a little below or a little above where it will be."""
        at = next(one for one in self.bodies if one["name"] == body)
        at["shapes"] = [{"type": "circle", "radius": RADIUS}]
        at["centre"] = (0.0, 0.0)
        gap = float(self.rng.choice([-2e-6, 1e-7, 2e-5, 1e-4]))
        y = at["at"][1] + H / 2 * at["velocity"][1]
        top = y - RADIUS - gap
        name = f"floor{len(self.floors)}"
        friction = float(self.rng.choice([0.0, 0.1, 0.5, 1.0]))
        self.bodies.append(fixed(name, shapes=[
            {"type": "box", "size": (9.0, 0.02), "at": (0.0, top - 0.01)}]))
        self.elements["contacts"].append({"between": (body, name), "friction": friction})
        self.floors.append((body, top, friction))

    def value(self, x: float) -> float:
        self.drive.append(x)
        return x

    def machine(self) -> Mechanism:
        return mechanism(gravity=(1.0, -G), bodies=self.bodies, **self.elements)


def bilateral(seed: int) -> Made:
    """Joints of all kinds with a loop, springs and cords of all kinds, torques and forces."""
    made = Made(seed)
    rng = made.rng
    made.joint(str(rng.choice(["slot", "weld", "pin"])), "b1", "b2")
    made.joint("rod", str(rng.choice(["wall", "mover", "b0"])), "b2")
    made.joint("slot", str(rng.choice(["wall", "b2"])), "b3", turns=bool(rng.integers(2)))
    for ends in (("b0", "b3"), ("wall", "b1")):
        made.spring(*ends, stiffness=float(10 ** rng.uniform(1, 4)))
    hinge = made.elements["joints"][1]["name"]
    made.add("springs", type="rotary", joint=hinge, stiffness=0.05, damping=made.maybe(1e-3),
             rest_angle=0.2)
    for stiffness in (10 ** rng.uniform(1, 3), 1e5):
        made.cord("wall", "b1", "b3", stiffness=stiffness)
    for n in (2, 3):  # soft or stiff by what a drive sets, with another stiffness of their own
        made.cord("wall", "b2", stiffness=50.0)
        made.add("drives", type="stiffness", tendon=f"t{n}",
                 value=made.value(float(10 ** rng.uniform(0, 5))))
    made.elements["tendons"].append(cord("pulled", ("mover",), ("b0", made.spot()), ("b2",)))
    made.add("drives", type="torque", joint=hinge, value=made.value(0.1))
    made.add("drives", type="force", body="b2", at=made.spot(), direction=(0.6, 0.8),
             frame=str(rng.choice(["body", "world"])), value=made.value(0.7))
    made.add("drives", type="pull", tendon="pulled", value=made.value(2.0))
    return made


def bounded(seed: int) -> Made:
    """Limits that are reached and not, ropes, motors and brakes weak and strong, two contacts."""
    made = Made(seed, contacts=2)
    rng = made.rng
    first, second = made.elements["joints"]
    driven = bool(rng.integers(2))
    for joint in (second,) if driven else (first, second):
        if rng.integers(2):
            turn = made.at[joint["b"]][2] - made.at[joint["a"]][2]
            angle = turn if joint["positive"] == "counterclockwise" else -turn
            joint["limits"] = (angle - 1e-4, angle + 1e-4)
    made.joint("rope", "b1", "b2", longest=float(rng.uniform(0.05, 0.6)))
    made.joint("slot", "b1", "b3", turns=True)
    if driven:  # not on a hinge with stops: how the two share a load is not decided
        made.add("drives", type=str(rng.choice(["motor", "brake"])), joint=first["name"],
                 value=made.value(float(10 ** rng.uniform(-3, 0))))
        if made.elements["drives"][-1]["type"] == "motor":
            made.elements["drives"][-1]["torque"] = float(10 ** rng.uniform(-3, 1))
    made.cord("wall", "b2", stiffness=1e5)
    return made


def compare(made: Made, steps: int, rtol: float) -> None:
    """Step the engine; at each step's pose and velocities its answer must be the truth's."""
    bench = Bench(made.machine())
    model, number = bench.world.model, bench.world.number
    springs = bench.constants.springs
    straight = (springs["number"] >= 0) & (springs["turning"] == 0)
    kinds = {"springs": springs["kind"][straight].tolist(),
             "cords": bench.constants.cords["kind"].tolist()}
    discs = tuple(Disc(model.names.body[body], RADIUS, top, friction)
                  for body, top, friction in made.floors)
    speeds = np.array([[0.1, -0.2, 0.4]])
    given = np.zeros((len(number), 3))
    given[model.names.body["mover"]] = speeds
    for _ in range(steps):
        bench.step(*made.drive, speeds=speeds)
        pose, before = bench.state.body[number, :3], bench.result.before[number]
        step = Step(model, H, pose, before, drive=made.drive, given=given,
                    kinds={key: list(value) for key, value in kinds.items()}, discs=discs)
        truth = step.answer(bench.result.velocity[number])
        assert truth
        off = np.abs(bench.result.velocity[number] - truth.velocity).max()
        scale = max(1.0, np.abs(truth.velocity).max())
        if scale * H > 0.1:
            break  # near a singular pose a step turns too far for joints to close in three tries
        assert off < rtol * scale + 2 * CLOSED / H * truth.sway


def seeds(daily: int, nightly: int) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("seed", [
        *range(daily), *(pytest.param(seed, marks=pytest.mark.nightly)
                         for seed in range(daily, nightly))])


@seeds(12, 60)
def test_bilateral_mechanisms(seed: int) -> None:
    """The tolerance is the gap that joints may keep, and rounding."""
    compare(bilateral(seed), steps=3, rtol=1e-9)


@seeds(20, 150)
def test_bounded_mechanisms(seed: int) -> None:
    """Tangential rows have a compliance of 1e-7 of the slip."""
    compare(bounded(seed), steps=6, rtol=1e-6)
