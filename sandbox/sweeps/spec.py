"""The format of study files: a sweep, or a search, of a scene; its short texts and its points.

Ranges and distributions map quantiles from 0 to 1 to values, so every design of points can sample
them (inverse transform sampling; Devroye, Non-Uniform Random Variate Generation, 1986, II.2).
"""

from __future__ import annotations

import itertools
import json
import math
import re
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Annotated, Any, Literal, Self, get_args

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Tag, ValidationInfo, model_validator

from sandbox.numeric import Array
from sandbox.scene.settings import STATISTICS, Looked
from sandbox.sweeps.job import Override, Point
from sandbox.sweeps.options import SearchSpec
from sandbox.values.expressions import parse_expression
from sandbox.values.numbers import Number, Quantity, number_from, parameters_of
from sandbox.values.spec import Spec
from sandbox.values.units import Measured, dimension_of, factor_of, parse_quantity
from sandbox.wording import WrongValueError, listed, near, quoted, refuse_if

MAX_VALUES = 1_000_000  # values of one path
TEXTS = ('"2:8:60" (from:to:count), "1:100:20:log", "1, 2, 5", "[1, 2, 5]", '
         '"normal(3 N, 0.2 N)", "2:8" with a count of points')
"""Examples of the texts that :func:`parse_values` reads."""
_CALL = re.compile(r"\s*([A-Za-z_][A-Za-z0-9_]*)\s*\(([^()]*)\)\s*")
_refuse_if = partial(refuse_if, code="bad-study")


def _scipy(stats: Any, name: str, shapes: tuple[float, ...], loc: float, scale: float) -> Any:
    found = getattr(stats, name, None)
    if not isinstance(found, stats.rv_continuous):
        known = [each for each in dir(stats)
                 if isinstance(getattr(stats, each), stats.rv_continuous)]
        raise WrongValueError(
            "bad-study", f"scipy.stats has no continuous distribution {quoted(name)}",
            hint=near(name, known))
    _refuse_if(len(shapes) != found.numargs, f"{name} has {found.numargs} shape parameters "
               f"({found.shapes or 'none'}), not {len(shapes)}")
    return found(*shapes, loc=loc, scale=scale)


DISTRIBUTIONS: dict[str, tuple[tuple[str, ...], dict[str, Any], Callable[..., Any]]] = {
    "uniform": (("from", "to"), {}, lambda x, low, high: x.uniform(low, high - low)),
    "log_uniform": (("from", "to"), {}, lambda x, low, high: x.loguniform(low, high)),
    "normal": (("mean", "std"), {"from": -np.inf, "to": np.inf}, lambda x, mean, std, low, high: (
        x.norm(mean, std) if np.isinf([low, high]).all() else
        x.truncnorm((low - mean) / std, (high - mean) / std, mean, std))),
    "log_normal": (("median", "sigma"), {}, lambda x, median, sigma: x.lognorm(sigma, 0, median)),
    "triangular": (("from", "peak", "to"), {}, lambda x, low, peak, high: x.triang(
        (peak - low) / (high - low), low, high - low)),
    "exponential": (("mean",), {}, lambda x, mean: x.expon(0, mean)),
    "scipy": (("name",), {"shapes": (), "loc": 0.0, "scale": 1.0}, _scipy),
}
"""Required arguments of each distribution, optional ones with their defaults, and its definition by
``scipy.stats`` from all of these."""


class Continuous(Spec):
    """Numbers at quantiles from 0 to 1."""

    @property
    def unit(self) -> str:
        """The unit in which they were written: the first number's, empty where none has one."""
        numbers = [value for key, value in self if isinstance(value, float) and key != "sigma"]
        units = [value.unit for value in numbers if isinstance(value, Measured)]
        bare = any(not isinstance(value, Measured) and value != 0.0 for value in numbers)
        refuse_if(units and bare, f"one number has the unit {''.join(units[:1])}, another has none",
                  "wrong-unit")
        kinds = [*dict.fromkeys(map(dimension_of, units))]
        refuse_if(len(kinds) > 1, f"these are a {' and a '.join(kinds[:2])}", "wrong-unit")
        return units[0] if units else ""


class Range(Continuous):
    """Numbers from one to another, both included."""

    from_: Quantity = Field(alias="from")
    """The first, with a unit or in SI."""
    to: Quantity
    """The last."""
    count: Annotated[int, Field(ge=1, le=MAX_VALUES)] | None = None
    """Number of values, for a grid or for pairs; other designs choose them."""
    scale: Literal["linear", "log"] = "linear"
    """Even spacing, or even ratios."""

    def _verify(self) -> None:
        unit, same = self.unit, self.from_ == self.to
        _refuse_if(self.scale == "log" and not (self.from_ > 0 and self.to > 0),
                   "a log scale has numbers greater than 0 only")
        _refuse_if(self.count == 1 and not same, "one number cannot be at both ends: count is 2 or "
                   "more, or a list with this number")
        low = f"{in_unit(self.to, unit):g} {unit}".strip()
        _refuse_if(self.count != 1 and same,
                   f"the range goes from {low} to {low}: there is nothing to vary",
                   allowed="two ends that differ, or a list with this one value")

    def at(self, quantiles: Array) -> Array:
        """Numbers [unit] at quantiles from 0 to 1, [n]."""
        low, high = in_unit(self.from_, self.unit), in_unit(self.to, self.unit)
        if self.scale == "linear":
            return np.asarray((1 - quantiles) * low + quantiles * high)
        numbers = np.exp((1 - quantiles) * math.log(low) + quantiles * math.log(high))
        return np.where(quantiles == 0, low, np.where(quantiles == 1, high, numbers))


class Distribution(Continuous):
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

    def _verify(self) -> None:
        kind, arguments = self.distribution, self._arguments
        required, optional, _ = DISTRIBUTIONS[kind]
        known = [*required, *optional]
        missing = " and ".join(quoted(key) for key in required if key not in arguments)
        _refuse_if(missing, f"a {kind} distribution needs {missing}")
        for key in sorted(arguments.keys() - {*known}):
            _refuse_if(key, f"a {kind} distribution has no {quoted(key)}", allowed=listed(known))
        with np.errstate(all="ignore"):
            middle = self.at(np.array([0.5]))
        given = ", ".join(f"{key} = {value}" for key, value in arguments.items())
        _refuse_if(not np.isfinite(middle).all(),
                   f"a {kind} distribution has no values with {given}")

    @property
    def _arguments(self) -> dict[str, Any]:
        """The given arguments, by the names in a file; quantities in SI."""
        return {key.rstrip("_"): value for key, value in self
                if key != "distribution" and value not in (None, ())}

    def at(self, quantiles: Array) -> Array:
        """Numbers [unit] at quantiles from 0 to 1, [n]; the ends are moved inside by rounding."""
        from scipy import stats
        required, optional, frozen = DISTRIBUTIONS[self.distribution]
        given = optional | {key: np.float64(in_unit(value, self.unit))
                            if isinstance(value, float) and key != "sigma" else value
                            for key, value in self._arguments.items()}
        found = frozen(stats, *[given[key] for key in (*required, *optional)])
        inside = np.finfo(float).eps / 2
        return np.asarray(found.ppf(np.clip(quantiles, inside, 1 - inside)), dtype=float)


def _check_list(values: Any, info: ValidationInfo) -> Any:
    """Report NaN once, not for each type of a value; and expressions that cannot be computed."""
    for value in values if isinstance(values, (list, tuple)) else ():
        if isinstance(value, float) and not math.isfinite(value):
            raise WrongValueError("bad-study", "numbers must be finite (NaN and infinity are not "
                                  "numbers here)")
        if isinstance(value, str) and value.lstrip().startswith("="):
            number_from(value, None, parameters_of(info))
    return values


Listed = Annotated[tuple[Override, ...], BeforeValidator(_check_list),
                   Field(min_length=1, max_length=MAX_VALUES)]
"""Single values, each as a scene file may hold it."""
Values = Annotated[
    Annotated[Listed, Tag("list")] | Annotated[Distribution, Tag("distribution")]
    | Annotated[Range, Tag("span")],
    Discriminator(lambda value: "list" if isinstance(value, (list, tuple)) else "distribution"
                  if isinstance(value, dict) and "distribution" in value else "span")]
Given = Annotated[Values, BeforeValidator(
    lambda value: parse_values(value) if isinstance(value, str) else value,
    json_schema_input_type=Values | str)]
"""The values of a path, as an object or a short text."""


def in_unit(value: float, unit: str) -> float:
    """A number [SI] in a unit, as it was written: ``0.0161`` is 16.1 of ``mm``."""
    return float(f"{float(value) / factor_of(unit, None):.15g}") if unit else float(value)


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
    _refuse_if(not text, "there are no values", allowed=TEXTS)
    if ":" not in text:
        return [*map(_parse_value, text.split(","))]
    first, last, *more = (part.strip() for part in text.split(":"))
    found: dict[str, Any] = {"from": _parse_value(first), "to": _parse_value(last)}
    if more and more[-1] in ("log", "linear"):
        found["scale"] = more.pop()
    _refuse_if(len(more) > 1, f"{quoted(text)} has too many parts", allowed=TEXTS)
    if more and not more[0].isdecimal():
        raise WrongValueError("bad-study", f"{quoted(more[0])} is not a whole number",
                              allowed=TEXTS, hint=near(more[0], ["log"]))
    return found | ({"count": int(more[0])} if more else {})


def _parse_distribution(name: str, inside: str) -> dict[str, Any]:
    if name not in DISTRIBUTIONS:
        raise WrongValueError("bad-study", f"there is no distribution {quoted(name)}",
                              allowed=", ".join(DISTRIBUTIONS), hint=near(name, DISTRIBUTIONS))
    keys = [*DISTRIBUTIONS[name][0], *DISTRIBUTIONS[name][1]]
    found: dict[str, Any] = {"distribution": name}
    for place, part in enumerate(filter(None, map(str.strip, inside.split(",")))):
        key, equals, value = map(str.strip, part.partition("="))
        if not equals:
            _refuse_if(place >= len(keys), f"{name} takes no more than {', '.join(keys)}")
            key, value = keys[place], key
        found[key] = _parse_value(value)
    return found


def _parse_value(text: str) -> Any:
    """A number or word of the command line as a file has it."""
    try:
        return json.loads(text)
    except ValueError:
        return text.strip()


def points_of(dimensions: Iterable[Mapping[str, Sequence[Override]]]) -> list[Point]:
    """The product of dimensions, each of paths that vary together; the last changes fastest."""
    rows = [[dict(zip(each, values, strict=True)) for values in zip(*each.values(), strict=True)]
            for each in dimensions]
    return [{path: value for part in parts for path, value in part.items()}
            for parts in itertools.product(*rows)]


def values_at(values: Values, quantiles: Array, *, digits: int = 17) -> list[Override]:
    """Values of a path at quantiles from 0 to 1, [n], as a scene file may hold them."""
    if isinstance(values, tuple):
        places = np.minimum((quantiles * len(values)).astype(int), len(values) - 1)
        return [values[place] for place in places]
    numbers = [float(f"{number:.{digits}g}") for number in values.at(quantiles)]
    return [f"{number!r} {values.unit}" if values.unit else number for number in numbers]


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
NAME = r"^[A-Za-z_*?\[][A-Za-z0-9_ .:/*?\[\]-]*$"


def parse_statistic(text: str) -> dict[str, Any]:
    """The object of ``"mean disc.x over last 0.2 s"`` or ``"disc.x at 0.5 s"``."""
    quantity, at, instant = map(str.strip, text.partition(" at "))
    if at:
        return {"quantity": quantity, "at": instant}
    what, *windows = text.strip().split(" over ")
    _refuse_if(len(windows) > 1, f"{quoted(text)} has more than one 'over'")
    statistic, _, quantity = what.partition(" ")
    if not quantity:
        statistic, quantity = "final", what
    elif statistic not in STATISTICS:
        raise WrongValueError("bad-study", f"there is no statistic {quoted(statistic)}",
                              allowed=", ".join(STATISTICS), hint=near(statistic, STATISTICS))
    found: dict[str, Any] = {statistic: quantity.strip()}
    for window in map(str.strip, windows):
        ends = window.split(":")
        _refuse_if(len(ends) != 2 and not window.startswith("last "),
                   f"{quoted(window)} is no window of time", allowed='"last 0.2 s", "0.5 s : 1 s"')
        found["over"] = window if len(ends) != 2 else [number_from(end.strip(), "time", {})
                                                       for end in ends]
    return found


def _result(value: Any) -> Any:
    """The object of a text; a text that is an expression is checked."""
    if not isinstance(value, str):
        return value
    if not value.lstrip().startswith("="):
        return parse_statistic(value)
    parse_expression(value)
    return value


Result = Annotated[
    Annotated[Looked, Tag("statistic")] | Annotated[str, Tag("expression")],
    Discriminator(lambda value: "expression" if isinstance(value, str) else "statistic"),
    BeforeValidator(_result, json_schema_input_type=Looked | str)]
"""A statistic of a quantity in a window of time, or an expression of earlier results."""


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
        design, lengths = self.chosen_design, dict[str, int | None]()
        explicit = design in EXPLICIT
        _refuse_if(explicit and self.count is not None, f"a design {quoted(design)} has no count: "
                   "its lists and spans give the number of points")
        _refuse_if(not explicit and self.count is None,
                   f"a design {quoted(design)} needs a count of points")
        for path, each in self.over.items():
            own = each.count if isinstance(each, Range) else None
            _refuse_if(
                not explicit and own is not None,
                f"{quoted(path)} has its own count {own}, but a design {quoted(design)} chooses "
                f"{self.count} points for all paths together",
                allowed='the range without its count; or a group in a study file: '
                        '"vary": [{"over": {…}}, {"over": {…}, "count": …}]')
            _refuse_if(
                explicit and isinstance(each, Distribution), f"{quoted(path)} has a distribution, "
                f"whose numbers a design {quoted(design)} cannot choose",
                allowed=", ".join(each for each in get_args(Design) if each not in EXPLICIT))
            _refuse_if(
                explicit and isinstance(each, Range) and own is None,
                f"{quoted(path)} has no count: give it a count, or give a design and a count for "
                "all paths", code=UNCOUNTED)
            lengths[path] = len(each) if isinstance(each, tuple) else own
        _refuse_if(
            design == "paired" and len({*lengths.values()}) > 1, "paired paths have as many values "
            f"each: {', '.join(f'{quoted(path)} {n}' for path, n in lengths.items())}")
        return self

    def dimensions(self, seed: int) -> list[dict[str, list[Override]]]:
        """The dimensions of its points."""
        design = self.chosen_design
        if design in EXPLICIT:
            axes = {path: [*values] if isinstance(values, tuple) else
                    values_at(values, np.linspace(0.0, 1.0, getattr(values, "count", 1)), digits=15)
                    for path, values in self.over.items()}
            return [{path: axis} for path, axis in axes.items()] if design == "grid" else [axes]
        rng, count = np.random.default_rng(seed), self.count or 1
        if design == "random":
            quantiles = rng.random((count, len(self.over)))
        else:
            from scipy.stats import qmc

            engine = {"latin_hypercube": qmc.LatinHypercube, "sobol": qmc.Sobol,
                      "halton": qmc.Halton}[design](len(self.over), rng=rng)
            with warnings.catch_warnings():  # Sobol's points are balanced for powers of two only
                warnings.simplefilter("ignore", UserWarning)
                quantiles = engine.random(count)
        return [{path: values_at(values, quantiles[:, k])
                 for k, (path, values) in enumerate(self.over.items())}]


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

    def _verify(self) -> None:
        seen = {*self.set}
        for path in (path for group in self.vary for path in group.over):
            _refuse_if(path in seen, f"{quoted(path)} is given values twice")
            seen.add(path)

    @property
    def over(self) -> dict[str, Values]:
        """The values of all varied paths."""
        return {path: values for group in self.vary for path, values in group.over.items()}

    def ends(self) -> list[dict[str, list[Override]]]:
        """One dimension: both ends of all ranges and lists, and the tails of distributions."""
        return [{path: values_at(values, TAILS if isinstance(values, Distribution)
                                 else np.array([0.0, 1.0]))
                 for path, values in self.over.items()}]

    def dimensions(self) -> list[dict[str, list[Override]]]:
        """The dimensions of all groups, which are nested."""
        return [axes for place, group in enumerate(self.vary)
                for axes in group.dimensions(self.seed + place)]


def study_schema() -> dict[str, Any]:
    """The JSON Schema of study files (draft 2020-12), with the short texts that they may hold."""
    from sandbox.scene.reference import DRAFT, described
    return {"$schema": DRAFT, **described(SweepSpec), "title": "A study of sandbox"}
