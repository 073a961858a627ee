"""Ring 3: environments of Gymnasium, and the shield."""

import gc
import resource

import numpy as np
import pytest
from conftest import needed

import fga

gymnasium = needed("gymnasium")
from gymnasium.utils.env_checker import check_env  # noqa: E402

import fga.gym  # noqa: E402


def test_gymnasiums_own_checker_passes():
    check_env(gymnasium.make("fga/Encounter-v0").unwrapped)


def test_the_vector_environment_is_the_single_one_side_by_side():
    count = 6
    many = gymnasium.make_vec("fga/Encounter-v0", num_envs=count, vectorization_mode="vector_entry_point")
    one = [fga.gym.EncounterEnv() for _ in range(count)]
    rng = np.random.default_rng(2)
    seen, _ = many.reset(seed=1, options={"encounters": range(count)})
    for place, env in enumerate(one):
        first, info = env.reset(options={"encounter": place})
        assert info["encounter"] == place and np.array_equal(first, seen[place])
    assert seen in many.observation_space
    ended = np.zeros(count, dtype=bool)
    for _ in range(700):
        actions = rng.uniform(-1, 1, (count, 2)).astype(np.float32)
        seen, rewards, terminated, truncated, _ = many.step(actions)
        for place in np.flatnonzero(~ended):
            told = one[place].step(actions[place])
            assert np.array_equal(told[0], seen[place]) and told[1] == rewards[place]
            assert (told[2], told[3]) == (terminated[place], truncated[place])
        ended |= terminated | truncated
    assert ended.all()


def test_an_episode_that_ended_begins_anew_at_the_next_step():
    many = fga.gym.EncounterVectorEnv(4, horizon_s=1.0)
    many.reset(seed=3)
    before = None
    for step in range(23):
        seen, rewards, _, truncated, _ = many.step(np.zeros((4, 2)))
        if before is not None and before.all():
            assert (rewards == 0).all() and (seen[:, :2] == 0).all(), "the start of another episode"
        before = truncated
    assert step == 22


def fly(shielded, episodes=24):
    """Flies a random policy; returns how many episodes enter a volume, and how often the shield flew."""
    env = fga.gym.EncounterEnv(shielded=shielded)
    entered = engaged = 0
    for number in range(episodes):
        rng = np.random.default_rng(number)
        env.reset(options={"encounter": number})
        over = False
        step = 0
        while not over:
            if step % 20 == 0:
                action = rng.uniform(-1, 1, 2)
            step += 1
            _, _, terminated, truncated, info = env.step(action)
            engaged += info["engaged"]
            entered += terminated
            over = terminated or truncated
    return entered, engaged


def test_the_shield_keeps_a_policy_that_knows_nothing_clear():
    entered, engaged = fly(shielded=False)
    assert entered > 0 and engaged == 0
    entered, engaged = fly(shielded=True)
    assert entered == 0 and engaged > 0


def test_a_soak_of_1e5_steps_takes_no_more_memory():
    many = fga.gym.EncounterVectorEnv(50)
    many.reset(seed=5)
    rng = np.random.default_rng(5)
    memory_kb = []
    for block in range(4):
        for _ in range(500):
            many.step(rng.uniform(-1, 1, (50, 2)))
        gc.collect()
        memory_kb.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    assert memory_kb[-1] - memory_kb[1] < 8192, memory_kb


@pytest.mark.parametrize(
    ("wrong", "error"),
    [
        (lambda: fga.Worlds("nonsense", 1), ValueError),
        (lambda: fga.Worlds("wall", 0), ValueError),
        (lambda: fga.Worlds("wall", 2).step(np.zeros((3, 2))), ValueError),
        (lambda: fga.Worlds("wall", 2).step("left"), TypeError),
        (lambda: fga.Worlds("wall", 2).reset([5], [0]), ValueError),
        (lambda: fga.Worlds("wall", 1, horizon_s=float("nan")), ValueError),
    ],
)
def test_wrong_worlds_are_refused(wrong, error):
    with pytest.raises(error):
        wrong()


def test_a_number_that_is_not_finite_is_flown_as_holding():
    worlds = fga.Worlds("wall", 1)
    seen, *_ = worlds.step(np.array([[np.nan, np.inf]]))
    assert np.isfinite(seen).all()
