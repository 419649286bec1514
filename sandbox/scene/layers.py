"""The layers of a picture, which a scene's ``view.show`` and ``--show`` select."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from sandbox.values.numbers import Written
from sandbox.wording import WrongValueError, kind_of, listed, near, quoted, refuse_if

if TYPE_CHECKING:
    from sandbox.scene.bodies import Body
    from sandbox.scene.settings import Group


@dataclass(frozen=True)
class Layer:
    """One kind of thing that a picture may show."""

    words: str  # the label of its switch
    about: str  # what it shows
    default: bool = True  # whether it is shown by default
    per_body: bool = False  # whether it may be shown of some bodies only


LAYERS: Mapping[str, Layer] = {
    "bodies": Layer("bodies", "outlines of bodies; fixed bodies are hatched", per_body=True),
    "springs": Layer("springs", "springs"),
    "tendons": Layer("tendons", "tendons with their guides, lines of fluid"),
    "joints": Layer("joints", "pins, grooves, rods, ropes, grounds, active stops"),
    "contacts": Layer("contact forces", "contact forces as arrows with magnitudes",
                      per_body=True),
    "tensions": Layer("tensions", "tendons, rods and ropes coloured by force, numbers at rods and "
                                  "ropes"),
    "drives": Layer("drives", "drives as arrows and marks"),
    "loads": Layer("loads", "loads as arrows", per_body=True),
    "names": Layer("names", "names of fingers"),
    "traces": Layer("traces", "paths of points with time marks: those of `view.traces`, else of "
                              "fingertips, else of centres of mass; on by default if `view.traces` "
                              "names points", default=False, per_body=True),
    "velocity": Layer("velocity", "velocity of traced points, else of the centre of mass",
                      default=False, per_body=True),
    "acceleration": Layer("acceleration", "acceleration of the same points", default=False,
                          per_body=True),
    "reactions": Layer("reactions", "reaction forces of pins, slots and welds", default=False,
                       per_body=True),
    "bars": Layer("bars", "two-pin bodies, coloured by axial tension or "
                          "compression", default=False, per_body=True),
    "pressure": Layer("pressure", "contact forces along flat sides as a line load with the same "
                                  "sum and moment",
                      default=False, per_body=True),
    "axes": Layer("axes", "the frames of bodies: x and y from the origin", default=False,
                  per_body=True),
    "coordinates": Layer("coordinates", "world grid with numbers", default=False),
    "body_names": Layer("names of bodies", "names at bodies", default=False, per_body=True),
}
"""By name; those shown by default first."""
PASSES: Mapping[str, str] = {
    "rails": "joints", "anchor lines": "bodies", "links": "joints", "bodies": "bodies",
    "grooves": "joints", "wheels": "tendons", "belts": "drives", "bars": "bars",
    "traces": "traces", "fluids": "tendons", "springs": "springs", "stops": "joints",
    "grounds": "joints", "marks": "drives", "latches": "joints", "pins": "joints",
    "cables": "tendons", "axes": "axes", "pressure": "pressure", "contacts": "contacts",
    "link_forces": "joints", "loads": "loads", "velocity": "velocity",
    "acceleration": "acceleration", "reactions": "reactions", "drives": "drives",
    "body_names": "body_names",
}
"""The drawing passes of a run, back to front, each with its layer, for films and pages."""
EVERY = ("*",)  # patterns that mean all bodies
BY_ROLE = "role:"  # begins a pattern of roles, as in role:object; no name has a colon
WHOLE = "all"  # as a layer: all of them
Show = Mapping[str, tuple[str, ...]]
"""Selected layers, each with patterns of bodies; empty for a layer that is hidden."""


def parse_layers(value: Any) -> dict[str, tuple[str, ...]]:
    """Read a selection of layers: patterns of bodies for each named layer.

    ``value`` is a list of layers or a text with commas, where ``-contacts`` removes one and ``all``
    means every one; or an object of layer: true, false or patterns of bodies. The last word counts.
    """
    found: dict[str, tuple[str, ...]] = {}
    if isinstance(value, Mapping):
        return {layer: _patterns(layer, of)
                for word, of in value.items() for layer in _layers(word)}
    words = value.split(",") if isinstance(value, str) else value
    if not isinstance(words, list | tuple):
        raise WrongValueError("wrong-type", f"{kind_of(value)} names no layers", allowed=FORMS)
    for word in words:
        named = word.strip() if isinstance(word, str) else word
        away = isinstance(named, str) and named.startswith("-")
        for layer in _layers(named[1:].strip() if away else named):
            found[layer] = () if away else EVERY
    return found


FORMS = 'a list of layers such as ["traces", "-contacts"], or an object such as ' \
        '{"velocity": ["finger*"], "contacts": false}'


def _layers(word: Any) -> list[str]:
    known = [*LAYERS, WHOLE]
    allowed = listed(known, most=len(known))
    if word == WHOLE:
        return list(LAYERS)
    if word in LAYERS:
        return [word]
    if not isinstance(word, str):
        raise WrongValueError("wrong-type", f"{kind_of(word)} is no layer", allowed=allowed)
    raise WrongValueError("not-allowed", f"there is no layer named {quoted(word)}",
                          allowed=allowed, hint=near(word, known, cutoff=0.5))


def _patterns(layer: str, of: Any) -> tuple[str, ...]:
    if isinstance(of, bool):
        return EVERY if of else ()
    patterns = (of,) if isinstance(of, str) else of
    refuse_if(not isinstance(patterns, list | tuple) or not all(
        isinstance(each, str) for each in patterns), f"{kind_of(of)} does not name the bodies for "
        f"{quoted(layer)}", "wrong-type", allowed="true, false, or a list of names and patterns of "
        "bodies")
    some = ", ".join(name for name, row in LAYERS.items() if row.per_body)
    refuse_if(not LAYERS[layer].per_body and tuple(patterns) not in ((), EVERY),
              f"{quoted(layer)} is shown for all bodies or for none", "wrong-type",
              allowed=f"true or false; of some bodies: {some}")
    return tuple(patterns)


def shown(show: Show, *, traced: bool) -> dict[str, tuple[str, ...]]:
    """The layers of a picture, each with patterns of its bodies; ``traced`` if there are traces."""
    default = {name: EVERY for name, layer in LAYERS.items()
               if layer.default or (name == "traces" and traced)}
    return {name: patterns for name, patterns in (default | dict(show)).items() if patterns}


WORDS = "list of layers, or object of layer: true, false or bodies"
_PATTERN_LIST: dict[str, Any] = {"type": "array", "items": {"type": "string"}}
SCHEMA = WithJsonSchema({"anyOf": [
    {"type": "array", "items": {"enum": [
        *LAYERS, WHOLE, *(f"-{name}" for name in (*LAYERS, WHOLE))]}},
    {"type": "object", "additionalProperties": False, "properties": {
        name: {"anyOf": [{"type": "boolean"}, {"type": "string"}, _PATTERN_LIST]}
        for name in (*LAYERS, WHOLE)}},
]})


ShownLayers = Annotated[Written[dict[str, tuple[str, ...]]], BeforeValidator(parse_layers), SCHEMA]
"""For each layer, patterns of the bodies that it shows; none hides it."""


def meant(patterns: Iterable[str], bodies: Iterable[Body],
          groups: Iterable[Group] = ()) -> list[int]:
    """The numbers of the bodies whose name, group or role (:data:`BY_ROLE`) fits a pattern."""
    tests = [(pattern.startswith(BY_ROLE),
              re.compile(fnmatch.translate(pattern.removeprefix(BY_ROLE))).match)
             for pattern in patterns]
    named = {name for group in groups if any(test(group.name) for by_role, test in tests
                                             if not by_role) for name in group.bodies}
    return [i for i, body in enumerate(bodies) if body.name in named
            or any(test(body.role if by_role else body.name) for by_role, test in tests)]
