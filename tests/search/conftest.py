"""Searches run in this process; tests/sweeps tests worker processes."""

import pytest

from tests.sweeps.scenes import InProcess


@pytest.fixture(autouse=True)
def _in_process(monkeypatch):
    monkeypatch.setattr("sandbox.sweeps.workers.Processes", InProcess)
