"""``python -m tests.mutation``: a seeded sample of mutants, and which of them nothing notices."""

from __future__ import annotations

import argparse
import json
import queue
import sys
import tempfile
import tomllib
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from tests.mutation.places import Mutation, places, sample
from tests.mutation.trees import PACKAGE, Baseline, Outcome, Tree

ROOMS = ("engine", "scene", "kinds", "model", "samples", "recording", "audit", "control",
         "mechanics")
EQUIVALENT = Path(__file__).with_name("equivalent.toml")
WANTED = 0.93
"""Share of the mutants that are not equivalent which has to be noticed."""


def main() -> int:
    """Draw, run, report; 0 if enough were noticed, 1 if not."""
    options = _options()
    mutants = sample(PACKAGE, options.rooms, options.seed, options.count)
    if options.list:
        for mutation in mutants:
            print(_told(mutation))
        return 0
    reasons = _equivalent()

    def keep(outcomes: list[Outcome]) -> None:
        if options.json:
            options.json.write_text(json.dumps(
                [_data(outcome, reasons) for outcome in outcomes], indent=1, ensure_ascii=False))
    outcomes = _run(mutants, options.jobs, keep, whole=options.whole)
    print(report(outcomes, reasons))
    for entry in stale(reasons):
        print(f"no longer there: {' | '.join(entry)}")
    return 0 if share(outcomes, reasons) >= WANTED else 1


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.mutation", description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="which sample (1)")
    parser.add_argument("--count", type=int, default=300, help="how many; 0 for all places (300)")
    parser.add_argument("--rooms", nargs="+", default=list(ROOMS), metavar="ROOM",
                        help="folders or files of the package, such as audit or scene/geometry.py")
    parser.add_argument("--jobs", type=int, default=2, help="how many at a time (2)")
    parser.add_argument("--whole", action="store_true",
                        help="ask all tests about a survivor, not only those near its room")
    parser.add_argument("--json", type=Path, help="write every mutant and what became of it")
    parser.add_argument("--list", action="store_true", help="show the sample and run nothing")
    return parser.parse_args()


def _run(
    mutants: list[Mutation], jobs: int, keep: Callable[[list[Outcome]], None], *, whole: bool,
) -> list[Outcome]:
    """All outcomes, in the order of the mutants; says and keeps each as it is known."""
    found: dict[Mutation, Outcome] = {}
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder, ThreadPoolExecutor(jobs) as pool:
        trees: queue.SimpleQueue[Tree] = queue.SimpleQueue()
        baseline = Baseline()
        for tree in pool.map(lambda job: Tree(Path(folder, str(job)), baseline, whole=whole),
                             range(jobs)):
            trees.put(tree)

        def judged(mutation: Mutation) -> Outcome:
            tree = trees.get()
            try:
                return tree.judge(mutation)
            finally:
                trees.put(tree)

        for done in as_completed([pool.submit(judged, mutation) for mutation in mutants]):
            outcome = done.result()
            found[outcome.mutation] = outcome
            keep([found[mutation] for mutation in mutants if mutation in found])
            print(f"{len(found):4d}/{len(mutants)} {outcome.state:8} {outcome.seconds:5.0f} s  "
                  f"{outcome.mutation.file}:{outcome.mutation.line}  {outcome.by}",
                  file=sys.stderr, flush=True)
    return [found[mutation] for mutation in mutants]


def _shown(mutation: Mutation) -> tuple[str, str]:
    return mutation.shown((PACKAGE / mutation.file).read_text())


def _told(mutation: Mutation) -> str:
    before, after = _shown(mutation)
    return f"{mutation.file}:{mutation.line}\n  - {before}\n  + {after}"


def _equivalent() -> dict[tuple[str, str, str], str]:
    """Reasons of the known survivors, by file, line before and line after."""
    known = tomllib.loads(EQUIVALENT.read_text()).get("mutant", [])
    return {(each["file"], each["before"], each["after"]): each["reason"] for each in known}


def stale(reasons: dict[tuple[str, str, str], str]) -> list[tuple[str, str, str]]:
    """Entries whose line was changed or is gone, so that they excuse nothing any more."""
    files = {file for file, _, _ in reasons if (PACKAGE / file).exists()}
    can_be = {(file, *mutation.shown((PACKAGE / file).read_text()))
              for file in files for place in places(PACKAGE, [file]) for mutation in place}
    return [entry for entry in reasons if entry not in can_be]


def _reason(outcome: Outcome, reasons: dict[tuple[str, str, str], str]) -> str:
    return reasons.get((outcome.mutation.file, *_shown(outcome.mutation)), "")


def share(outcomes: list[Outcome], reasons: dict[tuple[str, str, str], str]) -> float:
    """Share of the mutants that were noticed, of all that are not known to be equivalent."""
    counted = [o for o in outcomes if o.state != "survived" or not _reason(o, reasons)]
    noticed = sum(outcome.state != "survived" for outcome in counted)
    return noticed / len(counted) if counted else 1.0


def report(outcomes: list[Outcome], reasons: dict[tuple[str, str, str], str]) -> str:
    """The table of rooms, and every survivor that has no reason."""
    lines = [f"{'room':10} {'mutants':>8} {'killed':>8} {'timeouts':>8} {'equivalent':>10} "
             f"{'survived':>8} {'noticed':>8}"]
    rooms = sorted({outcome.mutation.file.split("/")[0] for outcome in outcomes})
    left = [o for o in outcomes if o.state == "survived" and not _reason(o, reasons)]
    for room in [*rooms, "all"]:
        own = [o for o in outcomes if room in ("all", o.mutation.file.split("/")[0])]
        states = [o.state for o in own]
        open_ = sum(o in left for o in own)
        lines.append(
            f"{room:10} {len(own):8d} {states.count('killed'):8d} {states.count('timeout'):8d} "
            f"{states.count('survived') - open_:10d} {open_:8d} "
            f"{100 * share(own, reasons):6.1f} %")
    return "\n".join(["", *lines, "", *(_told(outcome.mutation) for outcome in left)])


def _data(outcome: Outcome, reasons: dict[tuple[str, str, str], str]) -> dict[str, object]:
    before, after = _shown(outcome.mutation)
    return {"file": outcome.mutation.file, "line": outcome.mutation.line, "before": before,
            "after": after, "state": outcome.state, "by": outcome.by,
            "reason": _reason(outcome, reasons), "seconds": round(outcome.seconds, 1)}


if __name__ == "__main__":
    sys.exit(main())
