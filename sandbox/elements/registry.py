"""All kinds of element, by the list of a mechanism that they stand in."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, get_args

from sandbox.elements.controllers.kinds import Controller
from sandbox.elements.drives import Drive
from sandbox.elements.element import Element, tag_of
from sandbox.elements.fluids import Line, Valve
from sandbox.elements.joints import Joint
from sandbox.elements.loads import Load
from sandbox.elements.springs import Spring
from sandbox.elements.tendons import Tendon
from sandbox.values.spec import Spec


def members(union: Any) -> tuple[type[Spec], ...]:
    """The models of a discriminated union such as ``Joint``."""
    return get_args(get_args(union)[0])


_LISTS: Mapping[str, tuple[type[Any], ...]] = {
    "joints": members(Joint), "springs": members(Spring), "tendons": (Tendon,),
    "lines": (Line,), "valves": (Valve,), "loads": members(Load), "drives": members(Drive),
    "controllers": members(Controller)}
KINDS: Mapping[str, Mapping[str, type[Element]]] = {
    name: {tag_of(kind): kind for kind in kinds} for name, kinds in _LISTS.items()}
"""By list, then by ``type``; the ``type`` is empty in lists of one kind."""


def kind_of(name: str, data: Mapping[str, Any]) -> type[Element] | None:
    """The class of an element of a list, for its JSON data; None where it has none."""
    tag = data.get("type", "")
    return KINDS[name].get(tag) if name in KINDS and isinstance(tag, str) else None
