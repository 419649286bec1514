"""The points of a sweep: which values its paths have in the i-th run."""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from sandbox.errors import SandboxError
from sandbox.numeric import Array, Integers
from sandbox.scene.values.units import parse_quantity
from sandbox.sweeps.spec import EVEN, SweepSpec, Varying, len_of
from sandbox.sweeps.varied import Distributed, Spanned, Varied

Override = str | float | int | bool | list[Any] | dict[str, Any] | None
"""A value as ``--set`` takes it."""


@dataclass(frozen=True)
class Axis:
    """One path and the values that its points have, in their order."""

    path: str
    written: Sequence[Override]
    """As a scene's file may hold them."""


class Planned(Protocol):
    """Points of runs that are known: those of a sweep, or those that a search asked for."""

    def __len__(self) -> int:
        """How many runs there are."""

    def __getitem__(self, run: int) -> dict[str, Override]:
        """What the paths of a run, from 0, are set to."""

    def places(self, path: str) -> Integers:
        """Which of its values a path has in each run, [n]."""

    @property
    def paths(self) -> tuple[str, ...]:
        """All that are varied."""

    @property
    def axes(self) -> tuple[Axis, ...]:
        """Every path with its values."""

    @property
    def one_grid(self) -> bool:
        """Whether every value of each path meets every value of the others."""


class Points:
    """All points of a sweep; the last group, and in a grid the last path, changes fastest.

    Raises:
        SandboxError: designs that need scipy, where it is not installed.
    """

    def __init__(self, spec: SweepSpec) -> None:
        self._groups = [_laid_out(group, spec.seed + place)
                        for place, group in enumerate(spec.vary)]
        self.paths = tuple(axis.path for _, axes, _ in self._groups for axis in axes)

    def __len__(self) -> int:
        return math.prod(count for count, _, _ in self._groups)

    def __getitem__(self, run: int) -> dict[str, Override]:
        """What the paths of a run, from 0, are set to."""
        found: dict[str, Override] = {}
        rest = run
        for count, axes, grid in reversed(self._groups):
            rest, place = divmod(rest, count)
            here: dict[str, Override] = {}
            for axis in reversed(axes):
                if grid:
                    place, at = divmod(place, len(axis.written))
                else:
                    at = place
                here[axis.path] = axis.written[at]
            found = {**dict(reversed(here.items())), **found}
        return found

    def first(self, path: str, place: int) -> int:
        """The first run in which a path has its value ``place``."""
        return self._stride(path)[0] * place

    def places(self, path: str) -> Integers:
        """Which of its values a path has in each run, [n]."""
        stride, count = self._stride(path)
        return np.arange(len(self)) // stride % count

    def _stride(self, path: str) -> tuple[int, int]:
        """After how many runs a path has its next value, and how many it has."""
        below = 1
        for count, axes, grid in reversed(self._groups):
            inside = 1
            for axis in reversed(axes):
                if axis.path == path:
                    return below * inside, len(axis.written)
                inside *= len(axis.written) if grid else 1
            below *= count
        raise KeyError(path)

    @cached_property
    def axes(self) -> tuple[Axis, ...]:
        """Every path with its values."""
        return tuple(axis for _, axes, _ in self._groups for axis in axes)

    @property
    def one_grid(self) -> bool:
        """Whether every value of each path meets every value of the others."""
        return all(grid or len(axes) == 1 for _, axes, grid in self._groups)


def _laid_out(group: Varying, seed: int) -> tuple[int, list[Axis], bool]:
    """How many points a group has, its axes, and whether it is a grid of them."""
    design = group.laid_out
    if design in EVEN:
        axes = [Axis(path, _evenly(varied)) for path, varied in group.over.items()]
        grid = design == "grid"
        count = math.prod(len(axis.written) for axis in axes) if grid else len(axes[0].written)
        return count, axes, grid
    count = group.count or 1
    shares = _shares(design, count, len(group.over), seed)
    return count, [Axis(path, _chosen(varied, shares[:, k]))
                   for k, (path, varied) in enumerate(group.over.items())], False


def _shares(design: str, count: int, paths: int, seed: int) -> Array:
    """Points of the unit cube, [count, paths]."""
    if design == "random":
        return np.random.default_rng(seed).random((count, paths))
    try:
        from scipy.stats import qmc
    except ImportError:
        raise SandboxError(f"a design {design!r} needs scipy: pip install "
                           "'sandbox-mechanics[studies]'", code="missing-package") from None
    engine = {"latin_hypercube": qmc.LatinHypercube, "sobol": qmc.Sobol,
              "halton": qmc.Halton}[design](paths, rng=np.random.default_rng(seed))
    with warnings.catch_warnings():  # any count is a sample; powers of two are the balanced ones
        warnings.simplefilter("ignore", UserWarning)
        return np.asarray(engine.random(count), dtype=float)


def _evenly(varied: Varied) -> Sequence[Override]:
    if isinstance(varied, tuple):
        return [plain(value) for value in varied]
    assert isinstance(varied, Spanned)
    return with_unit(varied.even, varied.unit)


def _chosen(varied: Varied, shares: Array) -> Sequence[Override]:
    if isinstance(varied, tuple):
        last = len_of(varied) - 1
        return [plain(varied[min(int(share * len(varied)), last)]) for share in shares]
    assert isinstance(varied, (Spanned, Distributed))
    return with_unit(varied.at(shares), varied.unit)


def plain(value: Any) -> Override:
    """A value of a list as JSON has it: pydantic makes tuples of lists."""
    return list(map(plain, value)) if isinstance(value, tuple) else value


def with_unit(numbers: Array, unit: str) -> list[Override]:
    """Numbers as texts with their unit, or by themselves if they have none."""
    return [f"{number!r} {unit}" if unit else number for number in numbers.tolist()]


def number_of(written: Override) -> float | str:
    """What a value of a path is in a table: SI where it is a number, else the text itself."""
    if isinstance(written, bool) or written is None or isinstance(written, (list, dict)):
        return json.dumps(written)
    if isinstance(written, str):
        try:
            return float(parse_quantity(written, None))
        except ValueError:
            return written
    return float(written)
