"""Arguments and options that several commands share: scenes, limits, output, quantities."""

from __future__ import annotations

import functools
import json
import os
import re
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.shell_completion import CompletionItem

from sandbox.cli.console import Console
from sandbox.errors import OutputError, SceneError
from sandbox.wording import meant

if TYPE_CHECKING:
    from sandbox.engine.inspect import Inspection
    from sandbox.errors import Problem
    from sandbox.scene.read.limits import Limits
    from sandbox.scene.read.load import Loaded

Command = Callable[..., Any]


class _Out(click.Path):
    """A file or directory to write. An empty text is no path, though Python takes it for ``.``."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None,
    ) -> Any:
        if not os.fspath(value).strip():
            self.fail("the path is empty; '.' is the directory that you are in.", param, ctx)
        return super().convert(value, param, ctx)


OUT = _Out(path_type=Path)  # type of every option ``--out``


# -- values --------------------------------------------------------------------------


def read_pairs(
    ctx: click.Context, param: click.Parameter, words: Sequence[str],
) -> dict[str, str]:
    """Split ``name=value`` words, as the option's metavar names them."""
    found: dict[str, str] = {}
    for word in words:
        name, equals, text = (part.strip() for part in word.partition("="))
        if not (name and equals and text):
            form = (param.metavar or "NAME=VALUE").lower()
            raise click.BadParameter(f"{word!r} is not of the form {form}", ctx, param)
        if name in found:
            raise click.BadParameter(f"{name!r} is given twice", ctx, param)
        found[name] = text
    return found


def _read_overrides(
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


def _read_limits(ctx: click.Context, param: click.Parameter, words: Sequence[str]) -> Limits:
    """Read ``name=value`` words as limits of a scene."""
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


def read_quantity(dimension: str | None) -> Callable[..., float | None]:
    """A callback that reads a number in SI, or with a unit; lengths are 0 or more."""
    def read(ctx: click.Context, param: click.Parameter, word: str | None) -> float | None:
        from sandbox.values.units import parse_quantity

        try:
            value = None if word is None else parse_quantity(word, dimension)
        except ValueError as error:
            raise click.BadParameter(str(error), ctx, param) from None
        if word is not None and value and dimension == "length":
            if word.strip().isdecimal():
                raise click.BadParameter(f"{word} has no unit, as {word}mm has", ctx, param)
            if value < 0:
                raise click.BadParameter(f"must not be less than 0, got {word}", ctx, param)
        return value

    return read


def _read_elements(ctx: click.Context, param: click.Parameter, paths: Sequence[Path]) -> None:
    """Register the elements of files while the command runs."""
    if paths:
        from sandbox.scene.document import load_elements

        for path in paths:
            ctx.call_on_close(load_elements(path))


# -- scenes --------------------------------------------------------------------------


@dataclass(frozen=True)
class Source:
    """A scene of the command line: its file or name, and ``--set`` and ``--limit``."""

    word: str
    overrides: Mapping[str, Any]
    limits: Limits

    def load(self, changes: Mapping[str, Any] | None = None) -> Loaded:
        """Load the scene, with ``changes`` after those of ``--set``."""
        from sandbox.scene.library import find_scene
        from sandbox.scene.read.load import read_scene

        return read_scene(find_scene(self.word), overrides={**self.overrides, **(changes or {})},
                          limits=self.limits)

    def inspect(self, loaded: Loaded) -> Inspection:
        """Inspect a scene; a run that costs more than the limits allow is an error."""
        from sandbox.engine.inspect import look_over

        found = look_over(loaded.mechanism)
        beyond = list(found.estimate.beyond(self.limits))
        return found._replace(problems=[*beyond, *found.problems])


def refuse_blocking(problems: Sequence[Problem], loaded: Loaded) -> None:
    """Refuse a scene that cannot be simulated."""
    if blocking := [problem for problem in problems if problem.blocks]:
        from sandbox.scene.read.source import first_problems

        most = loaded.origins.source.limits.problems
        raise SceneError(first_problems(loaded.placed(blocking), most), loaded.name)


def title_of(path: Path) -> str:
    """The title in a scene's file, read without validation; empty if it has none."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return ""
    return str(data.get("title", "")) if isinstance(data, dict) else ""


def complete_scene(
    ctx: click.Context, param: click.Parameter, incomplete: str,
) -> list[CompletionItem]:
    """Complete the names of shipped scenes, and files."""
    from sandbox.scene.library import shipped_scenes

    named = [CompletionItem(name, help=title_of(path)) for name, path in shipped_scenes().items()
             if name.startswith(incomplete)]
    return [*named, CompletionItem(incomplete, type="file")]


SCENE, OUTPUT = ("scene", "set", "elements", "limit"), ("json", "quiet")
"""Names of the options of a command that loads a scene, and of one that prints results."""
_SHARED: dict[str, Callable[[Command], Command]] = {
    "scene": click.argument("scene", shell_complete=complete_scene),
    "set": click.option(
        "--set", "overrides", multiple=True, metavar="PATH=VALUE", callback=_read_overrides,
        help="Change the scene, as in 'parameters.pull=20 N' or 'run.step=1e-3'. Repeatable."),
    "elements": click.option(
        "--elements", multiple=True, metavar="FILE", is_eager=True,
        type=click.Path(exists=True, dir_okay=False, path_type=Path),
        callback=_read_elements, expose_value=False,
        help="Run a Python file that registers elements of your own. Repeatable."),
    "limit": click.option(
        "--limit", "limits", multiple=True, metavar="NAME=VALUE", callback=_read_limits,
        help="Change a limit, as in 'steps=5e6'; 'sandbox explain limits' lists them. Repeatable."),
    "json": click.option("--json", "as_json", is_flag=True,
                         help="Print one JSON object and nothing else."),
    "quiet": click.option("--quiet", "-q", is_flag=True, help="Print errors only."),
}


def takes(*names: str) -> Callable[[Command], Command]:
    """Give a command shared options: SCENE as a :class:`Source`, OUTPUT as a ``console``."""
    def give(command: Command) -> Command:
        @functools.wraps(command)
        def run(**given: Any) -> Any:
            if "scene" in names:
                given["scene"] = Source(*map(given.pop, ("scene", "overrides", "limits")))
            if {*OUTPUT} & {*names}:
                given["console"] = Console(given.pop("as_json", False), given.pop("quiet", False))
            return command(**given)

        made: Command = run
        for name in reversed(names):
            made = _SHARED[name](made)
        return made

    return give


# -- directories ---------------------------------------------------------------------

RENDERS = Path("renders")


def safe_name(name: str) -> str:
    """The name of a scene without characters that could lead to another directory."""
    return re.sub(r"[^\w.-]+", "_", name).strip("._") or "scene"


def prepare(directory: Path) -> None:
    """Check that files can be written into a directory, and make it."""
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=directory) as trial:
            trial.write(b"\0")
    except OSError as error:
        raise OutputError(f"cannot write into {directory}: {error.strerror or error}") from None


def written(directory: Path, names: Sequence[str]) -> list[str]:
    """The files of a list that a directory has."""
    return [name for name in names if (directory / name).is_file()]


def file_option(suffixes: Sequence[str], help_text: str) -> Callable[[Command], Command]:
    """A repeatable option ``--out FILE`` that accepts some suffixes."""
    def read(
        ctx: click.Context, param: click.Parameter, paths: tuple[Path, ...],
    ) -> tuple[Path, ...]:
        for path in paths:
            if path.suffix.lower() not in suffixes:
                raise click.BadParameter(f"{str(path)!r} does not end in one of "
                                         f"{', '.join(suffixes)}", ctx, param)
        return paths

    return click.option("--out", "files", multiple=True, type=OUT,
                        metavar="FILE", callback=read, help=help_text)
