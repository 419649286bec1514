"""The values of options, read from words of the command line."""

from __future__ import annotations

import contextlib
import itertools
import json
import math
import re
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from sandbox.wording import meant, refuse_if

if TYPE_CHECKING:
    from sandbox.scene.read.limits import Limits

_refuse_if = partial(refuse_if, code="bad-option")
MAX_STARTS = 200  # combinations of the values of ``--from``
_NUMBER = r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\s\d.:][^:]*?)?\s*"
_ALONG = re.compile(rf"\s*([^=]+?)\s*={_NUMBER}:{_NUMBER}:\s*(\d+)\s*")


def pairs(words: Sequence[str], form: str = "name=value") -> dict[str, str]:
    """Split ``name=value`` words."""
    found: dict[str, str] = {}
    for word in words:
        name, equals, text = (part.strip() for part in word.partition("="))
        _refuse_if(not (name and equals and text), f"{word!r} is not of the form {form}")
        _refuse_if(name in found, f"{name!r} is given twice")
        found[name] = text
    return found


def overrides(words: Sequence[str]) -> dict[str, Any]:
    """Split ``path=value`` words; a value that is not JSON is text."""
    overrides: dict[str, Any] = {}
    for word in words:
        path, equals, text = word.partition("=")
        _refuse_if(not equals or not path.strip(), f"{word!r} is not of the form path=value")
        overrides[path.strip()] = text
        with contextlib.suppress(ValueError, RecursionError):
            overrides[path.strip()] = json.loads(text)
    return overrides


def limits(words: Sequence[str]) -> Limits:
    """The limits that ``name=value`` words change."""
    from dataclasses import fields

    from sandbox.scene.read.limits import Limits
    known = [field.name for field in fields(Limits)]
    changes: dict[str, int] = {}
    for name, text in pairs(words).items():
        _refuse_if(name not in known, f"there is no limit {name!r}.{meant(name, known)} Limits: "
                   f"{', '.join(known)}.")
        value = float(text) if re.fullmatch(r"[\d.]+(?:[eE]\+?\d+)?", text) else 0.0
        _refuse_if(not (value >= 1 and value.is_integer()),
                   f"{name}={text} is not a valid positive integer")
        changes[name] = int(value)
    return Limits(**changes)


def quantity(text: str, dimension: str | None = None) -> float:
    """Read a number in SI, or with a unit."""
    from sandbox.values.units import parse_quantity
    return parse_quantity(text, dimension)


def length(text: str) -> float:
    """Read a length of 0 or more, with a unit, [m]."""
    value = quantity(text, "length")
    _refuse_if(value and text.strip().isdecimal(), f"{text} has no unit, as {text}mm has")
    _refuse_if(value < 0, f"must not be less than 0, got {text}")
    return value


def starts(words: Sequence[str]) -> list[dict[str, float]]:
    """All combinations of the values of ``--from``."""
    from sandbox.values.numbers import number_from
    given = {
        path: [number_from(each.strip(), "angle" if path.endswith(".angle") else "length", {})
               for each in text.split(",")]
        for path, text in pairs(words, "path=values").items()}
    _refuse_if(math.prod(map(len, given.values())) > MAX_STARTS,
               f"more than {MAX_STARTS} combinations")
    return [dict(zip(given, each, strict=True))
            for each in itertools.product(*given.values())] if given else []


def along(word: str) -> tuple[str, float, float, str, int]:
    """Path, first and last value, their unit and the count of ``PATH=FROM:TO:COUNT``."""
    if (match := _ALONG.fullmatch(word)) is None:
        raise ValueError(f"{word!r} is not of the form PATH=FROM:TO:COUNT, as in "
                         "parameters.pull=0:10:21 or 'parameters.pull=0 N:10 N:21'")
    path, begin, one, end, other, count = match.groups()
    _refuse_if(one and other and one != other, f"{one!r} and {other!r} are two units")
    return path, float(begin), float(end), one or other or "", int(count)


def size(word: str) -> tuple[int, int] | str:
    """Read ``800x600`` as two integers; other sizes stay text."""
    if re.search(r"[\d.]\s*[xX]\s*$|[a-z]{2}", word):
        return word
    if found := re.fullmatch(r"\s*(\d+)\s*[xX]\s*(\d+)\s*", word):
        return int(found[1]), int(found[2])
    raise ValueError(
        f"{word!r} is not of the form WIDTHxHEIGHT, as in 800x600, nor a factor, as in 2x, nor a "
        "size on paper, as in 85mm or 85mmx70mm")


def workers(word: str) -> int | str:
    """A number of processes, which begin to load here, or the address of a scheduler."""
    from sandbox.sweeps.processes import check_workers, preload
    if "://" in word:
        return word
    _refuse_if(word and (not word.isdecimal() or int(word) < 1), f"{word!r} is neither a number of "
               "processes nor the address of a Dask scheduler, as in tcp://10.0.0.1:8786")
    count = check_workers(int(word or 0))
    if not click.get_current_context().resilient_parsing:  # the shell completes a word
        preload()
    return count
