"""Published benchmarks: one concept a file, all of them in :data:`BENCHMARKS`."""

from sandbox.verification.benchmarks import (
    car_axis,
    driven,
    four_bars,
    pendulum,
    slider_crank,
    squeezer,
    wrapping,
)
from sandbox.verification.benchmarks.benchmark import Benchmark

BENCHMARKS: tuple[Benchmark, ...] = (
    *pendulum.BENCHMARKS, *four_bars.BENCHMARKS, *squeezer.BENCHMARKS, *car_axis.BENCHMARKS,
    *slider_crank.BENCHMARKS, *driven.BENCHMARKS, *wrapping.BENCHMARKS)

__all__ = ["BENCHMARKS", "Benchmark"]
