"""What several commands take: a scene, overrides, limits, sizes and points."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from sandbox.scene.mechanism import Mechanism
    from sandbox.scene.read.limits import Limits

F = TypeVar("F", bound=Callable[..., Any])
UNCOUNTED = ""
"""What click gives of an option that may have a number, and has none."""


class _Out(click.Path):
    """A file or directory to write; no text is no path, though Python takes it for ``.``."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None,
    ) -> Any:
        """The path that a word names."""
        if not os.fspath(value).strip():
            self.fail("the path is empty; '.' is the directory that you are in.", param, ctx)
        return super().convert(value, param, ctx)


OUT = _Out(path_type=Path)
"""The type of every option that says where something goes."""


def read_overrides(
    ctx: click.Context, param: click.Parameter, words: tuple[str, ...],
) -> dict[str, Any]:
    """``path=value`` words as a table; a value is JSON if it reads as JSON, otherwise text."""
    overrides: dict[str, Any] = {}
    for word in words:
        path, equals, text = word.partition("=")
        if not equals or not path.strip():
            raise click.BadParameter(f"{word!r} is not of the form path=value", ctx, param)
        try:
            overrides[path.strip()] = json.loads(text)
        except (ValueError, RecursionError):
            overrides[path.strip()] = text
    return overrides


def read_count(ctx: click.Context, param: click.Parameter, word: str | None) -> bool | int:
    """A whole number; without one after the option true, without the option false."""
    if word is None:
        return False
    if word == UNCOUNTED:
        return True
    try:
        return int(word)
    except ValueError:
        raise click.BadParameter(f"{word!r} is not a valid integer", ctx, param) from None


def read_size(
    ctx: click.Context, param: click.Parameter, word: str | None,
) -> tuple[int, int] | str | None:
    """``800x600`` as two whole numbers; ``2x`` and ``85mm`` stay as they are."""
    from sandbox.draw.film.paper import paper_of
    from sandbox.errors import OutputError

    try:
        if word is None or paper_of(word) is not None:
            return word
    except OutputError as error:
        raise click.BadParameter(str(error), ctx, param) from None
    before, cross, after = word.lower().partition("x")
    try:
        if cross and not after.strip():
            float(before)
            return word
        return int(before), int(after)
    except ValueError:
        raise click.BadParameter(
            f"{word!r} is not of the form WIDTHxHEIGHT, as in 800x600, nor a factor, as in 2x, "
            "nor a size on paper, as in 85mm or 85mmx70mm",
            ctx, param) from None


def read_time(
    ctx: click.Context, param: click.Parameter, word: str | None,
) -> float | None:
    """A time such as ``0.5s`` or ``200 ms`` [s]; a plain number is in seconds."""
    return _measured(ctx, param, word, "time")


def read_length(
    ctx: click.Context, param: click.Parameter, word: str | None,
) -> float | None:
    """A length of 0 or more such as ``85mm`` [m]; a whole number without a unit is a slip."""
    length = _measured(ctx, param, word, "length")
    if word is not None and length and word.strip().isdecimal():
        raise click.BadParameter(f"{word} has no unit, as {word}mm has", ctx, param)
    if length is not None and length < 0:
        raise click.BadParameter(f"must not be less than 0, got {word}", ctx, param)
    return length


def _measured(
    ctx: click.Context, param: click.Parameter, word: str | None, dimension: str,
) -> float | None:
    from sandbox.scene.values.units import parse_quantity

    try:
        return None if word is None else parse_quantity(word, dimension)
    except ValueError as error:
        raise click.BadParameter(str(error), ctx, param) from None


def read_point(
    ctx: click.Context, param: click.Parameter, word: str | None,
) -> tuple[float, float] | None:
    """``0.1,-0.02`` as two numbers [m]."""
    if word is None:
        return None
    try:
        x, y = (float(part) for part in word.split(","))
    except ValueError:
        raise click.BadParameter(
            f"{word!r} is not of the form X,Y in metres, as in 0.1,-0.02", ctx, param) from None
    return x, y


def read_layers(
    ctx: click.Context, param: click.Parameter, word: str | None,
) -> str | None:
    """``traces,-contacts``: layers of a picture, as they are asked for."""
    from sandbox.kinds.layers import asked
    from sandbox.wording import WrongValueError

    try:
        asked(word or "bodies")
    except WrongValueError as error:
        raise click.BadParameter(str(error), ctx, param) from None
    return word


show_option = click.option(
    "--show", callback=read_layers, metavar="LAYERS",
    help="Layers that pictures show besides the usual ones, as in 'traces,velocity'; '-contacts' "
         "leaves one out, 'all' means every one.")


meter_option = click.option(
    "--meter", "meters", multiple=True, metavar="QUANTITY",
    help="Show a meter in the picture, in place of those of the scene: a quantity, a pattern of "
         "them, or an expression as in '=finger.tendon.tension - 2'. May be given several times.")


def refuse_unknown(meters: Sequence[str], mechanism: Mechanism) -> None:
    """Refuse meters of what a run will not have, before it is run.

    Raises:
        click.BadParameter: quantities that are not known, expressions that are none.
    """
    from sandbox.draw.film.options import meters_view
    from sandbox.errors import OutputError
    from sandbox.model.catalogue import Catalogue

    if meters:
        try:
            meters_view(meters, Catalogue(mechanism))
        except OutputError as error:
            raise click.BadParameter(str(error), param_hint="'--meter'") from None


override_option = click.option(
    "--set", "overrides", multiple=True, metavar="PATH=VALUE", callback=read_overrides,
    help="Change the scene before it is read, as in 'parameters.pull=20 N' or 'run.step=1e-3'. "
         "May be given several times.")


LIMITS = {
    "file_bytes": "bytes of a scene's file",
    "nesting": "objects and lists inside one another",
    "problems": "problems told of one file",
    "bodies": "bodies of the mechanism",
    "elements": "elements of all kinds",
    "values": "numbers, texts, lists and objects",
    "matches": "names that patterns are held against",
    "corners": "corners of outlines, 2000 for each cam and drawing",
    "steps": "time steps",
    "samples": "recorded samples",
    "recorded_bytes": "bytes recorded, contacts included",
    "seconds": "seconds of a run, as estimated",
    "frames": "frames of a film",
    "pixels": "pixels of a picture",
    "runs": "runs of a sweep or a search",
}
"""The limits of a scene and what each counts; every one is an option ``--max-…``."""


_MOST = "max_"
"""Begins the parameter of a limit, as its option does: ``frames`` alone is a flag of ``run``."""


def limit_options(command: F) -> F:
    """Give a command one option for each of :data:`LIMITS`; :func:`chosen_limits` reads them."""
    for name, what in reversed(LIMITS.items()):
        command = click.option(
            f"--max-{name.replace('_', '-')}", f"{_MOST}{name}", type=click.IntRange(min=1),
            metavar="N", help=f"Allow so many {what}.")(command)
    return command


def chosen_limits(given: Mapping[str, int | None]) -> Limits:
    """The limits of a scene, as the options of :func:`limit_options` raised them."""
    from sandbox.scene.read.limits import Limits

    return Limits(**{name.removeprefix(_MOST): value for name, value in given.items()
                     if value is not None})
