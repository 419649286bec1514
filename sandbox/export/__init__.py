"""A mechanism as a model for another program; reads nothing but the mechanism."""

from __future__ import annotations

from collections.abc import Sequence

from sandbox.export.mjcf import write_mjcf
from sandbox.export.pymunk import write_script
from sandbox.export.selection import Export
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import listed, or_near, quoted

__all__ = ["FORMATS", "Export", "export_mechanism"]

FORMATS = {"mjcf": write_mjcf, "pymunk": write_script}


def export_mechanism(
    mechanism: Mechanism, *, format: str = "mjcf", without: Sequence[str] = (),
) -> Export:
    """Write a mechanism as a model for another program.

    Args:
        mechanism: what is exported.
        format: a name in :data:`FORMATS`.
        without: names and patterns (``tree.*``) of elements to leave out, with all elements that
            need them.

    Raises:
        ValueError: an unknown format.
        SceneError: a name in ``without`` that fits no element; every element without a counterpart.
    """
    if format not in FORMATS:
        raise ValueError(f"there is no export format {quoted(format)} (allowed: {listed(FORMATS)})"
                         f"{or_near(format, FORMATS)}")
    return FORMATS[format](mechanism, without)
