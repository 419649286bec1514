"""What a sweep is told in few words: ``2:8:60``, ``mean disc.x over last 0.2 s``."""

from __future__ import annotations

import json
import re
from typing import Any

from sandbox.scene.elements.settings import STATISTICS, Looked
from sandbox.scene.values.numbers import number_from
from sandbox.sweeps.varied import NEEDS
from sandbox.wording import WrongValueError, near, quoted

WAYS = ('"2:8:60" (from:to:count), "1:100:20:log", "1, 2, 5", "[1, 2, 5]", '
        '"normal(3 N, 0.2 N)", "2:8" with a count of points')
_CALL = re.compile(r"\s*([A-Za-z_][A-Za-z0-9_]*)\s*\(([^()]*)\)\s*")
_OVER = re.compile(r"\s+over\s+")


def varied_from(text: str) -> Any:
    """What a path is given, as a study file has it.

    Raises:
        WrongValueError: none of :data:`WAYS`.
    """
    text = text.strip()
    if call := _CALL.fullmatch(text):
        return _distribution(call[1], call[2])
    if text.startswith(("[", "{")):
        try:
            return json.loads(text, parse_constant=_no_number)
        except ValueError as error:
            raise WrongValueError("invalid-json",
                                  f"{quoted(text)} is not JSON: {error}", allowed=WAYS) from None
    if ":" in text:
        return _span(text)
    if not text:
        raise WrongValueError("bad-study", "there are no values", allowed=WAYS)
    return [_value(part) for part in text.split(",")]


def _span(text: str) -> dict[str, Any]:
    first, last, *more = (part.strip() for part in text.split(":"))
    span: dict[str, Any] = {"from": _value(first), "to": _value(last)}
    if more and more[-1] in ("log", "linear"):
        span["scale"] = more.pop()
    if len(more) > 1:
        raise WrongValueError("bad-study", f"{quoted(text)} has too many parts", allowed=WAYS)
    if more:
        try:
            span["count"] = int(more[0])
        except ValueError:
            raise WrongValueError("bad-study", f"{quoted(more[0])} does not say how many numbers",
                                  allowed=WAYS, hint=near(more[0], ["log"])) from None
    return span


def _distribution(name: str, inside: str) -> dict[str, Any]:
    if name not in NEEDS:
        raise WrongValueError("bad-study", f"there is no distribution {quoted(name)}",
                              allowed=", ".join(NEEDS), hint=near(name, NEEDS))
    needed, possible = NEEDS[name]
    keys = [key.rstrip("_") for key in (*needed, *possible)]
    found: dict[str, Any] = {"distribution": name}
    for place, part in enumerate(filter(None, (each.strip() for each in inside.split(",")))):
        key, equals, value = (each.strip() for each in part.partition("="))
        if not equals:
            if place >= len(keys):
                raise WrongValueError("bad-study", f"{name} takes no more than {', '.join(keys)}")
            key, value = keys[place], key
        found[key] = _value(value)
    return found


def _value(text: str) -> Any:
    """A number or word of the command line as a file would hold it."""
    try:
        return json.loads(text, parse_constant=_no_number)
    except ValueError:
        return text.strip()


def _no_number(word: str) -> float:
    raise ValueError(f"{word} is no number")


def looked_at(text: str) -> dict[str, Any]:
    """``"mean disc.x over last 0.2 s"`` or ``"disc.x at 0.5 s"`` as an object.

    A quantity alone means its last sample.

    Raises:
        WrongValueError: a statistic that there is none of, or no window.
    """
    quantity, at, instant = text.strip().partition(" at ")
    if at:
        return {"quantity": quantity.strip(), "at": instant.strip()}
    what, *windows = _OVER.split(text.strip())
    if len(windows) > 1:
        raise WrongValueError("bad-study", f"{quoted(text)} has more than one 'over'")
    head, _, rest = what.partition(" ")
    if not rest:
        statistic, quantity = "final", head
    elif head in STATISTICS:
        statistic, quantity = head, rest.strip()
    else:
        raise WrongValueError("bad-study", f"there is no statistic {quoted(head)}",
                              allowed=", ".join(STATISTICS), hint=near(head, STATISTICS))
    found: dict[str, Any] = {statistic: quantity}
    if windows:
        found["over"] = _window(windows[0].strip())
    return found


def told(asked: Looked) -> str:
    """The words of a statistic of a quantity: the inverse of :func:`looked_at`."""
    if asked.at is not None:
        return f"{asked.quantity} {asked.statistic}"
    begin, end = asked.over
    if begin < 0 and end is None:
        window = f"last {-begin:g} s"
    else:
        window = f"{begin:g} s : {'end' if end is None else f'{end:g} s'}"
    return f"{asked.statistic} {asked.quantity}" + (
        f" over {window}" if asked.over != (0.0, None) else "")


def _window(text: str) -> Any:
    if text.startswith("last "):
        return text
    ends = [part.strip() for part in text.split(":")]
    if len(ends) != 2:
        raise WrongValueError("bad-study", f"{quoted(text)} is no window of time",
                              allowed='"last 0.2 s", "0.5 s : 1 s"')
    return [number_from(end, "time", {}) for end in ends]


def kept_from(text: str) -> tuple[str, str]:
    """The name and what is kept of ``"tip = max finger.tip.x"``; without a name its own text.

    Raises:
        WrongValueError: it is empty, or an expression without a name.
    """
    name, equals, what = text.partition("=")
    name, what = name.strip(), what.strip()
    if not equals:
        name, what = text.strip(), text.strip()
    elif not name:
        raise WrongValueError("bad-study", f"{quoted(text)} has no name",
                              allowed="name==expression")
    if not what:
        raise WrongValueError("bad-study", f"{quoted(text)} does not say what is kept",
                              allowed='"max finger.tip.x over last 0.2 s", "tip=max finger.tip.x", '
                                      '"ratio==tip / pull"')
    return name, what
