"""Environments of Gymnasium: drawn encounters for a policy that learns.

An action is two numbers from -1 to 1: the turn from the present course, as a share of 90 degrees to the left, and
the climb angle, as a share of the limit. An observation holds 7 numbers of the aircraft and 9 for each of the
nearest obstacles, in metres, metres a second and radians, in the frame of its course (x forward, y left, z up):
[beside the line, above it, sine and cosine of the course, climb angle, bank angle, airspeed], then
[1 if there is an obstacle, its position (3), its relative velocity (3), radius, half height].

The reward of a step is minus the share of 500 m off the line, times the decision period; entering a volume
costs 100 and ends the episode. With `shielded=True` any action flies as long as a certified way out remains;
`info["engaged"]` says where the shield flew instead.

Importing this module registers `fga/Encounter-v0`.
"""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from ._fga import Worlds

CELL = "threats:2:300:5-20"
"""The default encounters: two threats, 300 m away, 5 to 20 m/s."""


def _spaces(worlds: Worlds) -> tuple[gymnasium.spaces.Box, gymnasium.spaces.Box]:
    observed = gymnasium.spaces.Box(-np.inf, np.inf, (worlds.observed,), np.float32)
    return observed, gymnasium.spaces.Box(-1.0, 1.0, (2,), np.float32)


def _number(generator: np.random.Generator) -> int:
    return int(generator.integers(0, 2**48))


class EncounterEnv(gymnasium.Env):
    """One aircraft in one drawn encounter after another.

    `cell` names the encounters as in campaigns; `reset(options={"encounter": n})` loads encounter n.
    """

    metadata = {"render_modes": []}

    def __init__(
        self,
        cell: str = CELL,
        *,
        seed: int = 0,
        vehicle: Any = None,
        horizon_s: float = 60.0,
        seen: int = 4,
        shielded: bool = False,
        render_mode: str | None = None,
    ) -> None:
        self._worlds = Worlds(
            cell, 1, seed=seed, vehicle=vehicle, horizon_s=horizon_s, seen=seen, shielded=shielded
        )
        self.observation_space, self.action_space = _spaces(self._worlds)
        self.render_mode = render_mode

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        super().reset(seed=seed)
        number = (options or {}).get("encounter")
        number = _number(self.np_random) if number is None else int(number)
        self._worlds.reset([0], [number])
        return self._worlds.observe()[0], {"encounter": number}

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        actions = np.asarray(action, dtype=np.float64).reshape(1, -1)
        seen, rewards, terminated, truncated, engaged = self._worlds.step(actions)
        info = {"engaged": bool(engaged[0])}
        return seen[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), info


class EncounterVectorEnv(gymnasium.vector.VectorEnv):
    """Many aircraft, each in its own encounters; one call steps all of them without the interpreter's lock.

    An episode that has ended restarts at the next step (`AutoresetMode.NEXT_STEP`).
    """

    metadata = {"autoreset_mode": AutoresetMode.NEXT_STEP, "render_modes": []}

    def __init__(
        self,
        num_envs: int,
        cell: str = CELL,
        *,
        seed: int = 0,
        vehicle: Any = None,
        horizon_s: float = 60.0,
        seen: int = 4,
        shielded: bool = False,
        render_mode: str | None = None,
    ) -> None:
        self._worlds = Worlds(
            cell, num_envs, seed=seed, vehicle=vehicle, horizon_s=horizon_s, seen=seen, shielded=shielded
        )
        self.num_envs = num_envs
        self.single_observation_space, self.single_action_space = _spaces(self._worlds)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.render_mode = render_mode
        self._over = np.zeros(num_envs, dtype=bool)

    def _begin(self, places: np.ndarray) -> None:
        self._worlds.reset(places.tolist(), [_number(self.np_random) for _ in places])

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        super().reset(seed=seed)
        places = np.arange(self.num_envs)
        numbers = (options or {}).get("encounters")
        if numbers is None:
            self._begin(places)
        else:
            self._worlds.reset(places.tolist(), [int(number) for number in numbers])
        self._over[:] = False
        return self._worlds.observe(), {}

    def step(
        self, actions: Any
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        begun = self._over.copy()
        if begun.any():
            self._begin(np.flatnonzero(begun))
        seen, rewards, terminated, truncated, engaged = self._worlds.step(
            # The step of an episode that begins shows its start.
            np.asarray(actions, dtype=np.float64),
            begun.tolist(),
        )
        self._over = terminated | truncated
        return seen, rewards, terminated, truncated, {"engaged": engaged}


if "fga/Encounter-v0" not in gymnasium.registry:
    gymnasium.register(
        id="fga/Encounter-v0",
        entry_point="fga.gym:EncounterEnv",
        vector_entry_point="fga.gym:EncounterVectorEnv",
    )
