"""A scene's file from a seed: valid, nearly valid, hostile, or hardly JSON.

It begins as one or two shipped scenes, which together hold every kind of element, and is changed
where a person or an enemy would change it: numbers at both ends of all ranges, references to what
is not there, elements twice, missing, of another kind or from another scene, text that is none.
"""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

from sandbox.scene.library import shipped_scenes

ENDS = (0.0, -0.0, 5e-324, 1e-300, 1e-155, 1e-24, 1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9,
        1e12, 1e15, 1e18, 1e155, 1e300, 1.7976931348623157e308)
TEXTS = ("", " ", "a" * 101, "a" * 5000, "\ud800", "\x1b[31m", "\u202e", "a\nb", "*", ".", "../x",
         "t", "=1/0", "=t", "=sin(t) * 1e300", "=1e300 ** 64", "=nothing", "=" + "(" * 70,
         "1e400 N", "12", "3 mm", "1e300 mm", "-1 deg", "5 furlongs", "last 0.1 s",
         "last -1 s", "١٢ mm",
         "=stretch", "=1e300 * stretch", "=1e9 * stretch ** 3", "=sqrt(stretch)", "=log(rate)",
         "=-1e6 * stretch", "=1e12 * sign(rate)", "=play(stretch)", "=play(play(t))",
         "=play(1e300)", "=characteristic(rate)", "=twist ** 64", "=1 / twist", "pull", "above",
         "cubic", "repeat", "extend")
OTHERS: tuple[Any, ...] = (None, True, False, [], {}, [[]], [None], {"type": "pin"}, 10**30,
                           -1, 0, 1, [1e300, 0], ["a", "b"])
RAW = (b"NaN", b"-Infinity", b"1e999", b"\x00", b"\xff\xfe", b"\xef\xbb\xbf", b"[" * 50,
       b'{"a":1,"a":2}', b"//", b",", b"}", b'"\\ud800"', b"1" * 400)
KEYS = ("extra", "limits", "value", "rate", "radius", "damping", "", "\ud800", "tables", "force",
        "torque", "only", "between", "beyond")
MAX_CHANGES = 6
Path = tuple[str | int, ...]
Change = Callable[[Any, random.Random], None]


def make(seed: int) -> bytes:
    """The file of a seed; the same on every machine."""
    chance = random.Random(seed)
    data = copy.deepcopy(chance.choice(_shipped()))
    data["view"] = {"size": [64, 64], "fps": 20}
    for _ in range(chance.choice([0, 1, 1, 1, 2, 2, 3, MAX_CHANGES])):
        chance.choice(CHANGES)(data, chance)
    text = json.dumps(data, indent=chance.choice([None, 1])).encode()
    return damaged(text, chance) if chance.random() < 0.1 else text


@cache
def _shipped() -> list[dict[str, Any]]:
    return [json.loads(path.read_text(encoding="utf-8")) for path in shipped_scenes().values()]


def _places(value: Any, path: Path = ()) -> Iterator[Path]:
    """Every place of the data but the whole."""
    steps = value.items() if isinstance(value, dict) else (
        enumerate(value) if isinstance(value, list) else ())
    for step, entry in steps:
        yield (*path, step)
        yield from _places(entry, (*path, step))


def _holder(data: Any, path: Path) -> Any:
    for step in path[:-1]:
        data = data[step]
    return data


def _pick(
    data: Any, chance: random.Random, fits: Callable[[Any], bool] = lambda value: True,
) -> tuple[Any, str | int] | None:
    """A container and a key in it whose value fits."""
    found = [(holder, path[-1]) for path in _places(data)
             if fits((holder := _holder(data, path))[path[-1]])]
    return chance.choice(found) if found else None


def _edit(fits: Callable[[Any], bool], new: Callable[[Any, random.Random], Any]) -> Change:
    """The change of one value that fits into a new one."""
    def change(data: Any, chance: random.Random) -> None:
        if spot := _pick(data, chance, fits):
            holder, key = spot
            holder[key] = new(holder[key], chance)

    return change


def _number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _other_number(value: float, chance: random.Random) -> float:
    end = chance.choice(ENDS) * chance.choice([1, 1, 1, -1])
    return chance.choice([end, end, value * chance.choice([-1, 0.5, 2, 1e3, 1e-3]),
                          chance.uniform(-1, 1)])


_change_number = _edit(_number, _other_number)
_change_quantity = _edit(
    lambda value: isinstance(value, str) and value[:1].isdigit(),
    lambda value, chance: f"{chance.choice(ENDS)!r} {value.partition(' ')[2]}".strip())
_change_text = _edit(lambda value: isinstance(value, str), lambda _, chance: chance.choice(TEXTS))
_change_kind = _edit(lambda _: True, lambda _, chance: copy.deepcopy(chance.choice(OTHERS)))
_add_key = _edit(lambda value: isinstance(value, dict), lambda value, chance: {
    **value, chance.choice(KEYS): copy.deepcopy(chance.choice([*OTHERS, *ENDS, *TEXTS]))})


def _swap_reference(data: Any, chance: random.Random) -> None:
    """Let a text be another text of the scene: another body, another kind, another quantity."""
    one, other = (_pick(data, chance, lambda v: isinstance(v, str)) for _ in range(2))
    if one and other:
        one[0][one[1]] = other[0][other[1]]


def _remove(data: Any, chance: random.Random) -> None:
    if spot := _pick(data, chance):
        del spot[0][spot[1]]


def _repeat(data: Any, chance: random.Random) -> None:
    """An element twice, as it is or under a name of its own."""
    if spot := _pick(data, chance, lambda v: isinstance(v, list) and bool(v)):
        entries = spot[0][spot[1]]
        again = copy.deepcopy(chance.choice(entries))
        if isinstance(again, dict) and chance.random() < 0.7:
            again["name"] = f"again{chance.randrange(9)}"
        entries.insert(chance.randrange(len(entries) + 1), again)


def _graft(data: Any, chance: random.Random) -> None:
    """An element of another scene, which may name what is not here."""
    other = chance.choice(_shipped())
    lists = [key for key, value in other.items() if isinstance(value, list) and value]
    if lists:
        key = chance.choice(lists)
        if isinstance(data.setdefault(key, []), list):
            data[key].append(copy.deepcopy(chance.choice(other[key])))


def _entries_of(data: Any, chance: random.Random) -> list[Any]:
    """The entries of some list of objects, perhaps one in an assembly or of shapes."""
    spot = _pick(data, chance, lambda v: isinstance(v, list) and any(
        isinstance(entry, dict) for entry in v))
    return spot[0][spot[1]] if spot else []


def _repeat_with_index(data: Any, chance: random.Random) -> None:
    """An entry that is repeated, by a good count or a hostile one."""
    entries = [entry for entry in _entries_of(data, chance) if isinstance(entry, dict)]
    if not entries:
        return
    entry = chance.choice(entries)
    count = chance.choice([1, 2, 3, 5, 300, 20_000, "=n", "=2 + 1", "=i", *OTHERS, *ENDS])
    entry["repeat"] = chance.choice([
        count, count, {"count": count, "circle": [0, chance.choice(ENDS)]},
        {"count": count, "line": ["1 mm", chance.choice([0, *TEXTS])]},
        {"list": [1, "2 mm", chance.choice([*TEXTS, *OTHERS])], "index": "k"},
        {"list": [{"a": 1, "b": "left"}, {"a": chance.choice(ENDS)}]}])
    if isinstance(entry.get("name"), str) and chance.random() < 0.8:
        entry["name"] += chance.choice(["{i}", "{i}", "{i + 1}", "{k}", "{a}", "{i", "{}", "{1/0}"])


def _template(data: Any, chance: random.Random) -> None:
    """An entry whose keys move to a template, perhaps one that is like itself."""
    entries = [entry for entry in _entries_of(data, chance) if isinstance(entry, dict)]
    templates = data.get("templates") if isinstance(data, dict) else None
    if not entries or not isinstance(data, dict):
        return
    if not isinstance(templates, dict):
        templates = data["templates"] = {}
    entry = chance.choice(entries)
    moved = chance.sample(list(entry), k=chance.randrange(len(entry) + 1))
    name = f"t{chance.randrange(3)}"
    templates[name] = {key: entry.pop(key) for key in moved}
    entry["like"] = chance.choice([name, name, name, "t0", "t9", 3])
    if chance.random() < 0.2:
        templates[name]["like"] = chance.choice(["t0", "t1", "t2"])
    if chance.random() < 0.1:
        templates[name]["parts"] = [{"like": name, "name": "a"}, {"like": name, "name": "b"}]


def _assemble(data: Any, chance: random.Random) -> None:
    """All elements in an assembly, or the scene's own file included."""
    if not isinstance(data, dict):
        return
    part: dict[str, Any] = {
        "name": chance.choice(["left", "a.b", "disc"]), "at": [chance.uniform(-1, 1), 0],
        "angle": chance.choice([0, "90 deg", 1, 1e300]), "scale": chance.choice([1, 1, 2, *ENDS])}
    if chance.random() < 0.5:
        part["mirror"] = chance.choice(["left-right", "up-down", "left-right", "left"])
    if chance.random() < 0.2:
        part["include"] = chance.choice(["scene", "../scene", "/etc/hostname", "", ".", *TEXTS])
        part["parameters"] = {"a": chance.choice(ENDS)}
    else:
        part["type"] = "assembly"
        for key in ("bodies", "joints", "springs", "tendons", "lines", "valves", "loads", "drives",
                    "meters", "parts"):
            if isinstance(data.get(key), list) and chance.random() < 0.9:
                part[key] = data.pop(key)
    parts = data.setdefault("parts", [])
    if isinstance(parts, list):
        parts.append(part)


CHANGES = (_repeat_with_index, _repeat_with_index, _template, _assemble, _assemble,
           _change_number, _change_number, _change_number, _change_quantity, _change_quantity,
           _change_text, _swap_reference, _change_kind, _remove, _repeat, _graft, _graft, _add_key)


def damaged(text: bytes, chance: random.Random) -> bytes:
    """Bytes of a file cut off, turned over or put in; an archive's lists lie at its end."""
    for _ in range(chance.randrange(1, 4)):
        place = chance.randrange(len(text) + 1)
        if chance.random() < 0.3:
            place = max(0, len(text) - chance.randrange(1, 4000))
        text = chance.choice([
            text[:place], text[:place] + chance.choice(RAW) + text[place:],
            text[:place] + bytes([chance.randrange(256)]) + text[place + 1:]])
    return text
