"""A scene with all files that it reads, so that each worker, here or elsewhere, runs the same."""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sandbox.scene.outlines.drawings import own_file
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.load import Loaded, read_scene

DRAWINGS = (".svg", ".dxf")
"""Endings of drawings that shapes are read from."""


@dataclass(frozen=True)
class Bundle:
    """A scene's own file, or its data, and the files beside it that it includes or draws from."""

    name: str
    """Of the scene."""
    main: str = ""
    """Its file's name; empty for a scene that is data."""
    data: dict[str, Any] | None = None
    files: Mapping[str, bytes] = field(default_factory=dict, repr=False)
    """By name, below the scene's folder."""

    @property
    def digest(self) -> str:
        """SHA-256 of all that it holds: hexadecimal digits."""
        total = hashlib.sha256(json.dumps(self.data, sort_keys=True).encode())
        total.update(f"{self.name}\0{self.main}".encode())
        for name in sorted(self.files):
            total.update(f"{name}\0{len(self.files[name])}\0".encode() + self.files[name])
        return total.hexdigest()

    @contextmanager
    def unpacked(self) -> Iterator[Path | dict[str, Any]]:
        """What :func:`read_scene` reads, in a folder of its own while the context lasts."""
        if self.data is not None:
            yield self.data
            return
        with tempfile.TemporaryDirectory(prefix="sandbox-sweep-") as folder:
            for name, content in self.files.items():
                path = Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(content)
            yield Path(folder, self.main)


def bundled(
    scene: Path | Mapping[str, Any], overrides: Mapping[str, Any], limits: Limits, *,
    also: Iterable[Any] = (),
) -> tuple[Bundle, Loaded]:
    """A scene's bundle, and the scene as it is with ``overrides``.

    Args:
        scene: its file, or its data.
        overrides: what is changed in it.
        limits: how large it may be.
        also: values that it is given later, which may name drawings and scenes beside it.

    Raises:
        SceneError: every problem of the scene.
    """
    also = list(also)
    loaded = read_scene(scene, overrides=overrides, limits=limits)
    if isinstance(scene, Mapping):
        data = json.loads(json.dumps(dict(scene)))
        return Bundle(loaded.mechanism.name, data=data), loaded
    found = {scene.name: scene.read_bytes()}
    for path in [*loaded.files, *_named(scene.parent, also, limits)]:
        name = path.relative_to(scene.parent) if path.is_relative_to(scene.parent) else path.name
        found[str(name)] = path.read_bytes()
    written = [*map(json.loads, found.values()), overrides, also]
    for text in {text for each in written for text in _texts(each)}:
        if text.lower().endswith(DRAWINGS) and (scene.parent / text).is_file():
            found[text] = own_file(scene.parent, text)
    return Bundle(loaded.mechanism.name, main=scene.name, files=found), loaded


def _named(folder: Path, also: Iterable[Any], limits: Limits) -> Iterator[Path]:
    """The files of scenes that values name, and those that these read in turn."""
    for text in sorted({text for text in _texts(list(also)) if text.isidentifier()}):
        path = folder / f"{text}.json"
        if path.is_file():
            yield path
            yield from read_scene(path, limits=limits).files


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, (Mapping, list, tuple)):
        for each in value.values() if isinstance(value, Mapping) else value:
            yield from _texts(each)
