"""What ``sandbox rest`` writes: numbers as JSON and CSV, the mechanism at rest, branches."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sandbox.equilibria.branches import Branch
    from sandbox.equilibria.rest import AtRest, RestFound
    from sandbox.recording.recording import Recording
    from sandbox.scene.mechanism import Mechanism

STIFFNESS = ("x", "y", "turn", "least")


def rest_data(found: RestFound, body: str, stiff: list[list[float] | None]) -> dict[str, Any]:
    """What was found, as JSON data in SI."""
    return {
        "rests": [{**_of(each), "stiffness": None if values is None else {
            "body": body, **{key: _finite(value) for key, value in zip(
                STIFFNESS, values, strict=True)}}}
            for each, values in zip(found.rests, stiff, strict=True)],
        "failed": [{"from": words.removeprefix(" from "), "reason": why}
                   for words, why in found.failed],
        "remarks": list(found.remarks)}


def _of(rest: AtRest) -> dict[str, Any]:
    from sandbox.equilibria.told import quantities

    return {"from": rest.start, "stability": rest.stability, "untold": rest.untold,
            "modes": [float(value) for value in rest.modes], "loose": list(rest.loose),
            "sticking": list(rest.sticking), "left": rest.left, "steps": rest.steps,
            "quantities": {name: {"value": _finite(rest[name]), "unit": unit}
                           for name, unit in quantities(rest.recording).items()}}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def rest_files(
    found: RestFound, data: dict[str, Any], folder: Path, mechanism: Mechanism,
) -> list[Path]:
    """Write ``rest.json``, ``rest.csv`` and a picture of each equilibrium; their paths.

    Raises:
        OutputError: they cannot be written.
    """
    from sandbox.draw.film.video import save_picture
    from sandbox.equilibria.told import quantities

    units: dict[str, str] = {}
    for each in found.rests:
        units |= quantities(each.recording)
    head = ["quantity", "unit", *(f"rest_{i}" for i in range(1, len(found.rests) + 1))]
    rows = [[name, unit, *(f"{each[name]:.12g}" for each in found.rests)]
            for name, unit in units.items()]
    paths = _numbers(folder, data, head, rows)
    for i, each in enumerate(found.rests, 1):
        paths.append(folder / (f"rest_{i}.png" if len(found.rests) > 1 else "rest.png"))
        save_picture(_titled(each, i if len(found.rests) > 1 else 0), paths[-1])
    return paths


def _titled(rest: AtRest, number: int) -> Recording:
    """A recording whose title says which rest of several it is, or that a single one won't stay."""
    from sandbox.recording.recording import Recording

    mechanism = rest.recording.mechanism
    told = rest.stability if rest.stability != "not told" else ""
    if not number and told != "unstable":
        return rest.recording
    words = ", ".join(filter(None, (f"rest {number}" if number else "", told))).capitalize()
    title = f"{words}: {mechanism.title or mechanism.name}"
    return Recording(mechanism.model_copy(update={"title": title}), rest.recording.arrays,
                     rest.recording.info)


def branch_files(
    branches: list[Branch], folder: Path, mechanism: Mechanism, along: str, quantity: str | None,
) -> tuple[dict[str, Any], list[Path]]:
    """Write branches; their data in SI, and the paths.

    Raises:
        OutputError: they cannot be written.
    """
    import numpy as np

    from sandbox.draw.figure.branches import BranchCurve, save_branches
    from sandbox.equilibria.told import quantities

    stops = [stop for branch in branches for stop in branch.stops]
    quantity = quantity or _moving_most(stops[0].rest, [stop.rest for stop in stops])
    first = stops[0].rest.recording
    units: dict[str, str] = {quantity: first.unit(quantity)}
    for stop in stops:
        units |= quantities(stop.rest.recording)
    data: dict[str, Any] = {
        "along": along, "quantity": quantity, "unit": units[quantity],
        "branches": [{"ends": branch.ends, "points": [
            {"value": stop.value, "fold": stop.fold, **_of(stop.rest)} for stop in branch.stops]}
            for branch in branches]}
    head = ["branch", along, "stability", "fold", *(f"{name}_{unit}" if unit else name
                                                    for name, unit in units.items())]
    rows = [[str(i), f"{stop.value:.12g}", stop.rest.stability, str(int(stop.fold)),
             *(f"{stop.rest[name]:.12g}" for name in units)]
            for i, branch in enumerate(branches, 1) for stop in branch.stops]
    paths = [*_numbers(folder, data, head, rows), folder / "rest.png"]
    save_branches(paths[-1], [BranchCurve(
        np.array([stop.value for stop in branch.stops]),
        np.array([stop.rest[quantity] for stop in branch.stops]),
        np.array([stop.rest.stability == "stable" for stop in branch.stops]),
        np.array([stop.fold for stop in branch.stops])) for branch in branches],
        title=f"Rest along {along.partition(' ')[0]}: {mechanism.title or mechanism.name}",
        along=along, quantity=quantity, unit=units[quantity])
    return data, paths


def _moving_most(first: AtRest, rests: list[AtRest]) -> str:
    """The angle or place that changes most, turns by the size of the mechanism."""
    from sandbox.equilibria.told import places

    def change(name: str) -> float:
        values = [rest[name] for rest in rests]
        scale = first.size if first.recording.unit(name) == "rad" else 1.0
        return scale * (max(values) - min(values))

    return max(places(first.recording), key=change)


def _numbers(
    folder: Path, data: dict[str, Any], head: list[str], rows: list[list[str]],
) -> list[Path]:
    from sandbox.atomic_files import write_atomic

    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    writer.writerows(rows)
    paths = [folder / "rest.json", folder / "rest.csv"]
    write_atomic(paths[0], json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n")
    write_atomic(paths[1], text.getvalue())
    return paths
