"""Trainings against twins in NumPy that are fed the same random numbers.

The twins (twins/) are written from the description of the algorithms (docs/algorithms.md) and compute in
double precision. gust's networks are of single precision, so the final weights differ by what rounding does to some
hundred gradient steps: 5e-6 to 5e-5 of the distance that they have come (PPO, RARL, RAP), 2e-6 to 3e-5 (SAC). A mistake
in the twin moves them apart by 0.02 to 3.

Longer trainings are no better test. Where a divergence comes within some 1e-6 of its threshold, a ratio of the bound of
its clip, or a sum of the hinge of its ReLU, rounding decides, and the two part from there on: by 1e-4 to 0.3 in 15 of
90 trainings of about this length. A twin whose networks' sums are off by 2e-7 ends at either place, by chance, and
where it ends with gust it is as near as elsewhere. At 50 Hz a pole that falls for a second or two multiplies a
difference by hundreds, so most settings here have shorter episodes. The seeds are of those that meet no such case.
"""

import dataclasses
import math

import numpy as np
import onnx
import pytest
from onnx import numpy_helper

from twins.adversaries import Rap, RapOptions, Rarl, RarlOptions
from twins.cartpole import SCG_2022, SCG_DEFAULT, CartPole
from twins.networks import Adam
from twins.ppo import Learner, Options, standardised
from twins.sac import Sac, SacLearner, SacOptions
from twins.trainings import Ppo

STEPS = 2000  # five rollouts
ROUNDING, MISTAKE = 1e-4, 1e-2
SHORT = dataclasses.replace(SCG_2022, control_rate=250)  # a second an episode: time ends some, a fall the others
SEED = 3  # two falls, six ends by time
MODERN = dict(use_gae=True, value_target="td_lambda", advantage_scale="minibatch", max_grad_norm=0.5,
              adam_epsilon=1e-5, rate_decay="linear", value_clip=0.2, entropy=0.0, target_kl=0.0)


def changes(settings, usual):
    """The command line's options for what is not as usual."""
    pairs = [(field.name, getattr(settings, field.name)) for field in dataclasses.fields(settings)]
    return [word for name, value in pairs if value != getattr(usual, name)
            for word in ("--set", f"{name}={str(value).lower()}")]


def weights(path):
    """Those of a policy: weights, biases, weights ..."""
    arrays = {tensor.name: numpy_helper.to_array(tensor) for tensor in onnx.load(path).graph.initializer}
    return [arrays[f"{kind}{layer}"] for layer in range(len(arrays) // 2) for kind in ("weight", "bias")]


def distance(ours, theirs):
    return math.sqrt(sum(((a - b)**2).sum() for a, b in zip(ours, theirs)))


@dataclasses.dataclass(frozen=True)
class Setting:
    """A training of gust's, and the twin of it."""

    twin: type = Ppo
    plant: CartPole = SHORT
    options: Options = Options()
    seed: int = SEED
    steps: int = STEPS

    def train(self, gust, folder):
        """gust's weights at the end."""
        preset, usual = ("scg-default", SCG_DEFAULT) if self.plant is SCG_DEFAULT else ("scg-2022", SCG_2022)
        gust("train", self.twin.__name__.lower(), "--plant", "cartpole", "--preset", preset, "--steps", self.steps,
             "--seed", self.seed, *changes(self.plant, usual), *changes(self.options, type(self.options)()),
             "--out", "policy.onnx")
        return weights(folder / "policy.onnx")

    def difference(self, theirs, **mistaken):
        """How far the twin ends from gust's weights, in distances that those have come from the start."""
        twin = mistaken.pop("twin", self.twin)(self.plant, self.options, self.seed, **mistaken)
        start = [parameter.copy() for parameter in twin.policy()]
        twin.run(self.steps)
        return distance(twin.policy(), theirs) / distance(start, theirs)


@pytest.mark.parametrize("setting", [
    Setting(plant=SCG_2022, seed=1),
    Setting(plant=SCG_2022, seed=2),
    Setting(plant=SCG_DEFAULT, seed=1),
    Setting(),
    Setting(options=Options(use_gae=True, minibatch=32, hidden=16, environments=5, rollout=80), seed=1),
    Setting(options=Options(**MODERN), seed=2),
], ids=("scg-2022", "scg-2022 seed 2", "scg-default", "short", "gae", "modern"))
def test_ppo_ends_where_its_twin_does(gust, tmp_path, setting):
    assert setting.difference(setting.train(gust, tmp_path)) < ROUNDING


class EndByTimeIsAnEnd(Learner):
    def bootstrap(self, rollout):
        return rollout.reward


class FailureIsNoEnd(Learner):
    def bootstrap(self, rollout):
        return rollout.reward + np.where(rollout.done, self.options.discount * self.value(rollout.last), 0)


class RawAdvantages(Learner):
    def scaled(self, advantage):
        return advantage


class CriticWithoutTheHalf(Learner):
    def value_slope(self, value, target, old):
        return 2 * super().value_slope(value, target, old)


class NoEntropy(Learner):
    def actor_gradient(self, batch, layers, slope):
        gradient = super().actor_gradient(batch, layers, slope)
        return [*gradient[:-1], gradient[-1] + self.options.entropy]


class EpsilonInsideTheRoot(Learner):
    class adam(Adam):
        def direction(self, mean, square):
            return mean / np.sqrt(square + self.epsilon)


class ClippedOnBothSides(Learner):
    def policy_slope(self, advantage, ratio):
        return -np.where(np.abs(ratio - 1) <= self.options.clip, advantage * ratio, 0) / len(ratio)


class ClippedWider(Learner):
    def policy_slope(self, advantage, ratio):
        return -np.where(np.where(advantage >= 0, ratio <= 1.25, ratio >= 0.75), advantage * ratio, 0) / len(ratio)


class StopsThePass(Learner):
    """Once the policy has moved too far, the actor is left alone for the rest of the rollout."""

    def update(self, samples, share=1):
        self.stopped = False
        super().update(samples, share)

    def too_far(self, old, new):
        self.stopped = self.stopped or super().too_far(old, new)
        return self.stopped


SHARP = Setting(options=Options(adam_epsilon=1e-3))  # with a small one Adam takes no notice of a loss's factor


@pytest.mark.parametrize("setting, mistaken", (
    (Setting(), EndByTimeIsAnEnd),
    (Setting(), FailureIsNoEnd),
    (Setting(), RawAdvantages),
    (SHARP, CriticWithoutTheHalf),
    (Setting(), NoEntropy),
    (Setting(), EpsilonInsideTheRoot),
    (Setting(), ClippedOnBothSides),
    (Setting(), ClippedWider),
    (Setting(), StopsThePass),
))
def test_a_mistake_in_the_twin_of_ppo_shows(gust, tmp_path, setting, mistaken):
    assert setting.difference(setting.train(gust, tmp_path), learner=mistaken) > MISTAKE


RARL = Setting(Rarl, options=RarlOptions(scale=2), steps=2400)  # far enough that the protagonist feels it
RAP = Setting(Rap, options=RapOptions(scale=5))
EPISODES = RapOptions(scale=5, population=3, reset_each_rollout=False, joint_advantages=False, strength_bins=2)


@pytest.mark.parametrize("setting", [
    RARL,
    Setting(Rarl, options=RarlOptions(), seed=1, steps=2400),
    Setting(Rarl, options=RarlOptions(site="action", scale=2, offset=0.5, adversary_iterations=2), seed=1, steps=2400),
    RAP,
    Setting(Rap, plant=SCG_2022, options=RapOptions(), seed=2),
    Setting(Rap, options=EPISODES, seed=1),
], ids=("rarl", "rarl weak", "rarl action", "rap", "rap scg-2022", "rap episodes"))
def test_trainings_with_adversaries_end_where_their_twins_do(gust, tmp_path, setting):
    assert setting.difference(setting.train(gust, tmp_path)) < ROUNDING


STUDY = """schema = 1
name = "twins"
plant = {{ kind = "cartpole", preset = "scg-2022", control_rate = 250 }}

[evaluate]
episodes = 1

[[policy]]
name = "policy"
kind = "train"
seeds = [{seed}]
agent = {{ kind = "{kind}", steps = {steps}, scale = {scale} }}

[[sweep]]
name = "nothing"
site = "action"
waveform = "step"
levels = [0]
"""


@pytest.mark.parametrize("setting", (RARL, RAP), ids=("rarl", "rap"))
def test_adversaries_end_where_their_twins_do(gust, tmp_path, setting):
    twin = setting.twin(setting.plant, setting.options, setting.seed)
    starts = [[parameter.copy() for parameter in adversary.actor.parameters] for adversary in twin.population]

    (tmp_path / "study.toml").write_text(STUDY.format(seed=setting.seed, kind=setting.twin.__name__.lower(),
                                                      steps=setting.steps, scale=setting.options.scale))
    gust("run", "study.toml", "--out", "results")
    twin.run(setting.steps)

    trained = [weights(path) for path in sorted((tmp_path / "results").rglob("adversary-*.onnx"))]
    assert len(trained) == len(twin.population)
    for theirs, adversary, start in zip(trained, twin.population, starts):
        assert distance(adversary.actor.parameters, theirs) / distance(start, theirs) < ROUNDING


class RarlWithCommonRewards(Rarl):
    def opposed(self, rollout, actions):
        return dataclasses.replace(rollout, action=actions)


class RarlAdversaryFirst(Rarl):
    def protagonists(self):
        return not super().protagonists()


class RarlThatBeginsAnew(Rarl):
    def iterate(self, share):
        if self.steps > 0:
            self.environments.restart()
        super().iterate(share)


class RapWithCommonRewards(Rap):
    def opposed(self, rollout, actions):
        return dataclasses.replace(rollout, action=actions)


class RapThatLearnsFromAll(Rap):
    def owned(self, owners, k):
        return np.full(owners.size, True)


class RapThatGoesOn(Rap):
    """Every rollout draws adversaries, but goes on where the last one ended."""

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)
        self.environments.restart = lambda: None


class RapThatKeepsItsOwners(Rap):
    def draw(self, marked):
        if not self.drawn.any():
            super().draw(marked)


class RapStandardisedApart(Rap):
    def scaled(self, advantages):
        return [standardised(advantage) for advantage in advantages]


@pytest.mark.parametrize("mistaken", (
    RarlWithCommonRewards, RarlAdversaryFirst, RarlThatBeginsAnew, RapWithCommonRewards, RapThatLearnsFromAll,
    RapThatGoesOn, RapThatKeepsItsOwners, RapStandardisedApart,
))
def test_a_mistake_in_the_twin_of_an_adversarial_training_shows(gust, tmp_path, mistaken):
    setting = RARL if issubclass(mistaken, Rarl) else RAP

    assert setting.difference(setting.train(gust, tmp_path), twin=mistaken) > MISTAKE


SMALL = SacOptions(hidden=32)
SAC = Setting(Sac, options=SMALL, seed=1, steps=1200)  # 200 updates; three falls, an end by time
AUTOMATIC = Setting(Sac, options=SacOptions(hidden=32, auto_temperature=True, sac_order="original"), steps=1100)
SAC_SHARP = Setting(Sac, options=SacOptions(hidden=32, adam_epsilon=1e-3), seed=1, steps=1100)
BOX = SacOptions(hidden=32, density="box", actor_trunk="relu")


@pytest.mark.parametrize("setting", [
    SAC,
    AUTOMATIC,
    Setting(Sac, plant=SCG_2022, options=SacOptions(hidden=64), steps=1100),
    Setting(Sac, plant=SCG_DEFAULT, options=SMALL, steps=1200),
    Setting(Sac, plant=SCG_DEFAULT, options=BOX, seed=4, steps=1200),
], ids=("sac", "automatic temperature", "scg-2022", "scg-default", "box and relu"))
def test_sac_ends_where_its_twin_does(gust, tmp_path, setting):
    assert setting.difference(setting.train(gust, tmp_path)) < ROUNDING


class SacEndByTimeIsAnEnd(SacLearner):
    def alive(self, batch):
        return ~(batch["failed"] | batch["cut"])


class SacFailureIsNoEnd(SacLearner):
    def alive(self, batch):
        return True


class SacCriticsWithAHalf(SacLearner):
    def value_slope(self, value, target):
        return (value - target) / len(value)


class SacTargetWithoutEntropy(SacLearner):
    def follows(self, batch, action, density):
        return super().follows(batch, action, 0)


class SacTargetByFastCritics(SacLearner):
    def __init__(self, *arguments):
        super().__init__(*arguments)
        for critic in self.critics:
            critic.slow = critic.network


class SacRaisesTheMean(SacLearner):
    def shares(self, first, second):
        return np.full_like(first, 0.5), np.full_like(second, 0.5)


class SacMovesTheTemperatureItself(SacLearner):
    """By the gradient at the temperature, not at its logarithm."""

    def move_temperature(self, density):
        temperature = np.array([self.temperature()])
        self.temperature_adam.parameters = [temperature]
        super().move_temperature(density)
        self.log_temperature[:] = np.log(temperature)


class SacCriticsLast(SacLearner):
    def __init__(self, options, *arguments):
        super().__init__(dataclasses.replace(options, sac_order="upstream"), *arguments)


@pytest.mark.parametrize("setting, mistaken", (
    (SAC, SacEndByTimeIsAnEnd),
    (SAC, SacFailureIsNoEnd),
    (SAC_SHARP, SacCriticsWithAHalf),
    (SAC, SacTargetWithoutEntropy),
    (SAC, SacTargetByFastCritics),
    (SAC, SacRaisesTheMean),
    (AUTOMATIC, SacMovesTheTemperatureItself),
    (AUTOMATIC, SacCriticsLast),
))
def test_a_mistake_in_the_twin_of_sac_shows(gust, tmp_path, setting, mistaken):
    assert setting.difference(setting.train(gust, tmp_path), learner=mistaken) > MISTAKE
