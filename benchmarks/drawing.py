"""Frames per second of drawing, of encoding, and of both side by side at 800 x 600."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from benchmarks.measure import Figure, interleaved, mechanism, seconds
from sandbox.engine.simulate import simulate
from sandbox.picture.film import GifWriter, frame_times, shared_palette, side_by_side
from sandbox.picture.frame import Picture
from sandbox.picture.frames import Frames

SIZE = (800, 600)
Frame = NDArray[np.uint32]


def figures(*, quick: bool = False) -> list[Figure]:
    """Rates of the two halves, and the time of both together over that of the longer one."""
    run = simulate(mechanism("adaptive_grasp", {"run.duration": 0.2 if quick else 2.0}))
    renderer = Frames(Picture(run, size=SIZE))
    times = frame_times(run, fps=50, speed=0.5)
    frames = [renderer.draw_packed(t).copy() for t in times]
    palette = shared_palette(frames[::50])

    def encoder() -> Callable[[Frame], None]:
        writer = GifWriter(io.BytesIO(), SIZE, palette)
        return lambda frame: writer.add(frame, 2)

    def draw() -> Iterable[Frame]:
        return (renderer.draw_packed(t) for t in times)

    def encode(some: Iterable[Frame]) -> None:
        add = encoder()
        for frame in some:
            add(frame)

    drawn, encoded, together = interleaved([
        lambda: seconds(lambda: [None for _ in draw()]),
        lambda: seconds(lambda: encode(frames)),
        lambda: seconds(lambda: side_by_side(draw(), encoder())),
    ], 1 if quick else 5)
    count = len(times)
    return [
        Figure("drawing", count / drawn, "frames/s", least=300),
        Figure("GIF encoding", count / encoded, "frames/s", least=200),
        Figure("both / (one after the other)", together / (drawn + encoded), "", most=0.85),
        Figure("  both side by side", count / together, "frames/s"),
    ]
