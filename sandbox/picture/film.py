"""Films and stills: GIF, MP4, PNG, or a directory of PNG frames."""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import IO, Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray
from PIL import GifImagePlugin, Image

from sandbox.atomic_files import atomic_file, output_path, remove_stale
from sandbox.errors import OutputError, optional
from sandbox.picture import options
from sandbox.picture.frame import PRINT_UNIT, Picture, Strip
from sandbox.picture.frames import Frames
from sandbox.picture.palette import PUSH, TENSION
from sandbox.recording.new_run import FRAME
from sandbox.samples.samples import Samples
from sandbox.scene.read.limits import Limits
from sandbox.scene.settings import View
from sandbox.values.numbers import number_from
from sandbox.wording import WrongValueError, near, quoted

T = TypeVar("T")
Words = NDArray[np.uint32]
Progress = Callable[[float], None]
Meters = str | Sequence[str | Mapping[str, Any]]
Show = str | Sequence[str] | Mapping[str, object]
CLEAR = 255  # place in the palette of a pixel that stays as before
COVERED = 128  # minimum opacity, 0 to 255, of a pixel that counts as covered
KEEP, CLEAN = 1, 2  # disposal of a frame in a GIF: it stays, or its box is emptied
FILMS, STILLS = (".gif", ".mp4"), (".png", ".svg", ".pdf")
WHAT = "a picture"
ENDS = ("start", "end")  # words for times
PLAIN = re.compile(r"[-+]?[0-9.]+(e[-+]?[0-9]+)?", re.IGNORECASE)  # a number without a unit
PICTURES, MAX_PICTURES = 5, 24  # of a strip: default and maximum
Size = tuple[int, int] | str
Instants = float | str | Sequence[float | str]
MAX_FRAMES = Limits.frames  # default limit of a film


def shared_palette(
    frames: Sequence[Words], keep: Sequence[tuple[int, int, int]] = (),
) -> NDArray[np.uint8]:
    """At most 255 colours [n, 3] for all ``frames``; ``keep`` (at most 100) are among them."""
    words, counts = np.unique(np.concatenate([f.ravel() for f in frames]), return_counts=True)
    kept = packed(np.array(keep, dtype=np.uint8).reshape(-1, 3))
    order = np.argsort(-counts, kind="stable")
    order = order[~np.isin(words[order], kept)]
    exact, rest = np.split(order, [min(100, int((counts[order] > counts.sum() / 2000).sum()))])
    found = colours(np.concatenate((kept, words[exact])))
    # edges: each mixed colour once or a few times, so that rare hues keep a place
    weight = np.minimum(np.ceil(np.sqrt(counts[rest])), 40).astype(int)
    strip = np.concatenate((kept[:1], words[:1], np.repeat(words[rest], weight)))
    mixed = Image.fromarray(colours(strip)[None]).quantize(
        CLEAR - len(found), method=Image.Quantize.MEDIANCUT).getpalette() or []
    return np.concatenate((found, np.array(mixed, np.uint8).reshape(-1, 3)))[:CLEAR]


def colours(words: Words) -> NDArray[np.uint8]:
    """Red, green, blue [..., 3] of words."""
    whole = np.ascontiguousarray(words).view(np.uint8).reshape(*words.shape, 4)
    return np.ascontiguousarray(whole[..., :3])


def packed(pixels: NDArray[np.uint8]) -> Words:
    """Red, green, blue [..., 3 or 4] as words."""
    return np.asarray(pixels[..., :3] @ np.array([1, 1 << 8, 1 << 16], dtype=np.uint32))


class GifWriter:
    """Writes frames to an open binary file."""

    def __init__(self, file: IO[bytes], size: tuple[int, int], palette: NDArray[np.uint8]) -> None:
        self._file = file
        self._last: Words | None = None
        self._palette = palette.astype(np.int32)
        self._places = np.full(1 << 24, CLEAR, dtype=np.uint8)  # of known words in the palette
        self._table = palette.tobytes().ljust(3 * 256, b"\0")
        # logical screen: a global table of 256 colours; then: repeat for ever
        file.write(b"GIF89a" + struct.pack("<HHBBB", *size, 0xF7, 0, 0) + self._table)
        file.write(b"!\xff\x0bNETSCAPE2.0\x03\x01" + struct.pack("<H", 0) + b"\x00")

    def add(self, frame: NDArray[Any], hundredths: int) -> None:
        """Write the box of words [h, w] that differs from the last frame, or an RGBA frame."""
        if frame.ndim == 3:
            words, new, disposal = packed(frame), frame[..., 3] >= COVERED, CLEAN
        else:
            words, disposal = frame, KEEP
            new = np.ones(frame.shape, dtype=bool) if self._last is None else frame != self._last
            self._last = words
        left, top, right, low = Image.fromarray(new).getbbox() or (0, 0, 1, 1)
        box = slice(top, low), slice(left, right)
        some = words[box][new[box]]
        unknown = np.unique(some[self._places[some] == CLEAR])
        apart = colours(unknown).astype(np.int32)[:, None] - self._palette
        self._places[unknown] = np.argmin((apart * apart).sum(axis=2), axis=1)  # the nearest one
        cut = np.full(new[box].shape, CLEAR, dtype=np.uint8)
        cut[new[box]] = self._places[some]
        image = Image.fromarray(cut)
        image.putpalette(self._table)
        blocks = GifImagePlugin.getdata(image, (left, top), duration=10 * hundredths,
                                        disposal=disposal, transparency=CLEAR)
        self._file.write(b"".join(blocks))


def render(
    run: Samples, path: str | Path, *, at: Instants | None = None, strip: bool | int = False,
    size: Size | None = None, fps: int | None = None, speed: float | None = None,
    centre: tuple[float, float] | None = None, width: float | None = None,
    show: Show | None = None, bodies: Sequence[str] | None = None, follow: str | None = None,
    meters: Meters | None = None, transparent: bool = False, bare: bool = False,
    scales: bool = False, progress: Progress | None = None, most_frames: int = MAX_FRAMES,
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
        OutputError: no path, an unknown ending, options that no view can have, no samples,
            a time that the run does not reach, too many frames, or a file that cannot be written.
    """
    options.check_run(run)
    path = output_path(path, WHAT)
    view = options.view_of(run.mechanism.view, {
        "size": size, "fps": fps, "speed": speed, "centre": centre, "width": width, "show": show,
        "bodies": bodies, "follow": follow, "meters": meters})
    options.check_view(run, view)
    layout: dict[str, Any] = {"view": view, "bare": bare, "scales": scales}
    if is_still(path, at=at is not None, strip=strip is not False, transparent=transparent,
                size=size):
        return _write_stills(run, path, _moments(run, view, at, strip), layout, size=size,
                             strip=strip is not False, transparent=transparent)
    times = frame_times(run, fps=view.fps, speed=view.speed, start=view.start, most=most_frames)
    _animate(run, path, times, layout, transparent=transparent, progress=progress)
    return [path]


def _write_stills(run: Samples, path: Path, moments: Sequence[Moment], layout: Mapping[str, Any],
                  *, size: Size | None, strip: bool, transparent: bool) -> list[Path]:
    """Write a picture of each moment, or a strip of them all; returns the files."""
    from sandbox.picture.paper import save

    times, paper = [moment.time for moment in moments], options.paper_of(size)
    made: Picture | Strip
    if strip:
        made = Strip(run, times, **layout, paper=paper,
                     size=None if size is None or isinstance(size, str) else layout["view"].size)
        moments = [Moment(times[0], "strip")]
    elif paper:
        picture = partial(Picture, run, **layout, moments=times, unit=PRINT_UNIT,
                          least=options.PRINT_TYPE)
        across, high = paper.pixels  # a layout in a tall picture finds a free height
        made = picture(size=(across, high or round(picture(size=(across, 3 * across)).needs)))
    else:
        made = Picture(run, **layout, moments=times)
    files = []
    for moment in moments:
        file = path
        if not path.suffix or path.is_dir():
            file = path / f"still_{moment.word}.png"
        elif len(moments) > 1:
            file = path.with_name(f"{path.stem}_{moment.word}{path.suffix}")
        save(output_path(file, WHAT), made, moment.time, transparent=transparent,
             per_inch=made.size[0] * options.UNITS["in"] / paper.width if paper else None)
        files.append(file)
    return files


def is_still(path: Path, *, at: bool, strip: bool, transparent: bool, size: Size | None) -> bool:
    """Whether the file's ending, or ``at`` and ``strip``, select stills; check that they agree."""
    ending, problem = "" if path.is_dir() else path.suffix.lower(), ""
    stills = ending in STILLS or at or strip
    if ending not in ("", *FILMS, *STILLS):
        problem = (f"no picture can have the ending {path.suffix!r}; allowed: "
                   f"{', '.join((*FILMS, *STILLS))}, or none for a directory")
    elif ending in FILMS and (at or strip or (transparent and ending != ".gif")):
        word = "at" if at else "strip" if strip else "transparent"
        what, more = ("single moments", ()) if at or strip else ("a see-through ground", (".gif",))
        problem = (f"{word} asks for {what}, which no {ending} has; allowed: "
                   f"{', '.join((*more, *STILLS))}, or none for a directory")
    elif not stills and options.paper_of(size):
        problem = (f"size={size!r} asks for paper: a film has pixels, as in 800x600; a size on "
                   f"paper is one of a still ({', '.join(STILLS)})")
    if problem:
        raise OutputError(f"{path}: {problem}", code="bad-picture")
    return stills


def frame_times(run: Samples, *, fps: int, speed: float, start: float = 0.0,
                most: int = MAX_FRAMES) -> list[float]:
    """Times of the frames [s]: ``speed / fps`` apart from ``start``, and the run's end."""
    end = float(run.time[-1])
    frames = (end - start) / speed * fps
    if not frames <= most:
        raise OutputError(
            f"at a speed of {speed:g} the film would have {frames:.3g} frames. Allowed: at "
            f"most {most} (the limit 'frames', raised by --limit frames=N or most_frames)",
            code="limit-exceeded")
    start, step = min(start, end), speed / fps
    return [start + k * step for k in range(math.ceil((end - start) / step - 1e-6))] + [end]


class Moment(NamedTuple):
    """A requested moment."""

    time: float  # [s]
    word: str  # in the name of its file: ``0.8s``, ``end``


def instants(run: Samples, at: Instants) -> list[Moment]:
    """The moments that ``at`` names: seconds, times with units, ``start``, ``end``; or a list.

    Raises:
        OutputError: values that are no times, or that the run does not reach; one a line.
    """
    found, problems = [], []
    for each in at if isinstance(at, (list, tuple, np.ndarray)) else [at]:
        try:
            found.append(_moment(run, each))
        except WrongValueError as error:
            problems.append(f"at={quoted(each)}: {error}")
    if problems or not found:
        raise OutputError("\n".join(problems) or
                          'at is an empty list: pass times, "start" or "end"', code="bad-time")
    return found


def _moment(run: Samples, given: Any) -> Moment:
    first, last = float(run.time[0]), float(run.time[-1])
    # a sample is taken within a step, so that none lies at the very start and end
    apart = (last - first) / max(len(run.time) - 1, 1) * (1 + 1e-9)
    start, end = (0.0 if first <= apart else first), run.mechanism.run.duration
    word = given.strip() if isinstance(given, str) else ""
    if word in ENDS:
        return Moment(start if word == ENDS[0] else last, word)
    try:
        time = number_from(float(word) if PLAIN.fullmatch(word) else given, "time", {})
    except ValueError as error:
        words = error.message if isinstance(error, WrongValueError) else str(error)
        raise WrongValueError("bad-time", words, hint=near(word, ENDS) if word else "",
                              allowed='a time such as 0.8 or "0.8 s", "start", "end"') from None
    if not start <= time <= (max(last, end) if end - last <= 2 * apart else last):
        raise WrongValueError("bad-time", f"the run lasts from {start:g} s to {last:g} s")
    return Moment(time, f"{time:.6g}s")


def _moments(run: Samples, view: View, at: Instants | None, strip: bool | int) -> list[Moment]:
    if at is not None and not isinstance(strip, bool):
        raise OutputError(f"strip={strip} and at say both which pictures a strip has: "
                          "pass strip=True with at, or a number without", code="bad-picture")
    if at is not None or strip is False:
        return instants(run, ENDS[1] if at is None else at)
    count, end = PICTURES if strip is True else strip, float(run.time[-1])
    if not 2 <= count <= MAX_PICTURES:
        raise OutputError(f"strip={quoted(strip)}: a strip has 2 to {MAX_PICTURES} pictures",
                          code="bad-picture")
    return [Moment(t, f"{t:.6g}s") for t in np.linspace(min(view.start, end), end, count).tolist()]


def _animate(run: Samples, path: Path, times: Sequence[float], layout: Mapping[str, Any], *,
             transparent: bool, progress: Progress | None) -> None:
    """Write a film, ``.gif`` or ``.mp4``, or a directory of ``frame_00000.png`` and so on."""
    ending, view = "" if path.is_dir() else path.suffix.lower(), layout["view"]
    even = 2 if ending == ".mp4" else 1
    picture = Picture(run, size=(view.size[0] // even * even, view.size[1] // even * even),
                      note="" if view.speed == 1 else f"{view.speed:g}× speed", **layout)
    draw: Callable[[float], NDArray[Any]]
    if transparent:
        from sandbox.picture.paper import pixels

        draw = partial(pixels, picture, transparent=True)
    else:
        draw = Frames(picture).draw_packed

    def drawn() -> Iterator[NDArray[Any]]:
        for k, t in enumerate(times):
            yield draw(t)
            if progress is not None:
                progress((k + 1) / len(times))

    if not ending:
        _write_frames(drawn(), path, len(times))
        return
    with atomic_file(path) as aside:
        if ending == ".mp4":
            optional("av", "'sandbox-mechanics[mp4]'")
            import imageio.v3 as iio

            with iio.imopen(aside, "w", plugin="pyav") as film:
                cast(Any, film).init_video_stream("libx264", fps=view.fps, pixel_format="yuv420p")
                side_by_side(drawn(), lambda frame: cast(Any, film).write_frame(colours(frame)))
            return
        some: list[Any] = [draw(times[k]) for k in np.unique(
            np.linspace(0, len(times) - 1, 5).astype(int))]
        palette = shared_palette([packed(each[each[..., 3] >= COVERED]) for each in some]
                                 if transparent else some, TENSION + PUSH * bool(
                                     picture.subject.carried.pushing))
        lasts = [100 // view.fps] * (len(times) - 1) + [round(100 * 1.5)]
        with aside.open("wb") as file:
            writer = GifWriter(file, picture.size, palette)
            side_by_side(zip(drawn(), lasts, strict=True), lambda frame: writer.add(*frame))
            file.write(b";")


def _write_frames(frames: Iterator[NDArray[Any]], directory: Path, count: int) -> None:
    def save(item: tuple[int, NDArray[Any]]) -> None:
        with atomic_file(directory / f"frame_{item[0]:05d}.png", durable=False) as aside:
            pixels = item[1] if item[1].dtype == np.uint8 else colours(item[1])
            Image.fromarray(pixels).save(aside, format="PNG", compress_level=3)

    remove_stale(directory)
    side_by_side(enumerate(frames), save)
    for old in sorted(directory.glob(FRAME))[count:]:
        old.unlink()


def side_by_side(produce: Iterable[T], consume: Callable[[T], None]) -> None:
    """Run ``produce`` in this thread, and ``consume`` its items, in order, in another one."""
    with ThreadPoolExecutor(1, "encoder") as encoder:
        consumed: Future[Any] = encoder.submit(int)
        for item in produce:
            consumed.result()
            consumed = encoder.submit(consume, item)
        consumed.result()
