"""Published benchmarks: one concept a file, all of them in :data:`BENCHMARKS`."""

from sandbox.verification.benchmarks import (
    bouncing_ball,
    cam,
    car_axis,
    driven,
    first_touch,
    four_bars,
    friction_oscillator,
    painleve,
    pendulum,
    pinch,
    rocking_block,
    rolling_disc,
    slider_crank,
    slider_with_play,
    squeezer,
    struck_row,
    toppling_rod,
    woodpecker,
    wrapping,
)
from sandbox.verification.benchmarks.benchmark import Benchmark

BENCHMARKS: tuple[Benchmark, ...] = (
    *pendulum.BENCHMARKS, *four_bars.BENCHMARKS, *squeezer.BENCHMARKS, *car_axis.BENCHMARKS,
    *slider_crank.BENCHMARKS, *driven.BENCHMARKS, *wrapping.BENCHMARKS, *bouncing_ball.BENCHMARKS,
    *rocking_block.BENCHMARKS, *struck_row.BENCHMARKS, *slider_with_play.BENCHMARKS,
    *first_touch.BENCHMARKS, *woodpecker.BENCHMARKS, *toppling_rod.BENCHMARKS,
    *painleve.BENCHMARKS, *friction_oscillator.BENCHMARKS, *rolling_disc.BENCHMARKS,
    *cam.BENCHMARKS, *pinch.BENCHMARKS)

__all__ = ["BENCHMARKS", "Benchmark"]
