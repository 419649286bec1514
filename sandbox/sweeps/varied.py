"""What one path of a scene is given in the runs of a sweep: a list, a span, a distribution.

Each stands for values between 0 and 1, its quantiles: so every design of points can take any of
them (inverse transform sampling; Devroye, Non-Uniform Random Variate Generation, 1986, II.2).
"""

from __future__ import annotations

import math
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
from sandbox.scene.elements.spec import Spec
from sandbox.scene.values.numbers import Number, Quantity, number_from, parameters_of, refusal
from sandbox.scene.values.units import Measured, dimension_of, factor_of, units_of
from sandbox.wording import near, quoted

Written = float | int | str | bool | list[Any] | dict[str, Any] | None
"""A value as a scene's file may hold it."""
MANY = 1_000_000
"""Values of one path."""


def common_unit(values: list[float]) -> str:
    """The unit that numbers were written in, the first one's; empty where none has one.

    Raises:
        PydanticCustomError: units of several dimensions, or some with a unit and some without.
    """
    units = [value.unit for value in values if isinstance(value, Measured)]
    bare = [value for value in values if not isinstance(value, Measured) and value != 0.0]
    if units and bare:
        raise PydanticCustomError(
            "wrong-unit", "one number has the unit {unit}, another has none", {"unit": units[0]})
    measures = dict.fromkeys(map(dimension_of, units))
    if len(measures) > 1:
        raise PydanticCustomError("wrong-unit", "these are a {one} and a {other}",
                                  dict(zip(("one", "other"), measures, strict=False)))
    return units[0] if units else ""


class Spanned(Spec):
    """Numbers from one to another, both included."""

    from_: Quantity = Field(alias="from")
    """The first, with a unit or in SI."""
    to: Quantity
    """The last."""
    count: Annotated[int, Field(ge=1, le=MANY)] | None = None
    """How many, for a grid or for pairs; other designs choose them."""
    scale: Literal["linear", "log"] = "linear"
    """Evenly spaced, or in even ratios."""

    @model_validator(mode="after")
    def _sound(self) -> Self:
        _ = self.unit
        if self.scale == "log" and not (self.from_ > 0 and self.to > 0):
            raise PydanticCustomError("bad-study", "a log scale has numbers greater than 0 only")
        if self.count == 1 and self.from_ != self.to:
            raise PydanticCustomError("bad-study", "one number cannot be at both ends: count is 2 "
                                      "or more, or a list with this number")
        if self.count != 1 and self.from_ == self.to:
            raise PydanticCustomError(
                "bad-study", "the range goes from {low} to {low}: there is nothing to vary",
                {"low": f"{in_unit(self.to, self.unit):g} {self.unit}".strip(),
                 "allowed": "two ends that differ, or a list with this one value"})
        return self

    @property
    def unit(self) -> str:
        """The unit that it was written in; empty for none."""
        return common_unit([self.from_, self.to])

    def at(self, shares: Array) -> Array:
        """Numbers [unit] at shares of the way, [n], 0 to 1."""
        low, high = in_unit(self.from_, self.unit), in_unit(self.to, self.unit)
        if self.scale == "log":
            numbers = np.exp((1 - shares) * math.log(low) + shares * math.log(high))
        else:
            numbers = (1 - shares) * low + shares * high
        ends = np.where(shares == 0, low, np.where(shares == 1, high, numbers))
        return np.asarray(ends, dtype=float)

    @property
    def even(self) -> Array:
        """Its ``count`` numbers [unit], [n], without the rounding of their 16th digit."""
        count = self.count or 1
        numbers = self.at(np.linspace(0.0, 1.0, count) if count > 1 else np.zeros(1))
        return np.array([float(f"{number:.15g}") for number in numbers])


class Distributed(Spec):
    """Random numbers; a design chooses their quantiles."""

    distribution: Literal["uniform", "log_uniform", "normal", "log_normal", "triangular",
                          "exponential", "scipy"]
    """Its name; ``scipy`` takes any continuous one of scipy.stats by its ``name``."""
    from_: Quantity | None = Field(None, alias="from")
    """Least number: of uniform, log_uniform and triangular ones; of a normal one where it is
    cut off."""
    to: Quantity | None = None
    """Largest number, as ``from``."""
    mean: Quantity | None = None
    """Of normal and exponential ones."""
    std: Quantity | None = None
    """Standard deviation of normal ones."""
    median: Quantity | None = None
    """Of log-normal ones."""
    sigma: Number | None = None
    """Standard deviation of the natural logarithm of log-normal ones."""
    peak: Quantity | None = None
    """Of triangular ones: the likeliest number."""
    name: str | None = None
    """Of scipy: ``gamma``, ``weibull_min``, ``beta``, …"""
    shapes: tuple[float, ...] = ()
    """Of scipy: the shape parameters, in its order."""
    loc: Quantity | None = None
    """Of scipy: where it begins, 0 by default."""
    scale: Quantity | None = None
    """Of scipy: how wide it is, 1 by default."""

    @model_validator(mode="after")
    def _sound(self) -> Self:
        needed, possible = NEEDS[self.distribution]
        given = {key for key in FIELDS if getattr(self, key) not in (None, ())}
        if lacking := [key for key in needed if key not in given]:
            raise PydanticCustomError("bad-study", "a {kind} distribution needs {keys}", {
                "kind": self.distribution, "keys": " and ".join(map(_shown, lacking))})
        if beyond := sorted(given - {*needed, *possible}):
            raise PydanticCustomError("bad-study", "a {kind} distribution has no {key}", {
                "kind": self.distribution, "key": _shown(beyond[0]),
                "allowed": ", ".join(map(_shown, (*needed, *possible)))})
        _ = self.unit
        self._frozen()
        return self

    @property
    def unit(self) -> str:
        """The unit that it was written in; empty for none."""
        return common_unit([value for key in FIELDS if key not in ("sigma", "name", "shapes")
                            and (value := getattr(self, key)) is not None])

    def _frozen(self) -> Any:
        """The distribution [unit], as scipy has it."""
        try:
            from scipy import stats
        except ImportError:
            raise PydanticCustomError("missing-package", "distributions need scipy: pip install "
                                      "'sandbox-mechanics[studies]'") from None
        known = {key: in_unit(value, self.unit) for key in FIELDS
                 if isinstance(value := getattr(self, key), float) and key != "sigma"}
        low, high = known.get("from_", -math.inf), known.get("to", math.inf)
        if low >= high:
            raise PydanticCustomError("bad-study", "'from' must be less than 'to'")
        match self.distribution:
            case "uniform":
                return stats.uniform(low, high - low)
            case "log_uniform":
                _positive("from", low)
                return stats.loguniform(low, high)
            case "normal":
                mean, std = known["mean"], _positive("std", known["std"])
                if math.isinf(low) and math.isinf(high):
                    return stats.norm(mean, std)
                return stats.truncnorm((low - mean) / std, (high - mean) / std, mean, std)
            case "log_normal":
                return stats.lognorm(_positive("sigma", float(self.sigma or 0.0)), 0,
                                     _positive("median", known["median"]))
            case "triangular":
                peak = known["peak"]
                if not low <= peak <= high:
                    raise PydanticCustomError("bad-study", "'peak' lies from 'from' to 'to'")
                return stats.triang((peak - low) / (high - low), low, high - low)
            case "exponential":
                return stats.expon(0, _positive("mean", known["mean"]))
        return _of_scipy(str(self.name), self.shapes, known.get("loc", 0.0),
                         known.get("scale", 1.0))

    def at(self, shares: Array) -> Array:
        """Quantiles [unit], [n], of shares, 0 to 1; 0 and 1 themselves are moved inside."""
        least = np.finfo(float).eps / 2
        return np.asarray(self._frozen().ppf(np.clip(shares, least, 1 - least)), dtype=float)


NEEDS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "uniform": (("from_", "to"), ()),
    "log_uniform": (("from_", "to"), ()),
    "normal": (("mean", "std"), ("from_", "to")),
    "log_normal": (("median", "sigma"), ()),
    "triangular": (("from_", "peak", "to"), ()),
    "exponential": (("mean",), ()),
    "scipy": (("name",), ("shapes", "loc", "scale")),
}
"""What each distribution needs, and what it may have besides."""
FIELDS = tuple(key for key in Distributed.model_fields if key != "distribution")


def _shown(key: str) -> str:
    return f"'{key.rstrip('_')}'"


def _positive(key: str, value: float) -> float:
    if not value > 0:
        raise PydanticCustomError("bad-study", "{key} must be greater than 0", {"key": key})
    return value


def _of_scipy(name: str, shapes: tuple[float, ...], loc: float, scale: float) -> Any:
    from scipy import stats

    found = getattr(stats, name, None)
    if not isinstance(found, stats.rv_continuous):
        known = [each for each in dir(stats) if isinstance(getattr(stats, each),
                                                            stats.rv_continuous)]
        raise PydanticCustomError("bad-study", "scipy.stats has no continuous distribution "
                                  "{name}", {"name": quoted(name), "hint": near(name, known)})
    if len(shapes) != found.numargs:
        raise PydanticCustomError(
            "bad-study", "{name} has {count} shape parameters ({which}), not {given}",
            {"name": name, "count": found.numargs, "which": found.shapes or "none",
             "given": len(shapes)})
    frozen = found(*shapes, loc=loc, scale=_positive("scale", scale))
    if not math.isfinite(frozen.ppf(0.5)):
        raise PydanticCustomError("bad-study", "{name} has no values with these shape "
                                  "parameters", {"name": name})
    return frozen


def _computed(values: Any, info: ValidationInfo) -> Any:
    """A list as it stands, once its expressions are known to have values."""
    for value in values:
        if isinstance(value, str) and value.lstrip().startswith("="):
            try:
                number_from(value, None, parameters_of(info))
            except ValueError as error:
                raise refusal(error) from None
    return values


def _kind(value: Any) -> str:
    if isinstance(value, (list, tuple)):
        return "list"
    if isinstance(value, Distributed) or (isinstance(value, dict) and "distribution" in value):
        return "distribution"
    return "span"


def _finite(values: Any) -> Any:
    """A list, once its numbers are known to be some: one problem, and not one for each type."""
    if isinstance(values, (list, tuple)) and any(
            isinstance(value, float) and not math.isfinite(value) for value in values):
        raise PydanticCustomError("bad-study", "numbers must be finite (NaN and infinity are not "
                                  "numbers here)")
    return values


Listed = Annotated[tuple[Written, ...], BeforeValidator(_finite), AfterValidator(_computed),
                   Field(min_length=1, max_length=MANY)]
"""Values one after the other, each as a scene's file may hold it."""
Varied = Annotated[
    Annotated[Listed, Tag("list")] | Annotated[Distributed, Tag("distribution")]
    | Annotated[Spanned, Tag("span")], Discriminator(_kind)]
"""What a path is given."""


def in_unit(value: float, unit: str) -> float:
    """A number [SI] in a unit, as it was written: ``0.0161`` is 16.1 of ``mm``."""
    if not unit:
        return float(value)
    return float(f"{float(value) / factor_of(unit, None):.15g}")


def si_unit(unit: str) -> str:
    """The SI unit of what a unit measures; empty for none, and for ratios."""
    found = units_of(dimension_of(unit))[0] if unit else ""
    return "" if found == "%" else found
