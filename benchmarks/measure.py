"""Figures with their targets, and fair timing on a noisy machine."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from sandbox.recording.recording import Recording
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene


@dataclass(frozen=True)
class Figure:
    """A measured number; ``most`` or ``least`` is its target, if it has one."""

    name: str
    value: float
    unit: str
    most: float | None = None
    least: float | None = None

    @property
    def ok(self) -> bool:
        """Whether the target is met."""
        return bool((self.most is None or self.value <= self.most)
                    and (self.least is None or self.value >= self.least))

    @property
    def target(self) -> str:
        """The target in words."""
        if self.most is not None:
            return f"at most {self.most:g}"
        return "" if self.least is None else f"at least {self.least:g}"

    def data(self) -> dict[str, Any]:
        """The figure as JSON data."""
        return {"name": self.name, "value": float(self.value), "unit": self.unit,
                "most": self.most, "least": self.least, "ok": self.ok}


def mechanism(
    scene: str | Mapping[str, Any], overrides: Mapping[str, Any] | None = None,
) -> Mechanism:
    """A shipped scene by name, or a scene's data, spelled out."""
    return expand(load_scene(scene, overrides=overrides))


def seconds(work: Callable[[], object]) -> float:
    """How long a piece of work takes [s]."""
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def interleaved(works: Sequence[Callable[[], float]], repetitions: int) -> list[float]:
    """Medians of what each of ``works`` measures, taken in turns so that all see the same noise."""
    measured = [[work() for work in works] for _ in range(repetitions)]
    return [median(column) for column in zip(*measured, strict=True)]


def loop_seconds(recording: Recording) -> float:
    """How long the loop took that made a recording, sampling included [s]."""
    return recording.info.wall["simulate"]


def table(figures: Sequence[Figure]) -> str:
    """Figures in columns."""
    rows = [(f.name, f"{f.value:.4g}", f.unit, f.target, "" if not f.target else
             "ok" if f.ok else "MISSED") for f in figures]
    widths = [max(len(row[i]) for row in rows) for i in range(5)]
    return "\n".join(
        f"{row[0]:<{widths[0]}}  {row[1]:>{widths[1]}} {row[2]:<{widths[2]}}  "
        f"{row[3]:<{widths[3]}}  {row[4]}".rstrip() for row in rows)


def as_json(figures: Sequence[Figure]) -> str:
    """Figures as one JSON object."""
    return json.dumps({"ok": all(f.ok for f in figures), "figures": [f.data() for f in figures]},
                      indent=2)
