"""Films and stills: GIF, MP4, PNG, or a directory of PNG frames."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.gif import GifWriter, Words, shared_palette
from sandbox.draw.film.options import check_run, check_view, view_of
from sandbox.draw.film.pipeline import side_by_side
from sandbox.errors import OutputError
from sandbox.recording.new_run import FRAME
from sandbox.scene.elements.settings import View
from sandbox.scene.read.limits import Limits
from sandbox.whole_files import place, tidy, written_whole

Progress = Callable[[float], None]
Show = str | Sequence[str] | Mapping[str, object]
ENDINGS = (".gif", ".mp4", ".png")
WHAT = "a picture"
MOST_FRAMES = Limits.frames
"""Of a film, unless more are allowed."""
HOLD = 1.5
"""How long a GIF shows its last frame [s], to let it be read."""
STILL = 4
"""How many times larger a still is drawn before it is scaled down."""
PALETTE_FRAMES = 5


def frame_times(run: Filmed, *, fps: int, speed: float, start: float = 0.0) -> list[float]:
    """Times of the frames [s]: ``speed / fps`` apart from ``start``, and the run's end."""
    end = float(run.time[-1])
    start = min(start, end)
    step = speed / fps
    count = max(0, int(np.ceil((end - start) / step - 1e-6)))
    return [start + k * step for k in range(count)] + [end]


def render(
    run: Filmed, path: str | Path, *, size: tuple[int, int] | None = None, fps: int | None = None,
    speed: float | None = None, centre: tuple[float, float] | None = None,
    width: float | None = None, show: Show | None = None, bodies: Sequence[str] | None = None,
    follow: str | None = None, progress: Progress | None = None, most_frames: int = MOST_FRAMES,
) -> None:
    """Draw a run to ``path``.

    It becomes a film (.gif, .mp4), a still of the run's end (.png), or, where
    the path has no ending, a directory of PNG frames.

    Args:
        run: the recording.
        path: where to; its ending decides what is made.
        size: width and height of the picture [pixels].
        fps: 20, 25 or 50 frames per second.
        speed: seconds of motion per second of film.
        centre: world point in the middle of the picture [m].
        width: of the world shown [m].
        show: layers besides those that the view shows, and ``-contacts`` for one that is left out,
            as a text or a list; or an object that says of each of which bodies.
        bodies: names and patterns of the bodies that the picture is fitted to.
        follow: the body that the picture goes with.
        progress: called with the fraction done, 0 to 1.
        most_frames: that a film may have.

    What is left out comes from the scene's view.

    Raises:
        OutputError: no path, an unknown ending, what no view can have, no recording or an empty
            one, too many frames, or a file that cannot be written.
    """
    check_run(run)
    path = place(path, WHAT)
    view = view_of(run.mechanism.view, {
        "size": size, "fps": fps, "speed": speed, "centre": centre, "width": width, "show": show,
        "bodies": bodies, "follow": follow})
    check_view(run, view)
    if path.suffix.lower() == ".png":
        save_picture(run, path, view=view)
    elif path.is_dir() or not path.suffix:
        write_frames(run, path, view=view, progress=progress, most_frames=most_frames)
    else:
        write_animation(run, path, view=view, progress=progress, most_frames=most_frames)


def write_animation(
    run: Filmed, path: str | Path, *, size: tuple[int, int] | None = None, fps: int | None = None,
    speed: float | None = None, view: View | None = None, progress: Progress | None = None,
    most_frames: int = MOST_FRAMES,
) -> None:
    """Draw the run as a film, .gif or .mp4; see :func:`render`."""
    path = place(path, WHAT)
    ending = path.suffix.lower()
    if ending not in (".gif", ".mp4"):
        raise OutputError(f"{path}: no film can have the ending {ending!r}; "
                          f"allowed: {', '.join(ENDINGS)}, or none for a directory of frames")
    renderer, times, rate = _prepare(run, size, fps, speed, view, most_frames,
                                     even=ending == ".mp4")
    with written_whole(path) as aside:
        if ending == ".gif":
            _write_gif(renderer, times, rate, aside, progress)
        else:
            _write_mp4(renderer, times, rate, aside, progress)


def write_frames(
    run: Filmed, directory: str | Path, *, size: tuple[int, int] | None = None,
    fps: int | None = None, speed: float | None = None, view: View | None = None,
    progress: Progress | None = None, most_frames: int = MOST_FRAMES,
) -> None:
    """Draw the run as ``frame_00000.png`` and so on; frames of an earlier film are removed."""
    directory = place(directory, WHAT)
    renderer, times, _ = _prepare(run, size, fps, speed, view, most_frames)

    def save(item: tuple[int, Words]) -> None:
        with written_whole(directory / f"frame_{item[0]:05d}.png", lasting=False) as aside:
            _image(item[1]).save(aside, format="PNG", compress_level=3)

    tidy(directory)
    side_by_side(enumerate(_drawn(renderer, times, progress)), save)
    kept = {f"frame_{k:05d}.png" for k in range(len(times))}
    for old in directory.glob(FRAME):
        if old.name not in kept:
            old.unlink()


def save_picture(
    run: Filmed, path: str | Path, *, t: float | None = None, size: tuple[int, int] | None = None,
    view: View | None = None,
) -> None:
    """Draw one moment as a PNG, more finely than a frame of a film; its end by default."""
    check_run(run)
    view = view_of(view or run.mechanism.view, {"size": size})
    renderer = FrameRenderer(run, size=view.size, view=view, enlarge=STILL)
    frame = renderer.draw_packed(float(run.time[-1]) if t is None else t)
    with written_whole(place(path, WHAT)) as aside:
        _image(frame).save(aside, format="PNG")


def _prepare(
    run: Filmed, size: tuple[int, int] | None, fps: int | None, speed: float | None,
    view: View | None, most_frames: int, *, even: bool = False,
) -> tuple[FrameRenderer, list[float], int]:
    """Renderer, times of its frames and frames per second."""
    check_run(run)
    view = view_of(view or run.mechanism.view, {"size": size, "fps": fps, "speed": speed})
    rate, pace, (width, height) = view.fps, view.speed, view.size
    frames = (float(run.time[-1]) - view.start) / pace * rate
    if not frames <= most_frames:
        raise OutputError(
            f"at a speed of {pace:g} the film would have {frames:.3g} frames. Allowed: at most "
            f"{most_frames} (the limit 'frames', raised by --max-frames or most_frames)")
    if even:
        width, height = width // 2 * 2, height // 2 * 2
    note = "" if pace == 1 else f"{pace:g}× speed"
    renderer = FrameRenderer(run, size=(width, height), view=view, note=note)
    return renderer, frame_times(run, fps=rate, speed=pace, start=view.start), rate


def _drawn(
    renderer: FrameRenderer, times: list[float], progress: Progress | None
) -> Iterator[Words]:
    for k, t in enumerate(times):
        yield renderer.draw_packed(t)
        if progress is not None:
            progress((k + 1) / len(times))


def _write_gif(renderer: FrameRenderer, times: list[float], fps: int, path: Path,
               progress: Progress | None) -> None:
    samples = np.unique(np.linspace(0, len(times) - 1, PALETTE_FRAMES).astype(int))
    palette = shared_palette(
        [renderer.draw_packed(times[k]) for k in samples], renderer.tension_colours)
    with path.open("wb") as file:
        writer = GifWriter(file, renderer.size, palette)

        def add(item: tuple[int, Words]) -> None:
            last = item[0] == len(times) - 1
            writer.add(item[1], round(100 * HOLD) if last else 100 // fps)

        side_by_side(enumerate(_drawn(renderer, times, progress)), add)
        writer.close()


def _write_mp4(renderer: FrameRenderer, times: list[float], fps: int, path: Path,
               progress: Progress | None) -> None:
    try:
        import av  # noqa: F401
    except ImportError:
        raise OutputError("an .mp4 needs the package 'av': "
                          "pip install 'sandbox-mechanics[mp4]', or write a .gif") from None
    import imageio.v3 as iio

    with iio.imopen(path, "w", plugin="pyav") as file:
        film: Any = file
        film.init_video_stream("libx264", fps=fps, pixel_format="yuv420p")
        side_by_side(_drawn(renderer, times, progress),
                     lambda frame: film.write_frame(_rgb(frame)))


def _rgb(frame: Words) -> NDArray[np.uint8]:
    return np.ascontiguousarray(frame.view(np.uint8).reshape(*frame.shape, 4)[..., :3])


def _image(frame: Words) -> Image.Image:
    return Image.fromarray(_rgb(frame))
