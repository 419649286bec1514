"""The figures that ``sandbox plot`` knows by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from sandbox.paper import finger_control_figure as finger_control
from sandbox.recording.recording import Recording
from sandbox.samples.response import Response


@dataclass(frozen=True)
class FigureKind:
    """A figure by name."""

    name: str
    about: str
    draw: Callable[[Recording, Mapping[str, float]], tuple[Any, dict[str, Response]]]
    """From a recording and targets by hand (SI) to a figure of matplotlib and what settled."""


FIGURES = {figure.name: figure for figure in (
    FigureKind("finger-control", "a finger under control: shortening, rotations with their "
               "targets, stiffness, pull", finger_control.draw),
)}
