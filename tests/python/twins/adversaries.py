"""Robust adversarial reinforcement learning, and adversary populations: trainings in which others act, too."""

import dataclasses

import numpy as np

from twins.ppo import Learner, Options, standardised
from twins.trainings import Ppo


@dataclasses.dataclass(frozen=True)
class Game(Options):
    """Where an adversary acts and how far it reaches; gust's options of the same names."""

    site: str = "dynamics"
    scale: float = 0.1
    offset: float = 0

    def channels(self):
        return 2 if self.site == "dynamics" else 1

    def acts(self, action):
        """What the environments feel of an adversary's actions: a pull at the pole or a share of the force, newton."""
        value = self.scale * np.clip(action, -1, 1) + self.offset
        return {"pull": value} if self.site == "dynamics" else {"nudge": value[:, 0]}


def opposed(rollout, action):
    """A rollout as an adversary has it, which took these actions."""
    return dataclasses.replace(rollout, action=action, reward=-rollout.reward)


@dataclasses.dataclass(frozen=True)
class RarlOptions(Game):
    """With the defaults of the preset scg-2022."""

    agent_iterations: int = 1
    adversary_iterations: int = 1


class Rarl(Ppo):
    """A protagonist and an adversary that learn in turn from rollouts in which both act."""

    def __init__(self, plant, options, seed, learner=Learner):
        super().__init__(plant, options, seed, learner)
        self.adversary = learner(options, 4, options.channels(), self.rng.split("adversary"))
        self.population = [self.adversary]

    def turn(self):
        return (self.options.agent_iterations + self.options.adversary_iterations) * self.samples()

    def protagonists(self):
        """Whose turn it is."""
        return self.steps % self.turn() < self.options.agent_iterations * self.samples()

    def iterate(self, share):
        ours = self.protagonists()
        noise, actions = self.adversary.noise(self.steps // self.options.environments), []

        def against(step, observation):
            actions.append(self.adversary.act(observation, noise[step]))
            return self.options.acts(actions[-1])

        rollout = self.play(against)
        if ours:
            self.protagonist.learn(rollout, share)
        else:
            self.adversary.learn(self.opposed(rollout, np.array(actions)), share)

    def opposed(self, rollout, actions):
        return opposed(rollout, actions)


@dataclasses.dataclass(frozen=True)
class RapOptions(Game):
    """With the defaults of the preset scg-2022."""

    site: str = "action"
    population: int = 2
    reset_each_rollout: bool = True
    joint_advantages: bool = True
    strength_bins: int = 1


class Rap(Ppo):
    """Each environment has one adversary of a population; all learn from every rollout, the adversaries from their own
    environments."""

    def __init__(self, plant, options, seed, learner=Learner):
        super().__init__(plant, options, seed, learner)
        rng = self.rng.split("population")
        self.population = [learner(options, 4, options.channels(), rng.split("adversary").split(k))
                           for k in range(options.population)]
        self.lots = [rng.split("owner").split(lane) for lane in range(options.environments)]
        self.drawn = np.zeros(options.environments, dtype=int)
        self.owner = np.zeros(options.environments, dtype=int)
        self.draw(np.full(options.environments, True))

    def draw(self, marked):
        """A new adversary for the environments that are marked, by each one's own lots."""
        for lane in np.flatnonzero(marked):
            self.owner[lane] = self.lots[lane].below(self.options.population, int(self.drawn[lane]))
        self.drawn += marked

    def iterate(self, share):
        options, clock = self.options, self.steps // self.options.environments
        if options.reset_each_rollout:
            self.environments.restart()
            self.draw(np.full(options.environments, True))
        noise, actions, owners = [adversary.noise(clock) for adversary in self.population], [], []

        def against(step, observation):
            if not options.reset_each_rollout and clock + step > 0:
                self.draw(self.environments.age == 0)
            owners.append(self.owner.copy())
            actions.append(np.array([adversary.act(observation, noise[k][step])
                                     for k, adversary in enumerate(self.population)]))
            taken = actions[-1][self.owner, np.arange(options.environments)]
            reach = (self.owner % options.strength_bins + 1) / options.strength_bins
            return options.acts(reach[:, None] * np.clip(taken, -1, 1))

        rollout = self.play(against)
        self.protagonist.learn(rollout, share)
        self.teach(rollout, np.array(actions), np.array(owners), share)

    def teach(self, rollout, actions, owners, share):
        own = []
        for k, adversary in enumerate(self.population):
            samples = adversary.samples(self.opposed(rollout, actions[:, k]))
            own.append({name: values[self.owned(owners, k)] for name, values in samples.items()})
        for adversary, samples, advantage in zip(self.population, own, self.scaled([one["advantage"] for one in own])):
            adversary.update({**samples, "advantage": advantage}, share)

    def opposed(self, rollout, actions):
        return opposed(rollout, actions)

    def owned(self, owners, k):
        """Which samples an adversary learns from."""
        return owners.ravel() == k

    def scaled(self, advantages):
        """Standardised over all adversaries together, or each one's by themselves."""
        if self.options.advantage_scale != "rollout":
            return advantages
        if not self.options.joint_advantages:
            return [standardised(advantage) if len(advantage) else advantage for advantage in advantages]
        ends = np.cumsum([len(advantage) for advantage in advantages])
        return np.split(standardised(np.concatenate(advantages)), ends[:-1])
