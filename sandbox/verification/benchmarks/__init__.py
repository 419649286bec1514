"""Published benchmarks: one concept a file, all of them in :data:`BENCHMARKS`."""

from sandbox.verification.benchmarks import car_axis
from sandbox.verification.benchmarks.benchmark import Benchmark

BENCHMARKS: tuple[Benchmark, ...] = (*car_axis.BENCHMARKS,)

__all__ = ["BENCHMARKS", "Benchmark"]
