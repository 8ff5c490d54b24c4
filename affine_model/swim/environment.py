"""The swimming arm as gymnasium environments: one arm, and many in one call of the compiled kernel.

    gymnasium.make("tentacle/Swim-v0")
    gymnasium.make_vec("tentacle/Swim-v0", num_envs=4096)

Action: u in [-1, 1], the angle that the servo goes to, over its largest. Observation: affine_model.swim.swimmers.
Reward: forward speed over the interval [cm/s]. An arm that leaves all bounds ends its episode (terminated); after
`seconds` it is truncated. model: an identified model, its effects acting; default: the paper's 21 cm arm.
"""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from affine_model.swim.silicones import assumed_model, paper_cone
from affine_model.swim.swimmers import LARGEST_OBSERVATION, Flags, Swimmers
from tentacle.model import Model

AnyArray = NDArray[Any]

ID = "tentacle/Swim-v0"
EPISODE_SECONDS = 10.0
START_SPREAD = 0.5  # of the largest angle: how far from straight an arm is when an episode begins
CM = 100.0


def _spaces(order: int) -> tuple[Box, Box]:
    """Observation and action of one arm."""
    return Box(-LARGEST_OBSERVATION, LARGEST_OBSERVATION, (2 * order + 4,), np.float32), Box(
        -1.0, 1.0, (1,), np.float32
    )


def _model(model: Model | None) -> Model:
    return assumed_model(paper_cone(0.21), "dragon-skin-10") if model is None else model


class SwimEnv(gymnasium.Env[AnyArray, AnyArray]):
    """One arm on its rail."""

    metadata = {"render_modes": []}  # noqa: RUF012 - gymnasium's own way to say it

    def __init__(self, model: Model | None = None, seconds: float = EPISODE_SECONDS, **settings: Any) -> None:
        """settings: rail, servo, interval, substeps, as Swimmers takes them."""
        self._swimmers = Swimmers(_model(model), 1, **settings)
        self.observation_space, self.action_space = _spaces(self._swimmers.arm.order)
        self._last = round(seconds / self._swimmers.interval)
        self._taken = 0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[AnyArray, dict[str, Any]]:
        """At rest, straight, at an angle drawn at random."""
        super().reset(seed=seed, options=options)
        largest = START_SPREAD * self._swimmers.limits.angle
        self._swimmers.reset(np.ones(1, dtype=bool), self.np_random.uniform(-largest, largest, 1))
        self._taken = 0
        return self._swimmers.observed()[0].astype(np.float32), {}

    def step(self, action: AnyArray) -> tuple[AnyArray, float, bool, bool, dict[str, Any]]:
        """One command."""
        tick = self._swimmers.command(np.asarray(action, dtype=float))
        self._taken += 1
        reward = float(CM * tick.forward[0] / self._swimmers.interval)
        seen = self._swimmers.observed()[0].astype(np.float32)
        return seen, reward, bool(tick.lost[0]), self._taken >= self._last, {"power_w": float(tick.power[0])}


class SwimVectorEnv(VectorEnv[AnyArray, AnyArray, AnyArray]):
    """B arms, each on its own rail; one that ended begins anew in the same step, its last observation in
    infos["final_obs"].
    """

    metadata = {"autoreset_mode": AutoresetMode.SAME_STEP, "render_modes": []}  # noqa: RUF012 - as above

    def __init__(
        self, num_envs: int = 1, model: Model | None = None, seconds: float = EPISODE_SECONDS, **settings: Any
    ) -> None:
        """settings: rail, servo, interval, substeps, as Swimmers takes them."""
        self.num_envs = num_envs
        self._swimmers = Swimmers(_model(model), num_envs, **settings)
        self.single_observation_space, self.single_action_space = _spaces(self._swimmers.arm.order)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._last = round(seconds / self._swimmers.interval)
        self._taken = np.zeros(num_envs, dtype=int)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[AnyArray, dict[str, Any]]:
        """All at rest, straight, at angles drawn at random."""
        super().reset(seed=seed, options=options)
        self._begin(np.ones(self.num_envs, dtype=bool))
        return self._observed(), {}

    def step(self, actions: AnyArray) -> tuple[AnyArray, AnyArray, AnyArray, AnyArray, dict[str, Any]]:
        """One command each, actions (B, 1)."""
        tick = self._swimmers.command(np.asarray(actions, dtype=float)[:, 0])
        self._taken += 1
        over = self._taken >= self._last
        ended = tick.lost | over
        infos: dict[str, Any] = {"power_w": tick.power}
        seen = self._observed()
        if ended.any():
            infos |= {"final_obs": seen, "_final_obs": ended}
            self._begin(ended)
            seen = self._observed()
        return seen, CM * tick.forward / self._swimmers.interval, tick.lost, over, infos

    def _begin(self, which: Flags) -> None:
        largest = START_SPREAD * self._swimmers.limits.angle
        self._swimmers.reset(which, self.np_random.uniform(-largest, largest, int(which.sum())))
        self._taken[which] = 0

    def _observed(self) -> AnyArray:
        return self._swimmers.observed().astype(np.float32)


def register() -> None:
    """Make the environments known to gymnasium, which calls this itself where the package is installed."""
    if ID not in gymnasium.registry:
        gymnasium.register(ID, entry_point=f"{__name__}:SwimEnv", vector_entry_point=f"{__name__}:SwimVectorEnv")
