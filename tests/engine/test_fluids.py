"""Lines of fluid against closed forms: pressures, flows, volumes, work; every kind of valve."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.elements.element import ATMOSPHERE
from sandbox.engine.inspect import inspect

from .machines import fixed, mechanism

AREA = 1e-3


def rams(*rams: tuple[str, float, float], **elements: Any) -> dict[str, Any]:
    """Bodies that slide along x on a fixed frame: name, mass and place of each."""
    return {
        "bodies": [fixed("ground"), *({"name": name, "mass": m, "inertia": 1e-3, "at": (x, 0.0)}
                                      for name, m, x in rams)],
        "joints": [{"type": "slot", "name": f"on_{name}", "a": "ground", "b": name,
                    "start": (-9, 0), "end": (9, 0), "turns": False} for name, _, _ in rams],
        **elements}


def cylinder(b: str, area: float = AREA, **more: Any) -> dict[str, Any]:
    return {"type": "cylinder", "a": "ground", "b": b, "area": area, **more}


def line(name: str, *chambers: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"name": name, "chambers": chambers, **more}


def push(body: str, value: Any) -> dict[str, Any]:
    return {"type": "force", "name": f"push_{body}", "body": body, "direction": (-1, 0),
            "value": value}


def steps(*points: tuple[float, float]) -> dict[str, Any]:
    return {"table": points, "between": "step"}


def run(scene: dict[str, Any], duration: float, step: float = 1e-3) -> sandbox.Recording:
    return sandbox.simulate(mechanism(duration=duration, step=step, **scene))


def test_a_stiff_line_damps_and_rests_where_it_must() -> None:
    """Too stiff for the step (w h = 10): it does not ring, and its mean pressure is exact."""
    recording = run(rams(("ram", 1.0, 0.1), lines=[
        line("oil", cylinder("ram"), volume=1e-5, modulus=1e9)], drives=[push("ram", 500.0)]), 0.1)
    assert recording["oil.pressure"][-1] == pytest.approx(500 / AREA, rel=1e-9)
    assert recording["ram.x"][-1] == pytest.approx(0.1 - 500 / AREA * 1e-14 / AREA, rel=1e-9)


def test_a_compressor_works_as_the_gas_has_it() -> None:
    """Of a vessel that holds x times its free air, integrated over what came: closed form.

    W = atm n / (n - 1) V ((x^n - 1) / n - x + 1). The midpoint rule is off by h^2 / 24 of how fast
    the power grows, half of the last step's work by h^2 / 8, and the gas law that a step takes
    straight adds less than h^2 / 12; it grows by n atm Q^2 / V at most.
    """
    n, volume, flow, h = 1.4, 1e-3, 2e-3, 1e-3
    scene = {"bodies": [fixed("ground"), {"name": "b", "mass": 1, "inertia": 1}],
             "lines": [line("air", volume=volume, gas=n)],
             "drives": [{"type": "flow", "name": "pump", "line": "air", "value": flow}]}
    recording = run(scene, 0.5, h)
    x = 1 + flow * recording.time[-1] / volume
    work = ATMOSPHERE * n / (n - 1) * volume * ((x**n - 1) / n - x + 1)
    assert recording["pump.work"][-1] == pytest.approx(
        work, abs=h**2 / 4 * n * ATMOSPHERE * flow**2 / volume)


def test_a_throttled_vane_turns_down_exponentially() -> None:
    """A wheel that pumps through a throttle into the tank: I dw/dt = -R D^2 w."""
    displacement, resistance, inertia = 1e-5, 1e8, 1e-3
    rate = resistance * displacement**2 / inertia
    scene = {"bodies": [fixed("ground"), {"name": "wheel", "mass": 1, "inertia": inertia,
                                          "angular_velocity": 5.0}],
             "joints": [{"type": "pin", "name": "axle", "a": "ground", "b": "wheel",
                         "on_a": (0, 0), "zero": 0.3}],
             "lines": [line("oil", {"type": "vane", "joint": "axle", "displacement": displacement},
                            volume=1e-9, pressure=0.0)],
             "valves": [{"name": "throttle", "a": "oil", "resistance": resistance}]}
    # BDF2: the decay is off by (r h)^2 / 3, the speed by / 4 after the first steps; a sample's rate
    # is a mean over its step, off by / 8, and its pressure off by 3/8 of (r h)^2 from that
    for h in (1e-3, 5e-4):
        recording = run(scene, 0.2, h)
        truth = 5 * np.exp(-rate * recording.time)
        off = (rate * h) ** 2 * (1 / (3 * math.e) + 1 / 4 + 1 / 8)
        assert np.abs(recording["axle.rate"] - truth).max() < 5 * off
        # the vane sucks, which the tank gives
        late = recording.time > 0.01
        assert recording["oil.pressure"][late] == pytest.approx(
            -resistance * displacement * truth[late],
            abs=resistance * displacement * 5 * (off + 3 / 8 * (rate * h) ** 2))


@pytest.mark.parametrize("resistance", [1e4, 1e9, 3e9, 1e10])
def test_a_wide_valve_does_not_overshoot(resistance: float) -> None:
    """From 1 MPa into two vessels, one after the other: pressures even out without crossing."""
    scene = {"bodies": [fixed("ground"), {"name": "b", "mass": 1, "inertia": 1}],
             "lines": [line("one", volume=1e-3, pressure=1e6), line("two", volume=1e-4),
                       line("three", volume=5e-4)],
             "valves": [{"name": "first", "a": "one", "b": "two", "resistance": resistance},
                        {"name": "second", "a": "two", "b": "three", "resistance": resistance}]}
    recording = run(scene, 0.2)
    one, two, three = (recording[f"{name}.pressure"] for name in ("one", "two", "three"))
    assert (one - two).min() > -1e-3
    assert (two - three).min() > -1e-3
    assert one[-1] == pytest.approx(1e6 / 1.6, rel=1e-5)


def test_a_check_valve_lets_in_and_holds() -> None:
    """It opens for the pump; then 2 kN rest on the oil, and nothing comes back."""
    recording = run(rams(("ram", 10.0, 0.1), lines=[
        line("oil", cylinder("ram")), line("source", volume=1e-5)],
        valves=[{"name": "check", "a": "source", "b": "oil", "area": 5e-6, "one_way": True}],
        drives=[push("ram", steps((0, 500), (0.15, 2000))),
                {"type": "pressure", "name": "pump", "line": "source", "value": 1e6}]), 0.6)
    assert recording["check.flow"].min() == 0.0
    assert recording["check.flow"][(recording.time > 0.1) & (recording.time < 0.14)].min() > 0
    late = recording.time > 0.3
    assert (recording["check.flow"][late] == 0.0).all()
    assert recording["oil.pressure"][-1] == pytest.approx(2e6, rel=1e-7)
    assert np.abs(recording["ram.vx"][-1]) < 1e-9


def test_a_relief_lets_out_and_the_work_adds_up() -> None:
    """Against a stop the line stays at its relief's pressure, and all that comes is spilled."""
    scene = rams(("ram", 10.0, 0.1), lines=[line("oil", cylinder("ram"), relief=2e6,
                                                 volume=1e-4)],
                 drives=[{"type": "flow", "name": "pump", "line": "oil", "value": 1e-5}])
    scene["joints"][0]["end"] = (0.101, 0.0)
    recording = run(scene, 0.5)
    assert recording["oil.pressure"][-1] == pytest.approx(2e6, rel=1e-12)
    assert recording["on_ram.reaction"][-1] == pytest.approx(2000, rel=1e-9)
    late = recording.time > 0.4
    spilled = np.gradient(recording["oil.spilled"][late], recording.time[late])
    assert spilled == pytest.approx(1e-5, rel=1e-6)
    assert recording["pump.work"][-1] - recording["pump.work"][-101] == pytest.approx(
        2e6 * 1e-5 * 0.1, rel=1e-9)


def test_a_shut_valve_holds_and_an_open_one_lets_down() -> None:
    """Laminar: v = p / (R A), at half an opening half of it."""
    resistance = 1e9
    recording = run(rams(("ram", 10.0, 0.5), lines=[line("oil", cylinder("ram"), pressure=1e6)],
                         valves=[{"name": "tap", "a": "oil", "resistance": resistance}],
                         drives=[push("ram", 1000.0),
                                 {"type": "opening", "name": "lever", "valve": "tap",
                                  "value": steps((0, 0), (0.1, 0.5), (0.3, 2))}]), 0.5)

    def speed(t: float) -> float:
        return float(np.interp(t, recording.time, recording["ram.vx"]))

    assert speed(0.08) == pytest.approx(0.0, abs=1e-9)
    assert speed(0.28) == pytest.approx(-0.5 * 1e6 / resistance / AREA, rel=1e-6)
    assert speed(0.48) == pytest.approx(-1e6 / resistance / AREA, rel=1e-6)
    assert recording["tap.loss"][-1] > 0


def test_a_void_pulls_with_its_least_pressure() -> None:
    """1 m/s out against 0.1 MPa: 10 mm and 20 ms, by the closed form of a parabola."""
    scene = rams(("ram", 10.0, 0.1), lines=[line("oil", cylinder("ram", 5e-3), least=-1e5,
                                                 modulus=1e12)])
    scene["bodies"][1]["velocity"] = (1.0, 0.0)
    recording = run(scene, 0.03, 5e-4)
    assert recording["ram.x"].max() - 0.1 == pytest.approx(0.01, abs=50 * 2.5e-4**2 / 2 + 1e-6)
    assert recording.time[np.argmax(recording["ram.x"])] == pytest.approx(0.02, abs=5e-4)
    assert recording["oil.pressure"].min() == -1e5


def test_flow_keeps_a_mechanism_awake() -> None:
    """Nothing moves, but one vessel fills the other: that is no rest."""
    scene = {"bodies": [fixed("ground"), {"name": "b", "mass": 1, "inertia": 1}],
             "lines": [line("one", volume=1e-3, pressure=1e6), line("two", volume=1e-3)],
             "valves": [{"name": "tap", "a": "one", "b": "two", "resistance": 1e12}]}
    recording = run(scene, 2.0, 1e-3)
    c = 1e-3 / 1.4e9
    truth = 5e5 * np.exp(-recording.time * 2 / (1e12 * c)) + 5e5
    # the trapezoid rule: the decay is off by (r h)^2 / 12, a step's mean by / 8
    off = (1e-3 * 2 / (1e12 * c)) ** 2 * (1 / (12 * math.e) + 1 / 8)
    assert np.abs(recording["one.pressure"] - truth).max() < 5e5 * off


def test_a_pump_without_an_outlet_is_an_error() -> None:
    """Before the run, and when the pressure has left all range: with the line's name."""
    scene = {"bodies": [fixed("ground"), {"name": "b", "mass": 1, "inertia": 1}],
             "lines": [line("oil", volume=1e-9, modulus=1e12)],
             "drives": [{"type": "flow", "name": "pump", "line": "oil", "value": 1.0}]}
    machine = mechanism(duration=1.0, step=1e-3, **scene)
    assert ["but no relief" in p.message for p in inspect(machine)
            if p.element == "oil"] == [False, True]
    with pytest.raises(sandbox.SimulationDiverged, match="oil: its pressure has run away"):
        sandbox.simulate(machine)


def test_a_cylinder_without_a_direction_is_refused() -> None:
    scene = rams(("ram", 1.0, 0.0), lines=[line("oil", cylinder("ram"), volume=1e-3)])
    with pytest.raises(sandbox.SceneError, match="the two points of its cylinder 0 coincide"):
        sandbox.simulate(mechanism(**scene))
