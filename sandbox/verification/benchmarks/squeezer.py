"""Andrews' squeezing mechanism (Schiehlen 1990; IVP test set): seven bodies, three loops, 30 ms.

K1 turns about the origin under a constant torque, K2 leads from its end to E; K3 (about B),
K4 on K5 and K6 on K7 (both about A) hold E, and a spring leads from K3 to C. Angles here are the
bodies' own in the plane: beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon.
"""

from __future__ import annotations

import cmath

from sandbox.verification.benchmarks.benchmark import Benchmark, Criterion, Json, at, spelled
from sandbox.verification.benchmarks.pieces import GROUND, body, pin, point

A, B, C = -0.06934 - 0.00227j, -0.03635 + 0.03273j, 0.014 + 0.072j
D, DA, E, EA = 28e-3, 115e-4, 2e-2, 1421e-5
RR, RA, SS, SA, SB, SC, SD = 7e-3, 92e-5, 35e-3, 1874e-5, 1043e-5, 18e-3, 2e-2
TA, TB, U, UA, UB, ZF, ZT, FA = 2308e-5, 916e-5, 4e-2, 1228e-5, 449e-5, 2e-2, 4e-2, 1421e-5
MASSES = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)
INERTIAS = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)
TORQUE, STIFFNESS, REST = 0.033, 4530.0, 0.07785
BETA, THETA, GAMMA, PHI, DELTA, OMEGA, EPSILON = (
    -0.0617138900142764496358948458001, 0.0, 0.455279819163070380255912382449,
    0.222668390165885884674473185609, 0.487364979543842550225598953530,
    -0.222668390165885884674473185609, 1.23054744454982119249735015568)
START = (BETA, BETA + THETA, GAMMA, PHI + DELTA, DELTA, OMEGA + EPSILON, EPSILON)
KEPT = {"beta": 15.81077119629904, "theta": -15.75637105984298, "gamma": 0.04082224013073101,
        "phi": -0.5347301163226948, "delta": 0.5244099658805304, "omega": 0.5347301163226948,
        "epsilon": 1.048080741042263}
"""Of the test set at 0.03 s [rad]."""
ANGLES = {"beta": "k1.angle", "theta": "k2.angle - k1.angle", "gamma": "k3.angle",
          "phi": "k4.angle - k5.angle", "delta": "k5.angle", "omega": "k6.angle - k7.angle",
          "epsilon": "k7.angle"}
"""The test set's, of the bodies' own."""
END = 0.03
FASTEST = 1200.0
"""K1 at the end: 1140 rad/s."""


def scene(step: float) -> Json:
    """Frames at O, F, B, G, A, H and A, at rest."""
    turned = [cmath.exp(1j * angle) for angle in START]
    places = (0.0, RR * turned[0], B, A + ZT * turned[4], A, A - 1j * U * turned[6], A)
    centres = (RA, -DA, SB - 1j * SA, -1j * (E - EA), TB - 1j * TA, ZF - FA, -UB - 1j * UA)
    bodies = [body(f"k{i + 1}", places[i], START[i], centres[i], MASSES[i], INERTIAS[i])
              for i in range(7)]
    joints = [
        pin("ground", "k1"), pin("k1", "k2"), pin("ground", "k3"), pin("ground", "k5"),
        pin("ground", "k7"), pin("k5", "k4"), pin("k7", "k6"), pin("k2", "k3", -1j * SS),
        pin("k2", "k4", -1j * E), pin("k2", "k6", ZF)]
    return spelled(
        END, step, bodies=[GROUND, *bodies], joints=joints,
        springs=[{"type": "linear", "name": "spring", "a": "ground", "b": "k3",
                  "on_a": point(C), "on_b": [SD, -SC], "stiffness": STIFFNESS,
                  "rest_length": REST}],
        drives=[{"type": "torque", "name": "motor", "joint": "ground_k1", "value": TORQUE}],
        meters=[{"name": name, "value": f"={of}", "unit": "rad"} for name, of in ANGLES.items()])


BENCHMARKS = (Benchmark(
    "andrews", "Andrews' squeezer",
    "Seven bodies of some centimetres in three loops, a spring of 4530 N/m, and a torque of 33 "
    "mN m that turns the crank two and a half times within 30 ms, up to 1140 rad/s.",
    "Schiehlen (1990); Test Set for IVP Solvers (Mazzia and Magherini, Bari), Andrews' squeezing "
    "mechanism. All digits are the test set's.",
    "Nothing.",
    scene, (4e-6, 2e-6, 1e-6),
    (Criterion("the seven angles", "rad", [at(name, END, x) for name, x in KEPT.items()],
               KEPT["beta"], FASTEST, "the crank's way times (h ω)², ω the crank's at the end"),),
    {"bodies[k5].mass": 1.01 * MASSES[4]}, quick=(1e-5, 5e-6),
    drawn="Andrews' squeezer"),)
