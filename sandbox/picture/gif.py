"""GIF files: one palette for all frames, only what changed is written.

The pixels come as words of red + 256 green + 65536 blue. The palette is made
from a few frames; every colour's place in it is looked up once and kept in a
table of all 2**24 colours. A frame is cut to the box that changed, and pixels
inside it that did not change are written as see-through, which compresses well.
Of a film without a ground all that it covers is written anew in each frame, since a
see-through pixel cannot take an older one away; a pixel is either covered or not.
Pillow does the compression (LZW).
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import IO

import numpy as np
from numpy.typing import NDArray
from PIL import GifImagePlugin, Image

Words = NDArray[np.uint32]
CLEAR = 255
"""Place in the palette that stands for: as before."""
UNKNOWN = 255
COVERED = 128
"""Opacity, 0 to 255, from which a pixel counts as covered."""
KEEP, CLEAN = 1, 2
"""What is done with a frame when its time is over: it stays, or its box is emptied."""


def shared_palette(
    frames: list[Words], keep: Sequence[tuple[int, int, int]] = (),
) -> NDArray[np.uint8]:
    """At most 255 colours [n, 3] that suit all ``frames``, the most frequent ones exact.

    ``keep`` (at most 100) are always among them.

    Flat fills matter most in drawings: colours that cover more than 1 in 2000
    pixels are taken as they are, the mixed ones at edges share what remains.
    """
    words, counts = np.unique(np.concatenate([f.ravel() for f in frames]),
                              return_counts=True)
    order = np.argsort(-counts, kind="stable")
    words, counts = words[order], counts[order]
    kept = np.array([r + 256 * g + 65536 * b for r, g, b in keep], dtype=words.dtype)
    others = ~np.isin(words, kept)
    frequent = counts > counts.sum() / 2000
    words = np.concatenate((kept, words[others]))
    counts = np.concatenate((np.full(len(kept), counts[0]), counts[others]))
    exact = len(kept) + min(100, int(frequent[others].sum()))
    if len(words) <= CLEAR:
        return colours(words)
    rare = colours(words[exact:])
    # edges: each mixed colour once or a few times, so that rare hues keep a place
    weight = np.minimum(np.ceil(np.sqrt(counts[exact:])), 40).astype(int)
    strip = Image.fromarray(np.repeat(rare, weight, axis=0)[None])
    mixed = strip.quantize(CLEAR - exact, method=Image.Quantize.MEDIANCUT,
                           dither=Image.Dither.NONE).getpalette() or []
    return np.concatenate((colours(words[:exact]),
                           np.array(mixed, np.uint8).reshape(-1, 3)[: CLEAR - exact]))


def colours(words: Words) -> NDArray[np.uint8]:
    """Red, green, blue [n, 3] of words [n]."""
    return np.stack((words & 255, words >> 8 & 255, words >> 16 & 255), axis=-1).astype(np.uint8)


def packed(pixels: NDArray[np.uint8]) -> Words:
    """Red, green, blue [..., 3 or 4] as words."""
    red, green, blue = (pixels[..., k].astype(np.uint32) for k in range(3))
    return np.asarray(red | green << 8 | blue << 16, dtype=np.uint32)


def covered_words(pixels: NDArray[np.uint8]) -> Words:
    """The words of the pixels that are covered, in a row."""
    return packed(pixels[pixels[..., 3] >= COVERED])


class GifWriter:
    """Writes frames to an open binary file."""

    def __init__(self, file: IO[bytes], size: tuple[int, int],
                 palette: NDArray[np.uint8]) -> None:
        self._file = file
        self._palette = palette.astype(np.int32)
        self._table = np.full(1 << 24, UNKNOWN, dtype=np.uint8)
        self._last: Words | None = None
        filled = np.zeros((256, 3), np.uint8)
        filled[: len(palette)] = palette
        self._colours = filled.tobytes()
        # logical screen: a global table of 256 colours; then: repeat for ever
        file.write(b"GIF89a" + struct.pack("<HHBBB", *size, 0xF7, 0, 0) + self._colours)
        file.write(b"!\xff\x0bNETSCAPE2.0\x03\x01" + struct.pack("<H", 0) + b"\x00")

    def add(self, frame: Words, hundredths: int) -> None:
        """Write ``frame`` (height, width), shown for ``hundredths`` of a second."""
        if self._last is None:
            self._write(self._places(frame.ravel()).reshape(frame.shape), (0, 0), hundredths)
        else:
            changed = frame != self._last
            rows = np.flatnonzero(changed.any(axis=1))
            top, bottom = (int(rows[0]), int(rows[-1]) + 1) if len(rows) else (0, 1)
            columns = np.flatnonzero(changed[top:bottom].any(axis=0))
            left, right = (int(columns[0]), int(columns[-1]) + 1) if len(columns) else (0, 1)
            new = np.flatnonzero(changed[top:bottom, left:right])
            cut = np.full((bottom - top, right - left), CLEAR, dtype=np.uint8)
            cut.ravel()[new] = self._places(frame[top:bottom, left:right].ravel()[new])
            self._write(cut, (left, top), hundredths)
        self._last = frame

    def add_covered(self, pixels: NDArray[np.uint8], hundredths: int) -> None:
        """Write red, green, blue and opacity [h, w, 4] where it is covered, and nothing else."""
        covered = pixels[..., 3] >= COVERED
        rows, columns = (np.flatnonzero(covered.any(axis=axis)) for axis in (1, 0))
        if not len(rows):
            rows = columns = np.zeros(1, dtype=np.intp)
        box = (slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1))
        words = packed(pixels)[box]
        places = np.where(covered[box], self._places(words.ravel()).reshape(words.shape), CLEAR)
        self._write(places.astype(np.uint8), (int(columns[0]), int(rows[0])), hundredths, CLEAN)

    def close(self) -> None:
        """Write the trailer; the file itself stays open."""
        self._file.write(b";")

    def _write(self, cut: NDArray[np.uint8], at: tuple[int, int], hundredths: int,
               disposal: int = KEEP) -> None:
        image = Image.fromarray(cut)
        image.putpalette(self._colours)
        blocks = GifImagePlugin.getdata(image, at, duration=10 * hundredths, disposal=disposal,
                                        transparency=CLEAR)
        self._file.write(b"".join(blocks))

    def _places(self, words: Words) -> NDArray[np.uint8]:
        """Places in the palette, the nearest colour where there is no equal one."""
        found = self._table.take(words)
        if (unknown := found == UNKNOWN).any():
            new = np.unique(words[unknown])
            apart = colours(new).astype(np.int32)[:, None] - self._palette
            self._table[new] = np.argmin((apart * apart).sum(axis=2), axis=1)
            found = self._table.take(words)
        return found
