"""PPO learns to swim forward: stable-baselines3 on 256 arms in one call of the compiled kernel.

    pip install 'tentacle-twin[learn]'
    python examples/learning/learn_to_swim.py --out policy.zip

Prints the forward speed [cm/s] of the policy as it learns, of the best sine that the same servo is told, and of the
policy at the end, each on 16 arms that it has not seen, from the third second on.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnv

from affine_model.swim.environment import EPISODE_SECONDS, SwimVectorEnv
from tentacle.io.model_file import read_model
from tentacle.model import Model

INTERVAL = 0.05  # s between commands
SETTLED = 60  # commands that are left out of a mean
SINES = np.linspace(0.3, 2.5, 23)  # Hz
Policy = Callable[[np.ndarray, int], np.ndarray]


class Arms(VecEnv):
    """SwimVectorEnv as stable-baselines3 takes it."""

    def __init__(self, arms: SwimVectorEnv, seed: int) -> None:
        self.arms = arms
        super().__init__(arms.num_envs, arms.single_observation_space, arms.single_action_space)
        self._first = seed
        self._actions = np.zeros((arms.num_envs, 1))

    def reset(self) -> np.ndarray:
        return self.arms.reset(seed=self._first)[0]

    def step_async(self, actions: np.ndarray) -> None:
        self._actions = actions

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        seen, reward, lost, over, infos = self.arms.step(self._actions)
        each: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for k in np.flatnonzero(lost | over):
            each[k] = {"terminal_observation": infos["final_obs"][k], "TimeLimit.truncated": bool(over[k] & ~lost[k])}
        return seen, reward.astype(np.float32), lost | over, each

    def close(self) -> None:
        self.arms.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        del indices
        return [getattr(self.arms, attr_name, None)] * self.num_envs

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        raise NotImplementedError(f"{attr_name} = {value!r} for {indices}: the arms share their settings")

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
        raise NotImplementedError(f"{method_name}{args}{kwargs} for {indices}: the arms are stepped together")

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        del wrapper_class, indices
        return [False] * self.num_envs


def speeds(policy: Policy, model: Model | None, count: int = 16) -> np.ndarray:
    """Forward speed of each arm (count,) [cm/s] under a policy (observation, k) -> action."""
    arms = SwimVectorEnv(count, model)
    seen, _ = arms.reset(seed=99)
    kept = []
    for k in range(round(EPISODE_SECONDS / INTERVAL) - 1):
        seen, reward, *_ = arms.step(policy(seen, k))
        kept.append(reward)
    return np.mean(kept[SETTLED:], axis=0)


class Told(BaseCallback):
    """Prints the speed at every tenth of the training."""

    def __init__(self, model: Model | None, steps: int) -> None:
        super().__init__()
        self.arm, self.every, self.next, self.start = model, steps // 10, 0, time.perf_counter()

    def _on_step(self) -> bool:
        return True

    def _on_rollout_end(self) -> None:
        if self.num_timesteps >= self.next:
            self.next += self.every
            speed = float(np.mean(speeds(greedy(self.model), self.arm)))
            print(
                f"{self.num_timesteps:8d} steps, {time.perf_counter() - self.start:5.0f} s: {speed:5.2f} cm/s",
                flush=True,
            )


def greedy(learner: Any) -> Policy:
    """The learner's mean action."""
    return lambda seen, _k: learner.predict(seen, deterministic=True)[0]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--model", type=Path, metavar="MODEL.toml", help="an identified model, default: the paper's arm"
    )
    parser.add_argument("--steps", type=int, default=1_000_000, help="of one arm each, in all, default: 1 000 000")
    parser.add_argument("--arms", type=int, default=256, help="side by side, default: 256")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, metavar="FILE.zip", help="where to keep the policy")
    arguments = parser.parse_args()
    model = None if arguments.model is None else read_model(arguments.model)
    torch.set_num_threads(1)
    learner = PPO(
        "MlpPolicy", Arms(SwimVectorEnv(arguments.arms, model), arguments.seed), seed=arguments.seed, device="cpu",
        n_steps=64, batch_size=4096, n_epochs=5, gamma=0.99, gae_lambda=0.95, learning_rate=1e-3, ent_coef=0.001,
        policy_kwargs={"net_arch": [64, 64], "log_std_init": -0.5},
    )  # fmt: skip
    start = time.perf_counter()
    learner.learn(arguments.steps, callback=Told(model, arguments.steps))
    taken = time.perf_counter() - start
    sines = speeds(lambda _seen, k: np.sin(2.0 * np.pi * SINES * k * INTERVAL)[:, None], model, len(SINES))
    print(f"best sine told to this servo: {sines.max():.2f} cm/s at {SINES[sines.argmax()]:.1f} Hz")
    print(f"learnt in {taken:.0f} s: {np.mean(speeds(greedy(learner), model)):.2f} cm/s")
    if arguments.out is not None:
        learner.save(arguments.out)


if __name__ == "__main__":
    main()
