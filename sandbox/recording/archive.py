"""``run.npz``: every array of a recording, equal bytes for equal content.

A plain zip that ``numpy.load`` reads too: arrays in order of their names,
stored without compression and with one fixed date, then ``mechanism.json``
and ``info.json``; the run's id is the archive's comment. Wall times are not in it.
Nothing is ever unpickled.
"""

from __future__ import annotations

import hashlib
import json
import zipfile
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from sandbox.errors import OutputError
from sandbox.kinds.arrays import Arrays, faults
from sandbox.samples.outcome import Outcome, outcome_data, read_outcome
from sandbox.samples.samples import Samples
from sandbox.scene.mechanism import Mechanism

FORMAT = 1
MECHANISM, INFO = "mechanism.json", "info.json"
CHUNK = 1 << 24
"""Bytes of an array that are written at a time."""
UNSTEADY = ("wall_s",)
"""Keys of ``info`` that differ from run to run and stay out of the archive."""
RARE = ("events", "stopped", "controllers")
"""Keys that are written only where there is something to say: most runs have no control."""


def write(run: Samples, file: IO[bytes]) -> None:
    """Write the archive of a run into an open file.

    Raises:
        OSError: the disk is full, or gone.
    """
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for key, array in sorted(run.with_meters().items()):
            with archive.open(_member(f"{key}.npy"), "w", force_zip64=True) as member:
                _write_array(member, array)
        text = {MECHANISM: run.mechanism.model_dump_json(by_alias=True),
                INFO: _info_text(run)}
        for name, content in text.items():
            archive.writestr(_member(name), content)
        archive.comment = _id_of(archive).encode()


def read(path: Path) -> tuple[Mechanism, Arrays, Outcome]:
    """What a recording is made of: its mechanism, its arrays, its outcome.

    Raises:
        OutputError: missing, not an archive, damaged, or of a newer format.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            names = set(archive.namelist())
            if lacking := sorted({MECHANISM, INFO} - names):
                raise OutputError(f"{path} is not a recording: it has no {lacking[0]!r}")
            info = _read_info(path, archive)
            mechanism = Mechanism.model_validate_json(archive.read(MECHANISM))
            outcome = _outcome(info, mechanism)
            arrays = {name[:-4]: _read_array(archive, name)
                      for name in sorted(names) if name.endswith(".npy")}
    except FileNotFoundError:
        raise OutputError(
            f"there is no recording in {path.parent}: {path.name} is missing") from None
    except OSError as error:
        raise OutputError(f"cannot read {path}: {error.strerror or error}") from None
    except ValidationError as error:
        first = error.errors()[0]
        raise OutputError(
            f"{path} is damaged: its mechanism is not valid: {first['msg']}") from None
    except OutputError:
        raise
    except Exception as error:  # zip, zlib, numpy and json each raise their own on garbage
        raise OutputError(f"{path} is not a recording, or damaged: {_line(error)}") from None
    if found := faults(mechanism, arrays):
        raise OutputError(f"{path} is damaged: {'; '.join(found)}")
    return mechanism, arrays, outcome


def read_id(path: Path) -> str:
    """The id of the run in an archive; empty for one of an older version.

    Raises:
        OutputError: there is no archive.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            return archive.comment.decode("ascii", "replace")
    except (OSError, zipfile.BadZipFile) as error:
        raise OutputError(f"cannot read {path}: {_line(error)}") from None


def _id_of(archive: zipfile.ZipFile) -> str:
    """What tells runs apart: a digest of the names, sizes and checksums of all members.

    Equal content has equal ids, so that equal runs stay equal byte for byte.
    """
    members = [f"{one.filename} {one.file_size} {one.CRC:08x}\n" for one in archive.infolist()]
    return hashlib.sha256("".join(members).encode()).hexdigest()[:32]


def _member(name: str) -> zipfile.ZipInfo:
    """A zip entry that depends on nothing but its name."""
    info = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
    info.create_system, info.external_attr = 3, 0o644 << 16
    return info


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


def _read_array(archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    with archive.open(name) as member:
        array: NDArray[Any] = np.lib.format.read_array(member, allow_pickle=False)
    return array


def _info_text(run: Samples) -> str:
    info = {key: value for key, value in outcome_data(run.info).items()
            if key not in UNSTEADY and (value or key not in RARE)}
    info |= {"format": FORMAT, "notes": run.notes}
    return json.dumps(info, sort_keys=True, indent=1)


def _read_info(path: Path, archive: zipfile.ZipFile) -> dict[str, Any]:
    info: Any = json.loads(archive.read(INFO))
    version = info.pop("format", None) if isinstance(info, dict) else None
    if not isinstance(version, int):
        raise ValueError(f"{INFO!r} does not describe a run")
    if version > FORMAT:
        raise OutputError(f"{path} has format {version}; this version reads up to {FORMAT}: "
                          "use a newer sandbox")
    return dict(info)


def _outcome(info: dict[str, Any], mechanism: Mechanism) -> Outcome:
    try:
        return read_outcome(info, mechanism.run)
    except ValueError as error:
        raise ValueError(f"{INFO!r} does not describe a run: {error}") from None


def _line(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:200]


