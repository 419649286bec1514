"""``python -m tests.golden check [NAMES]`` compares, ``accept [NAMES]`` keeps what is now."""

from __future__ import annotations

import sys
import time
from argparse import ArgumentParser

from sandbox.errors import SandboxError
from tests.support.entry_points import all_entry_points

from . import digest
from .scenes import SCENES, recording_of

SHOWN = 12
"""Lines of one scene that are printed."""


def main() -> int:
    """Exit code 1 if something moved and is not accepted."""
    parser = ArgumentParser(prog="python -m tests.golden", description=__doc__)
    parser.add_argument("what", choices=("check", "accept"))
    parser.add_argument("names", nargs="*", metavar="NAME", help="all scenes by default")
    asked = parser.parse_args()
    if unknown := set(asked.names) - set(SCENES):
        parser.error(f"no such scenes: {', '.join(sorted(unknown))}")
    names, kept, began = asked.names or list(SCENES), digest.read_values(), time.process_time()
    known = kept["platform"] == digest.this_platform()
    if not known and kept["platform"]:
        print(f"values of another platform: numbers within a tolerance\n  {kept['platform']}\n"
              f"  {digest.this_platform()}")
    moved = 0
    for name in names:
        try:
            mechanism = SCENES[name].mechanism()
            # the tests run each scene with what it needs, and compare: nothing can be left out
            with all_entry_points():
                run = recording_of(mechanism)
        except SandboxError as error:
            moved += 1
            print(f"{name}: {error}", flush=True)
            continue
        new = digest.digest(run)
        found = ["new scene"] if name not in kept else digest.differences(
            kept[name], new, digest.names_by_kind(run), tolerance=digest.tolerance_of(kept, name))
        if found:
            moved += 1
            print(f"{name}: {len(found)} differences", *found[:SHOWN], sep="\n    ", flush=True)
        if asked.what == "accept" and (found or not known):
            kept[name] = {**new, "spread": digest.spread(mechanism, new)}
            if asked.names and not known:
                kept[name]["platform"] = digest.this_platform()
    gone = [name for name in kept if name not in SCENES and name != "platform"]
    print("".join(f"{name}: no such scene any more\n" for name in gone), end="")
    print(f"{len(names)} scenes, {moved} moved, {time.process_time() - began:.1f} s of processor")
    if asked.what == "accept":
        platform = kept["platform"] if asked.names else digest.this_platform()
        digest.write_values({"platform": platform,
                             **{name: kept[name] for name in SCENES if name in kept}})
        return 0
    return int(bool(moved or gone))


if __name__ == "__main__":
    sys.exit(main())
