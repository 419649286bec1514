"""Planar mechanisms and underactuated hands: JSON scenes to contact forces and pictures.

The public names load on first use, so that ``import sandbox`` and the
command line start at once (no numpy, pydantic, pymunk or pygame yet).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sandbox import build, gym, search
    from sandbox.elements.controllers.custom import Custom, StopRun
    from sandbox.engine.live import Live
    from sandbox.engine.pymunk_draft import to_pymunk
    from sandbox.engine.simulate import simulate
    from sandbox.engine.simulation import Simulation
    from sandbox.equilibria.branches import rest_along
    from sandbox.equilibria.rest import rest
    from sandbox.errors import (
        ControllerFailed,
        Interrupted,
        OutputError,
        RecordingFull,
        SandboxError,
        SceneError,
        SimulationDiverged,
    )
    from sandbox.picture.film import render
    from sandbox.recording.recording import Recording
    from sandbox.scene.document import Composite, register
    from sandbox.scene.expand import expand
    from sandbox.scene.read.load import load_scene
    from sandbox.sweeps.sweep import sweep

__version__ = "0.1.0"

__all__ = [
    "Composite",
    "ControllerFailed",
    "Custom",
    "Interrupted",
    "Live",
    "OutputError",
    "Recording",
    "RecordingFull",
    "SandboxError",
    "SceneError",
    "Simulation",
    "SimulationDiverged",
    "StopRun",
    "__version__",
    "build",
    "expand",
    "gym",
    "load_scene",
    "register",
    "render",
    "rest",
    "rest_along",
    "search",
    "simulate",
    "sweep",
    "to_pymunk",
]

_HOMES = {
    "Composite": "sandbox.scene.document",
    "ControllerFailed": "sandbox.errors",
    "Custom": "sandbox.elements.controllers.custom",
    "Interrupted": "sandbox.errors",
    "Live": "sandbox.engine.live",
    "OutputError": "sandbox.errors",
    "Recording": "sandbox.recording.recording",
    "RecordingFull": "sandbox.errors",
    "SandboxError": "sandbox.errors",
    "SceneError": "sandbox.errors",
    "Simulation": "sandbox.engine.simulation",
    "SimulationDiverged": "sandbox.errors",
    "StopRun": "sandbox.elements.controllers.custom",
    "expand": "sandbox.scene.expand",
    "load_scene": "sandbox.scene.read.load",
    "register": "sandbox.scene.document",
    "render": "sandbox.picture.film",
    "rest": "sandbox.equilibria.rest",
    "rest_along": "sandbox.equilibria.branches",
    "simulate": "sandbox.engine.simulate",
    "sweep": "sandbox.sweeps.sweep",
    "to_pymunk": "sandbox.engine.pymunk_draft",
}
"""Where each public name lives."""


def __getattr__(name: str) -> object:
    """Import a public name from its module at its first use (PEP 562)."""
    from importlib import import_module

    if name in ("build", "gym", "search"):
        return import_module(f"sandbox.{name}")
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value: object = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """The public names, loaded or not."""
    return sorted(__all__)
