"""The format of study files: a sweep, or a search, of a scene; and its short texts."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self, get_args

import numpy as np
from pydantic import (
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    ValidationInfo,
    field_validator,
    model_validator,
)

from sandbox.scene.settings import STATISTICS, Looked
from sandbox.sweeps.vary import (
    MAX_VALUES,
    Distribution,
    Given,
    Points,
    Range,
    Values,
    group_points,
    values_at,
    wrong_study,
)
from sandbox.values.expressions import parse_expression
from sandbox.values.numbers import Quantity, number_from, refusal
from sandbox.values.spec import Spec
from sandbox.wording import WrongValueError, near, quoted

Design = Literal["grid", "paired", "latin_hypercube", "sobol", "halton", "random"]
"""Arrangement of the points of a group."""
EXPLICIT = ("grid", "paired")
"""Designs that use the values of lists and ranges; the others choose their own."""
MAX_PATHS = 50
TAILS = np.array([0.01, 0.99])
"""Quantiles of a distribution at which a search reads the scene before anything runs."""
UNCOUNTED = "missing-key"
"""Error type of a range without a count, which a search can use and a sweep cannot."""
NAME = r"^[A-Za-z_][A-Za-z0-9_ .:/*?\[\]-]*$"


def parse_statistic(text: str) -> dict[str, Any]:
    """The object of ``"mean disc.x over last 0.2 s"`` or ``"disc.x at 0.5 s"``."""
    quantity, at, instant = text.strip().partition(" at ")
    if at:
        return {"quantity": quantity.strip(), "at": instant.strip()}
    what, *windows = text.strip().split(" over ")
    if len(windows) > 1:
        raise WrongValueError("bad-study", f"{quoted(text)} has more than one 'over'")
    statistic, _, quantity = what.partition(" ")
    if not quantity:
        statistic, quantity = "final", what
    elif statistic not in STATISTICS:
        raise WrongValueError("bad-study", f"there is no statistic {quoted(statistic)}",
                              allowed=", ".join(STATISTICS), hint=near(statistic, STATISTICS))
    found: dict[str, Any] = {statistic: quantity.strip()}
    if windows:
        window = windows[0].strip()
        ends = window.split(":")
        if len(ends) != 2 and not window.startswith("last "):
            raise WrongValueError("bad-study", f"{quoted(window)} is no window of time",
                                  allowed='"last 0.2 s", "0.5 s : 1 s"')
        found["over"] = window if len(ends) != 2 else [number_from(end.strip(), "time", {})
                                                       for end in ends]
    return found


def parse_result(text: str) -> tuple[str, str]:
    """Name and definition of ``"tip = max finger.tip.x"``; without a name, the text is the name."""
    name, equals, what = (part.strip() for part in text.partition("="))
    if not equals:
        name = what = text.strip()
    elif not name:
        raise WrongValueError("bad-study",
                              f"{quoted(text)} has no name", allowed="name==expression")
    if not what:
        raise WrongValueError("bad-study", f"{quoted(text)} names no quantity to keep",
                              allowed='"max finger.tip.x over last 0.2 s", "tip=max finger.tip.x", '
                                      '"ratio==tip / pull"')
    return name, what


def _result(value: Any) -> Any:
    """The object of a text; a text that is an expression is checked."""
    if not isinstance(value, str):
        return value
    try:
        if not value.lstrip().startswith("="):
            return parse_statistic(value)
        parse_expression(value)
    except ValueError as error:
        raise refusal(error) from None
    return value


Result = Annotated[
    Annotated[Looked, Tag("statistic")] | Annotated[str, Tag("expression")],
    Discriminator(lambda value: "expression" if isinstance(value, str) else "statistic"),
    BeforeValidator(_result, json_schema_input_type=Looked | str)]
"""A statistic of a quantity in a window of time, or an expression of earlier results."""


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

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.least and not self.most:
            raise wrong_study("give a quantity to minimise or maximise", code="bad-search",
                              allowed='"least": ["spread"], "most": ["force"]')
        if both := sorted({*self.least} & {*self.most}):
            raise wrong_study("{name} cannot be minimised and maximised at once", code="bad-search",
                              name=quoted(both[0]))
        return self


class SensitivitySearch(Spec):
    """The influence of each path on each result."""

    method: Literal["sobol", "morris"] = "sobol"
    """``sobol`` (shares of the variance) or ``morris`` (screening of many paths)."""
    count: Annotated[int, Field(ge=4)] = 64
    """Base points, a power of 2, each with as many runs as there are paths and two more; or
    Morris' trajectories."""
    seed: Seed = 0
    """Of the points."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.method == "sobol" and self.count & (self.count - 1):
            below = 1 << (self.count.bit_length() - 1)
            raise wrong_study("Sobol's points are a power of 2, not {count}", code="bad-search",
                              count=str(self.count), allowed=f"{below}, {2 * below}")
        return self


class SearchSpec(Spec):
    """One search; the study defines which paths vary and which results are kept."""

    threshold: ThresholdSearch | None = None
    fit: FitSearch | None = None
    best: BestSearch | None = None
    sensitivity: SensitivitySearch | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        known = list(type(self).model_fields)
        given = [name for name in known if getattr(self, name) is not None]
        if len(given) != 1:
            raise wrong_study("a study is one search" + (f", not {' and '.join(given)}" if given
                                                         else ""), code="bad-search",
                              allowed=", ".join(known))
        return self


class Varying(Spec):
    """Paths that vary together, by one design."""

    over: Annotated[dict[str, Given], Field(min_length=1, max_length=MAX_PATHS)]
    """Values of each path of the scene: a list, ``from``/``to``/``count``, a distribution, or a
    short text, as in ``"2 N:8 N:7"`` and ``"normal(3 N, 0.2 N)"``."""
    design: Design | None = None
    """Arrangement of the points. By default ``grid`` where lists and ranges have counts,
    ``random`` where there is a distribution, and otherwise ``latin_hypercube``."""
    count: Annotated[int, Field(ge=1, le=MAX_VALUES)] | None = None
    """Number of points, of designs that choose them."""

    @property
    def chosen_design(self) -> Design:
        """The design, given or by default."""
        if self.design is not None:
            return self.design
        if any(isinstance(each, Distribution) for each in self.over.values()):
            return "random"
        return "grid" if self.count is None else "latin_hypercube"

    @model_validator(mode="after")
    def _check(self, info: ValidationInfo) -> Self:
        if (info.context or {}).get("search"):  # it chooses its points itself
            return self
        design, lengths = self.chosen_design, dict[str, int]()
        explicit, words = design in EXPLICIT, {"design": quoted(design), "count": self.count}
        if explicit and self.count is not None:
            raise wrong_study("a design {design} has no count: its lists and spans give the number "
                              "of points", **words)
        if not explicit and self.count is None:
            raise wrong_study("a design {design} needs a count of points", **words)
        for path, each in self.over.items():
            own = each.count if isinstance(each, Range) else None
            words |= {"path": quoted(path), "own": own}
            if not explicit and own is not None:
                raise wrong_study(
                    "{path} has its own count {own}, but a design {design} chooses {count} points "
                    "for all paths together", **words,
                    allowed='the range without its count; or a group in a study file: '
                            '"vary": [{"over": {…}}, {"over": {…}, "count": …}]')
            if explicit and isinstance(each, Distribution):
                raise wrong_study(
                    "{path} has a distribution, whose numbers a design {design} cannot choose",
                    **words,
                    allowed=", ".join(each for each in get_args(Design) if each not in EXPLICIT))
            if explicit and isinstance(each, Range) and own is None:
                raise wrong_study("{path} has no count: give it a count, or give a design and a "
                                  "count for all paths", UNCOUNTED, **words)
            lengths[quoted(path)] = len(each) if isinstance(each, tuple) else own or 0
        if design == "paired" and len({*lengths.values()}) > 1:
            raise wrong_study("paired paths have as many values each: {lengths}",
                              lengths=", ".join(f"{path} {n}" for path, n in lengths.items()))
        return self


class SweepSpec(Spec):
    """A study file."""

    schema_: str = Field("", alias="$schema")
    """Address of a schema, for editors; nothing reads it."""
    format: Literal[1] = 1
    """Version of this format."""
    name: str = ""
    """Its name; by default that of its file."""
    title: str = ""
    """Title of its figure."""
    about: str = ""
    """Description."""
    scene: str | dict[str, Any]
    """The scene: a file beside this one, a shipped scene's name, or the scene itself."""
    set: dict[str, Any] = Field(default_factory=dict)
    """Further changes of the scene, in all runs, by path."""
    vary: tuple[Varying, ...] = Field(min_length=1, max_length=MAX_PATHS)
    """Paths and their values, as a grid; or a list of groups, each with a design of its own, that
    are nested: every point of one meets every point of the others."""
    seed: Annotated[int, Field(ge=0, le=2**63 - 1)] = 0
    """Of random points."""
    keep: dict[Annotated[str, Field(pattern=NAME, max_length=200)], Result] = \
        Field(default_factory=dict)
    """Results of each run, by name: ``{"mean": "finger.tip.x", "over": "last 0.2 s"}``, the same as
    a text, or an expression of parameters and earlier results."""
    search: SearchSpec | None = None
    """A search, which chooses the points itself: ``sandbox search`` runs it."""
    audit: bool = True
    """Whether each run is audited."""
    recordings: bool = False
    """Whether the whole recording of each run is kept."""

    @field_validator("vary", mode="before",
                     json_schema_input_type=dict[str, Given] | tuple[Varying, ...])
    @classmethod
    def _one_group(cls, value: Any) -> Any:
        return [{"over": value}] if isinstance(value, dict) else value

    @model_validator(mode="after")
    def _each_once(self) -> Self:
        seen: set[str] = set(self.set)
        for group in self.vary:
            for path in group.over:
                if path in seen:
                    raise wrong_study("{path} is given values twice", path=quoted(path))
                seen.add(path)
        return self

    @property
    def over(self) -> dict[str, Values]:
        """The values of all varied paths."""
        return {path: values for group in self.vary for path, values in group.over.items()}

    def ends(self) -> Points:
        """Two points, at both ends of all ranges and lists, and in the tails of distributions."""
        return Points([{path: values_at(values, TAILS if isinstance(values, Distribution)
                                        else np.array([0.0, 1.0]))
                        for path, values in self.over.items()}])

    def points(self) -> Points:
        """The points of all groups, which are nested."""
        return Points([axes for place, group in enumerate(self.vary) for axes in group_points(
            group.over, group.chosen_design, group.count or 1, self.seed + place)])


def study_schema() -> dict[str, Any]:
    """The JSON Schema of study files (draft 2020-12), with the short texts that they may hold."""
    from sandbox.scene.reference import DRAFT, described
    return {"$schema": DRAFT, **described(SweepSpec), "title": "A study of sandbox"}
