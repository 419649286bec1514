"""A problem before it is known where in the file it stands."""

from __future__ import annotations

from dataclasses import dataclass

from sandbox.scene.read.paths import JsonPath


@dataclass(frozen=True)
class Finding:
    """One thing wrong at a path of the data; ``key`` if the key is wrong, not its value."""

    message: str
    path: JsonPath = ()
    allowed: str = ""
    hint: str = ""
    key: bool = False
    placed: bool = True
    """False for what has no place in the file, such as an option."""
