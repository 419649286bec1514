"""Tables as comma-separated text, read back by the standard library."""

from __future__ import annotations

import csv
import io

import numpy as np
from sandbox.comma import comma_separated


def test_what_is_written_is_read_back() -> None:
    names, third = ["a, with a comma", 'a "quote"'], np.float64(1) / 3
    text = comma_separated(names, [["x,y", third], [None, -1e-300], [True, 12345678]])
    assert "np." not in text
    head, *rows = csv.reader(io.StringIO(text))
    assert head == names
    assert [row[0] for row in rows] == ["x,y", "", "True"]
    assert [float(row[1]) for row in rows] == [third, -1e-300, 12345678]


def test_floats_are_rounded_and_whole_numbers_are_not() -> None:
    text = comma_separated(["n", "x"], [[1234567, np.float64(2) / 3]], digits=3)
    assert text == "n,x\n1234567,0.667\n"
