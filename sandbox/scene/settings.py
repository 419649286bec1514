"""Models beside the machine: run, contact rules, meters, expectations, events, view, groups."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ValidationInfo,
    WithJsonSchema,
    field_serializer,
    field_validator,
    model_validator,
)

from sandbox.elements.controllers.controller import bound
from sandbox.elements.element import BODY, HELD, BodyName
from sandbox.scene.bodies import STATIC_OF_NOTHING
from sandbox.scene.layers import ShownLayers
from sandbox.values import numbers as of
from sandbox.values.expressions import is_expression
from sandbox.values.numbers import Instant, Items, Name, Pair, Quantity, number_from
from sandbox.values.spec import Spec, text_for
from sandbox.wording import refuse_if

RETIRED = ("iterations", "slop")  # settings of Run in older scenes and recordings; they are ignored


class PymunkRun(Spec):
    """Settings of the solver pymunk."""

    substeps: int = Field(default=1, ge=1, le=1000)
    """Steps of pymunk in each time step of the run."""
    iterations: int = Field(default=30, ge=1, le=10_000)
    """Iterations of pymunk's solver in each step."""


class Run(Spec):
    """Duration, time step and sample rate of a run.

    Older scenes may have ``iterations`` and ``slop``; they are ignored.
    """

    duration: of.Duration = 1.0
    """Duration of the run [s]."""
    step: of.Duration = 5e-4
    """Time step h [s]: shorter is more accurate and takes longer in proportion."""
    sample_rate: of.Frequency = 1000.0
    """Samples recorded per second [Hz], rounded to a whole number of steps."""
    solver: Literal["direct", "pymunk"] = "direct"
    """``direct`` solves all forces of a step together; ``pymunk`` uses pymunk's joints, springs and
    contacts, whose errors docs/pymunk.md shows."""
    pymunk: PymunkRun = PymunkRun()
    """Steps and iterations of the solver ``pymunk``."""

    @property
    def solver_step(self) -> float:
        """Time step of the solver [s]."""
        return self.step / (self.pymunk.substeps if self.solver == "pymunk" else 1)

    @model_validator(mode="before")
    @classmethod
    def _without_retired(cls, data: Any) -> Any:
        return {key: value for key, value in data.items() if key not in RETIRED} if isinstance(
            data, dict) else data


class ContactRule(Spec):
    """Contact rule between two sets of bodies; later rules override earlier ones."""

    between: Pair[str]
    """Two names or patterns: ``finger*`` means all bodies whose name starts with ``finger``."""
    collide: of.Flag = True
    """False disables contact, true enables it again; a joint's ``collide`` overrides all rules."""
    friction: of.Ratio | None = None
    """Coulomb coefficient; by default the geometric mean of the two materials'."""
    static: of.Ratio | None = Field(default=None, ge=1)
    """Ratio of static to sliding friction; by default the geometric mean of the two materials'."""

    def _verify(self) -> None:
        refuse_if(self.friction == 0 and (self.static or 1) > 1, STATIC_OF_NOTHING)


def _bound_text(text: str, info: ValidationInfo) -> str:
    """An expression with the scene's parameters replaced by their values."""
    return f"={of.bound_expression(text, info).text}"


class Meter(Spec):
    """A named quantity computed from recorded ones, saved in ``run.npz``."""

    name: Name
    """Its name; it is recorded, expected and plotted like any other quantity."""
    value: Annotated[str, AfterValidator(_bound_text)]
    """An expression of quantities, SI: ``"=finger1.mcp.angle + finger1.pip.angle"``."""
    unit: str = ""
    """Unit shown in files and plots; values are not converted."""


def _window(value: object, info: ValidationInfo) -> object:
    if isinstance(value, str) and value.startswith("last "):
        return -number_from(value.removeprefix("last "), "time", of.parameters_of(info)), None
    return value


_NUMBER = {"anyOf": [{"type": "number"}, {"type": "string"}]}
WINDOW = WithJsonSchema({"anyOf": [
    {"type": "string", "pattern": "^last "},
    {"type": "array", "minItems": 2, "maxItems": 2,
     "prefixItems": [_NUMBER, {"anyOf": [*_NUMBER["anyOf"], {"type": "null"}]}]},
]})
Window = Annotated[
    of.Written[tuple[Quantity, Quantity | None]], BeforeValidator(_window), WINDOW]
STATISTICS = ("mean", "min", "max", "std", "final")
ROUNDING = 1e-9  # two instants closer than this [s] are one
WITHIN = "0.1 %"  # default tolerance of an expectation


class Looked(Spec):
    """A number made of a recorded quantity: its value at an instant, or a statistic in a window."""

    mean: str | None = None
    """Quantity or pattern; its mean over the window is used."""
    min: str | None = None
    """Quantity or pattern; its minimum in the window is used."""
    max: str | None = None
    """Quantity or pattern; its maximum in the window is used."""
    std: str | None = None
    """Quantity or pattern; its standard deviation over the window is used."""
    final: str | None = None
    """Quantity or pattern; its last sample of the window is used."""
    over: Window = (0.0, None)
    """Window of time: ``"last 0.2 s"`` or ``[from, to]`` [s]; the whole run by default."""
    of: Annotated[str | None, Field(alias="quantity")] = None
    """Quantity or pattern; its value at the instant ``at`` is used."""
    at: Instant | None = None
    """Instant [s] of the value of ``quantity``, interpolated linearly between samples."""

    @property
    def statistic(self) -> str:
        """One of :data:`STATISTICS`, or the instant, as in ``at 0.5 s``."""
        return self.key if self.at is None else f"at {self.at:g} s"

    @property
    def key(self) -> str:
        """The JSON key that names the quantity."""
        return next((name for name in STATISTICS if getattr(self, name) is not None), "quantity")

    @property
    def quantity(self) -> str:
        """The quantity, or pattern of quantities."""
        return str(getattr(self, self.key) if self.of is None else self.of)

    def past_end(self, duration: float) -> str:
        """Why no run of a duration [s] has this value; empty otherwise."""
        start, end = self.over
        if self.at is not None and self.at > duration + ROUNDING:
            return f"the instant is {self.at:g} s, the run ends at {duration:g} s"
        if end is not None and end > duration + ROUNDING:
            return f"the window ends at {end:g} s, the run at {duration:g} s"
        if end is None and -start > duration + ROUNDING:
            return f"the window is the last {-start:g} s, the run has {duration:g} s"
        return ""

    def _verify(self) -> None:
        start, end = self.over
        refuse_if(sum(getattr(self, name) is not None for name in (*STATISTICS, "of")) != 1,
                  f"give exactly one of {', '.join(STATISTICS)}, or 'quantity' with 'at'")
        refuse_if((self.of is None) != (self.at is None), "'quantity' and 'at' go together")
        refuse_if(self.at is not None and self.over != (0.0, None),
                  "'at' is one instant and 'over' a window: give one of them")
        refuse_if(end is not None and end < start, f"the window ends at {end or 0:g} s, before it "
                  f"begins at {start:g} s", "out-of-range")


class Expect(Looked):
    """An expectation: a range for a recorded quantity, the scene's regression test.

    One of ``mean``, ``min``, ``max``, ``std`` or ``final`` names the quantity, or ``quantity`` with
    the instant ``at``; every match of a pattern must hold. One of ``is``, ``between``, ``above`` or
    ``below`` gives the range.
    """

    value: Annotated[Quantity | None, Field(alias="is")] = None
    """Its value, in the quantity's unit, up to ``within``."""
    within: str | Quantity = WITHIN
    """Tolerance about ``is``: a fraction, by default ``"0.1 %"``, or an absolute quantity. By
    default 0 for quantities that are 1 or 0, such as ``held``."""
    between: Pair[Quantity] | None = None
    """[minimum, maximum], both included."""
    above: Quantity | None = None
    """Minimum, included; may be combined with ``below``."""
    below: Quantity | None = None
    """Maximum, included; may be combined with ``above``."""
    because: str = ""
    """Source of the range: a closed form, a paper, a measurement."""

    @field_validator("within", mode="before")
    @classmethod
    def _tolerance(cls, value: object, info: ValidationInfo) -> object:
        fraction = isinstance(value, str) and value.strip().endswith("%")
        number = number_from(value, "ratio" if fraction else None, of.parameters_of(info))
        return value if fraction else number

    @field_serializer("within")
    def _without_unit(self, within: str | float) -> str | float:
        """A plain number: pydantic takes a union's members by their very types."""
        return within if isinstance(within, str) else float(within)

    def _verify(self) -> None:
        super()._verify()
        either = self.above if self.above is not None else self.below
        refuse_if(sum(x is not None for x in (self.value, self.between, either)) != 1,
                  "give one of 'is', 'between', or 'above'/'below'")
        refuse_if(self.between is not None and self.between[0] > self.between[1],
                  "'between' is [lowest, highest]", "out-of-range")

    def range(self) -> tuple[float, float]:
        """Minimum and maximum that pass (infinite where open)."""
        if self.value is not None:
            width = self.within if not isinstance(self.within, str) else \
                abs(self.value) * number_from(self.within, "ratio", {})
            return self.value - width, self.value + width
        if self.between is not None:
            return self.between
        return (-math.inf if self.above is None else self.above,
                math.inf if self.below is None else self.below)


def _listed(value: object) -> object:
    return [value] if isinstance(value, str) else value


Names = Annotated[Items[Annotated[Name, HELD]], BeforeValidator(_listed, json_schema_input_type=(
    Name | tuple[Name, ...]))]
"""One name or several of elements that can be released."""


class Event(Spec):
    """Sets drives, switches controllers, releases or engages elements, or stops the run.

    It happens at most once. An event without actions marks an instant in plots and pages.
    """

    name: Name
    """Its name in the result."""
    at: of.Instant | None = None
    """Its time [s]: before the first step whose forces act at or after it."""
    when: Annotated[str, AfterValidator(bound)] | None = None
    """A condition of quantities, such as ``"=finger.mcp.angle > 0.5"``; instead of ``at``."""
    after: of.Instant = 0.0
    """Earliest time for ``when`` [s]."""
    rate: of.Frequency | None = None
    """Rate at which ``when`` is evaluated [Hz]; by default 1 kHz as a controller's rate."""
    set: dict[str, Quantity] = Field(default_factory=dict)
    """New values of drives, ``<controller>.target`` or ``<controller>.active`` (0 or 1)."""
    release: Names = ()
    """Joints, springs and tendons to release: they carry no load and are not drawn. With a pin its
    stops, damping, springs and drives are released."""
    take_up: Names = ()
    """Joints, springs and tendons to engage again, after they were released or broke."""
    lasts: of.Duration | None = None
    """Time after which its values, releases and engagements are reversed [s]; by default never."""
    stop: Literal["pass", "fail"] | None = None
    """Stops the run with this result; by default the run continues."""
    because: str = ""
    """Reason, shown in the result."""

    def _verify(self) -> None:
        refuse_if((self.at is None) == (self.when is None), "give either 'at' or 'when'")
        for key in ("after", "rate"):
            refuse_if(self.at is not None and getattr(self, key), f"'{key}' needs 'when', not 'at'")
        for name in set(self.release) & set(self.take_up):
            refuse_if(name, f"one event cannot release and engage '{name}'")


def first_step(event: Event, step: float) -> int:
    """How many steps of ``step`` [s] are made before an event may happen."""
    if event.at is not None:
        # the forces of step k act at (k - 1/2) h: before the first such step
        return max(0, math.ceil(event.at / step - 0.5 - 1e-9))
    return math.ceil(event.after / step - 1e-9)


class Trace(Spec):
    """The path of a point up to the current time."""

    body: BodyName
    """Name of the body that the point belongs to."""
    at: of.Point = (0.0, 0.0)
    """The point in the body's frame [m], also outside the body."""


class ShownMeter(Spec):
    """A meter in the picture: the curve of a quantity with a time cursor, or its value alone.

    A text is short for a meter with only ``of``.
    """

    of: Annotated[
        Items[str], BeforeValidator(_listed), AfterValidator(
            lambda words, info: tuple(_bound_text(word, info) if is_expression(word) else word
                                      for word in words)), WithJsonSchema(
            {"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"},
                                            "minItems": 1, "maxItems": 32}]}),
    ] = Field(min_length=1, max_length=32)
    """A name or pattern of quantities or an expression (SI) such as
    ``"=finger1.tendon.tension - 2"``, or a list: curves of one meter, in one unit."""
    title: str = ""
    """Title; by default the quantity's name."""
    unit: str = ""
    """Unit shown for expressions; a quantity has its own."""
    range: Pair[Quantity] | None = None
    """[minimum, maximum] of the plot, SI; by default from the run."""
    style: Literal["plot", "number"] = "plot"
    """``"plot"`` has the curve below the value, ``"number"`` is the value alone."""

    def _verify(self) -> None:
        refuse_if(self.range is not None and not self.range[0] < self.range[1],
                  "'range' is [lowest, highest]", "out-of-range")


class View(Spec):
    """The picture: visible region, size and speed. Fitted to the motion by default."""

    centre: of.Point | None = None
    """Point of the world in the middle of the picture [m]; by default that of visible motion."""
    width: of.Length | None = None
    """Width of the visible region [m]; by default fitted to the motion."""
    size: Pair[Annotated[int, Field(ge=64, le=8192)]] = (800, 600)
    """Width and height of the picture [pixels]."""
    fps: Literal[20, 25, 50] = 25
    """Frames per second of film."""
    speed: of.Number = Field(default=1.0, gt=0)
    """Seconds of motion per second of film: 0.1 is ten times slower, 2 twice as fast."""
    force_scale: of.Distance = 0.0
    """Length in the world of the arrow of a contact force of 1 N [m]; 0, the default, fits it to
    the largest lasting force of the run."""
    start: of.Instant = 0.0
    """Time of the run at which the film begins [s]."""
    traces: Items[Trace] = Field(default=(), max_length=64)
    """Points whose paths are drawn, such as that of a coupler's point or of a projectile."""
    meters: Items[Annotated[ShownMeter, text_for(ShownMeter, "of")]] = Field(
        default=(), max_length=12)
    """Meters beside or below the motion: quantities, patterns, expressions, or objects."""
    show: ShownLayers = Field(default={})
    """Layers in addition to the default ones; a minus removes one, as in ``"-contacts"``, and
    ``"all"`` means every layer. Or an object that gives each layer ``true``, ``false`` or the
    bodies (names, patterns, roles) that it shows. docs/pictures.md and ``sandbox render --help``
    list the layers."""
    bodies: Items[str] = Field(default=(), max_length=64)
    """Names and patterns of the bodies or groups that the picture is fitted to, or roles, as in
    ``"role:object"``; other bodies are drawn where visible. By default all bodies; those that fall
    or fly away count only near the others. ``["*"]`` means all, always."""
    follow: Annotated[Name | None, BODY] = None
    """Body whose centre of mass keeps its place in the picture, which shows its mechanism and what
    is near the body and does not rotate."""


class Group(Spec):
    """A named group of bodies: a finger, a section, a tree."""

    name: Name
    """Its name; quantities are ``<name>.contact.count`` and ``<name>.contact.normal``."""
    kind: Literal["finger", "section", "rocker_tree", "pulley_tree", "group"] = "group"
    """Kind of group; ``"group"`` for user-defined ones."""
    bodies: Items[BodyName] = ()
    """Names of its bodies; a finger's are its phalanges, the proximal one first."""

    @property
    def tree(self) -> bool:
        """Whether it is a tree of rockers or pulleys, which divides a pull."""
        return self.kind.endswith("_tree")
