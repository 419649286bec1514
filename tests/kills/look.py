"""What is in a directory after a kill: a run that was there, the new one, or a marked one."""

from __future__ import annotations

import json
from pathlib import Path

from sandbox.errors import OutputError
from sandbox.recording.recording import Recording

Whole = dict[str, dict[str, bytes]]
"""For each run by its name what its files hold."""


def contents(folder: Path) -> dict[str, bytes]:
    """Visible files below a folder by their relative names, wall times left out."""
    found = {str(path.relative_to(folder)): path.read_bytes()
             for path in sorted(folder.rglob("*")) if path.is_file()
             and not any(part.startswith(".") for part in path.relative_to(folder).parts)}
    if "run.json" in found:
        said = json.loads(found["run.json"])
        del said["wall_s"]
        found["run.json"] = json.dumps(said).encode()
    return found


def run_fault(folder: Path, whole: Whole) -> tuple[str, str]:
    """What a directory holds in a word, and what is wrong with that; empty if nothing is."""
    found = contents(folder)
    if "run.json" in found:
        found.pop("run.incomplete.json", None)
        for name, files in whole.items():
            if found == files:
                return name, "" if Recording.load(folder).complete else f"{name}, not complete"
        return "mixed", f"run.json beside {sorted(found)} of no one run"
    if not found:
        return "empty", ""
    if "run.incomplete.json" not in found:
        return "unmarked", f"{sorted(found)} without a mark"
    if json.loads(found["run.incomplete.json"])["complete"] is not False:
        return "unmarked", "its mark says complete"
    try:
        loaded = Recording.load(folder)
    except OutputError:
        return "marked", ""
    return "marked", "loaded as complete" if loaded.complete else ""


def files_fault(folder: Path, whole: dict[str, bytes]) -> tuple[str, str]:
    """The same of files that are written one by one: each is whole, or not there."""
    found = contents(folder)
    wrong = sorted(name for name, data in found.items() if whole.get(name) != data)
    return f"{len(found)} of {len(whole)} files", f"{wrong} are not whole" if wrong else ""
