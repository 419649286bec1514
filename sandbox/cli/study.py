"""``sandbox study``: computations over many runs, each with pictures, tables and a conclusion."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.console import Console, Progress, compilation_notices, resume_notice, table
from sandbox.cli.failures import Exit
from sandbox.cli.options import OUT, crew_options
from sandbox.cli.robustness import robustness
from sandbox.cli.runs import prepare
from sandbox.wording import meant

if TYPE_CHECKING:
    from sandbox.findings.registry import Study

ALL = "all"
RENDERS = Path("renders") / "studies"
MOST = 200
"""Letters of what a command is about."""


class _Studies(click.Group):
    """Studies of any scene, each a command with words of its own; other names are shipped ones."""

    def make_context(
        self, info_name: str | None, args: list[str], parent: click.Context | None = None,
        **extra: Any,
    ) -> click.Context:
        """The context of a command, or of the one that runs shipped studies."""
        if args and args[0] in self.commands:
            return super().make_context(info_name, args, parent, **extra)
        if len(args) > 1 and not extra.get("resilient_parsing") and not any(
                word.startswith("-") for word in args[:2]):
            from sandbox.findings.registry import STUDIES

            _chosen(STUDIES, args[0])  # the name is wrong, not what stands behind it
        return shipped.make_context(info_name, args, parent, **extra)


@click.group(cls=_Studies, commands={"robustness": robustness})
def study() -> None:
    """Run a shipped study, or one of a scene."""


@click.command(epilog="'sandbox study robustness SCENE' maps over which values of a scene "
                      "something holds; 'sandbox study robustness --help' has its words.")
@click.argument("name", required=False)
@click.option("--out", type=OUT, metavar="DIR",
              help="Where the files go, with 'all' a directory for each study in it; "
                   "renders/studies/NAME by default.")
@crew_options
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
def shipped(
    name: str | None, out: Path | None, workers: int, cluster: str, as_json: bool, quiet: bool,
) -> int:
    """Run a study by NAME, or all of them; without a name, list them.

    Studies of many runs are spread over processes or a cluster, and go on where
    they were stopped.
    """
    from sandbox.findings.registry import STUDIES

    console = Console(as_json=as_json, quiet=quiet)
    if name is None:
        return list_studies(STUDIES, console)
    return run_studies(STUDIES, name, out, console, workers=workers, cluster=cluster)


def list_studies(studies: Mapping[str, Study], console: Console) -> int:
    """Print the names of the studies and what they are about; the exit code."""
    if console.as_json:
        console.result_json({"studies": [{"name": s.name, "about": s.about}
                                         for s in studies.values()]})
    else:
        rows = [[s.name, s.about] for s in studies.values()]
        rows += [[f"{each} SCENE", command.get_short_help_str(MOST)]
                 for each, command in study.commands.items()]
        console.result(*table(["study", ""], rows))
    return Exit.DONE


def run_studies(
    studies: Mapping[str, Study], name: str, out: Path | None, console: Console, **crew: Any,
) -> int:
    """Run one study, or with ``all`` each of them; the exit code.

    Args:
        studies: those there are, by name.
        name: of one of them, or ``all``.
        out: where the files go; for ``all`` the directory of the directories.
        console: prints.
        crew: ``workers`` and ``cluster``, for studies of many runs.

    Raises:
        BadParameter: an unknown name, with a near miss.
        OutputError: the directory cannot be written.
    """
    chosen = _chosen(studies, name)
    folders = {s.name: _folder(s, out, single=name != ALL) for s in chosen}
    for folder in folders.values():
        prepare(folder)
    reports = []
    for s in chosen:
        folder, before = folders[s.name], _seen(folders[s.name])
        began = time.perf_counter()
        going_on = resume_notice(folder, console) if s.many else contextlib.nullcontext()
        with (going_on, compilation_notices(console),
              Progress(s.name, shown=console.shows_progress) as progress):
            text = s.load()(folder, progress=progress, **(crew if s.many else {}))
        seconds = time.perf_counter() - began
        files = sorted(str(path.relative_to(folder)) for path, mark in _seen(folder).items()
                       if before.get(path) != mark)
        reports.append({"name": s.name, "directory": str(folder), "files": files, "text": text,
                        "wall_s": seconds})
        if not console.as_json:
            console.say(s.name, *text.strip().splitlines(),
                        f"{folder}: {', '.join(files)}  ({seconds:.1f} s)", "")
    if console.as_json:
        console.result_json({"status": "done", "exit_code": int(Exit.DONE), "studies": reports})
    return Exit.DONE


def _chosen(studies: Mapping[str, Study], name: str) -> list[Study]:
    if name == ALL:
        return list(studies.values())
    if name not in studies:
        known = [*studies, ALL, *study.commands]
        raise click.BadParameter(f"no study is named {name!r}.{meant(name, known)} Studies: "
                                 f"{', '.join(known)}.", param_hint="NAME")
    return [studies[name]]


def _folder(s: Study, out: Path | None, *, single: bool) -> Path:
    if out is None:
        return RENDERS / s.name
    return out if single else out / s.name


def _seen(folder: Path) -> dict[Path, tuple[int, int]]:
    """The files in a directory, with what changes when they are written again; not those of rows.

    They are there to go on from, and tables say what is in them.
    """
    from sandbox.sweeps.log import FOLDER

    return {path: ((stat := path.stat()).st_mtime_ns, stat.st_size)
            for path in folder.rglob("*") if path.is_file() and path.parent.name != FOLDER}
