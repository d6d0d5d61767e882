"""A whole training by proximal policy optimisation."""

import math

import numpy as np

from twins.cartpole import Environments
from twins.ppo import Learner, Rollout
from twins.rng import Rng


class Ppo:
    """One who learns from every rollout."""

    def __init__(self, plant, options, seed, learner=Learner):
        self.options, self.rng, self.steps = options, Rng(seed).split("training"), 0
        self.environments = Environments(plant, options.environments, self.rng.split("environments"))
        self.protagonist = learner(options, 4, 1, self.rng.split("learner"))

    def policy(self):
        return self.protagonist.actor.parameters

    def run(self, steps):
        total = math.ceil(steps / self.turn()) * self.turn()
        while self.steps < total:
            self.iterate(1 - self.steps / total if self.options.rate_decay == "linear" else 1)

    def samples(self):
        return self.options.environments * self.options.rollout

    def turn(self):
        """The training ends after a multiple of so many steps."""
        return self.samples()

    def iterate(self, share):
        self.protagonist.learn(self.play(), share)

    def play(self, against=lambda step, observation: {}):
        """A rollout; `against` says what an adversary does to the environments."""
        noise, steps = self.protagonist.noise(self.steps // self.options.environments), []
        for step in range(self.options.rollout):
            observation = self.environments.state.copy()
            action = self.protagonist.act(observation, noise[step])
            reward, failed, cut, last = self.environments.step(action, **against(step, observation))
            steps.append((observation, action, reward, failed | cut, cut, last))
        self.steps += self.samples()
        return Rollout(*map(np.array, zip(*steps)), self.environments.state.copy())
