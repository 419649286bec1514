"""What results print as: a line, however many runs they hold."""

import numpy as np

import sandbox
from sandbox.equilibria.branches import Branch
from sandbox.equilibria.rest import RestFound
from sandbox.search.regions_found import RobustnessSheet
from sandbox.search.thresholds import ThresholdFound
from sandbox.wording import told_of

BALL = {"title": "A ball", "parameters": {"up": 1.0}, "run": {"duration": 0.01},
        "bodies": [{"name": "ball", "mass": 1, "inertia": 1, "velocity": ["=up", 0]}]}


def test_a_table_and_its_plan_print_as_a_line():
    table = sandbox.sweep(BALL, vary={"parameters.up": "1:5:5"}, keep={"x": "ball.x"}, audit=False)
    assert repr(table) == f"<SweepTable of {table.plan.name!r}: 5 runs, 1 kept, 5 done>"
    assert repr(table.plan) == f"<Plan of {table.plan.name!r}: 5 runs, 1 kept>"


def test_answers_print_as_what_they_say_first():
    found = ThresholdFound("parameters.push", "N", 4.9, 4.91, True, "speed < 1 mm/s", 20, True, "")
    assert repr(found) == told_of(found, found.lines)
    assert repr(found).startswith("<ThresholdFound: speed < 1 mm/s holds below parameters.push")
    assert len(told_of(found, ["x" * 1000, "y"])) < 130


def test_maps_and_rests_print_as_a_line():
    sheet = RobustnessSheet("2 N", 0.25, 0.2, 0.3, 0.0, (("a",),) * 40, (), None,
                            np.zeros((64, 64), dtype=int), (), None)
    assert repr(sheet) == "<RobustnessSheet at 2 N: 25 % holds, 40 cells>"
    assert repr(RestFound((), (("a", "b"),), ())) == "<RestFound: 0 at rest, 1 failed>"
    assert repr(Branch()) == "<Branch: 0 at rest, 0 folds>"
