"""A recording as a table: with pandas and xarray where they are, with a clear line where not."""

from __future__ import annotations

import sys

import numpy as np
import pytest

import sandbox
from sandbox.samples.patterns import MixedUnitsError


@pytest.fixture(scope="module")
def run() -> sandbox.Recording:
    return sandbox.simulate(sandbox.load_scene("single_finger", overrides={"run.duration": 0.05}))


def test_time_is_a_quantity(run: sandbox.Recording) -> None:
    assert run["time"] is run.time
    assert run.unit("time") == "s"
    assert "time" in run
    assert "time" not in run.names()


def test_a_pattern_gives_columns(run: sandbox.Recording) -> None:
    names = run.names("finger.*p.angle")
    assert names == ["finger.mcp.angle", "finger.pip.angle", "finger.dip.angle"]
    assert run["finger.*p.angle"].shape == (len(run), 3)
    for i, name in enumerate(names):
        np.testing.assert_array_equal(run["finger.*p.angle"][:, i], run[name])
    assert run.unit("finger.*p.angle") == "rad"
    assert "finger.*p.angle" in run
    assert run["finger.*/disc.normal"].shape[0] == len(run)


def test_a_pattern_that_fits_nothing_or_several_units(run: sandbox.Recording) -> None:
    for ask in (run.__getitem__, run.names, run.unit):
        with pytest.raises(sandbox.SandboxError, match=r"no quantity fits 'finger\.\*\.angel'; did "
                                                       r"you mean 'finger\.\*\.angle'\?"):
            ask("finger.*.angel")
    with pytest.raises(sandbox.SandboxError, match=r"did you mean 'finger\.\*\.angle'\?"):
        run.names("fingr.*.angle")
    assert "finger.*.angel" not in run
    for ask in (run.__getitem__, run.unit):
        with pytest.raises(MixedUnitsError, match=r"'disc\.\*' fits quantities of \d units \("
                                                  r"disc\.x in m, "):
            ask("disc.*")


@pytest.mark.parametrize("name", ["pandas", "xarray"])
def test_what_is_not_installed_is_said(
    run: sandbox.Recording, name: str, monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(sandbox.SandboxError, match=f"'{name}', which is not installed: pip inst"):
        getattr(run, f"to_{name}")()


def test_with_the_libraries_themselves(run: sandbox.Recording) -> None:
    pandas = pytest.importorskip("pandas", reason="pandas is not installed")
    xarray = pytest.importorskip("xarray", reason="xarray is not installed")
    table, data = run.to_pandas(), run.to_xarray("finger.mcp.angle")
    assert isinstance(table, pandas.DataFrame)
    assert isinstance(data, xarray.Dataset)
    assert len(table) == len(run)
    assert "finger.tendon.tension" in table
    np.testing.assert_array_equal(table["finger.mcp.angle"], data["finger.mcp.angle"])
