"""Types of arrays: what is said of every one is its shape and its unit, not its type."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Quantities, 8 bytes each."""
Matrix = Array
"""The same, with two axes where a compiled function takes it."""
Stack = Array
"""The same, with three axes."""
Integers = NDArray[np.int64]
"""Places in other arrays, and counts."""
Flags = NDArray[np.bool_]
"""What holds, and what does not."""
Records = NDArray[Any]
"""Rows with named fields (a structured dtype)."""
