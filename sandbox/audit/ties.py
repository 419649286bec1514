"""Figures of what is let go and taken up: nothing it carries then, no more before it breaks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import EXACT, Figure, Worst, judged, missing
from sandbox.model.ties import held_one
from sandbox.numeric import Array, Flags
from sandbox.samples.cords import piece_tensions


def tie_figures(evidence: Evidence) -> Iterator[Figure]:
    """Loads of what is let go, and of what may break."""
    source, none = "F = 0 where released", "nothing can be released"
    if not evidence.model.ties.name:
        yield missing("release.force", why=none, source=source)
        yield missing("release.load", why=none, source="F <= F_b")
        return
    most, told = 0.0, []
    for tie, name in enumerate(evidence.model.ties.name):
        holds, load = _holds(evidence, tie), _load(evidence, tie)
        gone = ~holds
        gone[1:] &= ~holds[:-1]  # in the step in which it breaks it gives a part of its load
        most = max(most, float(load[gone].max(initial=0.0)))
        if (~holds).any():
            told.append(f"{name} at {evidence.run.time[int(np.argmin(holds))]:.4g} s"
                        + _freed(evidence, tie, holds))
    yield judged(
        "release.force", most, "N", 0.0, source=source,
        why="largest load of released elements; released: " + ("; ".join(told[:4]) or "nothing"))
    yield _loads(evidence)


def _loads(evidence: Evidence) -> Figure:
    worst, ties = Worst(), evidence.model.ties
    for tie in np.flatnonzero(np.isfinite(ties.breaks_at)).tolist():
        over = _load(evidence, tie) / ties.breaks_at[tie] - 1.0
        worst.add(ties.name[tie], np.maximum(over, 0.0), EXACT, _holds(evidence, tie))
    return worst.figure(
        "release.load", "", source="F <= F_b", none="no element has a breaking load",
        why="load above the breaking load, relative to it, {count:element}, worst: {where}")


def _holds(evidence: Evidence, tie: int) -> Flags:
    return held_one(tie, evidence.run.arrays["held"])


def _element(evidence: Evidence, tie: int) -> tuple[str, int]:
    return next((kind, int(found[0])) for kind in ("joint", "spring", "tendon")
                if (found := np.flatnonzero(evidence.model.ties.of(kind) == tie)).size)


def _load(evidence: Evidence, tie: int) -> Array:
    """Size of what it carries [N, N m], [n]: of a cord the largest tension along it."""
    (kind, i), a, model = _element(evidence, tie), evidence.run.arrays, evidence.model
    if kind == "joint":
        return np.asarray(a["joint_reaction"][:, i])
    if kind == "tendon":
        pieces = np.flatnonzero(model.tendons.stretch_tendon == i)
        return np.asarray(np.abs(piece_tensions(model, a, pieces)).max(axis=0))
    force = a["spring_force"][:, i]
    if not model.springs.straight[i]:  # its damping is its hinge's
        j = model.springs.joint[i]
        holds = held_one(model.ties.joint[j], a["held"])
        force = force - holds * model.springs.damping[i] * evidence.rates[j]
        return np.asarray(np.where(np.abs(force) > EXACT * np.abs(
            a["spring_force"][:, i]).max(initial=0.0), np.abs(force), 0.0))
    return np.asarray(np.abs(force))


def _freed(evidence: Evidence, tie: int, holds: Flags) -> str:
    """What energy was in a linear spring or cord, which is lost with it."""
    kind, i = _element(evidence, tie)
    springs, tendons = evidence.model.springs, evidence.model.tendons
    last = int(np.argmin(holds)) - 1
    if kind == "joint" or last < 0:
        return ""
    k = springs.stiffness[i] if kind == "spring" else tendons.stiffness[i]
    law = kind == "spring" and springs.law[i] is not None
    driven = (springs.drive[i] >= 0 if kind == "spring"
              else max(tendons.drive[i], tendons.stiffener[i]) >= 0)
    if law or driven or not k > 0:
        return ""
    return f" with {float(_load(evidence, tie)[last]) ** 2 / (2 * k):.3g} J, which go with it"
