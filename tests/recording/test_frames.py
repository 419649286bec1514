"""A recording as a table: with pandas and xarray where they are, with a clear line where not."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

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


def test_something_named_time_is_what_its_scene_says() -> None:
    scene = {"run": {"duration": 0.01}, "bodies": [{"name": "a", "mass": 1, "inertia": 1}],
             "meters": [{"name": "time", "value": "=2 * t"}]}
    run = sandbox.simulate(scene)
    np.testing.assert_allclose(run["time"], 2 * run.time, rtol=1e-12)


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


def test_what_a_table_is_made_of(
    run: sandbox.Recording, monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Without pandas and xarray: what they are given, by stand-ins that keep it."""
    table: Any = SimpleNamespace(attrs={})

    def frame(columns: Any, index: Any, **more: Any) -> Any:
        table.columns, table.index = columns, index
        return table

    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(
        DataFrame=frame, Index=lambda values, name: (values, name)))
    monkeypatch.setitem(sys.modules, "xarray", SimpleNamespace(
        Dataset=lambda variables, coords, attrs: (variables, coords, attrs)))
    run.to_pandas("finger.*p.angle", "time", "finger.mcp.angle")
    assert list(table.columns) == [*run.names("finger.*p.angle"), "time"]
    assert table.index == (run.time, "time")
    assert table.attrs["units"]["finger.mcp.angle"] == "rad"
    variables, coords, attrs = run.to_xarray("finger.tendon.tension")
    dims, values, units = variables["finger.tendon.tension"]
    assert (dims, units) == ("time", {"units": "N"})
    np.testing.assert_array_equal(values, run["finger.tendon.tension"])
    assert coords["time"][2] == {"units": "s"}
    assert attrs["scene"] == "single_finger"


def test_with_the_libraries_themselves(run: sandbox.Recording) -> None:
    pandas = pytest.importorskip("pandas", reason="pandas is not installed")
    xarray = pytest.importorskip("xarray", reason="xarray is not installed")
    table, data = run.to_pandas(), run.to_xarray("finger.mcp.angle")
    assert isinstance(table, pandas.DataFrame)
    assert isinstance(data, xarray.Dataset)
    assert len(table) == len(run)
    assert "finger.tendon.tension" in table
    np.testing.assert_array_equal(table["finger.mcp.angle"], data["finger.mcp.angle"])
