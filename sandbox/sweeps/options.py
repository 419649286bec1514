"""The options of searches in study files."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from sandbox.values.numbers import Quantity
from sandbox.values.spec import Spec
from sandbox.wording import quoted, refuse_if

Sampler = Literal["cmaes", "tpe", "gp", "nsga2", "random"]
"""Samplers of an optimisation: CMA-ES (Hansen and Ostermeier, Evol. Comput. 9 (2001) 159),
tree-structured Parzen estimators (Bergstra et al., 2011), a Gaussian process, NSGA-II (Deb et al.,
IEEE Trans. Evol. Comput. 6 (2002) 182), random."""
MAX_SEED = 2**32 - 1  # the largest seed that all libraries take


Texts = Annotated[
    tuple[str, ...], Field(max_length=100),
    BeforeValidator(lambda value: [value] if isinstance(value, str) else value,
                    json_schema_input_type=str | tuple[str, ...])]
Width = Annotated[Quantity, Field(gt=0)]
Seed = Annotated[int, Field(ge=0, le=MAX_SEED)]


class ThresholdSearch(Spec):
    """The value of one path at which a condition begins or ceases to hold."""

    where: Texts = ()
    """Conditions on results, as ``"slip < 1 mm"``; by default the scene's expectations."""
    within: Width | None = None
    """Width of the bracket, as ``"0.01 N"``; a thousandth of the range by default."""


class FitSearch(Spec):
    """The values with which the scene reproduces a measurement."""

    data: Annotated[str, Field(min_length=1)]
    """The measurement: a CSV file beside this one, with a column ``time`` [s], and columns of
    quantities, SI or as in ``x [mm]``."""
    match: dict[str, str] | None = None
    """The quantity of each column, ``{"x": "puck.x"}``; by default columns that have a quantity's
    name."""
    noise: dict[str, Width] | None = None
    """Standard deviation of each column, ``{"x": "0.5 mm"}``; estimated by default."""


class BestSearch(Spec):
    """The values that minimise or maximise results."""

    least: Texts = ()
    """Names of results to minimise; several goals have several solutions."""
    most: Texts = ()
    """Names of results to maximise."""
    where: Texts = ()
    """Conditions on results, as ``"slip < 1 mm"``."""
    sampler: Sampler | None = None
    """``cmaes`` (the default for one goal over ranges), ``tpe`` (with conditions or lists),
    ``gp``, ``nsga2`` (for several goals), ``random``."""
    runs: Annotated[int, Field(ge=1)] = 200
    """Number of runs; a larger one continues the search."""
    seed: Seed = 0
    """Of the sampler."""

    def _verify(self) -> None:
        refuse_if(not self.least and not self.most, "give a quantity to minimise or maximise",
                  "bad-search", allowed='"least": ["spread"], "most": ["force"]')
        for name in sorted({*self.least} & {*self.most}):
            refuse_if(name, f"{quoted(name)} cannot be minimised and maximised at once",
                      "bad-search")


class SensitivitySearch(Spec):
    """The influence of each path on each result."""

    method: Literal["sobol", "morris"] = "sobol"
    """``sobol`` (shares of the variance) or ``morris`` (screening of many paths)."""
    count: Annotated[int, Field(ge=4)] = 64
    """Base points, a power of 2, each with as many runs as there are paths and two more; or
    Morris' trajectories."""
    seed: Seed = 0
    """Of the points."""

    def _verify(self) -> None:
        below = 1 << (self.count.bit_length() - 1)
        refuse_if(self.method == "sobol" and self.count != below,
                  f"Sobol's points are a power of 2, not {self.count}", "bad-search",
                  allowed=f"{below}, {2 * below}")


class SearchSpec(Spec):
    """One search; the study defines which paths vary and which results are kept."""

    threshold: ThresholdSearch | None = None
    fit: FitSearch | None = None
    best: BestSearch | None = None
    sensitivity: SensitivitySearch | None = None

    def _verify(self) -> None:
        given = [name for name, options in self if options is not None]
        refuse_if(len(given) != 1, "a study is one search" +
                  (f", not {' and '.join(given)}" if given else ""), "bad-search",
                  allowed=", ".join(type(self).model_fields))
