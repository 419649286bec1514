"""A search as it stands in a study file: its words looked over, and run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sandbox.errors import Problem, SceneError
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.paths import path_text
from sandbox.scene.read.source import read_source
from sandbox.search.asking import Where
from sandbox.search.criteria import RefusedError, conditions, known_name
from sandbox.search.fitting import Fitted, find_fit
from sandbox.search.influences import Sensitivity, find_sensitivity
from sandbox.search.optimum import Chosen, find_best, goals_of
from sandbox.search.question import Question, Scene, asked_in
from sandbox.search.regions import find_robustness
from sandbox.search.regions_found import RobustnessFound
from sandbox.search.thresholds import ThresholdFound, find_threshold
from sandbox.sweeps.plan import study_file
from sandbox.sweeps.searching import KEY, SEARCHES

Found = ThresholdFound | Fitted | Chosen | Sensitivity | RobustnessFound


@dataclass(frozen=True)
class WrittenSearch:
    """A search of a study file."""

    question: Question
    kind: str
    """Which of those that a file may say; empty of a study that says none."""
    words: Mapping[str, Any]
    """What the file says itself, by the names of options."""

    def run(self, place: Where | None = None, *, kind: str = "", **words: Any) -> Found:
        """Run it.

        Args:
            place: where it runs and what it leaves behind.
            kind: which search it is, of a study that says none.
            words: what the file does not say.

        Raises:
            SceneError: words of the file that do not fit its ranges.
            SandboxError: what the search itself raises.
        """
        try:
            return FINDERS[self.kind or kind](self.question, place=place, **words, **self.words)
        except RefusedError as error:
            if not self.kind:
                raise
            raise self._wrong([(line, ()) for line in str(error).splitlines()]) from None

    def looked_over(self) -> None:
        """See that what it names is kept, and that its file of data is there.

        Raises:
            SceneError: every problem.
        """
        wrong: list[tuple[str, tuple[str | int, ...]]] = []
        kept = self.question.kept
        for name in ("where", "holds", "least", "most"):
            listed_ = isinstance(self._written.get(name), list)
            for place, text in enumerate(self.words.get(name, ())):
                try:
                    known_name(text, kept) if name in ("least", "most") else \
                        conditions([text], kept)
                except RefusedError as error:
                    wrong.append((str(error), (name, place) if listed_ else (name,)))
        data = self.words.get("data")
        if data is not None and not data.is_file():
            wrong.append((f"there is no file {data}", ("data",)))
        if wrong:
            raise self._wrong(wrong)

    @property
    def _written(self) -> Mapping[str, Any]:
        found: Mapping[str, Any] = self.question.source.data[KEY][self.kind] if self.kind else {}
        return found

    def _wrong(self, told: list[tuple[str, tuple[str | int, ...]]]) -> SceneError:
        source = self.question.source
        paths = [(KEY, self.kind, *path) for _, path in told]
        return SceneError([Problem("bad-search", message, path_text(path), *source.where(path))
                           for (message, _), path in zip(told, paths, strict=True)], source.name)


def read_search(study: Scene, limits: Limits | None = None) -> WrittenSearch:
    """The search of a study: a file, a shipped one's name, or a mapping of what a file holds.

    Raises:
        SceneError: every problem.
    """
    question = asked_in(study, limits)
    spec = question.plan.spec.search
    if spec is None:
        return WrittenSearch(question, "", {})
    words = spec.words
    if spec.kind != "fit" and "seed" in question.source.data:
        words.setdefault("seed", question.plan.spec.seed)
    if "data" in words:
        words["data"] = question.folder / words["data"]
    found = WrittenSearch(question, spec.kind, words)
    found.looked_over()
    return found


def kind_in(study: str) -> str:
    """Which search a study says that it is; empty of one that says none, and of a scene.

    Raises:
        SceneError: a file that cannot be read, or a search that there is none of.
    """
    file = study_file(study)
    data = read_source(file or Path(study)).data
    if file is None or KEY not in data:
        return ""
    kinds = [name for name in SEARCHES if isinstance(data[KEY], dict) and name in data[KEY]]
    return kinds[0] if kinds else read_search(study).kind


def only_of(search: WrittenSearch, kind: str) -> None:
    """See that a search that is run as one kind is not another.

    Raises:
        SceneError: the file says that it is.
    """
    if search.kind not in ("", kind):
        source = search.question.source
        raise SceneError([Problem(
            "bad-search", f"the study is a search of the kind {search.kind}, not {kind}",
            path_text((KEY, search.kind)), *source.where((KEY, search.kind), key=True))],
            source.name)


def _best(question: Question, *, least: Any = (), most: Any = (), sampler: Any = None,
          **words: Any) -> Chosen:
    return find_best(question, goals_of(least, most), sampler=sampler or "", **words)


def _robustness(question: Question, *, holds: Any = (), **words: Any) -> RobustnessFound:
    return find_robustness(question, holds, **words)


FINDERS: Mapping[str, Callable[..., Found]] = {
    "threshold": find_threshold, "fit": find_fit, "best": _best, "sensitivity": find_sensitivity,
    "robustness": _robustness}
"""What does each search, by its name and with the names of its options."""
