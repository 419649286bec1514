"""Balance of forces: reactions of joints, momentum of every body."""

from __future__ import annotations

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import EXACT, ROUNDING, SMALLEST_SCALE, NotComputed, Worst, check, whole
from sandbox.model.supports import LARGEST_GROUP, shared_joints
from sandbox.samples.samples import OLDER

POSES = 5
"""Number of poses in which a joint has to be redundant: near a dead centre some are in one."""
UNBALANCED = ("difference between {0} and the sum of all {1} on a body, relative to the largest, "
              "{{count:body|bodies}}, worst: {{where}}")


@check("reaction.size", source="|R|",
       asks="is each reaction the magnitude of its x and y components?",
       compared="magnitude of each reaction against its components, relative to the largest of its "
                "joint, {count:joint}, worst: {where}",
       none="there is no joint")
def _reaction_sizes(evidence: Evidence, worst: Worst) -> None:
    a = evidence.run.arrays
    if not evidence.vectors:
        raise NotComputed(OLDER)
    off = np.abs(np.hypot(*a["joint_force"].transpose(2, 0, 1)) - a["joint_reaction"])
    for j, name in enumerate(evidence.model.joints.name):
        worst.add(name, off[:, j] / whole(a["joint_reaction"][:, j]), ROUNDING)


@check("reaction.shared", source="rank of J", asks="does statics determine every joint reaction?",
       compared="joints whose reactions statics does not determine: {note}")
def _shared(evidence: Evidence, worst: Worst) -> str:
    """Joints whose reactions statics does not determine in each of a few poses."""
    model, poses = evidence.model, evidence.run.arrays["body_pose"]
    if not len(model.joints.name):
        raise NotComputed("there is no joint")
    if not evidence.joints_hold.all():
        raise NotComputed("joints were released: others share the load")
    few = np.unique(np.linspace(0, len(poses) - 1, min(len(poses), POSES)).astype(int))
    found = [shared_joints(model, poses[i]) for i in few]
    if not found[0].asked:
        raise NotComputed(f"more than {LARGEST_GROUP} forces are connected")
    shared = [model.joints.name[j] for j in sorted(set.intersection(*(f.joints for f in found)))]
    worst.judge(len(shared), 0.0)
    more = f" and {len(shared) - 6} more" if len(shared) > 6 else ""
    return "; ".join(shared[:6]) + more if shared else "none"


@check("momentum.force", source="m a = Σ F", asks="is F = m a for every body?",
       compared=UNBALANCED.format("m a", "forces"), none="nothing moves freely")
def _momentum(evidence: Evidence, worst: Worst) -> None:
    _compare(evidence, worst, 0)


@check("momentum.moment", source="I α = Σ M", asks="is M = I alpha for every body?",
       compared=UNBALANCED.format("I alpha", "moments"), none="nothing moves freely")
def _angular_momentum(evidence: Evidence, worst: Worst) -> None:
    _compare(evidence, worst, 1)


def _compare(evidence: Evidence, worst: Worst, row: int) -> None:
    """Compare the residuals of m a - sum F (``row`` 0) or of I alpha - sum M (1)."""
    if not evidence.vectors:
        raise NotComputed(OLDER)
    model, loads = evidence.model, evidence.loads
    for b in np.flatnonzero(model.bodies.free).tolist():
        force, moment = loads.largest[:, b].tolist()
        scale = max(moment, force * ROUNDING / EXACT) if row else force
        scale = max(scale, SMALLEST_SCALE)
        left = loads.left[:, b]
        error = np.abs(left[2]) if row else np.hypot(left[0], left[1])
        worst.add(model.bodies.name[b], error / scale, evidence.left_allowed[row, b] / scale)
