"""What runs that stand beside each other are called, so that a reader can tell them apart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

MOST = 3
"""Parameters that are named of a run."""


def told_apart(
    titles: Sequence[str], parameters: Sequence[Mapping[str, float]], sources: Sequence[str],
) -> list[str]:
    """A name of each run: its title; of equal ones the parameters that differ, else its place.

    Args:
        titles: of the scenes.
        parameters: of the scenes as they were run, in SI; empty where they are not known.
        sources: where the runs lie.
    """
    if _differ(titles):
        return list(titles)
    names = dict.fromkeys(name for each in parameters for name in each)
    varied = [name for name in names
              if all(name in each for each in parameters)
              and len({each[name] for each in parameters}) > 1]
    told = [_told(each, varied) for each in parameters]
    if not _differ(told):
        told = list(sources)
    if len(set(titles)) == 1:
        return [text or title for text, title in zip(told, titles, strict=True)]
    return [f"{title}: {text}" if text else title
            for title, text in zip(titles, told, strict=True)]


def _told(parameters: Mapping[str, float], varied: Sequence[str]) -> str:
    return ", ".join(f"{name} = {parameters[name]:.4g}" for name in varied[:MOST]) + (
        ", \u2026" if len(varied) > MOST else "")


def _differ(names: Sequence[str]) -> bool:
    return all(names) and len(set(names)) == len(names)
