"""Write docs/gallery.md: every shipped scene with its picture, a sentence of its own, its command.

``python docs/make_scenes.py`` writes; with ``--check`` it only tells whether the page is as it
would write it. The topics and their order stand in scenes/topics.toml.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from sandbox.scene.library import folder_of, scene_topics, shipped_scenes, wholes

DOCS = Path(__file__).parent
PAGE = DOCS / "gallery.md"
TOPICS = scene_topics()
TOLD = {folder: f"{folder}.md" for folder in ("hands", "mechanisms")}
"""Folders of scenes that have a page, and which."""
COLUMNS = 3
ENOUGH = 45
"""Characters: a first sentence that is shorter has the next one with it."""

HEAD = """# Gallery

All scenes that come with sandbox. After this page you know what there is to start from, and how to
copy a scene and change it. Type the command below a picture: you get the film, the forces and the
verdict. [Hands](hands.md) and [mechanisms](mechanisms.md) have pages that say what is expected of
each, and why.

```console
$ sandbox new slider_crank
wrote slider_crank.json
$ sandbox run slider_crank.json --no-render --set "parameters.r=35 mm"
7 of 7 expectations passed
```

<!-- This page is written by docs/make_scenes.py from scenes/topics.toml and the scenes. -->
"""


def ungrouped() -> list[str]:
    """Shipped scenes without a topic."""
    grouped = {name for topic in TOPICS for name in topic.scenes}
    return [name for name in shipped_scenes() if name not in grouped]


def sentence(about: str) -> str:
    """The first sentence of what a scene says of itself, and more while it is short."""
    ends = (match.end() for match in re.finditer(r"[.!?](?= [A-Z])", about))
    return about[:next((end for end in ends if end >= ENOUGH), len(about))]


def page() -> str:
    """The whole page."""
    lines = [HEAD]
    for topic in TOPICS:
        lines += [f"## {topic.title}", "", topic.about, "", *grid(topic.scenes), ""]
    return "\n".join(lines)


def grid(names: Sequence[str]) -> Iterator[str]:
    """A table of cells, whose last row is filled up with empty ones."""
    yield "| " * COLUMNS + "|"
    yield "|---" * COLUMNS + "|"
    for first in range(0, len(names), COLUMNS):
        cells = [cell(name) for name in names[first:first + COLUMNS]]
        yield "| " + " | ".join(cells + [""] * (COLUMNS - len(cells))) + " |"


def cell(name: str) -> str:
    """Picture, title, sentence and command of a scene, one below the other."""
    path = shipped_scenes()[name]
    scene = json.loads(path.read_text(encoding="utf-8"))
    title = _plain(scene["title"])
    folder = folder_of(path)
    shown = f"[{title}]({TOLD[folder]}#{_anchor(scene['title'])})" \
        if folder in TOLD and name in wholes(folder) else title
    return "<br>".join((f"![{title}](../renders/gallery/scenes/{name}.png)", f"**{shown}**",
                        _plain(sentence(scene["about"])), f"`sandbox run {name}`"))


def _plain(text: str) -> str:
    """Text in a table, where a stroke would begin another cell and stars would be marks."""
    return re.sub(r"([|*_])", r"\\\1", text)


def _anchor(title: str) -> str:
    """Where a heading is on its page, as GitHub has it."""
    return re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")


def main(words: list[str] | None = None) -> int:
    """Write or check the page; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 if outdated")
    check = parser.parse_args(words).check
    if missing := ungrouped():
        sys.stderr.write(f"no topic of scenes/topics.toml has {', '.join(missing)}\n")
        return 1
    text = page()
    if PAGE.is_file() and PAGE.read_text(encoding="utf-8") == text:
        return 0
    if not check:
        PAGE.write_text(text, encoding="utf-8")
    sys.stdout.write(f"{PAGE.name}: {'is outdated' if check else 'written'}\n")
    return 1 if check else 0


if __name__ == "__main__":
    sys.exit(main())
