"""A fingerprint of the compiled code's sources.

Numba keeps what it compiled, and takes it out again while the file of that one
function is unchanged; it does not look at the functions called from there. A
kernel that calls into other files therefore reads :data:`KERNELS` from an
enclosing scope, which is a part of what Numba does look at.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

_FILES = ("advance.py", "forces.py", "memory.py", "native.py", "network.py", "snapshot.py",
          "state.py", "work.py")


def _hash(*files: Path) -> int:
    """A number that fits a machine word; to ask whether a text is empty would cost compiling."""
    digest = hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).digest()
    return int.from_bytes(digest[:7], "big") | 1


KERNELS = _hash(*(Path(__file__).with_name(name) for name in _FILES))
"""Changes when any source of the compiled code does."""
