"""The points of a sweep or a search: the values of the varied paths in each run."""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from sandbox.numeric import Array, Integers
from sandbox.sweeps.job import Override
from sandbox.sweeps.spec import EXPLICIT, SweepSpec
from sandbox.sweeps.vary import Distribution, Range, Values
from sandbox.values.units import parse_quantity


@dataclass(frozen=True)
class Axis:
    """A path and its values, as a scene file may hold them."""

    path: str
    written: Sequence[Override]


class Points:
    """Points that are the product of dimensions, of which the last changes fastest.

    Args:
        dimensions: axes that vary together, with as many values each.
    """

    def __init__(self, dimensions: Sequence[Sequence[Axis]]) -> None:
        self._dimensions = dimensions
        self.axes = tuple(axis for axes in dimensions for axis in axes)
        self.paths = tuple(axis.path for axis in self.axes)
        self.is_grid = all(len(axes) == 1 for axes in dimensions)
        """Whether every value of each path is combined with every value of the others."""

    @classmethod
    def listed(cls, paths: Sequence[str], points: Sequence[Mapping[str, Override]]) -> Points:
        """Points that are given one by one."""
        return cls([[Axis(path, [point[path] for point in points]) for path in paths]])

    def __len__(self) -> int:
        return math.prod(self._shape)

    @property
    def _shape(self) -> list[int]:
        return [len(axes[0].written) for axes in self._dimensions]

    @cached_property
    def _places(self) -> dict[str, Integers]:
        found = np.unravel_index(np.arange(len(self)), self._shape)
        return {axis.path: place for axes, place in zip(self._dimensions, found, strict=True)
                for axis in axes}

    def __getitem__(self, run: int) -> dict[str, Override]:
        """The values of all paths in a run, from 0."""
        return {axis.path: axis.written[self._places[axis.path][run]] for axis in self.axes}

    def places(self, path: str) -> Integers:
        """The index of a path's value in each run, [n]."""
        return self._places[path]


def make_points(spec: SweepSpec) -> Points:
    """The points of a study's groups, which are nested."""
    dimensions: list[list[Axis]] = []
    for place, group in enumerate(spec.vary):
        design = group.chosen_design
        if design in EXPLICIT:
            axes = [Axis(path, _explicit(values)) for path, values in group.over.items()]
            dimensions += [[axis] for axis in axes] if design == "grid" else [axes]
        else:
            quantiles = _sample(design, group.count or 1, len(group.over), spec.seed + place)
            dimensions.append([Axis(path, values_at(values, quantiles[:, k]))
                               for k, (path, values) in enumerate(group.over.items())])
    return Points(dimensions)


def _sample(design: str, count: int, paths: int, seed: int) -> Array:
    """Points of the unit cube, [count, paths]."""
    rng = np.random.default_rng(seed)
    if design == "random":
        return rng.random((count, paths))
    from scipy.stats import qmc

    engine = {"latin_hypercube": qmc.LatinHypercube, "sobol": qmc.Sobol,
              "halton": qmc.Halton}[design](paths, rng=rng)
    with warnings.catch_warnings():  # Sobol's points are balanced for powers of two only
        warnings.simplefilter("ignore", UserWarning)
        return np.asarray(engine.random(count), dtype=float)


def _explicit(values: Values) -> Sequence[Override]:
    if isinstance(values, tuple):
        return [_plain(value) for value in values]
    assert isinstance(values, Range)
    return with_unit(values.even, values.unit)


def values_at(values: Values, quantiles: Array) -> list[Override]:
    """Values of a path at quantiles from 0 to 1, [n], as a scene file may hold them."""
    if isinstance(values, tuple):
        places = np.minimum((quantiles * len(values)).astype(int), len(values) - 1)
        return [_plain(values[place]) for place in places]
    assert isinstance(values, (Range, Distribution))
    return with_unit(np.asarray(values.at(quantiles)), values.unit)


def _plain(value: Any) -> Override:
    """A value of a list as JSON has it: pydantic makes tuples of lists."""
    return list(map(_plain, value)) if isinstance(value, tuple) else value


def with_unit(numbers: Array, unit: str) -> list[Override]:
    """Numbers as texts with their unit, or as numbers without one."""
    return [f"{number!r} {unit}" if unit else number for number in numbers.tolist()]


def number_of(written: Override) -> float | str:
    """A value of a path as a table has it: SI where it is a number, else text."""
    if isinstance(written, bool) or written is None or isinstance(written, (list, dict)):
        return json.dumps(written)
    if isinstance(written, str):
        try:
            return float(parse_quantity(written, None))
        except ValueError:
            return written
    return float(written)
