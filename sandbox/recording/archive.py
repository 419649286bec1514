"""``run.npz``: every array of a recording, equal bytes for equal content.

A plain zip that ``numpy.load`` reads too: arrays in order of their names, without compression,
aligned so that they can be mapped (:mod:`sandbox.recording.reading`), with a fixed date, then
``mechanism.json`` and ``info.json``; the run's id is the archive's comment. No wall times.
"""

from __future__ import annotations

import hashlib
import json
import struct
import zipfile
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from sandbox.elements.arrays import IMPACT
from sandbox.errors import OutputError
from sandbox.recording.reading import FORMAT, INFO, MECHANISM, line_of
from sandbox.samples.outcome import outcome_data
from sandbox.samples.samples import Samples

CHUNK = 1 << 24
"""Bytes of an array that are written at a time."""
ALIGN, PADDING, SIZES = 64, "<HHH", 20
"""Alignment of arrays; zip's format of padding; bytes of sizes beyond 4 GB."""
RARE = ("events", "broke", "stopped", "controllers", "contact_solver")
"""Keys of ``info`` that are left out where they are empty."""


def write(run: Samples, file: IO[bytes]) -> None:
    """Write the archive of a run into an open file.

    Raises:
        OSError: the disk is full, or gone.
    """
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        none = IMPACT if not len(run.arrays["impact_time"]) else ()
        for key, array in sorted(run.with_meters().items()):
            if key in none:
                continue
            with archive.open(_aligned(f"{key}.npy", file.tell()), "w", force_zip64=True) as member:
                _write_array(member, array)
        text = {MECHANISM: run.mechanism.model_dump_json(by_alias=True),
                INFO: _info_text(run)}
        for name, content in text.items():
            archive.writestr(_member(name), content)
        archive.comment = _id_of(archive).encode()


def read_id(path: Path) -> str:
    """The id of the run in an archive; empty for one of an older version.

    Raises:
        OutputError: there is no archive.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            return archive.comment.decode("ascii", "replace")
    except (OSError, zipfile.BadZipFile) as error:
        raise OutputError(f"cannot read {path}: {line_of(error)}", code="run-damaged") from None


def _id_of(archive: zipfile.ZipFile) -> str:
    """A digest of the names, sizes and checksums of all members."""
    members = [f"{one.filename} {one.file_size} {one.CRC:08x}\n" for one in archive.infolist()]
    return hashlib.sha256("".join(members).encode()).hexdigest()[:32]


def _member(name: str) -> zipfile.ZipInfo:
    """A zip entry that depends on nothing but its name."""
    info = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
    info.create_system, info.external_attr = 3, 0o644 << 16
    return info


def _aligned(name: str, offset: int) -> zipfile.ZipInfo:
    """An entry at ``offset`` padded so that its content begins at a multiple of 64 bytes."""
    member = _member(name)
    before = offset + 30 + len(member.filename) + SIZES + struct.calcsize(PADDING)
    pad = -before % ALIGN
    member.extra = struct.pack(PADDING, 0xD935, pad + 2, ALIGN) + bytes(pad)
    return member


def _write_array(file: IO[bytes], array: NDArray[Any]) -> None:
    """The ``.npy`` form, in pieces, so that no copy of the whole is made."""
    little = array.dtype.newbyteorder("<")
    np.lib.format.write_array_header_1_0(
        file, {"descr": np.lib.format.dtype_to_descr(little), "fortran_order": False,
               "shape": array.shape})
    if not array.size:
        return
    step = max(1, CHUNK * len(array) // array.nbytes)
    for first in range(0, len(array), step):
        file.write(np.ascontiguousarray(array[first:first + step], dtype=little).tobytes())


def _info_text(run: Samples) -> str:
    info = {key: value for key, value in outcome_data(run.info).items()
            if key != "wall_s" and (value or key not in RARE)}
    info |= {"format": FORMAT, "notes": run.notes}
    return json.dumps(info, sort_keys=True, indent=1)
