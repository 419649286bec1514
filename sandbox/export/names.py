"""Names in a model: the scene's own as they are, made ones that collide with none of them."""

from __future__ import annotations

from collections.abc import Iterable


class UniqueNames:
    """Gives out names; each kind of object (body, joint, site …) has its own space of names."""

    def __init__(self, reserved: Iterable[str]) -> None:
        self._reserved = frozenset(reserved)
        self._given: dict[str, set[str]] = {}

    def made(self, kind: str, wanted: str) -> str:
        """A name for a new object of a kind: ``wanted``, lengthened until it is free."""
        taken = self._given.setdefault(kind, set())
        name = wanted
        while name in taken or name in self._reserved:
            name += "_"
        taken.add(name)
        return name
