"""Checks of drives, controllers and events: readings, algebraic loops, limits."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from sandbox.elements.controllers.custom import Custom
from sandbox.elements.quantities import LIVE, row_of
from sandbox.engine.inspect_elements import NEGLIGIBLE, deg, look, mm
from sandbox.errors import Problem, SceneError
from sandbox.model.catalogue import Catalogue
from sandbox.model.meters import misread, order
from sandbox.model.model import Model
from sandbox.scene.check.control import rate_problems
from sandbox.scene.check.ranges import nothing_to_run
from sandbox.scene.document import Scene
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import read_scene, sound
from sandbox.values.expressions import dotted, names_in, parse_expression, rings
from sandbox.values.signals import Constant, Ramp, Table, values
from sandbox.wording import MAX_NAMED, NearMisses, listed, quoted


def control_problems(mechanism: Mechanism) -> list[Problem]:
    """Readings that a run does not have or cannot give while it runs, and algebraic loops."""
    known = LiveCatalogue(mechanism)
    problems: list[Problem] = []
    for i, controller in enumerate(mechanism.controllers):
        several = isinstance(getattr(controller, "reads", ""), tuple)
        for j, text in enumerate(controller.readings):
            place = f"$.controllers[{i}].{controller.reads_key}" + (f"[{j}]" if several else "")
            problems += unreadable(text, known, place)
    for i, event in enumerate(mechanism.events):
        if event.when is not None:
            problems += unreadable(event.when, known, f"$.events[{i}].when")
    if not problems:
        problems += _circles(mechanism, known)
        for i, controller in enumerate(mechanism.controllers):
            problems += controller.law_problems(mechanism, f"$.controllers[{i}]")
    return problems


@dataclass(frozen=True)
class Checked:
    """A mechanism that was read and inspected, and is not checked again."""

    mechanism: Mechanism


Runnable = Scene | Mechanism | Checked | str | os.PathLike[str] | Mapping[str, Any]


def checked(scene: Runnable, customs: Sequence[Custom]) -> Mechanism:
    """The mechanism of a scene; SceneError with every problem of its control."""
    problems: list[Problem] = []
    name = ""
    if isinstance(scene, Checked):
        mechanism = scene.mechanism
    elif isinstance(scene, (str, os.PathLike, Mapping)):
        loaded = read_scene(scene)
        mechanism, name = loaded.mechanism, loaded.name
        problems += loaded.placed(control_problems(mechanism))
    else:
        mechanism = sound(scene)
        problems += control_problems(mechanism)
    problems += [*nothing_to_run(mechanism), *_custom_problems(mechanism, customs)]
    if problems:
        raise SceneError(problems, name)
    return mechanism


def _custom_problems(mechanism: Mechanism, customs: Sequence[Custom]) -> Iterator[Problem]:
    known, near = LiveCatalogue(mechanism), NearMisses()
    drives = dict.fromkeys(drive.name for drive in mechanism.drives)
    taken = {name for controller in mechanism.controllers for name in controller.written}
    taken |= {name for event in mechanism.events for name in event.set}
    named = {controller.name for controller in mechanism.controllers}
    for custom in customs:
        place = f"controller {custom.name}"
        if custom.name in named:
            yield Problem("duplicate-name",
                          "another controller has this name", place, allowed="a unique name")
        named.add(custom.name)
        yield from rate_problems(custom.rate, mechanism.run.step, place)
        for text in custom.reads:
            yield from unreadable(text, known, place)
        for name in custom.writes:
            if name not in drives:
                yield Problem("name-not-found", f"there is no drive named {quoted(name)} to write",
                              place, allowed=listed(drives), hint=near(name, drives))
            elif name in taken:
                yield Problem("set-twice", f"the drive {quoted(name)} is written already, by "
                              "another controller or an event", place)
            taken.add(name)


class LiveCatalogue(Catalogue):
    """All quantities, and what readings come from."""

    def late(self, names: Iterable[str]) -> list[str]:
        """Those of the names that cannot be read during a run; of meters the first in them."""
        found: set[str] = set()
        for name in names:
            if name not in self:
                continue
            source = self.find(name)
            if source.kind == "meter":
                found.update(self._late_of_meters.get(source.index, ()))
            elif not row_of(source.kind, source.quantity).live:
                found.add(name)
        return sorted(found)

    @cached_property
    def _late_of_meters(self) -> dict[int, tuple[str, ...]]:
        """By meter: meters that do not depend on themselves, after those that they read."""
        self._late_of_meters = found = {}
        for index in order(self.mechanism)[0]:
            found[index] = tuple(self.late(
                names_in(self.mechanism.meters[index].value) - {"t"})[:MAX_NAMED])
        return found


def _names(text: str, known: Catalogue) -> list[str]:
    """The quantities that a reading is made of; a bare pair name is one."""
    if not text.startswith("=") and text in known:
        return [text]
    return sorted(names_in(text) - {"t"})


def unreadable(text: str, known: LiveCatalogue, path: str) -> Iterator[Problem]:
    """Problems of a quantity or an expression that is to be read during a run."""
    if not text.startswith("=") and "/" not in text and dotted(parse_expression(text).tree) is None:
        yield Problem("bad-quantity",
                      f"{quoted(text)} is an expression", path, allowed=quoted(f"={text}"))
    names = _names(text, known)
    if text not in known:
        yield from misread(known, text, names, path, live=True,
                           itself="{} without '=' and all else is read as the pair")
    for name in known.late(names):
        kind = known.find(name).kind
        yield Problem("quantity-not-live", f"{quoted(name)} is computed after the run and cannot "
                      "be read during it", path, allowed=f"of a {kind}: {listed(LIVE[kind])}")


def _circles(mechanism: Mechanism, known: Catalogue) -> Iterator[Problem]:
    """Loops of laws without memory that read each other's outputs."""
    controllers = mechanism.controllers
    laws = [("law", i) for i, law in enumerate(controllers) if law.immediate]
    writer = {f"{name}.value": law for law in laws for name in controllers[law[1]].written}

    def nexts(node: tuple[str, int]) -> Iterator[tuple[str, int]]:
        """What a law or a meter reads: the laws that write it, and meters."""
        kind, index = node
        for name in (_names(controllers[index].immediate, known) if kind == "law"
                     else sorted(names_in(mechanism.meters[index].value))):
            if name in writer:
                yield writer[name]
            elif name in known and (source := known.find(name)).kind == "meter":
                yield "meter", source.index

    meters = [("meter", i) for i in range(len(mechanism.meters) if laws else 0)]
    for ring in rings({node: [*nexts(node)] for node in (*laws, *meters)}):
        members = [index for kind, index in ring if kind == "law"]
        if not members:
            continue  # meters alone are reported elsewhere
        members = members[(at := members.index(min(members))):] + members[:at]
        path = " → ".join(quoted(controllers[i].name) for i in [*members, members[0]])
        yield Problem("algebraic-loop", f"an algebraic loop: {path}; each reads the value that the "
                      "next one writes", f"$.controllers[{members[0]}].value",
                      allowed="a law with memory in the loop, such as a pid")


INSTANTS = 257  # instants of a run at which the target of a drive is checked


def idle_problems(model: Model) -> Iterator[Problem]:
    """Drives without effect, or outside of limits."""
    drives, joints, tendons = model.drives, model.joints, model.tendons
    for i, (kind, name) in enumerate(zip(drives.kind, drives.name, strict=True)):
        path, target = f"$.drives[{i}]", int(drives.target[i])
        moved = ([target] if kind.gives == "force" else
                 joints.bodies[target].tolist() if kind.gives == "torque" else
                 tendons.guide_body[tendons.guides(target)].tolist() if kind.gives == "tension"
                 else [])
        if moved and not kind.limited and not model.bodies.free[moved].any():
            yield look("no-effect", path, name,
                       f"acts on {model.bodies.name[moved[0]]!r}, which cannot move freely")
        if kind.gives == "surface" and not model.mechanism.bodies[target].shapes:
            yield look("no-effect", f"{path}.body", name, f"{model.bodies.name[target]} has no "
                       "shapes, so it has no surface to drive", "a shape of that body")
        if not kind.places:
            continue
        set_to = values(model.mechanism.drives[i].signal(model.mechanism), np.linspace(
            0.0, model.mechanism.run.duration, INSTANTS), model.mechanism.functions)
        turns = bool(joints.angle[target])
        low, high = (joints.stops if turns else joints.reach)[target].tolist()
        for value, over, bound, end in ((set_to.max(), set_to.max() - high, high, "most"),
                                        (set_to.min(), low - set_to.min(), low, "least")):
            if not over > NEGLIGIBLE:
                continue
            fault, advice = f"it is {mm(bound)} long at {end}", "a length within its stroke"
            if turns:
                fault, advice = f"its limits are [{deg(low)}, {deg(high)}]", "an angle within them"
                if abs(value) > math.tau:
                    advice += f"; numbers are in rad: for degrees write \"{value:.4g} deg\""
            yield look("outside-limits", f"{path}.value", name, f"sets {joints.name[target]} to "
                       f"{deg(value) if turns else mm(value)}, but {fault}", advice)


def beyond_stops(model: Model) -> Iterator[Problem]:
    """Events that wait for a hinge to pass its stop, controllers that lead one there: warnings."""
    joints, mechanism = model.joints, model.mechanism
    stops = {f"{joints.name[i]}.angle": joints.stops[i].tolist() for i in joints.stopped}
    free = (-math.inf, math.inf)
    for i, event in enumerate(mechanism.events):
        compared = re.fullmatch(r"=?\s*([^<>=]+?)\s*([<>])=?\s*([^<>=]+?)\s*", event.when or "")
        if compared is None:
            continue
        name, symbol, value = compared.groups()
        if name not in stops:
            name, symbol, value = value, "<" if symbol == ">" else ">", name
        low, high = stops.get(name, free)
        with suppress(ValueError):  # no number
            number = parse_expression(value).evaluate({})
            if number >= high if symbol == ">" else number <= low:
                yield look("outside-limits", f"$.events[{i}].when", event.name,
                           f"waits for {name} {symbol} {number:.4g} rad, but its stops are at "
                           f"{low:.4g} and {high:.4g} rad", "it will probably never happen")
    for i, controller in enumerate(mechanism.controllers):
        for name, target in zip(controller.readings, controller.signals, strict=False):
            low, high = stops.get(name, free)
            goal = (target.constant if isinstance(target, Constant) else
                    target.to if isinstance(target, Ramp) else
                    target.table[-1][1] if isinstance(target, Table) else math.nan)
            if goal < low or goal > high:
                yield look("outside-limits", f"$.controllers[{i}]", controller.name,
                           f"leads {name} to {goal:.4g} rad, but its stops are at {low:.4g} and "
                           f"{high:.4g} rad", "it cannot reach this")
