"""The format of study files: a sweep, or a search, of a scene; and its short texts."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from sandbox.scene.settings import STATISTICS, Looked
from sandbox.sweeps.vary import MAX_VALUES, Distribution, Given, Range, Values
from sandbox.values.expressions import parse_expression
from sandbox.values.numbers import Quantity, number_from, refusal
from sandbox.values.spec import Spec
from sandbox.wording import WrongValueError, near, quoted

Design = Literal["grid", "paired", "latin_hypercube", "sobol", "halton", "random"]
"""Arrangement of the points of a group."""
EXPLICIT = ("grid", "paired")
"""Designs that use the values of lists and ranges; the others choose their own."""
MAX_PATHS = 50
UNCOUNTED = "missing-key"
"""Error type of a range without a count, which a search can use and a sweep cannot."""
NAME = r"^[A-Za-z_][A-Za-z0-9_ .:/*?\[\]-]*$"
_OVER = re.compile(r"\s+over\s+")


# -- short texts ---------------------------------------------------------------------


def parse_statistic(text: str) -> dict[str, Any]:
    """The object of ``"mean disc.x over last 0.2 s"`` or ``"disc.x at 0.5 s"``.

    A quantity alone means its last sample.

    Raises:
        WrongValueError: an unknown statistic, or no window of time.
    """
    quantity, at, instant = text.strip().partition(" at ")
    if at:
        return {"quantity": quantity.strip(), "at": instant.strip()}
    what, *windows = _OVER.split(text.strip())
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
        found["over"] = _parse_window(windows[0].strip())
    return found


def _parse_window(text: str) -> Any:
    if text.startswith("last "):
        return text
    ends = [part.strip() for part in text.split(":")]
    if len(ends) != 2:
        raise WrongValueError("bad-study", f"{quoted(text)} is no window of time",
                              allowed='"last 0.2 s", "0.5 s : 1 s"')
    return [number_from(end, "time", {}) for end in ends]


def statistic_text(statistic: Looked) -> str:
    """The text of a statistic: the inverse of :func:`parse_statistic`."""
    if statistic.at is not None:
        return f"{statistic.quantity} {statistic.statistic}"
    begin, end = statistic.over
    text = f"{statistic.statistic} {statistic.quantity}"
    if statistic.over == (0.0, None):
        return text
    if begin < 0 and end is None:
        return f"{text} over last {-begin:g} s"
    return f"{text} over {begin:g} s : {'end' if end is None else f'{end:g} s'}"


def parse_result(text: str) -> tuple[str, str]:
    """Name and definition of ``"tip = max finger.tip.x"``; without a name, the text is the name.

    Raises:
        WrongValueError: it is empty, or an expression without a name.
    """
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


def _statistic(value: Any) -> Any:
    if isinstance(value, str) and not value.lstrip().startswith("="):
        try:
            return parse_statistic(value)
        except ValueError as error:
            raise refusal(error) from None
    return value


def _expression(value: Any) -> Any:
    if isinstance(value, str):
        try:
            parse_expression(value)
        except ValueError as error:
            raise refusal(error) from None
    return value


def _kind(value: Any) -> str:
    return "expression" if isinstance(value, str) else "statistic"


_Result = Annotated[
    Annotated[Looked, Tag("statistic")]
    | Annotated[str, BeforeValidator(_expression), Tag("expression")], Discriminator(_kind)]
Result = Annotated[_Result, BeforeValidator(_statistic)]
"""A statistic of a quantity in a window of time, or an expression of earlier results."""


# -- searches ------------------------------------------------------------------------

Sampler = Literal["cmaes", "tpe", "gp", "nsga2", "random"]
"""Samplers of an optimisation: CMA-ES (Hansen and Ostermeier, Evol. Comput. 9 (2001) 159),
tree-structured Parzen estimators (Bergstra et al., 2011), a Gaussian process, NSGA-II (Deb et al.,
IEEE Trans. Evol. Comput. 6 (2002) 182), random."""
Method = Literal["sobol", "morris"]
MAX_RUNS = 1_000_000
MAX_SEED = 2**32 - 1
"""The largest seed that all libraries take."""


def _several(value: Any) -> Any:
    return [value] if isinstance(value, str) else value


def _positive(value: float) -> float:
    if value <= 0:
        raise PydanticCustomError("bad-search", "must be greater than 0")
    return value


Texts = Annotated[
    tuple[str, ...], Field(max_length=100),
    BeforeValidator(_several, json_schema_input_type=str | tuple[str, ...])]
Width = Annotated[Quantity, AfterValidator(_positive)]
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
    runs: Annotated[int, Field(ge=1, le=MAX_RUNS)] = 200
    """Number of runs; a larger one continues the search."""
    seed: Seed = 0
    """Of the sampler."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.least and not self.most:
            raise PydanticCustomError("bad-search", "give a quantity to minimise or maximise",
                                      {"allowed": '"least": ["spread"], "most": ["force"]'})
        return self


class SensitivitySearch(Spec):
    """The influence of each path on each result."""

    method: Method = "sobol"
    """``sobol`` (shares of the variance) or ``morris`` (screening of many paths)."""
    count: Annotated[int, Field(ge=4, le=MAX_RUNS)] = 64
    """Base points, a power of 2, each with as many runs as there are paths and two more; or
    Morris' trajectories."""
    seed: Seed = 0
    """Of the points."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.method == "sobol" and (powers := powers_around(self.count)):
            raise PydanticCustomError(
                "bad-search", "Sobol's points are a power of 2, not {count}",
                {"count": str(self.count), "allowed": ", ".join(map(str, powers))})
        return self


def powers_around(count: int) -> tuple[int, ...]:
    """The powers of 2 below and above a count; none if it is one itself."""
    return (1 << (count.bit_length() - 1), 1 << count.bit_length()) if count & (count - 1) else ()


class SearchSpec(Spec):
    """One search; the study defines which paths vary and which results are kept."""

    threshold: ThresholdSearch | None = None
    """The value of one path at which a condition begins or ceases to hold."""
    fit: FitSearch | None = None
    """The values with which the scene reproduces a measurement."""
    best: BestSearch | None = None
    """The values that minimise or maximise results."""
    sensitivity: SensitivitySearch | None = None
    """The influence of each path on each result."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        given = [name for name in SEARCHES if getattr(self, name) is not None]
        if len(given) != 1:
            raise PydanticCustomError(
                "bad-search", "a study is one search" + (f", not {' and '.join(given)}" if given
                                                     else ""), {"allowed": ", ".join(SEARCHES)})
        return self

    @property
    def kind(self) -> str:
        """Its name."""
        return next(name for name in SEARCHES if getattr(self, name) is not None)

    @property
    def options(self) -> dict[str, Any]:
        """The options that the file gives."""
        own = getattr(self, self.kind)
        return {name: getattr(own, name) for name in type(own).model_fields
                if name in own.model_fields_set}


SEARCHES = tuple(SearchSpec.model_fields)


# -- sweeps --------------------------------------------------------------------------


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
    def _check(self) -> Self:
        design = self.chosen_design
        if design in EXPLICIT:
            self._check_explicit(design)
        elif self.count is None:
            raise PydanticCustomError("bad-study", "a design {design} needs a count of points",
                                      {"design": quoted(design)})
        for path, each in self.over.items():
            if design not in EXPLICIT and isinstance(each, Range) and each.count is not None:
                raise PydanticCustomError(
                    "bad-study", "{path} has its own count {own}, but a design {design} chooses "
                                 "{count} points for all paths together",
                    {"path": quoted(path), "own": each.count, "design": quoted(design),
                     "count": self.count, "allowed": "the range without its count; or a group in a "
                                                     'study file: "vary": [{"over": {…}}, '
                                                     '{"over": {…}, "count": …}]'})
        return self

    def _check_explicit(self, design: Design) -> None:
        if self.count is not None:
            raise PydanticCustomError(
                "bad-study", "a design {design} has no count: its lists and spans give the number "
                             "of points", {"design": quoted(design)})
        for path, each in self.over.items():
            if isinstance(each, Distribution):
                raise PydanticCustomError(
                    "bad-study", "{path} has a distribution, whose numbers a design {design} "
                    "cannot choose",
                    {"path": quoted(path), "design": quoted(design), "allowed": ", ".join(
                        name for name in get_args(Design) if name not in EXPLICIT)})
            if isinstance(each, Range) and each.count is None:
                raise PydanticCustomError(
                    UNCOUNTED, "{path} has no count: give it a count, or give a design and a count "
                               "for all paths", {"path": quoted(path)})
        lengths = {path: value_count(each) for path, each in self.over.items()}
        if design == "paired" and len(set(lengths.values())) > 1:
            raise PydanticCustomError(
                "bad-study", "paired paths have as many values each: {lengths}",
                {"lengths": ", ".join(f"{quoted(path)} {n}" for path, n in lengths.items())})


def value_count(values: Values) -> int:
    """Number of values of a list or a range."""
    if isinstance(values, tuple):
        return len(values)
    return values.count or 1 if isinstance(values, Range) else 1


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

    @field_validator("vary", mode="before")
    @classmethod
    def _one_group(cls, value: Any) -> Any:
        return [{"over": value}] if isinstance(value, dict) else value

    @model_validator(mode="after")
    def _each_once(self) -> Self:
        seen: set[str] = set(self.set)
        for group in self.vary:
            for path in group.over:
                if path in seen:
                    raise PydanticCustomError("bad-study", "{path} is given values twice",
                                              {"path": quoted(path)})
                seen.add(path)
        return self


def study_schema() -> dict[str, Any]:
    """The JSON Schema of study files (draft 2020-12), with the short texts that they may hold."""
    from sandbox.scene.reference import DRAFT, described

    schema = described(SweepSpec)
    own = schema["properties"]
    over = schema["$defs"]["Varying"]["properties"]["over"]
    over["additionalProperties"] = {"anyOf": [
        {key: value for key, value in over["additionalProperties"].items() if key != "default"},
        {"type": "string", "description": "\"2 N:8 N:7\", \"normal(3 N, 0.2 N)\" or \"1, 2, 5\", "
                                          "as on the command line."}]}
    own["vary"] = {"description": own["vary"]["description"], "anyOf": [
        {key: value for key, value in each.items() if key != "description"}
        for each in (over, own["vary"])]}
    own["keep"]["additionalProperties"] = {"anyOf": [
        {"$ref": "#/$defs/Looked"},
        {"type": "string", "description": "\"mean disc.x over last 0.2 s\", or an expression such "
                                          "as \"=tip / pull\"."}]}
    own["keep"].pop("patternProperties", None)
    return {"$schema": DRAFT, **schema, "title": "A study of sandbox"}
