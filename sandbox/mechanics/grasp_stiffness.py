"""How stiffly compliant fingers hold a body: K = G (1/Kc + J 1/Kq J^T)^-1 G^T.

The body moves by u = (x, y, turn), its contact points by G^T u. The spring Kc of a contact and the
finger with the springs Kq of its joints carry the contact's force in series; G sums the forces of
all contacts (Cutkosky and Kao 1989). Contacts hold in both directions, without slip. The change of
existing forces with the rotation of the body is left out: it is the stiffness of a light grasp.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sandbox.mechanics.checks import matrix, points, positive
from sandbox.numeric import Array

SINGULAR = 1e-12  # compliance in one direction below this share of that in another counts as none


def grasp_map(contacts: ArrayLike, centre: ArrayLike) -> Array:
    """G, shape [3, 2 m]: forces (x, y) at contacts [m], [m, 2], to the wrench about ``centre``."""
    at = points("contacts", contacts)
    arm = matrix("contacts", at, "m") - points("centre", centre)
    G = np.zeros((3, 2 * len(at)))
    G[0, 0::2] = G[1, 1::2] = 1.0
    G[2, 0::2], G[2, 1::2] = -arm[:, 1], arm[:, 0]
    return G


def tip_jacobian(contacts: ArrayLike, hinges: ArrayLike, moves: ArrayLike) -> Array:
    """J, shape [2 m, n]: rates of hinges to velocities (x, y) of the points that touch.

    Args:
        contacts: points in the world [m], shape [m, 2].
        hinges: in the world [m], shape [n, 2]; turns count counter-clockwise.
        moves: whether each contact's point is moved by each hinge, shape [m, n] of bool.
    """
    p, c, on = points("contacts", contacts), points("hinges", hinges), np.asarray(moves, bool)
    if on.shape != (len(p), len(c)):
        raise ValueError(f"moves must have a boolean for each of {len(p)} contacts and {len(c)} "
                         f"hinges, got shape {on.shape}")
    arm = (p[:, None] - c) * on[..., None]
    J = np.empty((2 * len(p), len(c)))
    J[0::2], J[1::2] = -arm[..., 1], arm[..., 0]
    return J


def grasp_stiffness(
    grasp: ArrayLike, jacobian: ArrayLike, joint_stiffness: ArrayLike, *,
    contact_stiffness: ArrayLike = np.inf,
) -> Array:
    """K, shape [3, 3] in N/m, N and N m: a small motion u of the body gives the wrench -K u.

    Args:
        grasp: G, shape [3, 2 m].
        jacobian: J [m], shape [2 m, n].
        joint_stiffness: of the hinges one by one [N m/rad], > 0, shape [n], or all of Kq,
            symmetric, shape [n, n]: an elastic tendon of k [N/m] with arms h adds k h h^T.
        contact_stiffness: Kc of every direction of every contact [N/m], of one number or shape
            [2 m]; rigid by default.

    Raises:
        ValueError: a grasp that is rigid in some direction.
    """
    G, J = matrix("grasp", grasp, "m"), matrix("jacobian", jacobian, "m")
    if len(G) != 3 or len(J) != G.shape[1]:
        raise ValueError(f"jacobian must have a row for each column of grasp, got shapes "
                         f"{J.shape} and {G.shape}")
    n, Kq = J.shape[1], np.asarray(joint_stiffness, dtype=np.float64)
    if Kq.shape == (n,):
        Kq = np.diag(positive("joint_stiffness", Kq, "N m/rad"))
    elif Kq.shape != (n, n):
        raise ValueError(f"joint_stiffness must have shape [{n}] or [{n}, {n}] in N m/rad, "
                         f"got {Kq.shape}")
    elif not np.allclose(Kq, Kq.T, rtol=1e-9) or np.linalg.eigvalsh(Kq)[0] <= 0:
        raise ValueError("joint_stiffness must be symmetric and positive definite in N m/rad")
    gives = J @ np.linalg.inv(Kq) @ J.T
    soft = np.asarray(contact_stiffness, dtype=np.float64)
    if not (soft > 0).all():
        raise ValueError("contact_stiffness must be greater than 0 N/m")
    gives += np.diag(np.broadcast_to(1 / soft, len(gives)))
    values = np.linalg.eigvalsh(gives)
    if values[0] <= SINGULAR * values[-1]:
        raise ValueError("contact_stiffness must be finite where no joint lets a contact give way: "
                         f"got {n} joints for {len(J)} directions of contacts")
    return np.asarray(G @ np.linalg.solve(gives, G.T))
