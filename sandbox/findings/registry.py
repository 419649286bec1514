"""The studies that ``sandbox study`` knows: what each is about, and where it lives.

A study is a function ``run(directory, *, progress=None) -> str``: it computes,
writes its pictures and tables into ``directory`` and returns a few lines that
say what came out. It is imported when it is asked for. One of many runs is
spread over processes or a cluster, too, and goes on where it was stopped.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol


class StudyFunction(Protocol):
    """What a study's module offers as ``run``."""

    def __call__(
        self, directory: Path, *, progress: Callable[[float], None] | None = None, **crew: Any,
    ) -> str:
        """Write pictures and tables into ``directory``; a few lines on what came out.

        ``crew`` is for studies of many runs only: ``workers`` and ``cluster``, as of a sweep.
        """


@dataclass(frozen=True)
class Study:
    """A study by name."""

    name: str
    about: str
    module: str
    many: bool = False
    """Whether it is made of many runs, which are spread over ``workers`` or a ``cluster``."""

    def load(self) -> StudyFunction:
        """The function that runs it."""
        function: StudyFunction = import_module(self.module).run
        return function


STUDIES = {study.name: study for study in (
    Study("least-pull", "The least pull at which stiffness control holds a pose: closed form "
          "against bisection over simulations.", "sandbox.paper.least_pull"),
    Study("ideal-pull", "The pull at which stiffness control settles soonest: a quadrature of the "
          "slow motion against simulations.", "sandbox.paper.ideal_pull"),
    Study("redundancy", "The pairs of pull and stiffness that hold one pose.",
          "sandbox.paper.redundancy"),
    Study("controllers", "The paper's controllers against better ones: settling, overshoot, "
          "effort, and what is left of it when the finger is not the one they were made for.",
          "sandbox.paper.better_controllers"),
    Study("hand-stiffness", "Figure 22: the same hand and pull with equal and with varied springs.",
          "sandbox.paper.hand_stiffness"),
    Study("proposals", "Controlled stiffness, an antagonist tendon, joint locks: which poses "
          "each reaches at one pull.", "sandbox.paper.proposals"),
    Study("soft-vs-adaptive", "Figure 2d: elastic tendons from one bar against a differential, on "
          "the same fingers and objects: spread of force over the fingers.",
          "sandbox.paper.soft_and_adaptive"),
    Study("gripping-force", "Whether the gripping force depends on the object: 1536 random "
          "sections in the hand of Figure 6, against a closed form.",
          "sandbox.findings.gripping_force", many=True),
    Study("differential", "The same fingers tied rigidly to one bar, by springs, and by rockers, "
          "on 128 random objects: spread of force, sections lost.",
          "sandbox.findings.differential", many=True),
    Study("survival", "Which grasp survives: maps over pose and friction of the adaptive grasp and "
          "of a hand with a free object, and ejection against its closed form.",
          "sandbox.findings.survival", many=True),
    Study("guides", "Where to put the guides: phalanges that press alike over a range of discs, "
          "and what that costs elsewhere.", "sandbox.findings.guides", many=True),
    Study("sheaths", "How much of the pull reaches the tip through sheaths that rub, and what "
          "that does to adaptation.", "sandbox.findings.sheaths", many=True),
    Study("identification", "A finger's springs and damping back from a noisy measurement, with "
          "intervals that hold the truth as often as they say.",
          "sandbox.findings.identification", many=True),
)}
