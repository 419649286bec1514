"""A scene as an environment of Gymnasium.

``sandbox.gym.make`` makes one, and ``gymnasium.make("sandbox.gym:sandbox/Scene-v0", scene=…, …)``
adds Gymnasium's wrappers. Gymnasium is imported on first use.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from sandbox.errors import SandboxError

if TYPE_CHECKING:
    from sandbox.gym.env import SceneEnv

__all__ = ["ID", "make"]

ID = "sandbox/Scene-v0"  # the identifier of make in Gymnasium
HERE = f"{__name__}:make"


def make(scene: Any, *, render_mode: str | None = None, **words: Any) -> SceneEnv:
    """Make an environment of a scene.

    Args:
        scene: a file, the name of a shipped scene, or a mapping.
        render_mode: ``"rgb_array"`` for pictures by ``render()``, or None.
        words: ``observe``, ``act``, ``reward``, ``every``, ``randomise``, ``set``, ``lost``,
            ``limits``: see :func:`sandbox.gym.task.read_task`.

    Raises:
        SandboxError: Gymnasium is not installed.
        SceneError: every problem of the scene and of the arguments.
    """
    if find_spec("gymnasium") is None:
        raise SandboxError("sandbox.gym needs Gymnasium: pip install 'sandbox-mechanics[gym]'",
                           code="missing-package")
    from gymnasium.envs.registration import EnvSpec

    from sandbox.gym.env import SceneEnv
    from sandbox.gym.task import read_task
    env = SceneEnv(read_task(scene, **words), render_mode=render_mode)
    env.spec = EnvSpec(ID, entry_point=HERE, order_enforce=False, disable_env_checker=True,
                       kwargs={"scene": scene, "render_mode": render_mode, **words})
    return env


if find_spec("gymnasium") is not None:
    from gymnasium import register

    register(ID, entry_point=HERE)
