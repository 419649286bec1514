"""Names that must lead somewhere: every reference of a mechanism, and every name once.

The models see one element at a time; here the mechanism is seen as a whole.
"""

from __future__ import annotations

import fnmatch
import itertools
import re
from collections.abc import Collection, Iterator, Mapping
from types import SimpleNamespace
from typing import Any

from sandbox.elements.drives import Drive, PullDrive, RadiusDrive, StiffnessDrive, kind_of
from sandbox.elements.fluids import Cylinder, Line, Vane
from sandbox.elements.kinds import (
    DRIVES,
    JOINTS,
    NAMED,
    RELEASABLE,
    SPRINGS,
    TIES,
    Target,
)
from sandbox.elements.loads import BuoyancyLoad
from sandbox.elements.quantities import GRASP, reserved
from sandbox.elements.springs import Spring
from sandbox.elements.tendons import RIGID
from sandbox.errors import Problem
from sandbox.scene.bodies import Body, Circle
from sandbox.scene.check.control import check_control
from sandbox.scene.check.signals import check_signals
from sandbox.scene.check.ties import check_ties
from sandbox.scene.fluids import volume_of
from sandbox.scene.layers import BY_ROLE, EVERY, meant
from sandbox.scene.mechanism import Mechanism, borne
from sandbox.values.ranges import size_fault
from sandbox.wording import MOST_NAMED, NearMisses, is_pattern, listed, quoted


def check_references(
    mechanism: Mechanism, *, assumed: Collection[str] = ()
) -> list[Problem]:
    """Every name that leads nowhere, stands twice or means two things; signals without a value.

    Paths are those of the mechanism (``$.joints[3].a``). Names in ``assumed``,
    and what begins with one of them and a dot, count as known: they belong to
    elements that could not be read. ``"*"`` stands for any name.
    """
    names = _References(mechanism, assumed)
    return [*names.names(), *names.joints(), *names.springs(), *names.tendons(),
            *names.lines(), *names.valves(), *names.loads(), *names.materials(), *names.drives(),
            *names.patterns(), *names.view(), *check_signals(mechanism),
            *check_control(mechanism, names._assumed),
            *check_ties(mechanism, names._assumed, names._none)]


def check_unread(
    unread: Mapping[str, Mapping[int, Any]], mechanism: Mechanism, assumed: Collection[str],
) -> Iterator[Problem]:
    """Names that stand twice or lead nowhere in the data of elements that could not be read.

    ``unread`` has, for each kind, the data by its place in the list, of which the paths of problems
    are; ``mechanism`` lacks them. ``assumed`` is as in :func:`check_references`.
    """
    names = _References(mechanism, assumed)
    taken: dict[str, str] = {}
    for kind in NAMED:
        for element in getattr(mechanism, kind):
            taken.setdefault(element.name, kind)
    for kind, entries in unread.items():
        for i, entry in entries.items():
            if not isinstance(entry, dict):
                continue
            path, name = f"$.{kind}[{i}]", entry.get("name")
            if isinstance(name, str) and kind in NAMED:
                if name in taken:
                    yield _taken(name, kind, taken[name], f"{path}.name")
                taken.setdefault(name, kind)
            for target, data, place in _named(kind, entry, path):
                named = data.get(target.field)
                if target.among == "tendons" and named in names.pulled_groups:
                    continue  # its tendon is meant, whose name it would be given when it is read
                if isinstance(named, str):
                    stand_in: Any = SimpleNamespace(**{"type": "", **data})
                    yield from names._target(stand_in, target, place)


def _named(
    kind: str, entry: dict[str, Any], path: str,
) -> Iterator[tuple[Target, dict[str, Any], str]]:
    """What the data of an element names: by which field, of which object, and where that stands."""
    tag, guides = entry.get("type"), entry.get("guides")
    targets: tuple[Target, ...] = ()
    if kind == "joints":
        targets = (Target("a", "bodies"), Target("b", "bodies"))
    elif kind == "springs" and isinstance(tag, str) and tag in SPRINGS:
        targets = SPRINGS[tag].targets
    elif kind == "drives" and isinstance(tag, str) and tag in DRIVES:
        targets = (DRIVES[tag].target,)
    elif kind == "tendons" and isinstance(guides, list):
        for j, guide in enumerate(guides):
            if isinstance(guide, dict):
                yield Target("body", "bodies"), guide, f"{path}.guides[{j}]"
    for target in targets:
        yield target, entry, path


def _taken(name: str, kind: str, first: str, path: str) -> Problem:
    """A name that an element of a kind has, and one of the ``first`` kind before it."""
    return Problem("duplicate-name", f"the name {quoted(name)} is already that of "
                   f"{'another' if first == kind else 'a'} {NAMED[first].one}", path,
                   allowed="a name of its own for every element")


class _References:
    def __init__(self, mechanism: Mechanism, assumed: Collection[str]) -> None:
        self.mechanism, self.assumed = mechanism, assumed
        first: dict[str, Body] = {}
        for body in mechanism.bodies:
            first.setdefault(body.name, body)
        self.bodies = first
        self.near = NearMisses()
        self.known = {kind: dict.fromkeys(each.name for each in getattr(mechanism, kind))
                      for kind in NAMED}
        self.hinges = dict.fromkeys(
            joint.name for joint in mechanism.joints if JOINTS[joint.type].angle)
        self.actuators = dict.fromkeys(
            joint.name for joint in mechanism.joints if JOINTS[joint.type].line)
        self.pulled_groups = [group.name for group in mechanism.groups
                              if group.kind in ("finger", "rocker_tree", "pulley_tree")]

    def _unknown(self, name: str, known: Collection[str], what: str, path: str, *,
                 also: Collection[str] = ()) -> Iterator[Problem]:
        """A name that is none of the known ones; ``also`` is meant only to be offered."""
        if name not in known and not self._assumed(name):
            yield Problem("name-not-found", f"there is no {what} named {quoted(name)}", path,
                          allowed=listed(known) or self._none(f"there is no {what}"),
                          hint=self.near(name, itertools.chain(known, also)))

    def _none(self, why: str) -> str:
        """That nothing is allowed, unless something could not be read."""
        return "" if self.assumed else f"none: {why}"

    def _target(self, element: Spring | Drive, target: Target, path: str) -> Iterator[Problem]:
        """What a spring or drive acts on; a pull may name the group that its tendon is of."""
        if target.among == TIES:
            known, what = {name: None for kind in RELEASABLE for name in self.known[kind]}, \
                "joint, spring or tendon"
        else:
            known, what = self.known[target.among], NAMED[target.among].one
        name = getattr(element, target.field)
        if (target.hinge and name in self.actuators) or (target.line and name in self.hinges):
            yield self._twin(element, target, name, f"{path}.{target.field}")
            return
        if target.hinge:
            known, what = self.hinges, "pin joint"
        if target.line:
            known, what = self.actuators, "actuator"
        yield from self._unknown(
            name, known, what, f"{path}.{target.field}",
            also=self.pulled_groups if target.among == "tendons" else ())

    def _twin(self, element: Spring | Drive, target: Target, name: str, path: str) -> Problem:
        """What acts on hinges named for an actuator, or the other way round."""
        known, one, acts = (self.hinges, "an actuator", "a hinge") if target.hinge else (
            self.actuators, "a hinge", "an actuator")
        twin = DRIVES[element.type].twin if element.type in DRIVES else ""
        return Problem(
            "name-not-found", f"{quoted(name)} is {one}, and '{element.type}' acts on {acts}", path,
            allowed=listed(known) or f"none: there is no {acts.split()[1]}",
            hint=f"a drive of type '{twin}', which acts on {one}" if twin else "")

    def _assumed(self, name: str) -> bool:
        return bool(self.assumed) and ("*" in self.assumed or any(
            name[:end] in self.assumed
            for end in (*(dot.start() for dot in re.finditer(r"\.", name)), len(name))))

    def names(self) -> Iterator[Problem]:
        """Names that stand twice, or that read like another element's quantity."""
        first: dict[str, tuple[str, str]] = {}
        for kind in NAMED:
            for i, element in enumerate(getattr(self.mechanism, kind)):
                path = f"$.{kind}[{i}].name"
                if element.name in first:
                    yield _taken(element.name, kind, first[element.name][0], path)
                first.setdefault(element.name, (kind, path))
        taken = {kind: reserved(kind) for kind in NAMED}
        objects = {body.name for body in self.mechanism.bodies if body.role == "object"}
        for name, (_, path) in first.items():
            words = name.split(".")
            for count in range(1, len(words)):
                head, quantity = ".".join(words[:count]), ".".join(words[count:])
                if head in first and (quantity in taken[first[head][0]]
                                      or (head in objects and quantity in GRASP)):
                    yield Problem("duplicate-name", f"the name {quoted(name)} also means the "
                                  f"quantity {quoted(quantity)} of {quoted(head)}", path,
                                  allowed="another name")

    def joints(self) -> Iterator[Problem]:
        for i, joint in enumerate(self.mechanism.joints):
            yield from self._unknown(joint.a, self.bodies, "body", f"$.joints[{i}].a")
            yield from self._unknown(joint.b, self.bodies, "body", f"$.joints[{i}].b")
            ends = [self.bodies.get(joint.a), self.bodies.get(joint.b)]
            if all(body is not None and body.motion != "dynamic" for body in ends):
                yield Problem("no-effect",
                              f"neither {quoted(joint.a)} nor {quoted(joint.b)} can move freely",
                              f"$.joints[{i}]", allowed="a joint of at least one dynamic body")

    def springs(self) -> Iterator[Problem]:
        for i, spring in enumerate(self.mechanism.springs):
            for target in SPRINGS[spring.type].targets:
                yield from self._target(spring, target, f"$.springs[{i}]")

    def tendons(self) -> Iterator[Problem]:
        for i, tendon in enumerate(self.mechanism.tendons):
            for j, guide in enumerate(tendon.guides):
                path = f"$.tendons[{i}].guides[{j}].body"
                yield from self._unknown(guide.body, self.bodies, "body", path)

    def lines(self) -> Iterator[Problem]:
        """Chambers on what is not there, and lines that nothing tells the volume of."""
        for i, line in enumerate(self.mechanism.lines):
            for j, chamber in enumerate(line.chambers):
                path = f"$.lines[{i}].chambers[{j}]"
                if isinstance(chamber, Vane):
                    yield from self._unknown(chamber.joint, self.hinges, "pin joint",
                                             f"{path}.joint")
                else:
                    yield from self._unknown(chamber.a, self.bodies, "body", f"{path}.a")
                    yield from self._unknown(chamber.b, self.bodies, "body", f"{path}.b")
            yield from self._volume(line, f"$.lines[{i}]")

    def _volume(self, line: Line, path: str) -> Iterator[Problem]:
        """What follows from the lengths of cylinders, where no volume is given."""
        cylinders = [chamber for chamber in line.chambers if isinstance(chamber, Cylinder)]
        if not all(name in self.bodies for one in cylinders for name in (one.a, one.b)):
            return
        volume = volume_of(line, self.bodies)
        if fault := size_fault(volume, "volume"):
            yield Problem("out-of-range", "its volume at t = 0 follows from the cylinders that "
                          f"push and is {fault}", f"{path}.volume",
                          allowed='the volume of its fluid, such as "0.1 l"')

    def valves(self) -> Iterator[Problem]:
        for i, valve in enumerate(self.mechanism.valves):
            for field, name in (("a", valve.a), ("b", valve.b)):
                if name is not None:
                    yield from self._unknown(name, self.known["lines"], "line",
                                             f"$.valves[{i}].{field}")

    def loads(self) -> Iterator[Problem]:
        """Loads on nothing that moves freely, names that mean two things, weightless liquids."""
        named = {each.name for kind in NAMED for each in getattr(self.mechanism, kind)}
        gravity = self.mechanism.gravity
        for i, load in enumerate(self.mechanism.loads):
            path, bodies = f"$.loads[{i}]", self.mechanism.bodies
            for j, pattern in enumerate(load.bodies):
                yield from self._borne(pattern, f"{path}.bodies[{j}]")
            for body in borne(load, bodies):
                if (both := f"{load.name}.{bodies[body].name}") in named:
                    yield Problem("duplicate-name",
                                  f"{quoted(both)} is the name of another element, and here it "
                                  f"would mean this load on {quoted(bodies[body].name)}",
                                  f"{path}.name", allowed="another name")
            if isinstance(load, BuoyancyLoad) and (gravity[0] or gravity[1] >= 0):
                yield Problem("bad-fluid", "a liquid lifts against gravity, which has to point "
                              f"downwards here, and it is [{gravity[0]:g}, {gravity[1]:g}]", path,
                              allowed='a scene with "gravity": [0, -9.81]')

    def _borne(self, pattern: str, path: str) -> Iterator[Problem]:
        """What is wrong with one of a load's patterns of bodies."""
        if self._maybe(pattern):
            return
        free = [body.name for body in self.mechanism.bodies if body.motion == "dynamic"]
        if not self._fits(pattern):
            hint = "'*', every body that moves freely" if pattern == "all" else (
                self.near(pattern, self.bodies))
            yield Problem("name-not-found", f"no body's name matches {quoted(pattern)}", path,
                          allowed=listed(free), hint=hint)
        elif not any(map(re.compile(fnmatch.translate(pattern)).match, free)):
            yield Problem("name-not-found", f"{quoted(pattern)} matches no body that moves freely",
                          path, allowed=listed(free) or "none: no body moves freely")

    def materials(self) -> Iterator[Problem]:
        for i, body in enumerate(self.mechanism.bodies):
            if body.material is not None:
                yield from self._unknown(body.material, self.mechanism.materials, "material",
                                         f"$.bodies[{i}].material")

    def drives(self) -> Iterator[Problem]:
        """Drives of nothing, and two drives that set the same thing."""
        owners: dict[tuple[object, ...], str] = {}
        for i, drive in enumerate(self.mechanism.drives):
            kind, path = kind_of(drive), f"$.drives[{i}]"
            name = getattr(drive, kind.target.field)
            yield from self._target(drive, kind.target, path)
            if isinstance(drive, StiffnessDrive):
                yield from self._stiffness(drive, path)
            if isinstance(drive, RadiusDrive):  # one of a body's shapes
                yield from self._circle(drive, path)
                owned: tuple[object, ...] = (kind.sole, name, drive.shape)
            else:
                owned, path = (kind.sole, name), f"{path}.{kind.target.field}"
            if kind.sole and owned in owners:
                yield Problem("set-twice", f"the {kind.sole} of {quoted(name)} is set already, by "
                              f"{owners[owned]}", path, allowed="one drive for each")
            owners.setdefault(owned, quoted(drive.name))

    def _stiffness(self, drive: StiffnessDrive, path: str) -> Iterator[Problem]:
        """Springs and tendons that have no stiffness to set."""
        if drive.tendon is not None:
            yield from self._softened(drive.tendon, f"{path}.tendon")
            return
        spring = next((each for each in self.mechanism.springs if each.name == drive.spring), None)
        if spring is not None and spring.stiffness is None:
            yield Problem("not-settable",
                          f"{quoted(spring.name)} follows a law and has no stiffness to set",
                          f"{path}.spring", allowed="a spring with a 'stiffness'")

    def _softened(self, name: str, path: str) -> Iterator[Problem]:
        """Tendons whose tension is not, or not along all of them, told by a stiffness."""
        tendon = next((each for each in self.mechanism.tendons if each.name == name), None)
        pull = next((each.name for each in self.mechanism.drives
                     if isinstance(each, PullDrive) and each.tendon == name), None)
        if pull is not None:
            yield Problem("not-settable",
                          f"{quoted(name)} has no stiffness to set: {quoted(pull)} pulls it, which "
                          "sets its tension", path, allowed="a tendon that no drive pulls")
        elif tendon is not None and tendon.gripping:
            yield Problem("not-settable", f"the stiffness of {quoted(name)} cannot be set: its "
                          f"guide {tendon.gripping[0]} has friction, so each span has its own "
                          "tension", path, allowed="a tendon whose guides have no 'friction'")
        elif tendon is not None and tendon.stiffness >= RIGID:
            yield Problem("not-settable", f"{quoted(name)} has no stiffness to set: with "
                          f"{tendon.stiffness:g} N/m it counts as inextensible", path,
                          allowed=f"a tendon with a 'stiffness' below {RIGID:g} N/m, which it has "
                          "until the drive sets another")

    def _circle(self, drive: RadiusDrive, path: str) -> Iterator[Problem]:
        if drive.body not in self.bodies:
            return
        shapes = self.bodies[drive.body].shapes
        if drive.shape < len(shapes) and isinstance(shapes[drive.shape], Circle):
            return
        circles = (str(i) for i, shape in enumerate(shapes) if isinstance(shape, Circle))
        allowed = ", ".join(itertools.islice(circles, MOST_NAMED)) \
            or f"none: {quoted(drive.body)} has no circle"
        if drive.shape >= len(shapes):
            yield Problem("not-settable", f"{quoted(drive.body)} has no shape {drive.shape} (they "
                          "count from 0)", f"{path}.shape", allowed=allowed)
        else:
            yield Problem("not-settable", f"shape {drive.shape} of {quoted(drive.body)} is a "
                          f"{shapes[drive.shape].type}; only a circle has a radius to set",
                          f"{path}.shape", allowed=allowed)

    def patterns(self) -> Iterator[Problem]:
        """Contact rules and groups that name no body."""
        for i, rule in enumerate(self.mechanism.contacts):
            for j, pattern in enumerate(rule.between):
                yield from self._fitting(pattern, f"$.contacts[{i}].between[{j}]")
        for i, group in enumerate(self.mechanism.groups):
            for j, name in enumerate(group.bodies):
                path = f"$.groups[{i}].bodies[{j}]"
                yield from self._unknown(name, self.bodies, "body", path)

    def view(self) -> Iterator[Problem]:
        """Bodies that a picture is asked to show, and that are not there."""
        view = self.mechanism.view
        for i, trace in enumerate(view.traces):
            yield from self._unknown(trace.body, self.bodies, "body", f"$.view.traces[{i}].body")
        if view.follow is not None:
            yield from self._unknown(view.follow, self.bodies, "body", "$.view.follow")
        groups = [group.name for group in self.mechanism.groups]
        for i, pattern in enumerate(view.bodies):
            if any(fnmatch.fnmatchcase(name, pattern) for name in groups):
                continue
            yield from self._seen(pattern, f"$.view.bodies[{i}]")
        for layer, patterns in view.show.items():
            for pattern in patterns if patterns != EVERY else ():
                yield from self._seen(pattern, f"$.view.show.{layer}")

    def _seen(self, pattern: str, path: str) -> Iterator[Problem]:
        """A pattern of what a picture shows that fits no body, by name or by role."""
        if not pattern.startswith(BY_ROLE):
            yield from self._fitting(pattern, path)
        elif not self.assumed and not meant([pattern], self.mechanism.bodies):
            roles = dict.fromkeys(BY_ROLE + body.role for body in self.mechanism.bodies)
            yield Problem("name-not-found",
                          f"no body has the role {quoted(pattern.removeprefix(BY_ROLE))}", path,
                          allowed=listed(roles), hint=self.near(pattern, roles))

    def _fitting(self, pattern: str, path: str) -> Iterator[Problem]:
        """A pattern of bodies that fits none."""
        if not self._maybe(pattern) and not self._fits(pattern):
            grouped = any(group.name == pattern for group in self.mechanism.groups)
            yield Problem("name-not-found", f"no body's name matches {quoted(pattern)}", path,
                          allowed=listed(self.bodies),
                          hint=f"'{pattern}.*'" if grouped else self.near(pattern, self.bodies))

    def _maybe(self, pattern: str) -> bool:
        """Whether a body that could not be read may fit."""
        return self._assumed(pattern) or (bool(self.assumed) and "*" in pattern)

    def _fits(self, pattern: str) -> bool:
        """Whether a body's name fits."""
        return pattern in self.bodies or (is_pattern(pattern) and any(
            map(re.compile(fnmatch.translate(pattern)).match, self.bodies)))
