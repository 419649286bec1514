"""Planes and colours of bodies."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, ValidationInfo, WithJsonSchema

from sandbox.values.expressions import is_expression
from sandbox.values.numbers import Items, number_from, parameters_of
from sandbox.wording import WrongValueError, kind_of, near, quoted, refuse_if

ALL: Literal["all"] = "all"
HIGHEST = 1000  # maximum magnitude of a plane's number
MAX_PLANES = 64  # of one body
WORDS = f'a whole number, a list of them, or "{ALL}"'

_PLANE: dict[str, Any] = {"anyOf": [
    {"type": "integer", "minimum": -HIGHEST, "maximum": HIGHEST},
    {"type": "string", "pattern": "^="}]}
SCHEMA = WithJsonSchema({"anyOf": [
    _PLANE, {"type": "array", "items": _PLANE, "minItems": 1, "maxItems": MAX_PLANES},
    {"const": ALL}]})


def _read(value: Any, info: ValidationInfo) -> tuple[int, ...] | Literal["all"]:
    if value == ALL:
        return ALL
    numbers = tuple(value) if isinstance(value, (list, tuple)) else (value,)
    refuse_if(not 0 < len(numbers) <= MAX_PLANES,
              f"expected 1 to {MAX_PLANES} planes, got {len(numbers)}", "wrong-type")
    planes = []
    for number in numbers:
        if is_expression(number):
            computed = number_from(number, None, parameters_of(info))
            number = int(computed) if computed.is_integer() else computed
        if isinstance(number, bool) or not isinstance(number, int) or abs(number) > HIGHEST:
            named = number if isinstance(number, str) else ""
            raise WrongValueError("not-allowed", f"{quoted(named) if named else kind_of(number)} "
                                  f"is not a plane from {-HIGHEST} to {HIGHEST}", allowed=WORDS,
                                  hint=near(named, [ALL]))
        planes.append(number)
    return tuple(planes)


Planes = Annotated[Items[int] | Literal["all"], BeforeValidator(_read), SCHEMA]


def depth(planes: Planes) -> int:
    """Place of a body from back to front: its lowest plane."""
    return -HIGHEST - 1 if planes == ALL else min(int(plane) for plane in planes)


RGB = tuple[int, int, int]
COLOURS: dict[str, RGB] = {
    "white": (255, 255, 255), "grey": (206, 210, 214), "black": (58, 64, 72),
    "blue": (158, 193, 230), "teal": (160, 214, 208), "green": (176, 216, 160),
    "yellow": (246, 226, 138), "orange": (246, 190, 120), "red": (236, 152, 140),
    "pink": (240, 190, 212), "purple": (204, 182, 228), "brown": (206, 180, 152),
}
"""Names of fills, pale, so that tendons and forces stand out."""
_HEX = re.compile(r"#(?:[0-9a-fA-F]{3}|[0-9a-fA-F]{6})")
COLOUR_WORDS = f'{", ".join(COLOURS)} or "#rrggbb"'


def _checked(text: str) -> str:
    if text in COLOURS or _HEX.fullmatch(text):
        return text
    raise WrongValueError("not-allowed", f"{quoted(text)} is not a colour", allowed=COLOUR_WORDS,
                          hint=near(text, COLOURS))


COLOUR_SCHEMA = WithJsonSchema({"anyOf": [
    {"enum": [*COLOURS]},
    {"type": "string", "pattern": "^#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})$"}]})
FillColour = Annotated[str, AfterValidator(_checked), COLOUR_SCHEMA]  # a colour as a scene has it


def rgb(text: str) -> RGB:
    """Red, green and blue, 0 to 255, of a colour."""
    if text in COLOURS:
        return COLOURS[text]
    digits = text[1:] if len(text) == 7 else "".join(2 * digit for digit in text[1:])
    red, green, blue = (int(digits[k:k + 2], 16) for k in (0, 2, 4))
    return red, green, blue
