"""Films and stills: GIF, MP4, PNG, or a directory of PNG frames."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sandbox.atomic_files import atomic_file, output_path, remove_stale
from sandbox.errors import OutputError
from sandbox.picture.frame import Picture
from sandbox.picture.frames import Frames, tension_colours
from sandbox.picture.gif import GifWriter, Words, covered_words, shared_palette
from sandbox.picture.options import check_run, check_view, view_of
from sandbox.picture.paper import paint_picture, pixels
from sandbox.picture.print_size import paper_of
from sandbox.picture.run_data import MeteredRun, frame_times
from sandbox.picture.stills import ENDINGS as STILLS
from sandbox.picture.stills import Instants, save_stills
from sandbox.recording.new_run import FRAME
from sandbox.scene.elements.settings import View
from sandbox.scene.read.limits import Limits

T = TypeVar("T")
Drawn = TypeVar("Drawn")
Progress = Callable[[float], None]
Meters = str | Sequence[str | Mapping[str, Any]]
Show = str | Sequence[str] | Mapping[str, object]
FILMS = (".gif", ".mp4")
ENDINGS = (*FILMS, *STILLS)
WHAT = "a picture"
NO_PAPER = ("a film has pixels, as in 800x600; a size on paper is one of a still "
            f"({', '.join(STILLS)})")
MOST_FRAMES = Limits.frames
"""Of a film, unless more are allowed."""
HOLD = 1.5
"""How long a GIF shows its last frame [s], to let it be read."""
PALETTE_FRAMES = 5
WAITING = 8
"""Frames that may wait to be encoded; more would only cost memory."""


def render(
    run: MeteredRun, path: str | Path, *, at: Instants | None = None, strip: bool | int = False,
    size: tuple[int, int] | str | None = None, fps: int | None = None,
    speed: float | None = None, centre: tuple[float, float] | None = None,
    width: float | None = None, show: Show | None = None, bodies: Sequence[str] | None = None,
    follow: str | None = None, meters: Meters | None = None,
    transparent: bool = False, bare: bool = False, scales: bool = False,
    progress: Progress | None = None, most_frames: int = MOST_FRAMES,
) -> list[Path]:
    """Draw a run to ``path``.

    It becomes a film (.gif, .mp4), a still (.png, .svg, .pdf) of the run's end or of the moments
    ``at``, or, where the path has no ending, a directory of PNG frames. What is left out comes
    from the scene's view.

    Args:
        run: the recording.
        path: where to; its ending decides what is made. Of several moments each has a file.
        at: moments of stills: seconds, ``"0.8 s"``, ``"start"``, ``"end"``, or a list of these.
        strip: moments side by side in one picture: those of ``at``, else so many of the film's,
            5 if True.
        size: width and height of the picture or strip [pixels]; ``"2x"`` for twice its usual size;
            ``"85mm"`` or ``"85mm x 70mm"`` of a still on paper, with letters of at least 7 points.
        fps: 20, 25 or 50 frames per second.
        speed: seconds of motion per second of film.
        centre: world point in the middle of the picture [m].
        width: of the world shown [m].
        show: layers besides those of the view, ``-contacts`` without one; or each with its bodies.
        bodies: names and patterns of the bodies that the picture is fitted to.
        follow: the body that the picture goes with.
        meters: in place of those of the view, as ``view.meters`` may hold them.
        transparent: stills, frames and a GIF are see-through where nothing is drawn.
        bare: without title, time and legend.
        scales: without them, but with the scales of lengths, arrows and tensions.
        progress: called with the fraction done, 0 to 1.
        most_frames: that a film may have.

    Returns:
        The files that were written, or the directory of frames.

    Raises:
        OutputError: no path, an unknown ending, what no view can have, no or an empty recording,
            a time that the run does not reach, too many frames, or a file that cannot be written.
    """
    check_run(run)
    path = output_path(path, WHAT)
    paper = paper_of(size)
    view = view_of(run.mechanism.view, {
        "size": None if paper else size, "fps": fps, "speed": speed, "centre": centre,
        "width": width, "show": show, "bodies": bodies, "follow": follow, "meters": meters})
    check_view(run, view)
    worn: Any = {"view": view, "transparent": transparent, "bare": bare, "scales": scales}
    if is_still(path, at=at is not None, strip=strip is not False, transparent=transparent,
                size=size):
        return save_stills(run, path, at=at, strip=strip, paper=paper,
                           sized=size is not None and not isinstance(size, str), **worn)
    write = write_animation if path.suffix and not path.is_dir() else write_frames
    write(run, path, progress=progress, most_frames=most_frames, **worn)
    return [path]


def is_still(path: Path, *, at: bool, strip: bool, transparent: bool,
             size: tuple[int, int] | str | None) -> bool:
    """Whether stills are asked for, by the ending or by ``at`` and ``strip``.

    Raises:
        OutputError: an ending that no picture has, or of a film that has not what is asked for,
            such as a size on paper.
    """
    ending = "" if path.is_dir() else path.suffix.lower()
    if ending in FILMS:
        asked = {"at": at, "strip": strip, "transparent": transparent}
        for word in (word for word, is_asked in asked.items() if is_asked):
            if word == "transparent" and ending == ".gif":
                continue
            what, films = ("a see-through ground", (".gif",)) if word == "transparent" else (
                "single moments", ())
            raise OutputError(f"{path}: {word} asks for {what}, which no {ending} has; allowed: "
                              f"{', '.join((*films, *STILLS))}, or none for a directory",
                              code="bad-picture")
    elif ending and ending not in STILLS:
        raise OutputError(f"{path}: no picture can have the ending {path.suffix!r}; allowed: "
                          f"{', '.join(ENDINGS)}, or none for a directory", code="bad-picture")
    stills = ending in STILLS or at or strip
    if not stills and paper_of(size):
        raise OutputError(f"{path}: size={size!r} asks for paper: {NO_PAPER}", code="bad-picture")
    return stills


def write_animation(
    run: MeteredRun, path: str | Path, *, size: tuple[int, int] | None = None,
    fps: int | None = None, speed: float | None = None, view: View | None = None,
    progress: Progress | None = None, most_frames: int = MOST_FRAMES, transparent: bool = False,
    bare: bool = False, scales: bool = False,
) -> None:
    """Draw the run as a film, .gif or .mp4; see :func:`render`."""
    path = output_path(path, WHAT)
    ending = path.suffix.lower()
    if ending not in FILMS:
        raise OutputError(f"{path}: no film can have the ending {ending!r}; "
                          f"allowed: {', '.join(ENDINGS)}, or none for a directory of frames",
                          code="bad-picture")
    picture, times, rate = _prepare(run, size, fps, speed, view, most_frames,
                                     even=ending == ".mp4", bare=bare, scales=scales)
    with atomic_file(path) as aside:
        if transparent:
            _write_see_through_gif(picture, times, rate, aside, progress)
        else:
            write = _write_gif if ending == ".gif" else _write_mp4
            write(Frames(picture), times, rate, aside, progress)


def write_frames(
    run: MeteredRun, directory: str | Path, *, size: tuple[int, int] | None = None,
    fps: int | None = None, speed: float | None = None, view: View | None = None,
    progress: Progress | None = None, most_frames: int = MOST_FRAMES,
    transparent: bool = False, bare: bool = False, scales: bool = False,
) -> None:
    """Draw the run as ``frame_00000.png`` and so on; frames of an earlier film are removed."""
    directory = output_path(directory, WHAT)
    picture, times, _ = _prepare(run, size, fps, speed, view, most_frames, bare=bare,
                                  scales=scales)

    def save(item: tuple[int, NDArray[np.uint8]]) -> None:
        with atomic_file(directory / f"frame_{item[0]:05d}.png", durable=False) as aside:
            Image.fromarray(item[1]).save(aside, format="PNG", compress_level=3)

    frames = None if transparent else Frames(picture)

    def draw(t: float) -> NDArray[np.uint8]:
        return see_through(picture, t) if frames is None else _rgb(frames.draw_packed(t))

    remove_stale(directory)
    side_by_side(enumerate(_drawn(draw, times, progress)), save)
    kept = {f"frame_{k:05d}.png" for k in range(len(times))}
    for old in directory.glob(FRAME):
        if old.name not in kept:
            old.unlink()


def _prepare(
    run: MeteredRun, size: tuple[int, int] | None, fps: int | None, speed: float | None,
    view: View | None, most_frames: int, *, even: bool = False, bare: bool = False,
    scales: bool = False,
) -> tuple[Picture, list[float], int]:
    """The picture, the times of its frames and frames per second."""
    check_run(run)
    view = view_of(view or run.mechanism.view, {"size": size, "fps": fps, "speed": speed})
    rate, pace, (width, height) = view.fps, view.speed, view.size
    frames = (float(run.time[-1]) - view.start) / pace * rate
    if not frames <= most_frames:
        raise OutputError(
            f"at a speed of {pace:g} the film would have {frames:.3g} frames. Allowed: at most "
            f"{most_frames} (the limit 'frames', raised by --limit frames=N or most_frames)",
            code="limit-exceeded")
    if even:
        width, height = width // 2 * 2, height // 2 * 2
    note = "" if pace == 1 else f"{pace:g}× speed"
    picture = Picture(run, size=(width, height), view=view, note=note, bare=bare, scales=scales)
    return picture, frame_times(run, fps=rate, speed=pace, start=view.start), rate


def see_through(picture: Picture, t: float) -> NDArray[np.uint8]:
    """A picture without a ground: red, green, blue and opacity [h, w, 4]."""
    return pixels(picture.size, picture.type, lambda paper: paint_picture(picture, paper, t),
                  transparent=True)


def _drawn(
    draw: Callable[[float], Drawn], times: list[float], progress: Progress | None,
) -> Iterator[Drawn]:
    for k, t in enumerate(times):
        yield draw(t)
        if progress is not None:
            progress((k + 1) / len(times))


def _write_gif(frames: Frames, times: list[float], fps: int, path: Path,
               progress: Progress | None) -> None:
    palette = shared_palette(
        [frames.draw_packed(t) for t in _for_palette(times)], frames.tension_colours)
    with path.open("wb") as file:
        writer = GifWriter(file, frames.size, palette)
        side_by_side(_lasting(_drawn(frames.draw_packed, times, progress), len(times), fps),
                     lambda item: writer.add(*item))
        writer.close()


def _write_see_through_gif(picture: Picture, times: list[float], fps: int, path: Path,
                           progress: Progress | None) -> None:
    def draw(t: float) -> NDArray[np.uint8]:
        return see_through(picture, t)

    palette = shared_palette([covered_words(draw(t)) for t in _for_palette(times)],
                             tension_colours(picture))
    with path.open("wb") as file:
        writer = GifWriter(file, picture.size, palette)
        side_by_side(_lasting(_drawn(draw, times, progress), len(times), fps),
                     lambda item: writer.add_covered(*item))
        writer.close()


def _for_palette(times: list[float]) -> list[float]:
    """Times of the frames that a palette is made from."""
    return [times[k] for k in np.unique(np.linspace(0, len(times) - 1, PALETTE_FRAMES).astype(int))]


def _lasting(frames: Iterator[Drawn], count: int, fps: int) -> Iterator[tuple[Drawn, int]]:
    """Each with how long it is shown, in hundredths of a second: the last one longer."""
    for k, frame in enumerate(frames):
        yield frame, round(100 * HOLD) if k == count - 1 else 100 // fps


def _write_mp4(frames: Frames, times: list[float], fps: int, path: Path,
               progress: Progress | None) -> None:
    try:
        import av  # noqa: F401
    except ImportError:
        raise OutputError("an .mp4 needs the package 'av': pip install 'sandbox-mechanics[mp4]', "
                          "or write a .gif", code="missing-package") from None
    import imageio.v3 as iio

    with iio.imopen(path, "w", plugin="pyav") as file:
        film: Any = file
        film.init_video_stream("libx264", fps=fps, pixel_format="yuv420p")
        side_by_side(_drawn(frames.draw_packed, times, progress),
                     lambda frame: film.write_frame(_rgb(frame)))


def _rgb(frame: Words) -> NDArray[np.uint8]:
    return np.ascontiguousarray(frame.view(np.uint8).reshape(*frame.shape, 4)[..., :3])


class _Consumer(threading.Thread, Generic[T]):
    def __init__(self, consume: Callable[[T], None]) -> None:
        super().__init__(name="encoder", daemon=True)
        self.waiting: queue.Queue[tuple[T] | None] = queue.Queue(WAITING)
        self.error: BaseException | None = None
        self._consume = consume

    def run(self) -> None:
        while (item := self.waiting.get()) is not None:
            if self.error is not None:
                continue
            try:
                self._consume(item[0])
            except BaseException as error:
                self.error = error


def side_by_side(produce: Iterable[T], consume: Callable[[T], None]) -> None:
    """Run ``produce`` in this thread, and ``consume`` each of its items, in order, in another.

    Frames are painted while those before them are encoded. An error of either is raised.
    """
    consumer = _Consumer(consume)
    consumer.start()
    try:
        for item in produce:
            if consumer.error is not None:
                break
            consumer.waiting.put((item,))
    finally:
        consumer.waiting.put(None)
        consumer.join()
    if consumer.error is not None:
        raise consumer.error
