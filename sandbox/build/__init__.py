"""Scenes without dictionaries: builders whose words an editor completes.

``body("link", mass="10 g", shapes=[shape.circle(radius="5 mm")])`` is the data that a file would
hold. Each builder is made of the model of what it builds; what editors read of them, beside this
file, is written by docs/make_reference.py.
"""

from __future__ import annotations

import re
from typing import Any, get_args

from sandbox.build.builders import TAG, EntryBuilder, Family, missing
from sandbox.scene.document import Part, Scene
from sandbox.scene.elements import bodies, controllers, drives, fluids, joints, loads, springs
from sandbox.scene.elements.events import Event
from sandbox.scene.elements.settings import (
    ContactRule,
    Expect,
    Group,
    Meter,
    Run,
    ShownMeter,
    Trace,
    View,
)
from sandbox.scene.elements.spec import Spec
from sandbox.scene.elements.tendons import Guide, Tendon
from sandbox.scene.parts.finger import FingerSprings, FingerTendon
from sandbox.scene.parts.trees import Leaf
from sandbox.scene.values import signals
from sandbox.scene.values.tables import NamedTable

_ALONE: dict[str, type[Spec]] = {
    "scene": Scene, "run": Run, "view": View, "trace": Trace, "shown_meter": ShownMeter,
    "table": NamedTable,
    "material": bodies.Material, "body": bodies.Body, "path": signals.Path,
    "tendon": Tendon, "guide": Guide, "line": fluids.Line, "valve": fluids.Valve,
    "event": Event, "contact": ContactRule, "group": Group, "meter": Meter,
    "expect": Expect,
    "finger_geometry": controllers.FingerGeometry, "finger_springs": FingerSprings,
    "finger_tendon": FingerTendon, "leaf": Leaf,
}
_UNIONS: dict[str, Any] = {
    "shape": bodies.WrittenShape, "joint": joints.Joint, "spring": springs.Spring,
    "chamber": fluids.Chamber, "load": loads.Load, "drive": drives.Drive,
    "controller": controllers.Controller, "part": Part,
}
_SIGNALS: tuple[type[Spec], ...] = (
    signals.Ramp, signals.Table, signals.Formula, signals.Constant)


def _family(name: str, union: Any) -> Family:
    tagged = {get_args(model.model_fields[TAG].annotation)[0]: model
              for model in get_args(get_args(union)[0])}
    return Family(name, {tag: EntryBuilder(f"{name}.{tag}", model, tag)
                         for tag, model in tagged.items()})


def _snake(name: str) -> str:
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()


BUILDERS: dict[str, EntryBuilder | Family] = {
    **{name: EntryBuilder(name, model) for name, model in _ALONE.items()},
    **{name: _family(name, union) for name, union in _UNIONS.items()},
    "signal": Family("signal", {_snake(model.__name__): EntryBuilder(
        f"signal.{_snake(model.__name__)}", model) for model in _SIGNALS}),
}
"""By name, those of one kind as a family."""
globals().update(BUILDERS)
__all__ = [*BUILDERS]


def __getattr__(name: str) -> Any:
    """Refuse what there is not, with a near miss."""
    raise AttributeError(name if name.startswith("__") else missing("build", name, BUILDERS))


def __dir__() -> list[str]:
    """The builders."""
    return sorted(BUILDERS)
