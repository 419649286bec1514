"""Several quantities side by side, by a pattern."""

from __future__ import annotations

import difflib
import itertools
from collections.abc import Sequence

from sandbox.errors import SandboxError
from sandbox.model.catalogue import Catalogue
from sandbox.wording import MOST_COMPARED, is_pattern

MOST_SHOWN = 4
"""Units that a refusal gives an example of."""


class MixedUnitsError(SandboxError, ValueError):
    """A pattern that fits quantities of several units, which are no columns of one array."""

    code = "bad-quantity"


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


def near_pattern(catalogue: Catalogue, pattern: str) -> str:
    """A pattern with one of its words mended, if that makes it fit something; or a near miss."""
    if hint := catalogue.near(pattern):
        return hint
    known = dict.fromkeys(word for name in catalogue.units for word in name.split("."))
    words = pattern.split(".")
    for i, word in enumerate(words):
        for close in [] if is_pattern(word) else difflib.get_close_matches(
                word, itertools.islice(known, MOST_COMPARED)):
            mended = ".".join([*words[:i], close, *words[i + 1:]])
            if catalogue.fits(mended):
                return mended
    return ""
