"""The progress bar: silent for a second, then share and remaining time, then gone."""

from __future__ import annotations

import pytest

from sandbox.cli.progress import Progress, clock_time


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_nothing_is_said_in_the_first_second_or_without_a_terminal(clock, capsys):
    for shown in (True, False):
        with Progress("draw", shown=shown, clock=clock) as progress:
            clock.now += 0.99
            progress(0.5)
            clock.now += 5 * (not shown)
            progress(0.6)
    assert capsys.readouterr() == ("", "")


def test_the_bar_tells_the_share_and_the_remaining_time(clock, capsys):
    with Progress("draw", shown=True, clock=clock) as progress:
        clock.now += 10
        progress(0.25)
        said = capsys.readouterr()
        assert said.out == ""
        assert " 25%  30 s left" in said.err  # 10 s for a quarter leaves 30 s
        assert said.err.count("#") == 8  # a quarter of 30, rounded
        clock.now += 0.05
        progress(0.26)
        assert capsys.readouterr().err == ""  # no more than ten times a second
        clock.now += 0.1
        progress(0.0)
        assert "left" not in capsys.readouterr().err  # nothing can be said of the time yet
    wiped = capsys.readouterr().err
    assert wiped.strip("\r") == " " * len(said.err.strip("\r"))
    assert wiped.endswith("\r")


@pytest.mark.parametrize(("seconds", "text"), [
    (0, "0 s"), (59.4, "59 s"), (59.6, "1 min 00 s"), (75, "1 min 15 s"),
    (3599.7, "1 h 00 min"), (3700, "1 h 01 min"),
])
def test_times_to_read_at_a_glance(seconds, text):
    assert clock_time(seconds) == text
