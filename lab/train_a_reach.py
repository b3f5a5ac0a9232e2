# %% [markdown]
# # Teach a hand to reach
#
# A policy of 27 numbers learns to move a person's aim so that the hand comes to rest at a target. 24 rigs run in
# parallel, and evolution keeps the policies of the best. Needs numpy only; takes two minutes.
#
#   python3 train_a_reach.py # or cell by cell, in an editor that supports `# %%`
#     python3 train_a_reach.py --seconds 10

# %%
import argparse
import time

import numpy

from wholehand.environment import Reaching
from wholehand.rig import VectorRig

RIGS = 24       # number of candidates in a generation
TARGETS = 3     # episodes per candidate; all candidates get the same targets
BEST = 6        # candidates that the next generation is drawn from


# %% [markdown] A policy is a matrix that maps the 9 observed numbers to the 3 numbers of the action. An episode lasts 2
# s and does not end when the hand arrives, so that all rigs stay in step. A hand that arrives early loses no further
# reward as long as it stays there.

# %%
def play(rigs, task, policies, target_m, seed):
    """Mean reward per step of each policy, (rigs,), and the final distance of each hand from the target [m]."""
    rigs.reset([seed] * len(rigs))
    aim, reward = rigs.q_s.copy(), numpy.zeros(len(rigs))
    for _ in range(task.STEPS):
        seen = task.observation(rigs, aim, numpy.tile(target_m, (len(rigs), 1)))
        aim = task.aim(aim, numpy.einsum("rao,ro->ra", policies, seen))
        rigs.step(aim, task.TICKS)
        reward += task.reward(rigs, target_m)
    return reward / task.STEPS, task.distance_m(rigs, target_m)


def train(seconds, seed=0, generations=None, say=print):
    """Train: return the mean policy and the mean reward of every generation."""
    rigs = VectorRig(RIGS, scene="empty")
    task, draws = Reaching(rigs), numpy.random.default_rng(seed)
    mean, spread, curve = numpy.zeros((3, 9)), numpy.full((3, 9), 0.5), []
    began = time.monotonic()
    while time.monotonic() - began < seconds and (generations is None or len(curve) < generations):
        policies = mean + spread * draws.standard_normal((RIGS, 3, 9))
        played = [play(rigs, task, policies, task.target_m(draws), seed) for _ in range(TARGETS)]
        rewards, ends_m = numpy.mean(played, axis=0)
        best = policies[numpy.argsort(rewards)[-BEST:]]
        mean, spread = best.mean(axis=0), best.std(axis=0) + 0.02
        curve.append(rewards.mean())
        bar = "#" * round(40 * numpy.exp(curve[-1]))
        say(f"{len(curve):4d} {time.monotonic() - began:6.1f} s   reward {curve[-1]:7.3f}   ends at {1e3 * ends_m.mean():5.0f} mm {bar}")
    return mean, curve


# %% [markdown] The learning curve: a reward of -1 means that the hand is 10 cm away from the target all the time.

# %%
def main():
    parser = argparse.ArgumentParser(description="Teach a hand to reach: a linear policy, by evolution.")
    parser.add_argument("--seconds", type=float, default=120.0)
    parser.add_argument("--generations", type=int, help="at most so many")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    policy, curve = train(options.seconds, options.seed, options.generations)

    # Compares the learned policy with a policy that does nothing, at ten new targets.
    rigs = VectorRig(RIGS, scene="empty")
    task, draws = Reaching(rigs), numpy.random.default_rng(options.seed + 1)
    policies = numpy.zeros((RIGS, 3, 9))
    policies[0] = policy
    ends_m = numpy.array([play(rigs, task, policies, task.target_m(draws), 0)[1] for _ in range(10)])
    print(f"reward {curve[0]:.3f} at first, {curve[-1]:.3f} at last")
    print(f"new targets: ends at {1e3 * ends_m[:, 0].mean():.1f} mm; without a policy at {1e3 * ends_m[:, 1].mean():.1f} mm")


if __name__ == "__main__":
    main()
