"""Values of a varied path: a list, a range or a distribution, as objects or as short texts.

Ranges and distributions map quantiles from 0 to 1 to values, so every design of points can sample
them (inverse transform sampling; Devroye, Non-Uniform Random Variate Generation, 1986, II.2).
"""

from __future__ import annotations

import json
import math
import re
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    ValidationInfo,
    model_validator,
)
from pydantic_core import PydanticCustomError

from sandbox.numeric import Array
from sandbox.values.numbers import Number, Quantity, number_from, parameters_of, refusal
from sandbox.values.spec import Spec
from sandbox.values.units import Measured, dimension_of, factor_of, units_of
from sandbox.wording import WrongValueError, near, quoted

Written = float | int | str | bool | list[Any] | dict[str, Any] | None
"""A value as a scene file may hold it."""
MAX_VALUES = 1_000_000
"""Values of one path."""
TEXTS = ('"2:8:60" (from:to:count), "1:100:20:log", "1, 2, 5", "[1, 2, 5]", '
         '"normal(3 N, 0.2 N)", "2:8" with a count of points')
"""Examples of the texts that :func:`parse_values` reads."""
_CALL = re.compile(r"\s*([A-Za-z_][A-Za-z0-9_]*)\s*\(([^()]*)\)\s*")


def common_unit(values: list[float]) -> str:
    """The unit in which numbers were written: the first one's, empty where none has one.

    Raises:
        PydanticCustomError: units of several dimensions, or some with a unit and some without.
    """
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
            raise PydanticCustomError("bad-study", "a log scale has numbers greater than 0 only")
        if self.count == 1 and self.from_ != self.to:
            raise PydanticCustomError("bad-study", "one number cannot be at both ends: count is 2 "
                                      "or more, or a list with this number")
        if self.count != 1 and self.from_ == self.to:
            raise PydanticCustomError(
                "bad-study", "the range goes from {low} to {low}: there is nothing to vary",
                {"low": f"{in_unit(self.to, unit):g} {unit}".strip(),
                 "allowed": "two ends that differ, or a list with this one value"})
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

    @property
    def even(self) -> Array:
        """Its ``count`` numbers [unit], [n], rounded to 15 digits."""
        numbers = self.at(np.linspace(0.0, 1.0, self.count or 1))
        return np.array([float(f"{number:.15g}") for number in numbers])


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
        required, optional = ARGUMENTS[self.distribution]
        given = {key for key in FIELDS if getattr(self, key) not in (None, ())}
        if missing := [key for key in required if key not in given]:
            raise PydanticCustomError("bad-study", "a {kind} distribution needs {keys}", {
                "kind": self.distribution, "keys": " and ".join(map(_shown, missing))})
        if unknown := sorted(given - {*required, *optional}):
            raise PydanticCustomError("bad-study", "a {kind} distribution has no {key}", {
                "kind": self.distribution, "key": _shown(unknown[0]),
                "allowed": ", ".join(map(_shown, (*required, *optional)))})
        self._frozen()
        return self

    @property
    def unit(self) -> str:
        """The unit in which it was written; empty for none."""
        return common_unit([value for key in FIELDS
                            if isinstance(value := getattr(self, key), float) and key != "sigma"])

    def _frozen(self) -> Any:
        """The frozen distribution [unit] of scipy.stats."""
        from scipy import stats

        known = {key: in_unit(value, self.unit) for key in FIELDS
                 if isinstance(value := getattr(self, key), float) and key != "sigma"}
        low, high = known.get("from_", -math.inf), known.get("to", math.inf)
        if low >= high:
            raise PydanticCustomError("bad-study", "'from' must be less than 'to'")
        for key in ("std", "sigma", "median", "scale") + ("mean",) * (
                self.distribution == "exponential") + ("from_",) * (
                self.distribution == "log_uniform"):
            if (value := getattr(self, key)) is not None and not value > 0:
                raise PydanticCustomError("bad-study", "{key} must be greater than 0",
                                          {"key": key.rstrip("_")})
        match self.distribution:
            case "uniform":
                return stats.uniform(low, high - low)
            case "log_uniform":
                return stats.loguniform(low, high)
            case "normal":
                mean, std = known["mean"], known["std"]
                if math.isinf(low) and math.isinf(high):
                    return stats.norm(mean, std)
                return stats.truncnorm((low - mean) / std, (high - mean) / std, mean, std)
            case "log_normal":
                return stats.lognorm(float(self.sigma or 0.0), 0, known["median"])
            case "triangular":
                peak = known["peak"]
                if not low <= peak <= high:
                    raise PydanticCustomError("bad-study", "'peak' lies from 'from' to 'to'")
                return stats.triang((peak - low) / (high - low), low, high - low)
            case "exponential":
                return stats.expon(0, known["mean"])
        return _scipy_distribution(str(self.name), self.shapes, known.get("loc", 0.0),
                                   known.get("scale", 1.0))

    def at(self, quantiles: Array) -> Array:
        """Numbers [unit] at quantiles from 0 to 1, [n]; the ends are moved inside by rounding."""
        least = np.finfo(float).eps / 2
        return np.asarray(self._frozen().ppf(np.clip(quantiles, least, 1 - least)), dtype=float)


ARGUMENTS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "uniform": (("from_", "to"), ()),
    "log_uniform": (("from_", "to"), ()),
    "normal": (("mean", "std"), ("from_", "to")),
    "log_normal": (("median", "sigma"), ()),
    "triangular": (("from_", "peak", "to"), ()),
    "exponential": (("mean",), ()),
    "scipy": (("name",), ("shapes", "loc", "scale")),
}
"""Required and optional arguments of each distribution."""
FIELDS = tuple(key for key in Distribution.model_fields if key != "distribution")


def _shown(key: str) -> str:
    return f"'{key.rstrip('_')}'"


def _scipy_distribution(name: str, shapes: tuple[float, ...], loc: float, scale: float) -> Any:
    from scipy import stats

    found = getattr(stats, name, None)
    if not isinstance(found, stats.rv_continuous):
        known = [each for each in dir(stats)
                 if isinstance(getattr(stats, each), stats.rv_continuous)]
        raise PydanticCustomError("bad-study", "scipy.stats has no continuous distribution "
                                  "{name}", {"name": quoted(name), "hint": near(name, known)})
    if len(shapes) != found.numargs:
        raise PydanticCustomError(
            "bad-study", "{name} has {count} shape parameters ({which}), not {given}",
            {"name": name, "count": found.numargs, "which": found.shapes or "none",
             "given": len(shapes)})
    frozen = found(*shapes, loc=loc, scale=scale)
    if not math.isfinite(frozen.ppf(0.5)):
        raise PydanticCustomError("bad-study", "{name} has no values with these shape "
                                  "parameters", {"name": name})
    return frozen


def _check_expressions(values: Any, info: ValidationInfo) -> Any:
    for value in values:
        if isinstance(value, str) and value.lstrip().startswith("="):
            try:
                number_from(value, None, parameters_of(info))
            except ValueError as error:
                raise refusal(error) from None
    return values


def _check_finite(values: Any) -> Any:
    """Report NaN once, and not once for each type that a value may have."""
    if isinstance(values, (list, tuple)) and any(
            isinstance(value, float) and not math.isfinite(value) for value in values):
        raise PydanticCustomError("bad-study", "numbers must be finite (NaN and infinity are not "
                                  "numbers here)")
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


Listed = Annotated[tuple[Written, ...], BeforeValidator(_check_finite),
                   AfterValidator(_check_expressions),
                   Field(min_length=1, max_length=MAX_VALUES)]
"""Single values, each as a scene file may hold it."""
Values = Annotated[
    Annotated[Listed, Tag("list")] | Annotated[Distribution, Tag("distribution")]
    | Annotated[Range, Tag("span")], Discriminator(_kind)]
"""The values of a path."""
Given = Annotated[Values, BeforeValidator(_from_text)]
"""The values of a path, as an object or a short text."""


def in_unit(value: float, unit: str) -> float:
    """A number [SI] in a unit, as it was written: ``0.0161`` is 16.1 of ``mm``."""
    return float(f"{float(value) / factor_of(unit, None):.15g}") if unit else float(value)


def si_unit(unit: str) -> str:
    """The SI unit of a unit's dimension; empty for none, and for ratios."""
    found = units_of(dimension_of(unit))[0] if unit else ""
    return "" if found == "%" else found


def parse_values(text: str) -> Any:
    """The object of a study file for a short text.

    Raises:
        WrongValueError: the text is none of :data:`TEXTS`.
    """
    text = text.strip()
    if call := _CALL.fullmatch(text):
        return _parse_distribution(call[1], call[2])
    if text.startswith(("[", "{")):
        try:
            return json.loads(text, parse_constant=_refuse_constant)
        except ValueError as error:
            raise WrongValueError("invalid-json",
                                  f"{quoted(text)} is not JSON: {error}", allowed=TEXTS) from None
    if ":" in text:
        return _parse_range(text)
    if not text:
        raise WrongValueError("bad-study", "there are no values", allowed=TEXTS)
    return [_parse_value(part) for part in text.split(",")]


def _parse_range(text: str) -> dict[str, Any]:
    first, last, *more = (part.strip() for part in text.split(":"))
    found: dict[str, Any] = {"from": _parse_value(first), "to": _parse_value(last)}
    if more and more[-1] in ("log", "linear"):
        found["scale"] = more.pop()
    if len(more) > 1:
        raise WrongValueError("bad-study", f"{quoted(text)} has too many parts", allowed=TEXTS)
    if more:
        try:
            found["count"] = int(more[0])
        except ValueError:
            raise WrongValueError("bad-study", f"{quoted(more[0])} is not a whole number",
                                  allowed=TEXTS, hint=near(more[0], ["log"])) from None
    return found


def _parse_distribution(name: str, inside: str) -> dict[str, Any]:
    if name not in ARGUMENTS:
        raise WrongValueError("bad-study", f"there is no distribution {quoted(name)}",
                              allowed=", ".join(ARGUMENTS), hint=near(name, ARGUMENTS))
    keys = [key.rstrip("_") for part in ARGUMENTS[name] for key in part]
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
    """A number or word of the command line as a file would hold it."""
    try:
        return json.loads(text, parse_constant=_refuse_constant)
    except ValueError:
        return text.strip()


def _refuse_constant(word: str) -> float:
    raise ValueError(f"{word} is no number")
