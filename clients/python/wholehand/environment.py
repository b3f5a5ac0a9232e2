"""A reaching task with the API of gymnasium, which is optional.

    from wholehand.environment import ReachEnvironment
    environment = ReachEnvironment()
    observation, info = environment.reset(seed=1)
    observation, reward, terminated, truncated, info = environment.step(environment.action_space.sample())

With gymnasium installed the class is a gymnasium.Env and has its spaces; without it, Box is a minimal replacement.
"""
from typing import Any, Dict, Optional, Tuple

import numpy
import numpy.typing

from wholehand.rig import Rig

__all__ = ["Box", "ReachEnvironment", "Reaching"]

Reals = numpy.typing.NDArray[numpy.float64]


class _PlainBox:
    """All arrays of one shape between two bounds: a minimal gymnasium.spaces.Box."""

    def __init__(self, low: Reals, high: Reals, dtype: Any = numpy.float64) -> None:
        self.low, self.high, self.dtype = numpy.asarray(low, dtype), numpy.asarray(high, dtype), numpy.dtype(dtype)
        self.shape = self.low.shape
        self._draws = numpy.random.default_rng()

    def seed(self, seed: Optional[int] = None) -> None:
        self._draws = numpy.random.default_rng(seed)

    def sample(self) -> Reals:
        """A uniformly distributed sample within the bounds; of unbounded numbers a standard normal one."""
        bounded = numpy.isfinite(self.low) & numpy.isfinite(self.high)
        low, high = numpy.where(bounded, self.low, 0.0), numpy.where(bounded, self.high, 1.0)
        drawn = numpy.where(bounded, self._draws.uniform(low, high), self._draws.standard_normal(self.shape))
        return drawn.astype(self.dtype)

    def contains(self, x: Any) -> bool:
        return (isinstance(x, numpy.ndarray) and x.shape == self.shape and numpy.can_cast(x.dtype, self.dtype)
                and bool(numpy.all(x >= self.low) and numpy.all(x <= self.high)))

    def __contains__(self, x: Any) -> bool:
        return self.contains(x)


class _PlainEnv:
    """A minimal gymnasium.Env."""
    metadata: Dict[str, Any] = {"render_modes": []}
    render_mode: Optional[str] = None
    _np_random: Optional[numpy.random.Generator] = None

    @property
    def np_random(self) -> numpy.random.Generator:
        if self._np_random is None:
            self._np_random = numpy.random.default_rng()
        return self._np_random

    def reset(self, *, seed: Optional[int] = None, options: Optional[Dict[str, Any]] = None) -> Any:
        if seed is not None:
            self._np_random = numpy.random.default_rng(seed)

    @property
    def unwrapped(self) -> Any:
        return self

    def render(self) -> None:
        return None


try:
    import gymnasium
    Box: Any = gymnasium.spaces.Box
    Env: Any = gymnasium.Env
except ImportError:
    Box, Env = _PlainBox, _PlainEnv


class Reaching:
    """The task, for one hand or for many at once: targets, observations, rewards. Arrays are (axes,) or (rigs, axes).

    The hand must come to rest at a target in the middle of its workspace. An action moves the aim, the pose that the
    person intends, by at most `MOST_M` on each axis; the person's arm, the device and its friction do the rest. """
    AXES = ("x", "y", "z")
    TICKS = 20              # ticks in a step: 0.02 s
    STEPS = 100             # steps in an episode: 2 s
    MOST_M = 0.01           # movement of the aim by an action of 1, in one step
    NEAR_M, SLOW_M_S = 0.01, 0.05
    SHARE = 0.8             # share of the workspace in which targets lie

    def __init__(self, rig: Any) -> None:
        missing = [name for name in self.AXES if name not in rig.axis_names]
        if missing:
            raise ValueError(f"the device has no axis {missing[0]}; reaching needs {', '.join(self.AXES)}")
        self.index = numpy.array([rig.axis_names.index(name) for name in self.AXES])
        self.lower, self.upper = rig.lower[self.index], rig.upper[self.index]
        self.speed_m_s = rig.speed_limit[self.index]

    def target_m(self, draws: numpy.random.Generator) -> Reals:
        middle, half = (self.lower + self.upper) / 2, (self.upper - self.lower) / 2
        return numpy.asarray(middle + self.SHARE * half * draws.uniform(-1.0, 1.0, 3))

    def aim(self, aim: Reals, action: Reals) -> Reals:
        """The next aim: moved by the action, limited to the workspace."""
        moved = aim.copy()
        moved[..., self.index] = numpy.clip(aim[..., self.index] + self.MOST_M * numpy.clip(action, -1.0, 1.0),
                                            self.lower, self.upper)
        return moved

    def observation(self, rig: Any, aim: Reals, target_m: Reals) -> Reals:
        """Vectors from the hand to the target and from the aim to the target [0.1 m], velocity [m/s]: 9 numbers."""
        hand = rig.q_s[..., self.index]
        return numpy.concatenate([10.0 * (target_m - hand), 10.0 * (target_m - aim[..., self.index]),
                                  rig.qd_s[..., self.index]], axis=-1)

    def distance_m(self, rig: Any, target_m: Reals) -> Reals:
        return numpy.asarray(numpy.linalg.norm(rig.q_s[..., self.index] - target_m, axis=-1))

    def reached(self, rig: Any, target_m: Reals) -> "numpy.typing.NDArray[numpy.bool_]":
        speed = numpy.linalg.norm(rig.qd_s[..., self.index], axis=-1)
        return numpy.asarray((self.distance_m(rig, target_m) < self.NEAR_M) & (speed < self.SLOW_M_S))

    def reward(self, rig: Any, target_m: Reals) -> Reals:
        """The negative distance [0.1 m] in a step; 0 in the step in which the hand arrives."""
        return numpy.where(self.reached(rig, target_m), 0.0, -10.0 * self.distance_m(rig, target_m))


class ReachEnvironment(Env):  # type: ignore[misc]
    """Reach for a point in empty space, and rest there.

    action: how the aim moves, (3,) in [-1, 1]. observation: Reaching.observation(). Terminated: the hand has arrived,
    or a fault has ended the run (`info["ended_by"]`). Truncated: after 2 s. The same seed and actions give the same
    bits. """
    metadata: Dict[str, Any] = {"render_modes": []}

    def __init__(self, rig: Optional[Rig] = None) -> None:
        """@param rig any rig whose device has the axes x, y, z; default: the six-axis device in empty space"""
        self.rig = rig if rig is not None else Rig(scene="empty")
        self.task = Reaching(self.rig)
        self.action_space = Box(-numpy.ones(3), numpy.ones(3), dtype=numpy.float64)
        self.observation_space = Box(numpy.full(9, -numpy.inf), numpy.full(9, numpy.inf), dtype=numpy.float64)
        self._steps = -1  # steps of the episode; -1: none has begun, or it is over

    def reset(self, *, seed: Optional[int] = None, options: Optional[Dict[str, Any]] = None) -> Tuple[Reals, Dict[str, Any]]:
        """Begins an episode. Without a seed the random targets continue the earlier sequence."""
        super().reset(seed=seed)
        self.rig.reset(int(self.np_random.integers(2 ** 31)))
        self.target_m = self.task.target_m(self.np_random)
        self._aim = self.rig.q_s.copy()
        self._steps = 0
        return self._observation(), self._info()

    def step(self, action: numpy.typing.ArrayLike) -> Tuple[Reals, float, bool, bool, Dict[str, Any]]:
        if self._steps < 0:
            raise RuntimeError("no episode runs: call reset() first")
        moves = numpy.asarray(action, float)
        if moves.shape != (3,) or not numpy.isfinite(moves).all():
            raise ValueError(f"action = {action!r}: must be 3 finite numbers in [-1, 1]")
        self._aim = self.task.aim(self._aim, moves)
        self.rig.step(self._aim, self.task.TICKS)
        self._steps += 1
        terminated = bool(self.task.reached(self.rig, self.target_m)) or not self.rig.running
        truncated = not terminated and self._steps >= self.task.STEPS
        if terminated or truncated:
            self._steps = -1
        return self._observation(), float(self.task.reward(self.rig, self.target_m)), terminated, truncated, self._info()

    def close(self) -> None:
        """Does nothing: no resource is open."""

    def _observation(self) -> Reals:
        return self.task.observation(self.rig, self._aim, self.target_m)

    def _info(self) -> Dict[str, Any]:
        return {"distance_m": float(self.task.distance_m(self.rig, self.target_m)),
                "reached": bool(self.task.reached(self.rig, self.target_m)), "target_m": self.target_m.copy(),
                "ended_by": self.rig.ended_by}
