"""A sweep as it is written: a file beside a scene, the words of a command line, or Python."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self, get_args

from pydantic import (
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    ValidationInfo,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from sandbox.scene.elements.settings import Looked
from sandbox.scene.elements.spec import Spec
from sandbox.scene.values.expressions import parse_expression
from sandbox.scene.values.numbers import refusal
from sandbox.sweeps.searching import SearchSpec
from sandbox.sweeps.varied import MANY, Distributed, Spanned, Varied
from sandbox.sweeps.words import looked_at, varied_from
from sandbox.wording import quoted

Design = Literal["grid", "paired", "latin_hypercube", "sobol", "halton", "random"]
"""How the points of a group lie."""
EVEN = ("grid", "paired")
"""Designs whose points are those that lists and spans say; the others choose their own."""
MOST_PATHS = 50
UNCOUNTED = "missing-key"
"""What is wrong with a range of which a sweep cannot take points, and a search can."""
NAME = r"^[A-Za-z_][A-Za-z0-9_ .:/*?\[\]-]*$"


def _looked(value: Any) -> Any:
    """``"mean finger.tip over last 0.2 s"`` as an object; a name alone means its last sample."""
    if isinstance(value, str) and not value.lstrip().startswith("="):
        try:
            return looked_at(value)
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


def _varied(value: Any) -> Any:
    """The command line's ``"2 N:8 N:7"`` and ``"normal(3 N, 0.2 N)"`` as a file's objects."""
    if isinstance(value, str):
        try:
            return varied_from(value)
        except ValueError as error:
            raise refusal(error) from None
    return value


Given = Annotated[Varied, BeforeValidator(_varied)]
"""What a path is given, as a file or the command line says it."""
_Written = Annotated[
    Annotated[Looked, Tag("statistic")]
    | Annotated[str, BeforeValidator(_expression), Tag("expression")], Discriminator(_kind)]
Kept = Annotated[_Written, BeforeValidator(_looked)]
"""A statistic of a quantity in a window of time, or an expression of those kept before it."""


class Varying(Spec):
    """Paths that are varied together, by one design."""

    over: Annotated[dict[str, Given], Field(min_length=1, max_length=MOST_PATHS)]
    """What each path of the scene is given: a list, ``from``/``to``/``count``, a distribution,
    or the command line's words for them, as in ``"2 N:8 N:7"`` and ``"normal(3 N, 0.2 N)"``."""
    design: Design | None = None
    """How points lie. By default ``grid`` where lists and spans say how many, ``random`` where
    there is a distribution, and otherwise ``latin_hypercube``."""
    count: Annotated[int, Field(ge=1, le=MANY)] | None = None
    """How many points, of designs that choose them."""

    @property
    def laid_out(self) -> Design:
        """The design, said or not."""
        if self.design is not None:
            return self.design
        if any(isinstance(each, Distributed) for each in self.over.values()):
            return "random"
        return "grid" if self.count is None else "latin_hypercube"

    @model_validator(mode="after")
    def _sound(self) -> Self:
        design = self.laid_out
        if design not in EVEN:
            if self.count is None:
                raise PydanticCustomError("bad-study", "a design {design} needs a count of points",
                                          {"design": quoted(design)})
            self._uncounted(design)
            return self
        if self.count is not None:
            raise PydanticCustomError("bad-study", "a design {design} has as many points as its "
                                      "lists and spans say, and no count of its own",
                                      {"design": quoted(design)})
        for path, each in self.over.items():
            if isinstance(each, Distributed):
                raise PydanticCustomError(
                    "bad-study", "{path} has a distribution, whose numbers a design {design} "
                    "cannot choose",
                    {"path": quoted(path), "design": quoted(design),
                               "allowed": ", ".join(
                                   each for each in get_args(Design) if each not in EVEN)})
            if isinstance(each, Spanned) and each.count is None:
                raise PydanticCustomError(
                    UNCOUNTED, "{path} does not say how many numbers: give it a count, or the "
                    "whole a count and a design", {"path": quoted(path)})
        lengths = {path: len_of(each) for path, each in self.over.items()}
        if design == "paired" and len(set(lengths.values())) > 1:
            raise PydanticCustomError(
                "bad-study", "paired paths have as many values each: {lengths}",
                {"lengths": ", ".join(f"{quoted(path)} {n}" for path, n in lengths.items())})
        return self

    def _uncounted(self, design: Design) -> None:
        """See that no path has a number of points, of a design that chooses them for all."""
        for path, each in self.over.items():
            if isinstance(each, Spanned) and each.count is not None:
                raise PydanticCustomError(
                    "bad-study", "{path} has a count of its own, {own}, and a design {design} "
                    "chooses {count} points for all its paths together",
                    {"path": quoted(path), "own": each.count, "design": quoted(design),
                     "count": self.count, "allowed": "the range without its count; or, for each of "
                     "its values with every other point, a group of its own in a study file: "
                     "\"vary\": [{\"over\": {…}}, {\"over\": {…}, \"count\": …}]"})


def len_of(varied: Varied) -> int:
    """How many values a list or a span of a grid has; a distribution has one at a time."""
    if isinstance(varied, tuple):
        return len(varied)
    return varied.count or 1 if isinstance(varied, Spanned) else 1


class SweepSpec(Spec):
    """A sweep: which scene, what is varied, what is kept of each run."""

    schema_: str = Field("", alias="$schema")
    """Address of a schema, for editors; nothing reads it."""
    format: Literal[1] = 1
    """Version of this format."""
    name: str = ""
    """Its name; by default that of its file."""
    title: str = ""
    """A line above its figure."""
    about: str = ""
    """What it is about."""
    scene: str | dict[str, Any]
    """The scene: a file beside this one, a shipped scene's name, or the scene itself."""
    set: dict[str, Any] = Field(default_factory=dict)
    """What else is changed in the scene, in all runs, by path."""
    vary: tuple[Varying, ...] = Field(min_length=1, max_length=MOST_PATHS)
    """What is varied: paths and values, a grid if nothing else is said; or a list of groups of
    such, each with a design of its own, of which every point meets every other (nested)."""
    seed: Annotated[int, Field(ge=0, le=2**63 - 1)] = 0
    """Of random points: the same seed, the same points."""
    keep: dict[Annotated[str, Field(pattern=NAME, max_length=200)], Kept] = \
        Field(default_factory=dict)
    """What is kept of each run, by name: ``{"mean": "finger.tip.x", "over": "last 0.2 s"}``, the
    same as a text, or an expression of parameters and of what stands before it."""
    search: SearchSpec | None = None
    """A search that chooses the points itself, of what is varied: ``sandbox search`` runs it."""
    audit: bool = True
    """Whether each run is audited."""
    recordings: bool = False
    """Whether the whole recording of each run is kept."""

    @field_validator("vary", mode="before")
    @classmethod
    def _one_group(cls, value: Any, info: ValidationInfo) -> Any:
        if isinstance(value, dict):
            return [{"over": value}]
        return value

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
