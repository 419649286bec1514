"""The key ``search`` of a study file: which search it is, in the words of its options."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from sandbox.scene.elements.spec import Spec
from sandbox.scene.values.numbers import Quantity

KEY = "search"
Sampler = Literal["cmaes", "tpe", "gp", "nsga2", "random"]
"""How points of a search for the best are chosen: CMA-ES (Hansen and Ostermeier, Evol. Comput. 9
(2001) 159) and tree-structured Parzen estimators (Bergstra et al., 2011), a Gaussian process,
NSGA-II (Deb et al., IEEE Trans. Evol. Comput. 6 (2002) 182), or at random."""
Method = Literal["sobol", "morris"]
"""How it is found what matters."""
MOST_TEXTS = 100
MOST_RUNS = 1_000_000
COARSE, WITHIN, RUNS, PROBES = 8, 1 / 64, 1000, 32
"""Of a map, if nothing else is said."""
FINEST = 2048
"""Cells of a map along each way."""


def _several(value: Any) -> Any:
    """One text may stand without a list."""
    return [value] if isinstance(value, str) else value


def _positive(value: float) -> float:
    if value <= 0:
        raise PydanticCustomError("bad-search", "must be greater than 0")
    return value


Texts = Annotated[
    tuple[str, ...], Field(max_length=MOST_TEXTS),
    BeforeValidator(_several, json_schema_input_type=str | tuple[str, ...])]
Width = Annotated[Quantity, AfterValidator(_positive)]
MOST_SEED = 2**32 - 1
"""The largest seed that all libraries take."""
Seed = Annotated[int, Field(ge=0, le=MOST_SEED)]
Runs = Annotated[int, Field(ge=1, le=MOST_RUNS)]


class ThresholdSearch(Spec):
    """Where a condition begins or ceases to hold along one range."""

    where: Texts = ()
    """What must hold of what is kept: ``"slip < 1 mm"``; by default what the scene expects."""
    within: Width | None = None
    """How narrow the bracket is to be, as ``"0.01 N"``; a thousandth of the range by default, a
    twentieth with random starts."""
    share: Annotated[float, Field(gt=0, lt=1)] = 0.5
    """Of random starts that is to hold."""
    runs: Runs = 200
    """At most so many random starts."""
    seed: Seed = 0
    """Of random starts."""


class FitSearch(Spec):
    """The values with which the scene moves as was measured."""

    data: Annotated[str, Field(min_length=1)]
    """What was measured: a CSV file beside this one, with a column ``time`` [s], and columns of
    quantities, SI or as in ``x [mm]``."""
    match: dict[str, str] | None = None
    """The quantity that each column is, ``{"x": "puck.x"}``; by default columns that have a
    quantity's name."""
    noise: dict[str, Width] | None = None
    """Standard deviation of each column, ``{"x": "0.5 mm"}``; estimated by default."""


class BestSearch(Spec):
    """The values with which something is least or most."""

    least: Texts = ()
    """Names of what is kept that is to be least; several goals have several answers."""
    most: Texts = ()
    """Names of what is kept that is to be most."""
    where: Texts = ()
    """What must hold of what is kept: ``"slip < 1 mm"``."""
    sampler: Sampler | None = None
    """How points are chosen: ``cmaes`` (the default for one goal over ranges), ``tpe`` (with
    conditions or lists), ``gp``, ``nsga2`` (for several goals), ``random``."""
    runs: Runs = 200
    """How many; more of them go on from what was done."""
    seed: Seed = 0
    """Of the sampler."""

    @model_validator(mode="after")
    def _sound(self) -> Self:
        if not self.least and not self.most:
            raise PydanticCustomError("bad-search", "say what is to be least or most, of what is "
                                      "kept", {"allowed": '"least": ["spread"], "most": ["force"]'})
        return self


class SensitivitySearch(Spec):
    """How much of what is kept comes from which path."""

    method: Method = "sobol"
    """``sobol`` (shares of the variance) or ``morris`` (screening of many paths)."""
    count: Annotated[int, Field(ge=4, le=MOST_RUNS)] = 64
    """Of points, a power of 2, each of as many runs as there are paths and two more; or of
    Morris' trajectories."""
    seed: Seed = 0
    """Of the points."""

    @model_validator(mode="after")
    def _sound(self) -> Self:
        if self.method == "sobol" and (powers := powers_around(self.count)):
            raise PydanticCustomError(
                "bad-search", "Sobol's points are a power of 2, not {count}",
                {"count": str(self.count), "allowed": ", ".join(map(str, powers))})
        return self


def powers_around(count: int) -> tuple[int, ...]:
    """The powers of 2 below and above a count; none if it is one itself."""
    return (1 << (count.bit_length() - 1), 1 << count.bit_length()) if count & (count - 1) else ()


class RobustnessSearch(Spec):
    """Over which values of one or two paths something holds, as a map."""

    holds: Texts = ()
    """What must hold of what is kept: ``"slip < 1 mm"``; by default what the scene expects."""
    coarse: Annotated[int, Field(ge=1, le=FINEST)] = COARSE
    """Cells along each range at first: what is smaller than one may be missed."""
    within: Annotated[float, Field(gt=0, le=1)] = WITHIN
    """How wide the smallest cells are, in which the boundary lies, as a share of each range."""
    runs: Runs = RUNS
    """At most so many, besides the probes and the certificate."""
    probes: Annotated[int, Field(ge=0, le=MOST_RUNS)] = PROBES
    """Random points that say how much the coarse grid can have missed."""
    boundary: str = ""
    """A closed form of the names that are varied, greater than 0 where it should hold:
    ``"mu - tan(angle)"``."""
    seed: Seed = 0
    """Of the probes."""


class SearchSpec(Spec):
    """One of the searches; what it varies and keeps, the study says."""

    threshold: ThresholdSearch | None = None
    """Where a condition begins or ceases to hold along one range."""
    fit: FitSearch | None = None
    """The values with which the scene moves as was measured."""
    best: BestSearch | None = None
    """The values with which something is least or most."""
    sensitivity: SensitivitySearch | None = None
    """How much of what is kept comes from which path."""
    robustness: RobustnessSearch | None = None
    """Over which values of one or two paths something holds, as a map."""

    @model_validator(mode="after")
    def _one(self) -> Self:
        given = [name for name in SEARCHES if getattr(self, name) is not None]
        if len(given) != 1:
            raise PydanticCustomError(
                "bad-search", "a study is one search" + (f", not {' and '.join(given)}" if given
                                                     else ""), {"allowed": ", ".join(SEARCHES)})
        return self

    @property
    def kind(self) -> str:
        """Which it is."""
        return next(name for name in SEARCHES if getattr(self, name) is not None)

    @property
    def words(self) -> dict[str, Any]:
        """What it says itself, by the names of its options."""
        own = getattr(self, self.kind)
        return {name: getattr(own, name) for name in type(own).model_fields
                if name in own.model_fields_set}


SEARCHES = tuple(SearchSpec.model_fields)
