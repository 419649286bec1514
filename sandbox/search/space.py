"""What a search varies: paths whose values are shares, 0 to 1, of the ways that they may go."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sandbox.numeric import Array
from sandbox.sweeps.points import Override, number_of, plain, with_unit
from sandbox.sweeps.varied import Distributed, Spanned, Varied


@dataclass(frozen=True)
class Space:
    """Paths and what each may be given."""

    over: Mapping[str, Varied]
    units: Mapping[str, str]
    """SI, by path; empty for none."""

    @property
    def paths(self) -> tuple[str, ...]:
        """In their order."""
        return tuple(self.over)

    @property
    def spans(self) -> tuple[str, ...]:
        """Paths that go from a number to another."""
        return tuple(path for path, each in self.over.items() if isinstance(each, Spanned))

    @property
    def random(self) -> tuple[str, ...]:
        """Paths that have a distribution."""
        return tuple(path for path, each in self.over.items() if isinstance(each, Distributed))

    @property
    def lists(self) -> tuple[str, ...]:
        """Paths that are given values of a list."""
        return tuple(path for path, each in self.over.items() if isinstance(each, tuple))

    def rising(self) -> Space:
        """The same with every range from its lesser end to the greater one."""
        return replace(self, over={
            path: each.model_copy(update={"from_": each.to, "to": each.from_})
            if isinstance(each, Spanned) and each.from_ > each.to else each
            for path, each in self.over.items()})

    def points(self, shares: Array | Sequence[Sequence[float]]) -> list[dict[str, Override]]:
        """What paths are set to at shares, [n, paths]."""
        table = np.asarray(shares, dtype=float)
        columns = [_written(each, table[:, k]) for k, each in enumerate(self.over.values())]
        return [dict(zip(self.paths, values, strict=True))
                for values in zip(*columns, strict=True)]

    def numbers(self, shares: Array | Sequence[Sequence[float]]) -> Array:
        """The same in SI, [n, paths]; nan for texts."""
        found = [[number_of(value) for value in point.values()] for point in self.points(shares)]
        return np.array([[value if isinstance(value, float) else np.nan for value in row]
                         for row in found])

    def slopes(self, shares: Array) -> Array:
        """How much each path's number [SI] grows per share, [paths], at shares [paths]."""
        step = 1e-5
        low, high = np.clip(shares - step, 0, 1), np.clip(shares + step, 0, 1)
        ends = self.numbers(np.stack([low, high]))
        return np.asarray((ends[1] - ends[0]) / (high - low))


def _written(varied: Varied, shares: Array) -> list[Override]:
    if isinstance(varied, tuple):
        return [plain(varied[min(int(share * len(varied)), len(varied) - 1)]) for share in shares]
    return with_unit(np.asarray(varied.at(shares)), varied.unit)
