"""JSON paths: ``$.parts[2].lengths[0]`` and the tuple ``("parts", 2, "lengths", 0)``."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from typing import Any

from sandbox.wording import WrongValueError

JsonPath = tuple[str | int, ...]
_PLAIN_KEY = re.compile(r"[A-Za-z_$][A-Za-z0-9_$]*")
_STEP = re.compile(
    r'(?:^|\.)(?P<key>[A-Za-z_$][\w$-]*)|\[(?P<index>[0-9]{1,9})\]'
    r'|\[(?P<quoted>"(?:[^"\\]|\\.)*")\]|\[(?P<name>[A-Za-z_][^\[\]"]*)\]')


def path_text(path: Sequence[str | int]) -> str:
    """``$.parts[2].lengths[0]`` for ``("parts", 2, "lengths", 0)``."""
    return "$" + "".join(
        f"[{step}]" if isinstance(step, int) else
        f".{step}" if _PLAIN_KEY.fullmatch(step) else f"[{json.dumps(step)}]" for step in path)


def parse_path(text: str) -> JsonPath:
    """The steps of a path; a leading ``$`` may be left out, and ``[finger1]`` is a name."""
    body = text.strip()
    if body == "$" or body.startswith(("$.", "$[")):
        body = body[1:].removeprefix(".")
    steps: list[str | int] = []
    at = 0
    while at < len(body):
        match = _STEP.match(body, at)
        if match is None:
            raise WrongValueError(
                "bad-override", f"{text[:80]!r} is not a path such as bodies[0].mass or run.step")
        if match["index"] is not None:
            steps.append(int(match["index"]))
        elif match["quoted"] is not None:
            steps.append(str(json.loads(match["quoted"])))
        else:
            steps.append(match["key"] or match["name"].strip())
        at = match.end()
    return tuple(steps)


def addresses(value: Any, at: str = "") -> Iterator[str]:
    """The paths of all values in data, with the names of list entries: ``bodies[disc].mass``."""
    for key, entry in value.items() if isinstance(value, dict) else \
            enumerate(value) if isinstance(value, list) else ():
        name = entry.get("name", key) if isinstance(entry, dict) else key
        path = f"{at}[{name}]" if isinstance(key, int) else f"{at}.{key}".removeprefix(".")
        yield path
        yield from addresses(entry, path)


def holds(value: Any, step: str | int) -> bool:
    """Whether a value has a key or an index."""
    if isinstance(value, list):
        return isinstance(step, int) and 0 <= step < len(value)
    return isinstance(value, dict) and step in value
