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
    "Composite", "ControllerFailed", "Custom", "Interrupted", "Live", "OutputError", "Recording",
    "RecordingFull", "SandboxError", "SceneError", "Simulation", "SimulationDiverged", "StopRun",
    "__version__", "build", "expand", "gym", "load_scene", "register", "render", "rest",
    "rest_along", "search", "simulate", "sweep", "to_pymunk",
]
_HOMES = {
    "sandbox.scene.document": "Composite register",
    "sandbox.errors": "ControllerFailed Interrupted OutputError RecordingFull "
                      "SandboxError SceneError SimulationDiverged",
    "sandbox.elements.controllers.custom": "Custom StopRun",
    "sandbox.engine.live": "Live",
    "sandbox.recording.recording": "Recording",
    "sandbox.engine.simulation": "Simulation",
    "sandbox.scene.expand": "expand",
    "sandbox.scene.read.load": "load_scene",
    "sandbox.picture.film": "render",
    "sandbox.equilibria.rest": "rest",
    "sandbox.equilibria.branches": "rest_along",
    "sandbox.engine.simulate": "simulate",
    "sandbox.sweeps.sweep": "sweep",
    "sandbox.engine.pymunk_draft": "to_pymunk",
}
"""The public names by the module that has them."""


def __getattr__(name: str) -> object:
    """Import a public name from its module at its first use (PEP 562)."""
    from importlib import import_module

    if name in ("build", "gym", "search"):
        return import_module(f"sandbox.{name}")
    home = next((module for module, names in _HOMES.items() if name in names.split()), "")
    if not home:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value: object = getattr(import_module(home), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """The public names, loaded or not."""
    return sorted(__all__)
