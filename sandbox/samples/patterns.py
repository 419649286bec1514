"""Several quantities side by side, by a pattern."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from sandbox.errors import SandboxError
from sandbox.model.catalogue import Catalogue

MOST_SHOWN = 4
"""Units that a refusal gives an example of."""


class MixedUnitsError(SandboxError, ValueError):
    """A pattern that fits quantities of several units, which are no columns of one array."""


def unit_of(catalogue: Catalogue, names: Sequence[str], pattern: str) -> str:
    """The one unit of the quantities that a pattern fits.

    Raises:
        MixedUnitsError: they have several.
    """
    units: dict[str, str] = {}
    for name in names:
        units.setdefault(catalogue.find(name).unit, name)
    if len(units) == 1:
        return next(iter(units))
    shown = [f"{name} in {unit}" for unit, name in itertools.islice(units.items(), MOST_SHOWN)]
    raise MixedUnitsError(
        f"{pattern!r} fits quantities of {len(units)} units ({', '.join(shown)}"
        f"{', …' if len(units) > MOST_SHOWN else ''}), which make no array: ask for those of one "
        "unit, such as '*.angle', or for a table with to_pandas()")
