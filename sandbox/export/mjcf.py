"""A mechanism as a MuJoCo model (MJCF): the same bodies, joints, cords, contacts and drives.

The plane is x-y and z points at the viewer, so that a hinge turns about z and
a body moves by what carries it in the mechanism's tree (:mod:`tree`); joints
that close loops become equality constraints. Contacts are explicit pairs. All
is SI, under the scene's own names.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import sandbox
from sandbox.errors import SceneError
from sandbox.export.exported import Export
from sandbox.export.mjcf_bodies import add_bodies, sense_bodies
from sandbox.export.mjcf_cords import add_springs, add_tendons
from sandbox.export.mjcf_document import Draft
from sandbox.export.mjcf_drives import add_drives, add_start
from sandbox.export.mjcf_joints import add_closing_angles, add_links
from sandbox.export.omission import leave_out
from sandbox.export.pairs import touching_pairs
from sandbox.export.tree import grow
from sandbox.export.unsupported import without_counterpart
from sandbox.export.xmltext import add, comment, document, number
from sandbox.model.compile import compile_mechanism
from sandbox.scene.mechanism import Mechanism

STIFFNESS = "0.9999 0.9999 0.001 0.5 2"
"""solimp: the hardest constraint that MuJoCo allows, whatever its depth."""
IMPEDANCE_RATIO = 10.0
"""Of friction against normal force; MuJoCo's contacts creep, the less the larger it is."""


def write_mjcf(mechanism: Mechanism, *, without: Sequence[str] = ()) -> Export:
    """``mechanism`` as a MuJoCo model, without the elements that ``without`` names.

    Raises:
        SceneError: elements that have no counterpart, or names that fit none.
    """
    kept, left_out = leave_out(mechanism, without)
    model = compile_mechanism(kept)
    tree = grow(model)
    if problems := without_counterpart(model, tree):
        raise SceneError(problems)
    draft = Draft(model, tree)
    add_springs(draft)
    step = min(kept.run.step, add_tendons(draft))
    add_links(draft)
    add_drives(draft)
    add_closing_angles(draft)
    sense_bodies(draft)
    geoms = add_bodies(draft)
    _add_pairs(draft, geoms)
    add_start(draft)
    _add_settings(draft, step)
    if step < kept.run.step:
        draft.notes.append(f"an elastic tendon takes a time step of {number(step)} s here, "
                           f"not {number(kept.run.step)} s")
    return Export(document(draft.root), tuple(draft.notes), left_out)


def _add_settings(draft: Draft, step: float) -> None:
    mechanism, sections = draft.mechanism, draft.sections
    head = (f"{mechanism.title or mechanism.name or 'A mechanism'}; written by sandbox "
            f"{sandbox.__version__}. SI units; the plane is x-y.")
    draft.root.insert(0, comment(head))
    for name, text in {"angle": "radian", "autolimits": "true", "inertiafromgeom": "false"}.items():
        sections["compiler"].set(name, text)
    option: Mapping[str, str] = {
        "timestep": number(step),
        "gravity": f"{number(mechanism.gravity[0])} {number(mechanism.gravity[1])} 0",
        "integrator": "implicitfast", "cone": "elliptic", "impratio": number(IMPEDANCE_RATIO),
        "solver": "Newton", "iterations": "200", "tolerance": "1e-12",
    }
    for name, text in option.items():
        sections["option"].set(name, text)
    hard = f"{number(2 * step)} 1"  # the shortest time constant that MuJoCo takes
    defaults = sections["default"]
    # a brake creeps, as friction does in MuJoCo, but the least that it can
    braked = any(hinge.brake is not None for hinge in draft.hinges.values())
    friction = {"solreffriction": hard, "solimpfriction": STIFFNESS} if braked else {}
    add(defaults, "joint", solreflimit=hard, solimplimit=STIFFNESS, **friction)
    add(defaults, "geom", contype="0", conaffinity="0")
    add(defaults, "site", size=0.0008, rgba="0.2 0.2 0.2 1")
    add(defaults, "tendon", solreflimit=hard, solimplimit=STIFFNESS, **friction)
    add(defaults, "equality", solref=hard, solimp=STIFFNESS)
    # a contact that slides chatters less with twice that
    add(defaults, "pair", solref=f"{number(4 * step)} 1", solimp=STIFFNESS)


def _add_pairs(draft: Draft, geoms: Mapping[str, Sequence[str]]) -> None:
    """A contact pair for any two shapes that may touch; ``condim`` 1 has no friction."""
    for pair in touching_pairs(draft.mechanism):
        for a in geoms[pair.a.name]:
            for b in geoms[pair.b.name]:
                add(draft.sections["contact"], "pair", geom1=a, geom2=b,
                    condim="3" if pair.friction else "1",
                    friction=(pair.friction, pair.friction) if pair.friction else None)
