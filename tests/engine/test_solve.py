"""One step of random mechanisms against dense algebra, every kind of element among them."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from sandbox.engine.joint_state import FLANK, LINE, STOP
from sandbox.engine.rows import CLOSED
from sandbox.engine.state import GRIPPED
from sandbox.model.model import Model
from sandbox.scene.mechanism import Mechanism

from .dense import Answer, Disc, Step, com
from .dense_cords import Cord
from .dense_loads import PlainLoad, press, random_loads
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
            "joints": [], "springs": [], "tendons": [], "lines": [], "drives": [], "contacts": [
                {"between": ("*", "*"), "collide": False}]}
        self.drive: list[float] = []
        self.loads: list[Any] = []
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

    def line(self, modulus: float, *chambers: dict[str, Any]) -> None:
        self.elements["lines"].append({
            "name": f"l{len(self.elements['lines'])}", "volume": 1e-5, "modulus": modulus,
            "pressure": 2e5, "chambers": chambers})

    def cylinder(self, a: str, b: str) -> dict[str, Any]:
        return {"type": "cylinder", "a": a, "b": b, "on_a": self.spot(), "on_b": self.spot(),
                "area": float(10 ** self.rng.uniform(-5.5, -4.5)),
                "pulls": bool(self.rng.integers(2))}

    def gripped(self, *bodies: str, closed: bool = False, pulled: bool = False) -> None:
        """Over eyes and wheels that hold it, pretensioned or hanging by up to 1 mm."""
        rng = self.rng
        guides: list[dict[str, Any]] = []
        for k, body in enumerate(bodies):
            inner = closed or 0 < k < len(bodies) - 1
            wheel = rng.integers(2) or not inner
            held = [0.05, 0.3, 1.0] + [0.0] * (k > 1)  # two at least of a loop, one of others
            guides.append({
                "body": body, "at": self.spot(), "side": str(rng.choice(["left", "right"])),
                "radius": float(rng.uniform(1e-3, 8e-3)) if wheel else 0.0,
                "turns": int(rng.integers(2)) if wheel and inner else 0,
                "friction": float(rng.choice(held)) if inner else 0.0})
            if wheel and inner and not guides[-1]["friction"]:
                guides[-1]["turns"] = 1  # else it would be lifted off, which has tests of its own
        places = [self.world(guide["body"], guide["at"]) for guide in guides]
        for k, (one, two) in enumerate(itertools.pairwise([*places, places[0]])):
            if np.hypot(*(two - one)) < 0.02:  # their wheels would meet
                at = guides[(k + 1) % len(guides)]
                at["radius"] = guides[k]["radius"] = 0.0
        name = f"t{len(self.elements['tendons'])}"
        stiffness = float(10 ** rng.uniform(2, 5.5))
        tight = ({"slack": 1e-3} if rng.random() < 0.2 else
                 {"pretension": float(10 ** rng.uniform(-1, 1))})
        self.elements["tendons"].append({
            "name": name, "guides": guides, "closed": closed, "stiffness": stiffness,
            "damping": self.maybe(1.0), **tight})
        if pulled:
            self.add("drives", type="pull", tendon=name, value=self.value(
                float(rng.choice([0.0, 0.5, 5.0]))))

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

    def mesh(self, a: str, b: str, kind: str = "gear", *, inside: bool = False) -> str:
        """Teeth or circles that meet at t = 0, wherever their bodies are."""
        on_a, on_b = self.spot(), self.spot()
        way = self.world(b, on_b) - self.world(a, on_a)
        apart, share = float(np.hypot(*way)), float(self.rng.uniform(0.2, 0.8))
        radii = {"radius_a": share * apart, "radius_b": (1 - share) * apart}
        if inside:
            radii = {"radius_a": share * apart, "radius_b": (1 + share) * apart}
            if self.rng.integers(2):
                radii = {"radius_a": radii["radius_b"], "radius_b": radii["radius_a"]}
        more: dict[str, Any] = {"inside": inside, **radii}
        if kind == "rack":
            along = self.rng.uniform(-1, 1, 2)
            there = self.at[b][2]
            c, s = np.cos(there), np.sin(there)
            x, y = c * along[0] - s * along[1], s * along[0] + c * along[1]
            more = {"along": along.tolist(), "radius": float(
                abs(x * way[1] - y * way[0]) / np.hypot(x, y))}
        if kind != "roll":
            more["stiffness"] = float(10 ** self.rng.uniform(5, 9))
            more["pressure_angle"] = float(self.rng.uniform(0.2, 0.5))
            more["backlash"] = float(self.rng.choice([0.0, 1e-4]))
        return self.add("joints", type=kind, a=a, b=b, on_a=on_a, on_b=on_b, **more)

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
    for modulus in (10 ** rng.uniform(6, 8), 10 ** rng.uniform(9, 10)):
        made.line(float(modulus), made.cylinder("b0", "b3"), made.cylinder("wall", "b2"),
                  {"type": "vane", "joint": hinge, "displacement": float(rng.normal(0, 1e-6))})
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


def driven(seed: int) -> Made:
    """Servos soft, stiff and rigid, weak and strong; actuators that swing, pushed and told."""
    made = Made(seed)
    rng = made.rng
    hinges = list(made.elements["joints"])
    made.joint(str(rng.choice(["pin", "slot"])), "b1", "b2")
    for hinge in hinges:
        law = {"stiffness": float(10 ** rng.uniform(-3, 5)), "damping": made.maybe(1e-2)}
        if rng.integers(2):
            made.add("drives", type="servo", joint=hinge["name"], value=made.value(0.3),
                     torque=float(10 ** rng.uniform(-3, 2)), **law)
            continue
        # so strong that it never has to brake in time, and near its target
        turn = made.at[hinge["b"]][2] - made.at[hinge["a"]][2]
        angle = turn if hinge["positive"] == "counterclockwise" else -turn
        made.add("drives", type="servo", joint=hinge["name"], torque=1e9,
                 value=float(angle - hinge.get("zero", 0.0) + rng.normal(0, 1e-5)))
        made.drive.append(made.elements["drives"][-1]["value"])
    rods = [made.joint("actuator", *ends) for ends in (("wall", "b2"), ("b1", "b3"), ("b2", "b3"))]
    made.add("drives", type="push", joint=rods[0], value=made.value(3.0))
    made.add("drives", type="extend", joint=rods[1], value=made.value(0.2),
             force=float(10 ** rng.uniform(-2, 3)))
    made.add("drives", type="length", joint=rods[2], value=abs(made.value(0.3)),
             force=float(10 ** rng.uniform(-1, 3)), stiffness=float(10 ** rng.uniform(0, 5)),
             damping=made.maybe(3.0))
    made.drive[-1] = abs(made.drive[-1])
    return made


def wheeled(seed: int) -> Made:
    """Gears outside and inside, a rack, circles that roll, on the chain and on what moves."""
    made = Made(seed)
    rng = made.rng
    made.mesh(str(rng.choice(["b0", "b1", "wall"])), "b2", inside=bool(rng.integers(2)))
    made.joint(str(rng.choice(["pin", "slot"])), "b1", "b2")
    kind = str(rng.choice(["rack", "roll", "gear"]))
    made.mesh(str(rng.choice(["b2", "mover", "b1"])), "b3", kind, inside=bool(rng.integers(2)))
    made.spring("b0", "b3", stiffness=float(10 ** rng.uniform(1, 4)))
    made.add("drives", type="torque", joint=made.elements["joints"][1]["name"],
             value=made.value(0.1))
    return made


def roped(seed: int) -> Made:
    """Cords over guides that hold them, fixed, moved and turning: tied, pulled, and a loop."""
    made = Made(seed)
    rng = made.rng
    made.joint(str(rng.choice(["slot", "pin"])), "b1", "b2")
    made.spring("b0", "b3", stiffness=float(10 ** rng.uniform(1, 4)))
    bodies = ["wall", "mover", "b0", "b1", "b2", "b3"]
    for closed, pulled in ((False, False), (False, True), (True, False)):
        count = int(rng.integers(3, 6))
        path = [str(body) for body in rng.choice(bodies, count, replace=False)]
        made.gripped(*path, closed=closed, pulled=pulled)
    return made


def rubbed(seed: int) -> Made:
    """Hinges and grooves with dry friction of both kinds, still and moving, a motor with a line.

    What a schedule pushes over a floor along a groove that rubs may jam, which no force undoes: one
    of them only.
    """
    dice = np.random.default_rng(seed)
    pushed = bool(dice.integers(2))
    made = Made(seed, contacts=0 if pushed else 1, speed=float(dice.choice([0.0, 0.3])))
    rng = made.rng
    first, second = made.elements["joints"]
    if rng.integers(2):
        first |= {"friction": float(10 ** rng.uniform(-3, 1)), "static": 1.5}
    second |= {"friction_coefficient": float(rng.uniform(0.05, 0.5)),
               "pin_radius": float(rng.uniform(1e-3, 2e-2)),
               "static": float(rng.choice([1.0, 1.2]))}
    coefficient = bool(rng.integers(2))
    made.joint("slot", "mover" if pushed else "b1", "b2", turns=bool(rng.integers(2)), **(
        {"friction_coefficient": float(rng.uniform(0.05, 0.4))} if coefficient else
        {"friction": float(10 ** rng.uniform(-2, 1))}))
    made.joint("slot", "wall", "b3", turns=True, friction_coefficient=0.3)
    made.spring("b0", "b3", stiffness=float(10 ** rng.uniform(1, 4)))
    if rng.integers(2):
        made.add("drives", type="motor", joint=first["name"], stall=float(10 ** rng.uniform(-3, 1)),
                 no_load=float(10 ** rng.uniform(0, 2)), value=made.value(3.0),
                 **({"torque": float(10 ** rng.uniform(-2, 0))} if rng.integers(2) else {}))
    return made


def loaded(seed: int) -> Made:
    """Loads by laws of all kinds, soft and stiff, on a chain, a spring and a contact."""
    made = Made(seed)
    rng = made.rng
    made.floor("b3")
    # no slot, no floor for b2: mud slows how its overlaps go, and the truth does not know of that
    made.joint(str(rng.choice(["rod", "pin"])), "b1", "b2")
    made.spring("b0", "b3", stiffness=float(10 ** rng.uniform(1, 4)))
    made.elements["loads"], made.loads = random_loads(rng)
    return made


def plain_loads(made: Made, model: Model) -> list[PlainLoad]:
    """The loads of a random mechanism as the truth has them."""
    found = []
    for name, at, turning, law in made.loads:
        body = model.names.body[name]
        arm = np.zeros(2) if at is None else at - model.bodies.centre[body]
        found.append(PlainLoad(body, arm, turning, law(model.bodies.mass[body])))
    return found


def compare(made: Made, steps: int, rtol: float) -> None:
    """Step the engine; at each step's pose and velocities its answer must be the truth's."""
    bench = Bench(made.machine())
    model, number = bench.world.model, bench.world.number
    kinds = {"springs": bench.constants.springs["kind"].tolist(),
             "cords": bench.constants.cords["kind"].tolist(),
             "lines": bench.constants.fluids["kind"].tolist()}
    discs = tuple(Disc(model.names.body[body], RADIUS, top, friction)
                  for body, top, friction in made.floors)
    speeds = np.array([[0.1, -0.2, 0.4]])
    given = np.zeros((len(number), 3))
    given[model.names.body["mover"]] = speeds
    cords = bench.constants.cords
    grips = {int(t): Cord(model, int(t), com(model))
             for t in np.flatnonzero(cords["kind"] == GRIPPED)}
    loads, on = plain_loads(made, model), bench.world.order[bench.constants.loaded["body"]]
    motors = bench.constants.motors
    for k in range(steps):
        targets = bench.state.motors["target"] / motors["sense"] - motors["zero"]
        rest = bench.state.cords["rest"].copy()
        flank = bench.state.joints["flank"].copy()
        rubs, own = bench.constants.rubs["joint"], bench.state.rubs
        slips, stays = own["mode"] != 0, (own["mode"] == 0) & (own["kept"] == 1)
        apart = {"slid": rubs[slips].tolist(),
                 "kept": dict(zip(rubs[stays].tolist(), own["place"][stays], strict=True))}
        bench.step(*made.drive, speeds=speeds)
        pose, before = bench.state.body[number, :3], bench.result.before[number]
        step = Step(model, H, pose, before, drive=made.drive, given=given,
                    kinds={key: list(value) for key, value in kinds.items()}, discs=discs,
                    flank=flank, **apart, servos=dict(zip(motors["drive"].tolist(), zip(
                        targets.tolist(), motors["stiff"].tolist(), strict=True), strict=True)),
                    slips=slid(bench), grips=tuple(
                        (grip, rest[cords["spans"][t]:cords["spans_end"][t]].tolist())
                        for t, grip in grips.items()))
        stiff = set(on[bench.result.loaded["stiff"] == 1].tolist())
        step.force += press(loads, pose, before, bench.result.velocity[number], H, (k + 0.5) * H,
                            stiff)
        truth = step.answer(bench.result.velocity[number])
        assert truth
        off = np.abs(bench.result.velocity[number] - truth.velocity).max()
        scale = max(1.0, np.abs(truth.velocity).max())
        if scale * H > 0.1:
            break  # near a singular pose a step turns too far for joints to close in three tries
        assert off < rtol * scale + 2 * CLOSED / H * truth.sway[0]
        forces(bench, truth, rtol)


def slid(bench: Bench) -> np.ndarray:
    """What the engine lets slide over each guide [m/s]; nan where its cord hangs."""
    hangs = bench.state.cords["active"][bench.constants.slips["cord"]] == 0
    return np.where(hangs, np.nan, bench.result.slips["rate"])


def forces(bench: Bench, truth: Answer, rtol: float) -> None:
    """What the engine reports of each element is the impulse that it gave."""
    most = max([abs(p) for p in truth.impulse.values()], default=0.0)
    for name, p in truth.impulse.items():
        off = 100 * rtol * most + 2 * CLOSED / H * truth.sway[1][name]
        assert reported(bench, name) == pytest.approx(p, abs=off), name


def reported(bench: Bench, name: tuple[Any, ...]) -> float:
    """The impulse of an element as the tables have it, in the sense of the dense equations."""
    kind, i = name[:2]
    model, constants, result, state = (
        bench.world.model, bench.constants, bench.result, bench.state)
    limits = constants.limits
    held = state.limits["impulse"] * (limits["joint"] == i)
    match kind:
        case "cord":
            return float(H * result.cords["tension"][i])
        case "fluid":
            return float(H * result.fluids["pressure"][i])
        case "span":
            return float(H * result.cords["tension"][i])
        case "slip":
            return float(result.slips["rate"][i])
        case "spring":
            return float(H * result.springs["force"][bench.tables.straight == i][0])
        case "damper":
            return float(H * (model.joints.sense[i] * state.dampers["torque"])[
                constants.dampers["joint"] == i][0])
        case "drive":
            return float((constants.motors["sense"] * state.motors["impulse"])[
                constants.motors["drive"] == i][0])
        case "rub":
            sense = 1.0 if np.isnan(model.joints.sense[i]) else model.joints.sense[i]
            return float(sense * state.rubs["impulse"][constants.rubs["joint"] == i][0])
        case "stop" | "line":
            return float(held[limits["what"] == (STOP if kind == "stop" else LINE)].sum())
        case "flank":
            return float(held[(limits["what"] == FLANK) & (limits["side"] == name[2])].sum())
        case "contact":  # from the disc, which has the lower number, to the floor
            touches = state.touches[:state.touching[0]]
            own = touches[touches["b"] == bench.number(f"floor{i}")]
            return float(own["normal"].sum() if name[2] == "n" else -own["tangent"].sum())
    joint = result.joints[i]
    if kind == "turn":
        return float(H * joint["couple"])
    # a limit's force along the line is a part of its joint's
    along = held * limits["side"] * (limits["what"] == LINE)
    x, y = H * joint["fx"] - along.sum() * joint["dx"], H * joint["fy"] - along.sum() * joint["dy"]
    if kind == "roll":
        ra, rb = model.joints.radii[i]
        around = -1.0 if model.joints.inside[i] and rb > ra else 1.0
        return float(around * (x * joint["dy"] - y * joint["dx"]))
    if kind in ("joint", "teeth"):
        across = model.joints.kind[i].keeps == "groove"
        return float(joint["dx"] * y - joint["dy"] * x if across else
                     joint["dx"] * x + joint["dy"] * y)
    return float({"jointx": x, "jointy": y}[kind])


@pytest.mark.parametrize("seed", range(60))
def test_bilateral_mechanisms(seed: int) -> None:
    """To what joints may be left open, and rounding; twice that, as how far they bend is bounded
    and not worked out.
    """
    compare(bilateral(seed), steps=3, rtol=1e-9)


@pytest.mark.parametrize("seed", range(150))
def test_bounded_mechanisms(seed: int) -> None:
    """The same with rows that may let go; tangential ones give way by 1e-7 of the slip."""
    compare(bounded(seed), steps=6, rtol=1e-6)


@pytest.mark.parametrize("seed", range(60))
def test_loads(seed: int) -> None:
    """The same of loads, which are found to 1e-10 of their sizes."""
    compare(loaded(seed), steps=6, rtol=1e-6)


def test_random_loads_are_taken_both_ways() -> None:
    """Else the comparison would leave one of them out."""
    ways = set()
    for seed in range(12):
        made = loaded(seed)
        bench = Bench(made.machine())
        bench.step(*made.drive, speeds=np.zeros((1, 3)))
        ways |= set(bench.result.loaded["stiff"].tolist())
    assert ways == {0, 1}


@pytest.mark.parametrize("seed", range(80))
def test_servos_and_actuators(seed: int) -> None:
    """The same of what goes to a place and of what acts along a line that turns."""
    compare(driven(seed), steps=6, rtol=1e-6)


@pytest.mark.parametrize("seed", range(80))
def test_wheels(seed: int) -> None:
    """The same of teeth with and without play and of circles that roll."""
    compare(wheeled(seed), steps=6, rtol=1e-6)


@pytest.mark.parametrize("seed", range(90))
def test_dry_friction_of_joints(seed: int) -> None:
    """The same of friction that is a number, or hangs on what the joint carries in that step."""
    compare(rubbed(seed), steps=6, rtol=1e-6)


@pytest.mark.parametrize("seed", [*range(90), 98, 147])
def test_cords_over_guides_that_hold_them(seed: int) -> None:
    """The same of spans and of what slides between them; the last two need Lemke's method."""
    compare(roped(seed), steps=6, rtol=1e-6)
