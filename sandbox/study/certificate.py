"""What a certificate says: trust in every expectation, what audits saw, what it would take."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from sandbox.audit.audit import Figure
from sandbox.study.convergence import Kind, Trust

OF_THE_MECHANISM = ("contact.shared", "tendon.slack")
"""Figures that ask for a look at what a mechanism is like, not at how well it was computed: the
step does not decide them, and what they do to an expected quantity is seen in its three values."""


@dataclass(frozen=True)
class Look:
    """A figure of the audit that asks for a look."""

    runs: tuple[str, ...]
    """In which it does: some of :data:`sandbox.study.repeats.LABELS`."""
    figure: Figure
    """Of the run where it exceeds its threshold most."""


@dataclass(frozen=True)
class Diverged:
    """A run that ran away."""

    run: str
    """Of :data:`sandbox.study.repeats.LABELS`."""
    time: float
    """Of its last sample [s]."""
    reason: str
    """When, and led by which body."""


@dataclass(frozen=True)
class Certificate:
    """What became of every expectation of a scene."""

    steps: tuple[float, float, float]
    """h, h/2, h/4 [s]."""
    quantities: tuple[Trust, ...]
    """In the order of the scene's expectations."""
    looks: tuple[Look, ...] = ()
    """What the audits of the three runs ask for a look at."""
    diverged: tuple[Diverged, ...] = ()

    @property
    def doubtful(self) -> tuple[Trust, ...]:
        """The expectations that cannot be relied on."""
        return tuple(trust for trust in self.quantities if not trust.certified)

    @property
    def objections(self) -> tuple[Look, ...]:
        """What the audit of the run at h, which is the one certified, has against it."""
        return tuple(look for look in self.looks
                     if "h" in look.runs and look.figure.name not in OF_THE_MECHANISM)

    @property
    def certified(self) -> bool:
        """Whether every expectation holds and would at any finer step, and the audit agrees."""
        return not (self.doubtful or self.objections or self.diverged)

    @property
    def conclusion(self) -> str:
        """What to make of it, in a sentence or two."""
        if not self.certified:
            return f"Not certified: {'; '.join(self._against())}."
        base = f"Certified at h = {1e3 * self.steps[0]:g} ms"
        total, settled = len(self.quantities), sum(t.settled for t in self.quantities)
        also = f" The audits ask for a look at {_figures(self.looks)}." if self.looks else ""
        if settled == total:
            return f"{base}: all {total} expected quantities have converged.{also}"
        rest = ("one hangs on the step but stays inside its range" if total - settled == 1 else
                f"{total - settled} hang on the step but stay inside their ranges")
        return f"{base}: {settled} of {total} expected quantities have converged; {rest}.{also}"

    def _against(self) -> Iterator[str]:
        if self.diverged:
            yield f"the simulation diverged at {', '.join(each.run for each in self.diverged)}"
        if self.doubtful:
            named = ", ".join(dict.fromkeys(t.quantity for t in self.doubtful))
            yield (f"{len(self.doubtful)} of {len(self.quantities)} expectations cannot be relied "
                   f"on at this step: {named}")
        if self.objections:
            so_far = "" if self.doubtful else "the expectations would hold, but "
            yield f"{so_far}the audit at h asks for a look at {_figures(self.objections)}"

    @property
    def advice(self) -> tuple[str, ...]:
        """What it would take, a sentence each; nothing where it is certified."""
        return (*_against_running_away(self), *_against_doubt(self))


def _figures(looks: tuple[Look, ...]) -> str:
    return ", ".join(look.figure.name for look in looks)


CAUSES = ("light parts that carry heavy ones, springs that are stiff for the masses on them, or "
          "chance, as in chaotic motion ('sandbox check' names what it can see)")


def _against_running_away(found: Certificate) -> Iterator[str]:
    if not found.diverged:
        return
    times = {each.run: each.time for each in found.diverged}
    if "h/4" not in times:
        yield f"The run at h/4 came to its end: certify from there, {_at(found.steps[2])}."
    elif "h/2" in times and times["h/4"] < times["h/2"] < times.get("h", float("inf")):
        yield ("The finer the step, the sooner it ran away, so no step will do. Look for "
               f"{CAUSES}.")
    else:
        yield f"Look for {CAUSES}."


def _against_doubt(found: Certificate) -> Iterator[str]:
    valued = [t for t in found.doubtful if not math.isnan(t.error)]
    grown = [t for t in valued if t.kind is Kind.DIVERGES]
    if grown:
        yield from _against_growth(found, grown)
    else:
        yield from _against_step(found, [t for t in valued if t.kind is Kind.OPEN or (
            t.kind is Kind.FAILS and t.low <= t.values[2] <= t.high)])
    if any(t.kind is Kind.STEP for t in valued):
        yield ("Where a quantity tends to a value outside its range, no step helps: the range or "
               "the mechanism has to change.")
    if found.objections and not found.diverged:
        yield ("What the audit looks at is explained in docs/audit.md; only a run whose audit "
               "passes is certified.")


def _against_step(found: Certificate, unsettled: list[Trust]) -> Iterator[str]:
    if unsettled and all(t.finer for t in unsettled):
        finer = max(t.finer for t in unsettled)
        yield f"If the orders hold, h/{finer} would do: {_at(found.steps[0] / finer)}."
    elif unsettled:
        yield ("Which step would do, these three cannot tell: certify from h/4 on, "
               f"{_at(found.steps[2])}.")


def _against_growth(found: Certificate, grown: list[Trust]) -> Iterator[str]:
    blows = [t for t in grown if t.unit == "N" and t.statistic in ("max", "min", "std")]
    if len(blows) == len(grown) and not found.objections:
        yield ("The peak of a blow has no limit, for its momentum is taken within one step: if "
               f"that of {blows[0].quantity} is one, expect its mean over a window instead.")
    else:
        yield (f"What changes the more, the finer the step, is decided by {CAUSES}. Certify over "
               f"a shorter time, or from h/4 on, {_at(found.steps[2])}: if it grows there, too, no "
               "step will do.")


def _at(step: float) -> str:
    return f"--set run.step={step:.6g}"
