"""A mechanism as a MuJoCo model (MJCF): the same bodies, joints, tendons, contacts and drives.

The plane is x-y and z points at the viewer, so that a hinge turns about z. Joints that close loops
are equality constraints, contacts are explicit pairs. Units are SI, names are the scene's.

A body in a groove, welded or pinned to a body of the kinematic tree becomes its child; without such
a joint it moves freely. Grooves come first, since a groove cannot close a loop in MuJoCo, then
welds, then pins. Rods and ropes are tendons. A coordinate is the number that a recording shows; for
a free body x and y are those of the centre of mass. The world is ``NONE``.
"""

from __future__ import annotations

import itertools
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import cast

import numpy as np

import sandbox
from sandbox.elements.tendons import RIGID
from sandbox.errors import SceneError
from sandbox.export.selection import Export, arc_of, contact_pairs, leave_out, without_counterpart
from sandbox.export.tree import Link, freedoms, grow
from sandbox.model.compile import compile_mechanism
from sandbox.model.model import NONE, Model
from sandbox.samples.cables import Frames, Stretches, rest_lengths
from sandbox.samples.loads import pulls_at_start
from sandbox.scene.bodies import Box, Capsule, Circle, Polygon, Role, Shape, Solid
from sandbox.scene.geometry import Vec, corners, reach_of, solids
from sandbox.scene.mechanism import Mechanism
from sandbox.values.signals import Constant, values


def number(value: float) -> str:
    """A number with 12 digits; never ``-0``."""
    return f"{value + 0.0:.12g}" if value else "0"


# of an attribute: a word, a number, or numbers in a row; None leaves it out
Value = str | float | Sequence[float] | None


def add(parent: ET.Element, tag: str, /, **attributes: Value) -> ET.Element:
    """A new element at the end of ``parent``."""
    return ET.SubElement(parent, tag, {
        key: _plain(value) if isinstance(value, str) else
        number(value) if isinstance(value, int | float) else " ".join(map(number, value))
        for key, value in attributes.items() if value is not None})


def _plain(text: str, kept: str = "") -> str:
    """The text with blanks for characters that do not print, except ``kept``."""
    return "".join(c if c.isprintable() or c in kept else " " for c in text)


def comment(text: str) -> ET.Element:
    """A comment; text that XML forbids is replaced."""
    plain = re.sub("-(?=-)", "- ", _plain(text, "\n"))
    return cast("ET.Element", ET.Comment(f" {plain} "))


SECTIONS = ("compiler", "option", "default", "asset", "worldbody", "contact", "equality", "tendon",
            "actuator", "sensor", "keyframe")
WORLD = "world"  # MuJoCo's name of the fixed frame


class Draft:
    """Sections by name, elements on bodies by index (``NONE`` for the world), and notes."""

    MAX_FORCE = 1e6  # a force that no tendon reaches [N], as MuJoCo needs closed ranges

    def __init__(self, model: Model, links: dict[int, Link], loops: list[int]) -> None:
        self.model, self.mechanism, self.links, self.loops = model, model.mechanism, links, loops
        elements = (model.bodies, model.joints, model.springs, model.tendons, model.drives)
        self._taken = {(kind, name) for part in elements for name in (WORLD, *part.name)
                       for kind in ("body", "joint", "site", "geom", "mesh", "sensor")}
        self.root = ET.Element("mujoco", {"model": self.mechanism.name or "mechanism"})
        self.sections = {name: add(self.root, name) for name in SECTIONS}
        # sites and pulleys, until the bodies are written
        self.on_body = {body: ET.Element("body") for body in (NONE, *range(len(model.bodies.name)))}
        self.brakes: dict[int, float] = {}  # torque of a hinge's brake [N m]
        self.driven: set[int] = set()  # hinges with a torque
        self.controls: list[float] = []  # value of every actuator at the end of the run
        self.notes: list[str] = []
        self.body_names = [
            self.unique("body", name) if name == WORLD else name for name in model.bodies.name]
        # coordinates of every body, with unique names
        self.moves = {body: [
            replace(move, name=self.unique("joint", move.name))
            if move.made else move for move in freedoms(model, link)
        ] for body, link in links.items()}

    def unique(self, kind: str, name: str) -> str:
        """A new name of a joint, site ...: ``name``, with ``_`` appended until it is free."""
        while (kind, name) in self._taken:
            name += "_"
        self._taken.add((kind, name))
        return name

    def site(self, body: int, wanted: str, at: Vec = (0.0, 0.0), **more: str | float) -> str:
        """Add a site to a body and return its name."""
        name = self.unique("site", wanted)
        add(self.on_body[body], "site", name=name, pos=(*at, 0.0), **more)
        return name

    @cached_property
    def world_frame(self) -> str:
        """The name of a site with the axes of the world."""
        return self.site(NONE, "frame")

    def sense(self, kind: str, wanted: str, **what: str) -> None:
        """Add a sensor."""
        add(self.sections["sensor"], kind, name=self.unique("sensor", wanted), **what)

    def target(self, drive: int) -> int:
        """The number of the element that a drive acts on."""
        return int(self.model.drives.target[drive])

    def drive_hinge(self, drive: int) -> dict[str, str]:
        """Attribute of an actuator of a hinge: its joint, or the tendon of a closed loop."""
        joint = self.target(drive)
        self.driven.add(joint)
        kind = "tendon" if joint in self.loops else "joint"
        return {kind: self.model.joints.name[joint]}

    def angle_sum(self, joint: int) -> tuple[dict[str, float], float]:
        """The angle of a pin that closes a loop [rad]: factors of coordinates, and an offset."""
        sense, factors = float(self.model.joints.sense[joint]), dict[str, float]()
        a, b = self.model.joints.bodies[joint].tolist()
        offset = float(self.model.joints.start[joint])
        for body, side in ((b, sense), (a, -sense)):
            while body != NONE:
                for move in self.moves[body]:
                    if move.kind == "hinge":
                        factor = side * move.axis[2]
                        factors[move.name] = factors.get(move.name, 0.0) + factor
                        offset -= factor * move.start
                body = self.links[body].parent
        return {name: factor for name, factor in factors.items() if factor}, offset

    def final_value(self, drive: int) -> float:
        """Value of a drive at the end of the run, SI."""
        signal = self.mechanism.drives[drive].signal(self.mechanism)
        end = np.array([self.mechanism.run.duration])
        return float(values(signal, end, self.mechanism.functions)[0])

    def motor(
        self, drive: int, what: str = "motor", gives: str = "value", **attributes: Value,
    ) -> None:
        """Add a drive's actuator, whose force is its quantity ``gives``; note a varying value."""
        section, name = self.sections["actuator"], self.model.drives.name[drive]
        signal = self.mechanism.drives[drive].signal(self.mechanism)
        end = self.final_value(drive)
        if not isinstance(signal, Constant):
            law = signal.model_dump_json(exclude_defaults=True)
            section.append(comment(f"{name} over time: {law}; {number(end)} at the end of the run"))
            self.notes.append(f"{name}: MuJoCo has no signals over time; the keyframe has the last "
                              f"value, {number(end)}")
        add(section, what, name=name, **attributes)
        self.controls.append(max(end, float(self.model.drives.floor[drive])))
        self.sense("actuatorfrc", f"{name}.{gives}", actuator=name)


# solimp: the hardest constraint that MuJoCo allows, whatever its depth
STIFFNESS = "0.9999 0.9999 0.001 0.5 2"


def write_mjcf(mechanism: Mechanism, without: Sequence[str] = ()) -> Export:
    """Write a MuJoCo model."""
    kept, left_out = leave_out(mechanism, without)
    model = compile_mechanism(kept)
    links, loops = grow(model)
    if problems := without_counterpart(model, loops):
        raise SceneError(problems)
    draft = Draft(model, links, loops)
    add_springs(draft)
    step = min(kept.run.step, add_tendons(draft))
    add_links(draft)
    for steering in (*kept.controllers, *kept.events):
        draft.notes.append(f"{steering.name}: MuJoCo has no controllers and no events; the drives "
                           "keep their own signals")
    for i, drive in enumerate(kept.drives):
        drive.write_mujoco(draft, i)
    for joint in draft.loops:
        if model.joints.angle[joint]:
            _add_closing_angle(draft, joint)
    sense_bodies(draft)
    geoms = add_bodies(draft)
    for a, b, friction in contact_pairs(model):
        for one, other in itertools.product(geoms[a], geoms[b]):
            add(draft.sections["contact"], "pair", geom1=one, geom2=other,
                condim="3" if friction else "1",  # 1 has no friction
                friction=(friction, friction) if friction else None)
    made = {move.name: move for own in draft.moves.values() for move in own}
    moves = [made[each.attrib["name"]] for each in draft.sections["worldbody"].iter("joint")]
    if moves or draft.controls:  # pose and speeds at t = 0, controls at the end of the run
        add(draft.sections["keyframe"], "key", name="start",
            qpos=[move.start for move in moves] or None,
            qvel=[move.rate for move in moves] if any(move.rate for move in moves) else None,
            ctrl=draft.controls or None)
    _add_settings(draft, step)
    if step < kept.run.step:
        draft.notes.append(f"an elastic tendon takes a time step of {number(step)} s here, "
                           f"not {number(kept.run.step)} s")
    for section in list(draft.root):
        if not len(section) and not section.attrib and not section.text:
            draft.root.remove(section)
    ET.indent(draft.root, "  ")
    return Export(ET.tostring(draft.root, encoding="unicode") + "\n", tuple(draft.notes), left_out)


def _add_settings(draft: Draft, step: float) -> None:
    mechanism, sections = draft.mechanism, draft.sections
    head = (f"{mechanism.title or mechanism.name or 'A mechanism'}; written by sandbox "
            f"{sandbox.__version__}. SI units; the plane is x-y.")
    draft.root.insert(0, comment(head))
    sections["compiler"].attrib.update(angle="radian", autolimits="true", inertiafromgeom="false")
    sections["option"].attrib.update(
        timestep=number(step),
        gravity=f"{number(mechanism.gravity[0])} {number(mechanism.gravity[1])} 0",
        integrator="implicitfast", cone="elliptic",
        impratio="10",  # of friction to normal force: contacts creep less if it is large
        solver="Newton", iterations="200", tolerance="1e-12")
    hard = f"{number(2 * step)} 1"  # the shortest time constant that MuJoCo takes
    defaults = sections["default"]
    # brakes creep, as friction does in MuJoCo: keep it small
    friction = {"solreffriction": hard, "solimpfriction": STIFFNESS} if draft.brakes else {}
    add(defaults, "joint", solreflimit=hard, solimplimit=STIFFNESS, **friction)
    add(defaults, "geom", contype="0", conaffinity="0")
    add(defaults, "site", size=0.0008, rgba="0.2 0.2 0.2 1")
    add(defaults, "tendon", solreflimit=hard, solimplimit=STIFFNESS, **friction)
    add(defaults, "equality", solref=hard, solimp=STIFFNESS)
    # sliding contacts chatter less with twice that time constant
    add(defaults, "pair", solref=f"{number(4 * step)} 1", solimp=STIFFNESS)


COLOURS: dict[Role, str] = {
    "link": "0.55 0.6 0.66 1", "ground": "0.5 0.5 0.5 1", "palm": "0.6 0.55 0.5 1",
    "phalanx": "0.88 0.74 0.6 1", "rocker": "0.45 0.6 0.75 1", "pulley": "0.45 0.6 0.75 1",
    "object": "0.5 0.7 0.5 1",
}
MARGIN = 1.05  # radius of the site of a touch sensor, relative to that of the body's shapes


def add_bodies(draft: Draft) -> dict[int, list[str]]:
    """Add all bodies to the world; return the names of each body's geoms."""
    world = draft.sections["worldbody"]
    add(world, "light", pos=(0, 0, 1), dir=(0, 0, -1), directional="true")
    places: dict[int, ET.Element] = {NONE: world}
    geoms: dict[int, list[str]] = {}
    for index, link in draft.links.items():
        x, y, angle = link.pose
        place = add(places[link.parent], "body", name=draft.body_names[index], pos=(x, y, 0.0),
                    euler=(0.0, 0.0, angle) if angle else None)
        places[index] = place
        bodies = draft.model.bodies
        if bodies.free[index]:
            # only the rotation about z matters; three equal values satisfy the triangle inequality
            add(place, "inertial", pos=(*bodies.centre[index].tolist(), 0.0),
                mass=float(bodies.mass[index]), diaginertia=(float(bodies.inertia[index]),) * 3)
        for move in draft.moves[index]:
            law = hinge_law(draft, move.joint) if move.joint != NONE else {}
            if move.loss:
                law["frictionloss"] = move.loss
            add(place, "joint", name=move.name, type=move.kind, axis=move.axis,
                pos=(*move.at, 0.0) if move.kind == "hinge" else None,
                ref=move.start or None, range=move.limits, **law)
        body = draft.mechanism.bodies[index]
        parts = [(solid, depth(shape)) for shape in body.shapes for solid, _ in solids(shape)]
        geoms[index] = []
        for i, (solid, half) in enumerate(parts):
            name = body.name if len(parts) == 1 else draft.unique("geom", f"{body.name}.{i}")
            geoms[index].append(name)
            add(place, "geom", name=name, rgba=COLOURS[body.role],
                **_geom(draft, name, solid, half))
    for index, place in places.items():
        place.extend(draft.on_body[index])
    return geoms


def _geom(draft: Draft, wanted: str, solid: Solid, half: float) -> dict[str, Value]:
    match solid:
        case Circle():
            return {"type": "sphere", "size": solid.radius, "pos": (*solid.at, 0.0)}
        case Capsule() if solid.start == solid.end:
            return {"type": "sphere", "size": solid.radius, "pos": (*solid.end, 0.0)}
        case Capsule():
            return {"type": "capsule", "size": solid.radius,
                    "fromto": (*solid.start, 0.0, *solid.end, 0.0)}
        case Box():
            return {"type": "box", "size": (solid.size[0] / 2, solid.size[1] / 2, half),
                    "pos": (*solid.at, 0.0),
                    "euler": (0.0, 0.0, solid.angle) if solid.angle else None}
        case Polygon():
            mesh = draft.unique("mesh", wanted)
            add(draft.sections["asset"], "mesh", name=mesh, vertex=[
                value for z in (-half, half) for x, y in corners(solid) for value in (x, y, z)])
            return {"type": "mesh", "mesh": mesh}


def depth(shape: Shape) -> float:
    """Half the depth of a prism [m]: half its size, so that prisms separate in the plane; or 0."""
    if not isinstance(shape, Box | Polygon):
        return 0.0
    points = corners(shape)
    return max(math.dist(p, q) for p in points for q in points) / 2


def sense_bodies(draft: Draft) -> None:
    """Add sensors for the quantities of bodies and hinges, and sites for contact forces."""
    for index, body in enumerate(draft.mechanism.bodies):
        if not draft.model.bodies.free[index]:
            continue
        own = draft.body_names[index]
        draft.sense("framepos", f"{body.name}.position", objtype="xbody", objname=own)
        draft.sense("framexaxis", f"{body.name}.xaxis", objtype="xbody", objname=own)
        draft.sense("framelinvel", f"{body.name}.velocity", objtype="body", objname=own)
        draft.sense("frameangvel", f"{body.name}.omega", objtype="body", objname=own)
        if body.shapes:
            centre = draft.model.bodies.centre[index].tolist()
            radius = math.hypot(  # of a ball around all shapes, with the depth of prisms [m]
                reach_of(body, centre), max(map(depth, body.shapes)))
            site = draft.site(index, f"{body.name}.skin", centre, size=MARGIN * radius, group="5")
            draft.sense("touch", f"{body.name}.contact.normal", site=site)
    for moves in draft.moves.values():
        for move in moves:
            if move.joint == NONE:
                continue
            draft.sense("jointpos", f"{move.name}.angle", joint=move.name)
            draft.sense("jointvel", f"{move.name}.rate", joint=move.name)
            if move.limits is not None:
                draft.sense("jointlimitfrc", f"{move.name}.stop", joint=move.name)


FAR = 1e6  # A length that no spring reaches [m], as MuJoCo needs closed ranges


def route(draft: Draft, cable: ET.Element, name: str, ends: Iterable[tuple[int, Vec]]) -> None:
    """Route a spatial tendon through points of bodies."""
    for i, (body, at) in enumerate(ends):
        add(cable, "site", site=draft.site(body, f"{name}.{i}", at))


def add_links(draft: Draft) -> None:
    """Add rods, ropes and actuators as tendons, then the joints that close loops as sites."""
    model, joints = draft.model, draft.model.joints
    bodies, anchors = joints.bodies.tolist(), joints.anchor.tolist()
    for joint in np.flatnonzero([kind.along_line for kind in joints.kind]).tolist():
        name, (a, b), (on_a, on_b) = joints.name[joint], bodies[joint], anchors[joint]
        low, high = joints.reach[joint].tolist()
        stiff, free = low == high, low == 0.0 and high == math.inf
        cable = add(draft.sections["tendon"], "spatial", name=name,
                    range=None if stiff or free else (low, min(high, FAR)), width=0.0005)
        route(draft, cable, name, ((a, on_a), (b, on_b)))
        draft.sense("tendonpos", f"{name}.length", tendon=name)
        if stiff:
            start = math.dist(*model.ends(joint))
            add(draft.sections["equality"], "tendon", name=name, tendon1=name,
                polycoef=(high - start, 0, 0, 0, 0))
        elif not free:
            draft.sense("tendonlimitfrc", f"{name}.reaction", tendon=name)
    for joint in draft.loops:  # of a weld the site on a is rotated
        name, (a, b), (on_a, on_b) = joints.name[joint], bodies[joint], anchors[joint]
        turns = joints.turns[joint]
        angle = 0.0 if turns else float(model.bodies.pose[b, 2] - model.bodies.pose[a, 2])
        more = {"euler": f"0 0 {angle:.12g}"} if angle else {}
        add(draft.sections["equality"], "connect" if turns else "weld", name=name,
            site1=draft.site(a, f"{name}.a", on_a, **more),
            site2=draft.site(b, f"{name}.b", on_b))


def hinge_law(draft: Draft, joint: int) -> dict[str, float]:
    """Stiffness, rest angle, damping and friction of a pin with its springs and brake."""
    springs, law = draft.model.springs, dict[str, float]()
    own = springs.joint == joint
    if stiffness := float(springs.stiffness[own].sum()):
        law["stiffness"] = stiffness
        law["springref"] = float(springs.stiffness[own] @ springs.rest[own]) / stiffness
    if damping := float(draft.model.hinge_damping[joint]):
        law["damping"] = damping
    if loss := float(draft.model.joints.friction[joint]) + max(draft.brakes.get(joint, 0.0), 0.0):
        law["frictionloss"] = loss
    return law


def _add_closing_angle(draft: Draft, joint: int) -> None:
    """Add a fixed tendon with the spring, damper, brake and stops of a pin that closes a loop."""
    law, joints = hinge_law(draft, joint), draft.model.joints
    limits = joints.stops[joint] if joint in joints.stopped else None
    factors, offset = draft.angle_sum(joint)
    if not factors or not (law or joint in draft.driven or limits is not None):
        return
    rest = law.pop("springref", None)
    cable = add(draft.sections["tendon"], "fixed", name=joints.name[joint], **law,
               springlength=None if rest is None else rest - offset,
               range=None if limits is None else (limits - offset).tolist())
    for name, factor in factors.items():
        add(cable, "joint", joint=name, coef=factor)


FRACTION = 0.2  # maximum time step times omega of an elastic tendon between its free bodies
WHEEL = "0.45 0.6 0.75 0.4"


def add_springs(draft: Draft) -> None:
    """Add all straight springs; others are in the law of their hinge."""
    springs = draft.model.springs
    for spring in np.flatnonzero(springs.straight).tolist():
        name = springs.name[spring]
        ends = zip(springs.bodies[spring].tolist(), springs.anchor[spring].tolist(), strict=True)
        law, rest = springs.law[spring], springs.rest[spring]
        free = rest if law is None else (0.0, rest) if law.side > 0 else (rest, FAR)
        cable = add(draft.sections["tendon"], "spatial", name=name, springlength=free,
                    stiffness=float(springs.stiffness[spring]) or None,
                    damping=float(springs.damping[spring]) or None,
                    rgba="0.6 0.6 0.3 1", width=0.0005)
        route(draft, cable, name, ends)
        draft.sense("tendonpos", f"{name}.length", tendon=name)


def add_tendons(draft: Draft) -> float:
    """Add all tendons; return the largest time step for the elastic ones [s]."""
    tendons, step, stiff = draft.model.tendons, math.inf, []
    rests, pulls = rest_lengths(draft.model).tolist(), pulls_at_start(draft.model)
    start = Frames.at_start(draft.model).cables
    for tendon, name in enumerate(tendons.name):
        law: dict[str, float | tuple[float, float]] = {}
        if tendons.drive[tendon] == NONE:
            rest, stiffness = rests[tendon], float(tendons.stiffness[tendon])
            if stiffness >= RIGID:  # an inextensible tendon
                stiff.append(name)
                law["range"] = (0.0, rest)
                draft.sense("tendonlimitfrc", f"{name}.tension", tendon=name)
            else:
                bodies, (x, y, moment) = draft.model.bodies, pulls[tendon].T
                mobility = float(np.sum(  # J M^-1 J^T of the free bodies [1/kg]
                    (x * x + y * y) / bodies.mass + moment**2 / bodies.inertia,
                    where=bodies.free)) or 1e-12
                step = min(step, FRACTION / math.sqrt(stiffness * mobility))
                if tendons.damping[tendon]:
                    # T = max(k (L - L0) + c L', 0), which a tendon's own law cannot have: the
                    # length of the actuator is -L, so that its force is T; it has no input
                    add(draft.sections["actuator"], "general", name=name, tendon=name, gear=-1.0,
                        gainprm=0.0, biastype="affine",
                        biasprm=(-stiffness * rest, -stiffness, -float(tendons.damping[tendon])),
                        ctrlrange=(0.0, 1.0), forcerange=(0.0, draft.MAX_FORCE))
                    draft.controls.append(0.0)
                    draft.sense("actuatorfrc", f"{name}.tension", actuator=name)
                else:
                    law["stiffness"], law["springlength"] = stiffness, (0.0, rest)
        cable = add(draft.sections["tendon"], "spatial", name=name, width=0.0005,
                   rgba="0.75 0.25 0.2 1", **law)
        _thread(draft, cable, tendon, start)
        draft.sense("tendonpos", f"{name}.length", tendon=name)
    if stiff:
        draft.notes.append(
            f"tendons of {RIGID:g} N/m and more do not stretch here: {', '.join(stiff)}")
    return step


def _thread(draft: Draft, cable: ET.Element, tendon: int, start: Stretches) -> None:
    tendons = draft.model.tendons
    path = tendons.guides(tendon)
    for i, guide in enumerate(range(path.start, path.stop)):
        body, at = int(tendons.guide_body[guide]), tendons.guide_at[guide].tolist()
        name, radius = f"{tendons.name[tendon]}.{i}", abs(float(tendons.guide_radius[guide]))
        if not radius:
            add(cable, "site", site=draft.site(body, name, at))
            continue
        middle = arc_of(draft.model, start, guide)[0] - float(draft.model.bodies.pose[body, 2])
        beside = (at[0] + 1.5 * radius * math.cos(middle), at[1] + 1.5 * radius * math.sin(middle))
        wheel = draft.unique("geom", name)
        add(draft.on_body[body], "geom", name=wheel, type="cylinder",
            size=(radius, radius / 4), pos=(*at, 0.0), rgba=WHEEL)
        add(cable, "geom", geom=wheel, sidesite=draft.site(body, f"{name}.side", beside))
