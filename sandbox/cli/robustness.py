"""``sandbox search robustness``: what holds over two values of a scene, as a map."""

from __future__ import annotations

import re
from typing import Any

import click

from sandbox.cli.scenes import complete_scene
from sandbox.cli.searched import KEEP, placed, searched
from sandbox.cli.sweep import read_varied

NEXT = re.compile(r",(?=\s*[A-Za-z_][\w.*\[\]]*\s*=[^=])")
"""Between two paths of one ``--over``; no list of values has an ``=`` in it."""


def read_over(
    ctx: click.Context, param: click.Parameter, words: tuple[str, ...],
) -> dict[str, str]:
    """``path=from:to`` words as a table; one may have several, with commas between them."""
    return read_varied(ctx, param, tuple(part for word in words for part in NEXT.split(word)))


@click.command()
@click.argument("scene", shell_complete=complete_scene)
@click.option("--over", "vary", multiple=True, metavar="PATH=FROM:TO", callback=read_over,
              help="A range, 'parameters.mu=0:1', with ':log' behind it in even ratios: one makes "
                   "a strip, two a map. A list besides, 'parameters.size=20 mm, 40 mm', makes a "
                   "map for each of its values.")
@KEEP
@click.option("--holds", multiple=True, metavar="CONDITION",
              help="What must hold of what is kept: 'slip < 1 mm'. Several must all hold. By "
                   "default what the scene expects.")
@click.option("--coarse", type=click.IntRange(min=1), default=8, show_default=True, metavar="N",
              help="Cells along each range at first: what is smaller than one may be missed.")
@click.option("--within", type=click.FloatRange(0, 1, min_open=True), default=1 / 64,
              show_default=True, metavar="SHARE",
              help="Of each range: how wide the smallest cells are, in which the boundary lies.")
@click.option("--runs", type=click.IntRange(min=1), default=1000, show_default=True,
              help="At most so many, besides the probes and the certificate.")
@click.option("--probes", type=click.IntRange(min=0), default=32, show_default=True,
              help="Random points that say how much the coarse grid can have missed.")
@click.option("--boundary", metavar="EXPRESSION", default="",
              help="A closed form of the names that are varied, greater than 0 where it should "
                   "hold: 'mu - tan(angle)'. Its line is drawn, and held against the runs.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True,
              help="Of the probes.")
@placed
def robustness(
    scene: str, holds: tuple[str, ...], coarse: int, within: float, runs: int, probes: int,
    boundary: str, seed: int, **words: Any,
) -> int:
    """Where in SCENE something holds, over two values of it: a map.

    A coarse grid is run first; then only cells whose corners disagree are
    divided. SCENE is a scene, or a study file that says what is varied and kept.
    Runs that are done are not done again.
    """
    return searched(scene, "robustness", {
        "holds": holds, "coarse": coarse, "within": within, "runs": runs, "probes": probes,
        "boundary": boundary, "seed": seed}, option="--over", **words)
