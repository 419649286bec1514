"""Tendon (8)-(19), springs (20)-(30) and chain (31) along a closing motion."""

from __future__ import annotations

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.tendon import route
from sandbox.study.plain_mechanisms import BODIES
from sandbox.study.reference_fingers import SET_G
from sandbox.verification.cases.case import Case, Check, Findings
from sandbox.verification.cases.closing import (
    MECHANISM,
    angles,
    closed_tips,
    closing,
    gap_bounds,
    gaps,
    origins,
    segments,
)

ROUNDING = 1e-14
"""Of lengths of some centimetres, summed over a dozen operations [m]."""
DRIFT = "largest gap of the hinges it spans, as measured; how large that may be, see the chain"


def _tendon() -> Findings:
    run = closing()
    cord, theta = route(SET_G.guides, SET_G.lengths), angles(run)
    length, engine = cord.lengths(theta).sum(axis=1), run["finger.tendon.length"]
    shortened, shown = cord.shortening(theta), run["finger.tendon.shortening"]
    allowed = float(gaps(run).sum(axis=1).max()) + ROUNDING
    ms = 1e3 * run.time
    parts = segments(run)
    local = cord.lengths(np.zeros(3)) - parts
    return Findings([
        *(Check(f"segment over joint {i + 1}, largest difference", "m", 0.0,
                float(np.abs(parts[:, i] - cord.lengths(theta)[:, i]).max()),
                float(gaps(run)[:, i].max()) + ROUNDING, DRIFT) for i in range(3)),
        Check("tendon length, largest difference", "m", 0.0,
              float(np.abs(length - engine).max()), allowed, DRIFT),
        Check("shortening, largest difference", "m", 0.0,
              float(np.abs(shortened - shown).max()), allowed, DRIFT),
        Check("shortening at the end", "m", float(shortened[-1]), float(shown[-1]), allowed, DRIFT),
    ], [
        Panel("Shortening of the tendon", "time [ms]", "shortening [mm]", [
            Curve("(19)", ms, 1e3 * shortened), Curve("engine", ms[::6], 1e3 * shown[::6],
                                                      "points")]),
        Panel("Of each segment", "time [ms]", "shortening [mm]", [
            c for i in range(3) for c in (
                Curve(f"joint {i + 1}, (18)", ms, 1e3 * cord.shortenings(theta)[:, i]),
                Curve(f"joint {i + 1}, engine", ms[::6], 1e3 * local[::6, i], "points"))]),
    ])


def _springs() -> Findings:
    run = closing()
    springs, theta = spring_set(SET_G.before, SET_G.after), angles(run)
    length = springs.lengths(theta)
    stretch = springs.elongations(theta)
    checks, curves = [], []
    ms, gap = 1e3 * run.time, gaps(run)
    for i in range(3):
        name = f"finger.spring{i + 1}"
        allowed = float(gap[:, i].max()) + ROUNDING
        engine, force = run[f"{name}.length"], run[f"{name}.force"]
        checks += [
            Check(f"length of spring {i + 1}, largest difference", "m", 0.0,
                  float(np.abs(engine - length[:, i]).max()), allowed, DRIFT),
            Check(f"force of spring {i + 1} against k Δlm, largest difference", "N", 0.0,
                  float(np.abs(force - SET_G.stiffness[i] * stretch[:, i]).max()),
                  SET_G.stiffness[i] * allowed, "stiffness times the same gap")]
        curves += [Curve(f"spring {i + 1}, (30)", ms, 1e3 * stretch[:, i]),
                   Curve(f"spring {i + 1}, engine", ms[::6],
                         1e3 * (engine - springs.lengths(np.zeros(3))[i])[::6], "points")]
    return Findings(checks, [Panel("Elongation of the springs", "time [ms]", "elongation [mm]",
                                   curves)])


def _chain() -> Findings:
    run = closing()
    tips, at = closed_tips(run), origins(run)
    allowed = float(gaps(run).sum(axis=1).max()) + ROUNDING
    angle = np.stack([run[f"{body}.angle"] for body in BODIES], axis=1)
    far = at + np.array(SET_G.lengths)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=2)
    checks = [Check(f"far end of the {name.partition('.')[2]} phalanx, largest distance", "m", 0.0,
                    float(np.linalg.norm(far[:, i] - tips[:, i], axis=1).max()), allowed, DRIFT)
              for i, name in enumerate(BODIES)]
    checks += [Check(f"gap of hinge {i + 1}, largest", "m", 0.0, float(gaps(run)[:, i].max()),
                     1.05 * float(gap_bounds(run)[i]),
                     "a step along the tangent, corrected by r (ω h)²/2 of the step before, leaves "
                     "r ω α h³ + r (ω h)³/6 on either side; 5 % for their change within it")
               for i in range(3)]
    curves = []
    for i, name in enumerate(("proximal", "middle", "distal")):
        curves += [Curve(f"{name}, (31)", 1e3 * tips[:, i, 0], 1e3 * tips[:, i, 1]),
                   Curve(f"{name}, engine", 1e3 * far[::6, i, 0], 1e3 * far[::6, i, 1], "points")]
    return Findings(checks, [Panel("Paths of the phalanges' far ends", "x [mm]", "y [mm]",
                                   curves, scale="plane")])


CASES = (
    Case("tendon", "Tendon segments and shortening", "(8)–(19)", MECHANISM,
         "recorded length and shortening with the triangles at the recorded joint angles",
         _tendon),
    Case("springs", "Elastic elements", "(20)–(30)", MECHANISM,
         "recorded spring lengths and forces with the triangles at the recorded joint angles",
         _springs),
    Case("chain", "Chain of phalanges", "(31)", MECHANISM,
         "recorded poses with the product of transforms at the recorded joint angles", _chain),
)
