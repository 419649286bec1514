"""A mechanism in the formats of other programs, to go on there; reads nothing but the mechanism."""

from __future__ import annotations

from collections.abc import Sequence

from sandbox.export.exported import Export
from sandbox.export.mjcf import write_mjcf
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import listed, or_near, quoted

__all__ = ["FORMATS", "Export", "export_mechanism"]

FORMATS = {"mjcf": write_mjcf}
"""Each format's name and its writer."""


def export_mechanism(
    mechanism: Mechanism, *, format: str = "mjcf", without: Sequence[str] = (),
) -> Export:
    """``mechanism`` as the text of another program's model.

    ``without`` names elements (or patterns of names, ``tree.*``) to leave out,
    with all that hangs on them.

    Raises:
        ValueError: a format that is not in :data:`FORMATS`.
        SceneError: a name in ``without`` that fits nothing, or elements that
            have no counterpart in that format, each of them named.
    """
    if format not in FORMATS:
        raise ValueError(f"there is no export format {quoted(format)} (allowed: {listed(FORMATS)})"
                         f"{or_near(format, FORMATS)}")
    return FORMATS[format](mechanism, without=without)
