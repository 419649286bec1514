"""Options that several commands share: paths, overrides, limits, lengths, times."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from sandbox.wording import meant

if TYPE_CHECKING:
    from sandbox.scene.read.limits import Limits

F = TypeVar("F", bound=Callable[..., Any])


class _Out(click.Path):
    """A file or directory to write. An empty text is no path, though Python takes it for ``.``."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None,
    ) -> Any:
        if not os.fspath(value).strip():
            self.fail("the path is empty; '.' is the directory that you are in.", param, ctx)
        return super().convert(value, param, ctx)


OUT = _Out(path_type=Path)
"""Type of every option ``--out``."""


def read_pairs(
    ctx: click.Context, param: click.Parameter, words: Sequence[str],
) -> dict[str, str]:
    """Split ``name=value`` words, as the option's metavar names them.

    Raises:
        BadParameter: a word without a name or a value, or the same name twice.
    """
    found: dict[str, str] = {}
    for word in words:
        name, equals, text = word.partition("=")
        name = name.strip()
        if not equals or not name or not text.strip():
            form = (param.metavar or "NAME=VALUE").lower()
            raise click.BadParameter(f"{word!r} is not of the form {form}", ctx, param)
        if name in found:
            raise click.BadParameter(f"{name!r} is given values twice", ctx, param)
        found[name] = text.strip()
    return found


def read_overrides(
    ctx: click.Context, param: click.Parameter, words: Sequence[str],
) -> dict[str, Any]:
    """Read ``path=value`` words; a value is JSON if it parses as JSON, otherwise text."""
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


def read_limits(ctx: click.Context, param: click.Parameter, words: Sequence[str]) -> Limits:
    """Read ``name=value`` words as limits of a scene.

    Raises:
        BadParameter: an unknown limit, with a suggestion, or a value that is no positive integer.
    """
    from dataclasses import fields

    from sandbox.scene.read.limits import Limits

    known = [field.name for field in fields(Limits)]
    changes: dict[str, int] = {}
    for name, text in read_pairs(ctx, param, words).items():
        if name not in known:
            raise click.BadParameter(f"there is no limit {name!r}.{meant(name, known)} Limits: "
                                     f"{', '.join(known)}.", ctx, param)
        try:
            value = float(text)
            changes[name] = int(value) if value.is_integer() else 0
        except (ValueError, OverflowError):
            changes[name] = 0
        if changes[name] < 1:
            raise click.BadParameter(f"{name}={text} is not a valid positive integer", ctx, param)
    return Limits(**changes)


def read_time(
    ctx: click.Context, param: click.Parameter, word: str | None,
) -> float | None:
    """Read a time such as ``0.5s`` or ``200 ms`` [s]; a plain number is in seconds."""
    return _measured(ctx, param, word, "time")


def read_length(
    ctx: click.Context, param: click.Parameter, word: str | None,
) -> float | None:
    """Read a length of 0 or more such as ``85mm`` [m]; a whole number needs its unit."""
    length = _measured(ctx, param, word, "length")
    if word is not None and length and word.strip().isdecimal():
        raise click.BadParameter(f"{word} has no unit, as {word}mm has", ctx, param)
    if length is not None and length < 0:
        raise click.BadParameter(f"must not be less than 0, got {word}", ctx, param)
    return length


def _measured(
    ctx: click.Context, param: click.Parameter, word: str | None, dimension: str,
) -> float | None:
    from sandbox.values.units import parse_quantity

    try:
        return None if word is None else parse_quantity(word, dimension)
    except ValueError as error:
        raise click.BadParameter(str(error), ctx, param) from None


def read_elements(ctx: click.Context, param: click.Parameter, paths: Sequence[Path]) -> None:
    """Register the elements of files while the command runs.

    Raises:
        SandboxError: a file cannot be read or run, or registers nothing.
    """
    if paths:
        from sandbox.scene.document import load_elements

        for path in paths:
            ctx.call_on_close(load_elements(path))


elements_option = click.option(
    "--elements", multiple=True, metavar="FILE", is_eager=True,
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    callback=read_elements, expose_value=False,
    help="Run a Python file that registers elements of your own. Repeatable.")
_set_option = click.option(
    "--set", "overrides", multiple=True, metavar="PATH=VALUE", callback=read_overrides,
    help="Change the scene, as in 'parameters.pull=20 N' or 'run.step=1e-3'. Repeatable.")


def scene_options(command: F) -> F:
    """Options of all commands that load a scene: ``--set`` and ``--elements``."""
    return _set_option(elements_option(command))


limit_option = click.option(
    "--limit", "limits", multiple=True, metavar="NAME=VALUE", callback=read_limits,
    help="Change a limit, as in 'steps=5e6'; 'sandbox explain limits' lists them. Repeatable.")
json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
quiet_option = click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
