"""Reduce a run to a few numbers, and compare them with those that are kept.

Of every named quantity the digest has the mean and a hash of its bytes; of all quantities of one
kind together the root mean square, the largest magnitude, the sum of the last values and how many
values are nan or infinite. A kind is the last word of the name: ``finger1.tendon.tension`` is of
the kind ``tension``. Contacts are kept by pair, as the kinds ``contact.force`` and
``contact.gap``. Beside them stand a hash of all names, the values of expectations, the events and
the audit's values.

On the platform on which ``values.json`` was written all bytes are the same. On another one the
numbers agree within a tolerance that comes from the scene itself: ``accept`` runs every scene a
second time with all masses larger by 1e-10 of themselves, and keeps by how much this moves the
numbers. Impacts amplify it; scenes that amplify it beyond :data:`CHAOTIC` are compared by their
outcome alone.
"""

from __future__ import annotations

import hashlib
import json
import platform
import re
import sys
from collections.abc import Iterator, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from llvmlite import binding

from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.grasps import STIFFNESS
from sandbox.scene.mechanism import Mechanism

from .scenes import recording_of

VALUES = Path(__file__).with_name("values.json")
DIGITS = 6
ROUNDING = 1.1e-5
"""Two numbers of six digits that differ by this share are the same."""
FLOOR = 1e-9
"""Numbers that differ by less are the same, in any SI unit: a force of 1e-15 N is rounding."""
PERTURBATION = 1e-10
"""Of all masses, to measure how a scene amplifies rounding."""
MARGIN = 30.0
"""The tolerance on other platforms, by what the perturbation moves."""
CHAOTIC = 1e-2
"""Tolerances beyond this are meaningless."""
OUTCOME = ("status", "samples", "names", "failed", "looks")
MOMENTS = ("rms", "largest", "sum of last values", "nan", "infinite")
UNHASHED = {*STIFFNESS}
"""Kinds whose last bits depend on the threads of LAPACK."""
AUDIT_SHARE, AUDIT_FLOOR = 0.01, 1e-7
"""Values of the audit are residuals, mostly of rounding: they may differ by this share, and by this
much. On other platforms only its verdicts are compared."""

Digest = dict[str, Any]


class Kind(NamedTuple):
    """All quantities of one kind."""

    moments: list[Any]
    """:data:`MOMENTS` of all of them together."""
    means: list[Any]
    """The mean of each."""
    hashes: str
    """Three hexadecimal digits of each; empty where they are not compared."""


def this_platform() -> dict[str, str]:
    """What exact bytes depend on."""
    features = sorted(name for name, on in binding.get_host_cpu_features().items() if on)
    return {
        "machine": f"{sys.platform} {platform.machine()}",
        "cpu": f"{binding.get_host_cpu_name()} "
               + hashlib.blake2b(",".join(features).encode(), digest_size=4).hexdigest(),
        "python": f"{sys.version_info.major}.{sys.version_info.minor}",
        **{name: version(name) for name in ("numpy", "numba", "llvmlite", "pymunk")}}


# --- of one run

def digest(run: Recording) -> Digest:
    """The numbers of a run."""
    kinds: dict[str, list[Array]] = {}
    for kind, _, values in _quantities(run):
        kinds.setdefault(kind, []).append(values)
    return {
        "status": run.info.status.name, "samples": len(run),
        "names": hashlib.blake2b("\n".join(run.names()).encode(), digest_size=3).hexdigest(),
        "kinds": {kind: _kind(kind, kinds[kind]) for kind in sorted(kinds)},
        "expect": [_short(verdict.value) for verdict in run.verdicts],
        "failed": [verdict.quantity for verdict in run.verdicts if not verdict.ok],
        "events": [[each.event, _short(each.time)]
                   for each in (*run.info.events, *run.info.broke)],
        "audit": {figure.name: _short(figure.value, 3) for figure in run.audit
                  if figure.verdict != "not computed"},
        "looks": [figure.name for figure in run.audit if figure.verdict == "look"]}


def _quantities(run: Recording) -> Iterator[tuple[str, str, Array]]:
    """Kind, name and values of all quantities and of the contacts of every pair."""
    for name in run.names():
        yield kind_of(name), name, run[name]
    a = run.arrays
    for name, rows in _pairs(run):
        yield "contact.force", name, np.column_stack([
            np.hypot(*a["contact_force"][rows].T), run.time[a["contact_sample"][rows]],
            a["contact_force"][rows], a["contact_point"][rows], a["contact_normal"][rows]])
        yield "contact.gap", name, a["contact_gap"][rows]


def _pairs(run: Recording) -> Iterator[tuple[str, Array]]:
    """Name of every pair in contact, and which contacts are its own."""
    bodies = [body.name for body in run.mechanism.bodies]
    pair = run.arrays["contact_body"] * len(bodies) + run.arrays["contact_other"]
    for each in np.unique(pair).tolist():
        yield f"{bodies[each // len(bodies)]}/{bodies[each % len(bodies)]}", pair == each


def kind_of(name: str) -> str:
    """``finger1.distal.contact.fx`` is of the kind ``fx``; numbers do not count."""
    return re.sub(r"\d+", "#", name.rpartition(".")[2])


def _kind(kind: str, series: list[Array]) -> Kind:
    first = [np.asarray(each if each.ndim == 1 else each[:, 0], dtype=np.float64)
             for each in series]
    finite = [np.where(np.isfinite(each), each, 0.0) for each in first]
    flat = np.concatenate(finite)
    size = max(1, len(flat))
    moments = [_short(float(np.sqrt(np.sum(flat**2) / size))),
               _short(float(np.abs(flat).max(initial=0.0))),
               _short(float(sum(each[-1] for each in finite if len(each)))),
               int(sum(np.isnan(each).sum() for each in first)),
               int(sum(np.isinf(each).sum() for each in first))]
    return Kind(moments, [_short(float(each.sum() / max(1, len(each)))) for each in finite],
                "" if kind in UNHASHED else "".join(map(_hash, series)))


def _hash(values: Array) -> str:
    """Three hexadecimal digits; zeros have no sign, and all nan are the same."""
    plain = np.where(np.isnan(values), np.nan, np.asarray(values, dtype=np.float64)) + 0.0
    return hashlib.blake2b(np.ascontiguousarray(plain).tobytes(), digest_size=2).hexdigest()[:3]


def _short(value: float, digits: int = DIGITS) -> float | str:
    """A number as JSON holds it: six digits, whole numbers without a point."""
    if not np.isfinite(value):
        return str(value)
    short = float(f"{value:.{digits}g}")
    return int(short) if short.is_integer() and abs(short) < 1e15 else short


# --- of two runs

def differences(
    old: Digest, new: Digest, names: Mapping[str, list[str]], *, tolerance: float = 0.0,
) -> list[str]:
    """What moved, in words; empty if nothing did.

    Args:
        old: as it is kept.
        new: as it is now.
        names: the quantities of every kind of the new run.
        tolerance: share by which numbers may differ; 0 compares bytes and the audit's values, inf
            the outcome alone.
    """
    keys = ("status", "failed") if tolerance == np.inf else OUTCOME
    found = [f"{key}: {old[key]} -> {new[key]}" for key in keys if old[key] != new[key]]
    if tolerance == np.inf:
        return found
    share = max(ROUNDING, tolerance)
    for kind in sorted(old["kinds"].keys() | new["kinds"].keys()):
        found += _moved_kind(kind, old["kinds"].get(kind), new["kinds"].get(kind),
                             names.get(kind, []), share, exact=not tolerance)
    if [name for name, _ in old["events"]] != [name for name, _ in new["events"]]:
        found.append(f"events: {old['events']} -> {new['events']}")
    if len(old["expect"]) != len(new["expect"]):
        found.append(f"expect: {len(old['expect'])} values -> {len(new['expect'])}")
    for what, one, two in (("expect", old["expect"], new["expect"]),
                           ("events", *([time for _, time in each["events"]]
                                        for each in (old, new)))):
        found += [f"{what}[{i}]: {_change(a, b)}"
                  for i, (a, b) in enumerate(zip(one, two, strict=False)) if _moved(a, b, share)]
    return found if tolerance else found + _moved_audit(old["audit"], new["audit"])


def _moved_kind(
    kind: str, old: Kind | None, new: Kind | None, names: list[str], share: float, *, exact: bool,
) -> list[str]:
    if old is None or new is None:
        return [f"{kind}: {'new' if old is None else 'gone'}"]
    if len(old.means) != len(new.means):
        return [f"{kind}: {len(old.means)} quantities -> {len(new.means)}"]
    size = max(abs(old.moments[1]), abs(new.moments[1]))
    found = [f"{kind}: {what} {_change(a, b)}" for what, a, b in zip(
        MOMENTS, old.moments, new.moments, strict=True) if _moved(a, b, share, size)]
    for i, (a, b) in enumerate(zip(old.means, new.means, strict=True)):
        if _moved(a, b, share, size):
            found.append(f"{names[i]}: mean {_change(a, b)}")
        elif exact and old.hashes[3 * i:3 * i + 3] != new.hashes[3 * i:3 * i + 3]:
            found.append(f"{names[i]}: other bytes, mean {b:.6g} as before")
    return found


def _moved_audit(old: dict[str, Any], new: dict[str, Any]) -> list[str]:
    if old.keys() != new.keys():
        return [f"audit: {sorted(old.keys() ^ new.keys())} computed in one of both"]
    return [f"audit {name}: {_change(old[name], new[name])}" for name in old
            if _moved(old[name], new[name], AUDIT_SHARE, floor=AUDIT_FLOOR)]


def _moved(a: Any, b: Any, share: float, size: float = 0.0, floor: float = FLOOR) -> bool:
    """Whether two numbers differ; ``size`` is the largest of their kind."""
    if isinstance(a, str) or isinstance(b, str):
        return bool(a != b)
    return bool(abs(a - b) > share * max(abs(a), abs(b), 1e-3 * size) + floor)


def _change(a: Any, b: Any) -> str:
    if isinstance(a, str) or isinstance(b, str):
        return f"{a} -> {b}"
    return f"{a:.6g} -> {b:.6g} ({abs(a - b) / max(abs(a), abs(b)):.2g} of it)"


def names_by_kind(run: Recording) -> dict[str, list[str]]:
    """The quantities of every kind of a run, in the order of its digest."""
    found: dict[str, list[str]] = {}
    for name in run.names():
        found.setdefault(kind_of(name), []).append(name)
    pairs = [name for name, _ in _pairs(run)]
    return found | ({"contact.force": pairs, "contact.gap": pairs} if pairs else {})


# --- how a scene amplifies rounding

def spread(mechanism: Mechanism, plain: Digest) -> float:
    """The largest relative change of a moment as all masses grow by :data:`PERTURBATION`."""
    bodies = tuple(
        body.model_copy(update={key: value * (1 + PERTURBATION) for key in ("mass", "density")
                                if (value := getattr(body, key)) is not None})
        for body in mechanism.bodies)
    moved = digest(recording_of(mechanism.model_copy(update={"bodies": bodies})))
    if any(moved[key] != plain[key] for key in OUTCOME):
        return 1.0
    shares = [
        (abs(a - b) - FLOOR) / max(abs(a), abs(b), 1e-3 * abs(old.moments[1]), FLOOR)
        for kind, old in plain["kinds"].items()
        if (new := moved["kinds"].get(kind)) and len(new.means) == len(old.means)
        for one, two in ((old.moments, new.moments), (old.means, new.means))
        for a, b in zip(one, two, strict=True)]
    return float(f"{max(0.0, max(shares, default=0.0)):.1g}")


# --- the file

def read_values(path: Path = VALUES) -> dict[str, Any]:
    """``platform``, and the digest of every scene, with its own platform where that is another."""
    if not path.exists():
        return {"platform": None}
    kept: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    figures = kept.pop("audit")
    for value in kept.values():
        if "kinds" in value:
            value["kinds"] = {kind: Kind(*each) for kind, each in value["kinds"].items()}
            value["audit"] = {name: each for name, each in zip(figures, value["audit"], strict=True)
                              if each is not None}
    return kept


def write_values(kept: Mapping[str, Any], path: Path = VALUES) -> None:
    """One line a scene; the names of the audit's values once for all."""
    figures = sorted({name for value in kept.values() for name in value.get("audit", ())})
    plain = {"platform": kept["platform"], "audit": figures, **{
        name: {**value, "audit": [value["audit"].get(figure) for figure in figures]}
        for name, value in kept.items() if name != "platform"}}
    lines = [f"{json.dumps(name)}: {json.dumps(value, separators=(',', ':'))}"
             for name, value in plain.items()]
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def tolerance_of(kept: Mapping[str, Any], name: str) -> float:
    """For :func:`differences`: 0 on the platform on which the scene was accepted."""
    if kept[name].get("platform", kept["platform"]) == this_platform():
        return 0.0
    tolerance = max(ROUNDING, MARGIN * float(kept[name]["spread"]))
    return tolerance if tolerance <= CHAOTIC else np.inf
