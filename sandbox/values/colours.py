"""Colours of bodies in pictures: a name, or red, green and blue in hexadecimal digits."""

from __future__ import annotations

import re
from typing import Annotated

from pydantic import AfterValidator, WithJsonSchema

from sandbox.wording import WrongValueError, near, quoted

RGB = tuple[int, int, int]
COLOURS: dict[str, RGB] = {
    "white": (255, 255, 255), "grey": (206, 210, 214), "black": (58, 64, 72),
    "blue": (158, 193, 230), "teal": (160, 214, 208), "green": (176, 216, 160),
    "yellow": (246, 226, 138), "orange": (246, 190, 120), "red": (236, 152, 140),
    "pink": (240, 190, 212), "purple": (204, 182, 228), "brown": (206, 180, 152),
}
"""Names of fills. They are pale, so that cords and forces stand out in front of them."""
_HEX = re.compile(r"#(?:[0-9a-fA-F]{3}|[0-9a-fA-F]{6})")
WORDS = f'{", ".join(COLOURS)} or "#rrggbb"'


def _checked(text: str) -> str:
    if text in COLOURS or _HEX.fullmatch(text):
        return text
    raise WrongValueError("not-allowed", f"{quoted(text)} is not a colour", allowed=WORDS,
                          hint=near(text, COLOURS))


SCHEMA = WithJsonSchema({"anyOf": [
    {"enum": [*COLOURS]},
    {"type": "string", "pattern": "^#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})$"}]})
FillColour = Annotated[str, AfterValidator(_checked), SCHEMA]
"""A colour as a scene has it."""


def rgb(text: str) -> RGB:
    """Red, green and blue, 0 to 255, of a colour."""
    if text in COLOURS:
        return COLOURS[text]
    digits = text[1:] if len(text) == 7 else "".join(2 * digit for digit in text[1:])
    red, green, blue = (int(digits[k:k + 2], 16) for k in (0, 2, 4))
    return red, green, blue
