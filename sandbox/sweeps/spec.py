"""The format of study files: a sweep, or a search, of a scene; its short texts and its points.

Ranges and distributions map quantiles from 0 to 1 to values, so every design of points can sample
them (inverse transform sampling; Devroye, Non-Uniform Random Variate Generation, 1986, II.2).
"""

from __future__ import annotations

import json
import math
import re
import warnings
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Annotated, Any, Literal, Self, get_args

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationInfo, model_validator
from pydantic_core import PydanticCustomError

from sandbox.numeric import Array, Integers
from sandbox.scene.settings import STATISTICS, Looked
from sandbox.sweeps.job import Override
from sandbox.values.expressions import parse_expression
from sandbox.values.numbers import Number, Quantity, number_from, parameters_of, refusal
from sandbox.values.spec import Spec
from sandbox.values.units import Measured, dimension_of, factor_of, parse_quantity, units_of
from sandbox.wording import WrongValueError, near, quoted

MAX_VALUES = 1_000_000  # values of one path
TEXTS = ('"2:8:60" (from:to:count), "1:100:20:log", "1, 2, 5", "[1, 2, 5]", '
         '"normal(3 N, 0.2 N)", "2:8" with a count of points')
"""Examples of the texts that :func:`parse_values` reads."""
DISTRIBUTIONS: dict[str, tuple[tuple[str, ...], tuple[str, ...], Callable[..., Any]]] = {
    "uniform": (("from", "to"), (), lambda x, low, high: x.uniform(low, high - low)),
    "log_uniform": (("from", "to"), (), lambda x, low, high: x.loguniform(low, high)),
    "normal": (("mean", "std"), ("from", "to"), lambda x, mean, std, low=-np.inf, high=np.inf: (
        x.norm(mean, std) if np.isinf([low, high]).all() else
        x.truncnorm((low - mean) / std, (high - mean) / std, mean, std))),
    "log_normal": (("median", "sigma"), (), lambda x, median, sigma: x.lognorm(sigma, 0, median)),
    "triangular": (("from", "peak", "to"), (), lambda x, low, peak, high: x.triang(
        (peak - low) / (high - low), low, high - low)),
    "exponential": (("mean",), (), lambda x, mean: x.expon(0, mean)),
    "scipy": (("name",), ("shapes", "loc", "scale"), lambda x, name, **more: _scipy(
        x, name, **more)),
}
"""Required and optional arguments of each distribution, and its definition by ``scipy.stats``."""
ENDS = {"from": "low", "to": "high"}
_CALL = re.compile(r"\s*([A-Za-z_][A-Za-z0-9_]*)\s*\(([^()]*)\)\s*")


def wrong_study(message: str, code: Any = "bad-study", **context: Any) -> PydanticCustomError:
    """The error of a study that is wrong."""
    return PydanticCustomError(code, message, context)


def common_unit(values: list[float]) -> str:
    """The unit in which numbers were written: the first one's, empty where none has one."""
    units = [value.unit for value in values if isinstance(value, Measured)]
    bare = [value for value in values if not isinstance(value, Measured) and value != 0.0]
    if units and bare:
        raise PydanticCustomError(
            "wrong-unit", "one number has the unit {unit}, another has none", {"unit": units[0]})
    dimensions = list(dict.fromkeys(map(dimension_of, units)))
    if len(dimensions) > 1:
        raise PydanticCustomError("wrong-unit", "these are a {one} and a {other}",
                                  {"one": dimensions[0], "other": dimensions[1]})
    return units[0] if units else ""


class Range(Spec):
    """Numbers from one to another, both included."""

    from_: Quantity = Field(alias="from")
    """The first, with a unit or in SI."""
    to: Quantity
    """The last."""
    count: Annotated[int, Field(ge=1, le=MAX_VALUES)] | None = None
    """Number of values, for a grid or for pairs; other designs choose them."""
    scale: Literal["linear", "log"] = "linear"
    """Even spacing, or even ratios."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        unit = self.unit
        if self.scale == "log" and not (self.from_ > 0 and self.to > 0):
            raise wrong_study("a log scale has numbers greater than 0 only")
        if self.count == 1 and self.from_ != self.to:
            raise wrong_study("one number cannot be at both ends: count is 2 or more, or a list "
                              "with this number")
        if self.count != 1 and self.from_ == self.to:
            raise wrong_study("the range goes from {low} to {low}: there is nothing to vary",
                              low=f"{in_unit(self.to, unit):g} {unit}".strip(),
                              allowed="two ends that differ, or a list with this one value")
        return self

    @property
    def unit(self) -> str:
        """The unit in which it was written; empty for none."""
        return common_unit([self.from_, self.to])

    def at(self, quantiles: Array) -> Array:
        """Numbers [unit] at quantiles from 0 to 1, [n]."""
        low, high = in_unit(self.from_, self.unit), in_unit(self.to, self.unit)
        if self.scale == "log":
            numbers = np.exp((1 - quantiles) * math.log(low) + quantiles * math.log(high))
        else:
            numbers = (1 - quantiles) * low + quantiles * high
        return np.asarray(np.where(quantiles == 0, low, np.where(quantiles == 1, high, numbers)),
                          dtype=float)


class Distribution(Spec):
    """Random numbers; a design chooses their quantiles."""

    distribution: Literal["uniform", "log_uniform", "normal", "log_normal", "triangular",
                          "exponential", "scipy"]
    """Its name; ``scipy`` takes any continuous one of scipy.stats by its ``name``."""
    from_: Quantity | None = Field(None, alias="from")
    """Lower end of uniform, log_uniform and triangular ones; a normal one is cut off there."""
    to: Quantity | None = None
    """Upper end, as ``from``."""
    mean: Quantity | None = None
    """Of normal and exponential ones."""
    std: Quantity | None = None
    """Standard deviation of normal ones."""
    median: Quantity | None = None
    """Of log-normal ones."""
    sigma: Number | None = None
    """Standard deviation of the natural logarithm of log-normal ones."""
    peak: Quantity | None = None
    """Of triangular ones: the most likely number."""
    name: str | None = None
    """Of scipy: ``gamma``, ``weibull_min``, ``beta``, …"""
    shapes: tuple[float, ...] = ()
    """Of scipy: the shape parameters, in its order."""
    loc: Quantity | None = None
    """Of scipy: the location, 0 by default."""
    scale: Quantity | None = None
    """Of scipy: the scale, 1 by default."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        kind, arguments = self.distribution, self._arguments
        required, optional, _ = DISTRIBUTIONS[kind]
        if missing := [quoted(key) for key in required if key not in arguments]:
            raise wrong_study("a {kind} distribution needs {keys}", kind=kind,
                              keys=" and ".join(missing))
        if unknown := sorted(arguments.keys() - {*required, *optional}):
            raise wrong_study("a {kind} distribution has no {key}", kind=kind,
                              key=quoted(unknown[0]),
                              allowed=", ".join(map(quoted, (*required, *optional))))
        with np.errstate(all="ignore"):
            middle = self.at(np.array([0.5]))
        if not np.isfinite(middle).all():
            raise wrong_study("a {kind} distribution has no values with {arguments}", kind=kind,
                              arguments=", ".join(f"{key} = {value}"
                                                  for key, value in arguments.items()))
        return self

    @property
    def _arguments(self) -> dict[str, Any]:
        """The given arguments, by the names in a file; quantities in SI."""
        return {key.rstrip("_"): value for key in type(self).model_fields
                if key != "distribution" and (value := getattr(self, key)) not in (None, ())}

    @property
    def unit(self) -> str:
        """As of a range."""
        return common_unit([value for key, value in self._arguments.items()
                            if isinstance(value, float) and key != "sigma"])

    def at(self, quantiles: Array) -> Array:
        """Numbers [unit] at quantiles from 0 to 1, [n]; the ends are moved inside by rounding."""
        from scipy import stats
        unit = self.unit
        known = {ENDS.get(key, key): np.float64(in_unit(value, unit))
                 if isinstance(value, float) and key != "sigma" else value
                 for key, value in self._arguments.items()}
        found = DISTRIBUTIONS[self.distribution][2](stats, **known)
        inside = np.finfo(float).eps / 2
        return np.asarray(found.ppf(np.clip(quantiles, inside, 1 - inside)), dtype=float)


def _scipy(
    stats: Any, name: str, shapes: tuple[float, ...] = (), loc: float = 0.0, scale: float = 1.0,
) -> Any:
    found = getattr(stats, name, None)
    if not isinstance(found, stats.rv_continuous):
        known = [each for each in dir(stats)
                 if isinstance(getattr(stats, each), stats.rv_continuous)]
        raise wrong_study("scipy.stats has no continuous distribution {name}", name=quoted(name),
                          hint=near(name, known))
    if len(shapes) != found.numargs:
        raise wrong_study("{name} has {count} shape parameters ({which}), not {given}", name=name,
                          count=found.numargs, which=found.shapes or "none", given=len(shapes))
    return found(*shapes, loc=loc, scale=scale)


def _check_list(values: Any, info: ValidationInfo) -> Any:
    """Report NaN once, not for each type of a value; and expressions that cannot be computed."""
    for value in values if isinstance(values, (list, tuple)) else ():
        if isinstance(value, float) and not math.isfinite(value):
            raise wrong_study("numbers must be finite (NaN and infinity are not numbers here)")
        if isinstance(value, str) and value.lstrip().startswith("="):
            try:
                number_from(value, None, parameters_of(info))
            except ValueError as error:
                raise refusal(error) from None
    return values


def _kind(value: Any) -> str:
    if isinstance(value, (list, tuple)):
        return "list"
    if isinstance(value, Distribution) or (isinstance(value, dict) and "distribution" in value):
        return "distribution"
    return "span"


def _from_text(value: Any) -> Any:
    """Objects of a file from the short texts of the command line."""
    if isinstance(value, str):
        try:
            return parse_values(value)
        except ValueError as error:
            raise refusal(error) from None
    return value


Listed = Annotated[tuple[Override, ...], BeforeValidator(_check_list),
                   Field(min_length=1, max_length=MAX_VALUES)]
"""Single values, each as a scene file may hold it."""
Values = Annotated[
    Annotated[Listed, Tag("list")] | Annotated[Distribution, Tag("distribution")]
    | Annotated[Range, Tag("span")], Discriminator(_kind)]
Given = Annotated[Values, BeforeValidator(_from_text, json_schema_input_type=Values | str)]
"""The values of a path, as an object or a short text."""


def in_unit(value: float, unit: str) -> float:
    """A number [SI] in a unit, as it was written: ``0.0161`` is 16.1 of ``mm``."""
    return float(f"{float(value) / factor_of(unit, None):.15g}") if unit else float(value)


def si_unit(unit: str) -> str:
    """The SI unit of a unit's dimension; empty for none, and for ratios."""
    found = units_of(dimension_of(unit))[0] if unit else ""
    return "" if found == "%" else found


def parse_values(text: str) -> Any:
    """The object of a study file for a short text."""
    text = text.strip()
    if call := _CALL.fullmatch(text):
        return _parse_distribution(call[1], call[2])
    if text.startswith(("[", "{")):
        try:
            return json.loads(text)
        except ValueError as error:
            raise WrongValueError("invalid-json",
                                  f"{quoted(text)} is not JSON: {error}", allowed=TEXTS) from None
    if not text:
        raise WrongValueError("bad-study", "there are no values", allowed=TEXTS)
    if ":" not in text:
        return [*map(_parse_value, text.split(","))]
    first, last, *more = (part.strip() for part in text.split(":"))
    found: dict[str, Any] = {"from": _parse_value(first), "to": _parse_value(last)}
    if more and more[-1] in ("log", "linear"):
        found["scale"] = more.pop()
    if len(more) > 1:
        raise WrongValueError("bad-study", f"{quoted(text)} has too many parts", allowed=TEXTS)
    if more and not more[0].isdecimal():
        raise WrongValueError("bad-study", f"{quoted(more[0])} is not a whole number",
                              allowed=TEXTS, hint=near(more[0], ["log"]))
    return found | ({"count": int(more[0])} if more else {})


def _parse_distribution(name: str, inside: str) -> dict[str, Any]:
    """The object of a distribution that is written as a call."""
    if name not in DISTRIBUTIONS:
        raise WrongValueError("bad-study", f"there is no distribution {quoted(name)}",
                              allowed=", ".join(DISTRIBUTIONS), hint=near(name, DISTRIBUTIONS))
    keys = [*DISTRIBUTIONS[name][0], *DISTRIBUTIONS[name][1]]
    found: dict[str, Any] = {"distribution": name}
    for place, part in enumerate(filter(None, (each.strip() for each in inside.split(",")))):
        key, equals, value = (each.strip() for each in part.partition("="))
        if not equals:
            if place >= len(keys):
                raise WrongValueError("bad-study", f"{name} takes no more than {', '.join(keys)}")
            key, value = keys[place], key
        found[key] = _parse_value(value)
    return found


def _parse_value(text: str) -> Any:
    """A number or word of the command line as a file has it."""
    try:
        return json.loads(text)
    except ValueError:
        return text.strip()


class Points:
    """The product of dimensions, each of paths that vary together; the last changes fastest."""

    def __init__(self, dimensions: Sequence[Mapping[str, Sequence[Override]]]) -> None:
        self._dimensions = dimensions
        self._shape = [len(next(iter(each.values()))) for each in dimensions]
        self.axes = {path: values for each in dimensions for path, values in each.items()}
        self.is_grid = len(self.axes) == len(dimensions)
        """Whether every value of each path is combined with every value of the others."""

    def __len__(self) -> int:
        return math.prod(self._shape)

    @cached_property
    def places(self) -> dict[str, Integers]:
        """The index of a path's value in each run, [n], by path."""
        found = np.unravel_index(np.arange(len(self)), self._shape)
        return {path: place for each, place in zip(self._dimensions, found, strict=True)
                for path in each}

    def __getitem__(self, run: int) -> dict[str, Override]:
        """The values of all paths in a run, from 0."""
        return {path: values[self.places[path][run]] for path, values in self.axes.items()}


def group_points(
    over: Mapping[str, Values], design: str, count: int, seed: int,
) -> list[dict[str, list[Override]]]:
    """The dimensions of a group of paths that vary by one design."""
    if design in ("grid", "paired"):
        axes = {path: [*map(_plain, values)] if isinstance(values, tuple) else
                values_at(values, np.linspace(0.0, 1.0, getattr(values, "count", 1)), digits=15)
                for path, values in over.items()}
        return [{path: axis} for path, axis in axes.items()] if design == "grid" else [axes]
    rng = np.random.default_rng(seed)
    if design == "random":
        quantiles = rng.random((count, len(over)))
    else:
        from scipy.stats import qmc

        engine = {"latin_hypercube": qmc.LatinHypercube, "sobol": qmc.Sobol,
                  "halton": qmc.Halton}[design](len(over), rng=rng)
        with warnings.catch_warnings():  # Sobol's points are balanced for powers of two only
            warnings.simplefilter("ignore", UserWarning)
            quantiles = engine.random(count)
    return [{path: values_at(values, quantiles[:, k])
             for k, (path, values) in enumerate(over.items())}]


def values_at(values: Values, quantiles: Array, *, digits: int = 17) -> list[Override]:
    """Values of a path at quantiles from 0 to 1, [n], as a scene file may hold them."""
    if isinstance(values, tuple):
        places = np.minimum((quantiles * len(values)).astype(int), len(values) - 1)
        return [_plain(values[place]) for place in places]
    numbers = [float(f"{number:.{digits}g}") for number in values.at(quantiles)]
    return [f"{number!r} {values.unit}" if values.unit else number for number in numbers]


def _plain(value: Any) -> Override:
    """A value of a list as JSON has it: pydantic makes tuples of lists."""
    return list(map(_plain, value)) if isinstance(value, tuple) else value


def number_of(written: Override) -> float | str:
    """A value of a path as a table has it: SI where it is a number, else text."""
    if isinstance(written, str):
        try:
            return float(parse_quantity(written, None))
        except ValueError:
            return written
    if written is None or isinstance(written, (bool, list, dict)):
        return json.dumps(written)
    return float(written)



Design = Literal["grid", "paired", "latin_hypercube", "sobol", "halton", "random"]
"""Arrangement of the points of a group."""
EXPLICIT = ("grid", "paired")  # designs with the values of lists and ranges
MAX_PATHS = 50
TAILS = np.array([0.01, 0.99])  # quantiles of a distribution at which a search reads the scene
UNCOUNTED = "missing-key"  # error of a range without a count, which only a search can use
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
    vary: Annotated[
        tuple[Varying, ...], Field(min_length=1, max_length=MAX_PATHS),
        BeforeValidator(lambda value: [{"over": value}] if isinstance(value, dict) else value,
                        json_schema_input_type=dict[str, Given] | tuple[Varying, ...])]
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
