"""What a run can be asked for, and how: printed where ``sandbox plot`` is asked for nothing."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sandbox.recording.recording import Recording

KINDS = {"meter": "meters", "drive": "drives", "tendon": "tendons", "joint": "joints",
         "spring": "springs", "load": "loads", "line": "lines", "valve": "valves",
         "group": "groups", "body": "bodies"}
"""What is asked for most comes first."""
MOST_NAMED, MOST_PAIRS, MOST_TRIED = 8, 6, 200
"""Elements of a kind and pairs of bodies that are named; pairs of which it is looked up whether
they touched."""
MOST_CURVES = 12
"""Of a pattern in an example: more are better looked at in parts."""


def quantity_lines(run: Recording, word: str) -> list[str]:
    """The quantities of a run, kind by kind, and commands that plot some of ``word``, the run."""
    title = run.mechanism.title or run.mechanism.name
    lines = [title, f"{len(run)} samples from 0 to {run.time[-1]:.3g} s of "
             f"{len(run.catalogue.units)} quantities"]
    for kind, many in KINDS.items():
        lines += _kind(run, kind, many)
    if pairs := list(_touching(run)):
        lines += ["", f"pairs of bodies that touched: {_named(pairs, MOST_PAIRS)}",
                  *_rows([(f".{name}", unit, about) for name, unit, about in _of(
                      "pair", {"normal": "N", "tangential": "N"})])]
    return [*lines, "", "to plot some:", *(f"  {line}" for line in examples(run, word, pairs))]


def quantity_data(run: Recording) -> list[dict[str, str]]:
    """Every quantity with its unit and its sentence, as JSON data."""
    found = []
    for name, unit in run.catalogue.units.items():
        source = run.catalogue.find(name)
        about = _meter_about(run, source.index) if source.kind == "meter" else \
            _about(source.kind, source.quantity)
        found.append({"name": name, "unit": unit, "about": about})
    return found


def examples(run: Recording, word: str, pairs: list[str]) -> list[str]:
    """Commands to copy: one quantity, several by a pattern, one against another, a contact."""
    from sandbox.kinds.quantities import USUAL
    from sandbox.samples.targets import led

    units, usual = run.catalogue.units, run.catalogue.usual
    wanted = list(dict.fromkeys([*led(run), *(name for names in usual.values() for name in names),
                                 *units]))
    plot, one = f"sandbox plot {shlex.quote(word)}", wanted[0]
    found = [f"{plot} {shlex.quote(one)}"]
    patterns = (pattern for tail in filter(None, USUAL.values()) for pattern in (
        f"*.{tail}", f"{one.partition('.')[0]}.*.{tail}"))
    if several := next((pattern for pattern in patterns
                        if 1 < len(run.match(pattern)) <= MOST_CURVES), ""):
        found.append(f"{plot} {shlex.quote(several)} --from {0.5 * run.time[-1]:.1g}s")
    if other := next((name for name in wanted if units[name] != units[one]), ""):
        found.append(f"{plot} {shlex.quote(other)} --x {shlex.quote(one)}")
    if pairs:
        found.append(f"{plot} {shlex.quote(f'{pairs[0]}.normal')}")
    return found


def _kind(run: Recording, kind: str, many: str) -> list[str]:
    having = {name: entry for name, entry in run.catalogue.elements.items() if entry.kind == kind}
    if not having:
        return []
    if kind == "meter":
        return ["", f"{many}:", *_rows([
            (name, entry.quantities[""], _meter_about(run, entry.index))
            for name, entry in having.items()])]
    units: dict[str, dict[str, None]] = {}
    count: dict[str, int] = {}
    for entry in having.values():
        for quantity, unit in entry.quantities.items():
            units.setdefault(quantity, {})[unit] = None
            count[quantity] = count.get(quantity, 0) + 1
    rows = []
    for quantity, each in units.items():
        some = "" if count[quantity] == len(having) else f" ({count[quantity]} of {len(having)})"
        rows.append((f".{quantity}", " or ".join(each), _about(kind, quantity) + some))
    return ["", f"{many}: {_named(list(having), MOST_NAMED)}", *_rows(rows)]


def _rows(rows: list[tuple[str, str, str]]) -> list[str]:
    wide, units = (max(len(row[i]) for row in rows) for i in (0, 1))
    return [f"  {name:{wide}}  {'' if unit == '1' else unit:{units}}  {about}".rstrip()
            for name, unit, about in rows]


def _of(kind: str, quantities: dict[str, str]) -> Iterator[tuple[str, str, str]]:
    return ((name, unit, _about(kind, name)) for name, unit in quantities.items())


def _about(kind: str, quantity: str) -> str:
    from sandbox.kinds.quantities import about

    return about(kind, quantity).replace("`", "'")


def _meter_about(run: Recording, index: int) -> str:
    return run.mechanism.meters[index].value


def _named(names: list[str], most: int) -> str:
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")


def _touching(run: Recording) -> Iterator[str]:
    """Pairs of bodies between which there was a force, as far as it is quick to tell."""
    for name in run.match("*/*.normal")[:MOST_TRIED]:
        if (run[name] > 0).any():
            yield name.removesuffix(".normal")
