"""Values of options, and the arguments and options that several commands share."""

from __future__ import annotations

import itertools
import json
import math
import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.errors import OutputError, SandboxError, SceneError
from sandbox.wording import WrongValueError, meant

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from sandbox.engine.inspect import Inspection
    from sandbox.errors import Problem
    from sandbox.scene.read.limits import Limits
    from sandbox.scene.read.load import Loaded

PICTURES = (".png", ".svg", ".pdf")  # suffixes of figures
NAMES = {"best": "optimize"}  # searches whose names differ from those in study files
MAX_STARTS = 200  # combinations of the values of ``--from``
_NUMBER = r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\s\d.:][^:]*?)?\s*"
_ALONG = re.compile(rf"\s*([^=]+?)\s*={_NUMBER}:{_NUMBER}:\s*(\d+)\s*")


class _Out(click.Path):
    """A file or directory to write. An empty text is no path, though Python takes it for ``.``."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not os.fspath(value).strip():
            self.fail("the path is empty; '.' is the directory that you are in.", param, ctx)
        return super().convert(value, param, ctx)


OUT = _Out(path_type=Path)  # type of every option ``--out``


def reads(convert: Callable[[Any], Any]) -> Callable[..., Any]:
    """A callback that converts what an option has; errors are reported at the option."""
    def read(ctx: click.Context, param: click.Parameter, value: Any) -> Any:
        try:
            return None if value is None else convert(value)
        except (ValueError, SandboxError) as error:
            raise click.BadParameter(str(error), ctx, param) from error

    return read


def read_pairs(words: Sequence[str], form: str = "name=value") -> dict[str, str]:
    """Split ``name=value`` words."""
    found: dict[str, str] = {}
    for word in words:
        name, equals, text = (part.strip() for part in word.partition("="))
        if not (name and equals and text):
            raise ValueError(f"{word!r} is not of the form {form}")
        if name in found:
            raise ValueError(f"{name!r} is given twice")
        found[name] = text
    return found


def _overrides(words: Sequence[str]) -> dict[str, Any]:
    overrides: dict[str, Any] = {}
    for word in words:
        path, equals, text = word.partition("=")
        if not equals or not path.strip():
            raise ValueError(f"{word!r} is not of the form path=value")
        try:
            overrides[path.strip()] = json.loads(text)
        except (ValueError, RecursionError):
            overrides[path.strip()] = text
    return overrides


def _limits(words: Sequence[str]) -> Limits:
    from dataclasses import fields

    from sandbox.scene.read.limits import Limits
    known = [field.name for field in fields(Limits)]
    changes: dict[str, int] = {}
    for name, text in read_pairs(words).items():
        if name not in known:
            raise ValueError(f"there is no limit {name!r}.{meant(name, known)} Limits: "
                             f"{', '.join(known)}.")
        try:
            value = float(text)
        except ValueError:
            value = 0.0
        if not (value >= 1 and value.is_integer()):
            raise ValueError(f"{name}={text} is not a valid positive integer")
        changes[name] = int(value)
    return Limits(**changes)


def read_quantity(text: str, dimension: str | None = None) -> float:
    """Read a number in SI, or with a unit."""
    from sandbox.values.units import parse_quantity
    return parse_quantity(text, dimension)


def read_length(text: str) -> float:
    """Read a length of 0 or more, with a unit, [m]."""
    value = read_quantity(text, "length")
    if value and text.strip().isdecimal():
        raise ValueError(f"{text} has no unit, as {text}mm has")
    if value < 0:
        raise ValueError(f"must not be less than 0, got {text}")
    return value


def read_noise(words: Sequence[str]) -> dict[str, float]:
    """Read ``column=size`` words."""
    return {name: read_quantity(text) for name, text in read_pairs(words, "column=size").items()}


def read_starts(words: Sequence[str]) -> list[dict[str, float]]:
    """All combinations of the values of ``--from``."""
    from sandbox.values.numbers import number_from
    given: dict[str, list[float]] = {}
    for path, text in read_pairs(words, "path=values").items():
        dimension = "angle" if path.endswith(".angle") else "length"
        try:
            given[path] = [number_from(each.strip(), dimension, {}) for each in text.split(",")]
        except WrongValueError as error:
            raise WrongValueError(error.code, f"'{path}={text}': {error}") from None
    if math.prod(map(len, given.values())) > MAX_STARTS:
        raise ValueError(f"more than {MAX_STARTS} combinations")
    return [dict(zip(given, each, strict=True))
            for each in itertools.product(*given.values())] if given else []


def read_along(word: str) -> tuple[str, float, float, str, int]:
    """Path, first and last value, their unit and the count of ``PATH=FROM:TO:COUNT``."""
    if (match := _ALONG.fullmatch(word)) is None:
        raise ValueError(f"{word!r} is not of the form PATH=FROM:TO:COUNT, as in "
                         "parameters.pull=0:10:21 or 'parameters.pull=0 N:10 N:21'")
    path, begin, one, end, other, count = match.groups()
    if one and other and one != other:
        raise ValueError(f"{one!r} and {other!r} are two units")
    return path, float(begin), float(end), one or other or "", int(count)


def read_size(word: str) -> tuple[int, int] | str:
    """Read ``800x600`` as two integers; other sizes stay text."""
    if re.search(r"[\d.]\s*[xX]\s*$|[a-z]{2}", word):
        return word
    if found := re.fullmatch(r"\s*(\d+)\s*[xX]\s*(\d+)\s*", word):
        return int(found[1]), int(found[2])
    raise ValueError(
        f"{word!r} is not of the form WIDTHxHEIGHT, as in 800x600, nor a factor, as in 2x, nor a "
        "size on paper, as in 85mm or 85mmx70mm")


def read_workers(word: str) -> int | str:
    """A number of processes, which begin to load here, or the address of a scheduler."""
    from sandbox.sweeps.processes import check_workers, preload
    if "://" in word:
        return word
    if word and (not word.isdecimal() or int(word) < 1):
        raise ValueError(f"{word!r} is neither a number of processes nor the address of a Dask "
                         "scheduler, as in tcp://10.0.0.1:8786")
    count = check_workers(int(word or 0))
    if not click.get_current_context().resilient_parsing:  # the shell completes a word
        preload()
    return count


def _read_elements(ctx: click.Context, param: click.Parameter, paths: Sequence[Path]) -> None:
    """Register the elements of files while the command runs."""
    if paths:
        from sandbox.scene.document import load_elements
        for path in paths:
            ctx.call_on_close(load_elements(path))


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


def complete_scene(_ctx: object, _param: object, incomplete: str) -> list[CompletionItem]:
    """Complete the names of shipped scenes, and files."""
    from click.shell_completion import CompletionItem

    from sandbox.scene.library import shipped_scenes
    named = [CompletionItem(name, help=title_of(path)) for name, path in shipped_scenes().items()
             if name.startswith(incomplete)]
    return [*named, CompletionItem(incomplete, type="file")]


def option(*names: str, read: Callable[[Any], Any] | None = None, **settings: Any) -> click.Option:
    """An option of a command; ``read`` converts the words."""
    return click.Option(names, **{"callback": read and reads(read), **settings})


def files(suffixes: Sequence[str], help_text: str) -> click.Option:
    """A repeatable option ``--out FILE`` that accepts some suffixes."""
    def read(paths: tuple[Path, ...]) -> tuple[Path, ...]:
        for path in paths:
            if path.suffix.lower() not in suffixes:
                raise ValueError(f"{str(path)!r} does not end in one of {', '.join(suffixes)}")
        return paths

    return option("--out", "files", multiple=True, type=OUT, metavar="FILE", read=read,
                  help=help_text)


RUN = click.Argument(["run"])
LIMIT = option(
    "--limit", "limits", multiple=True, metavar="NAME=VALUE", read=_limits,
    help="Change a limit, as in 'steps=5e6'; 'sandbox explain limits' lists them. Repeatable.")
ELEMENTS = option(
    "--elements", multiple=True, metavar="FILE", is_eager=True,
    type=click.Path(exists=True, dir_okay=False, path_type=Path), callback=_read_elements,
    expose_value=False,
    help="Run a Python file that registers elements of your own. Repeatable.")
CHANGES = (option(
    "--set", "overrides", multiple=True, metavar="PATH=VALUE", read=_overrides,
    help="Change the scene, as in 'parameters.pull=20 N' or 'run.step=1e-3'. Repeatable."),
    ELEMENTS, LIMIT)
SCENE = (click.Argument(["scene"], shell_complete=complete_scene), *CHANGES)
JSON = option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
QUIET = option("--quiet", "-q", is_flag=True, help="Print errors only.")


RENDERS = Path("renders")


def safe_name(name: str) -> str:
    """The name of a scene without characters that could lead to another directory."""
    return re.sub(r"[^\w.-]+", "_", name).strip("._") or "scene"


def prepare(directory: Path) -> None:
    """Check that files can be written into a directory, and make it."""
    import tempfile
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=directory) as trial:
            trial.write(b"\0")
    except OSError as error:
        raise OutputError(f"cannot write into {directory}: {error.strerror or error}") from None


def written(directory: Path, names: Sequence[str]) -> list[str]:
    """The files of a list that a directory has."""
    return [name for name in names if (directory / name).is_file()]
