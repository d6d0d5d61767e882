"""Proximal policy optimisation in double precision, written from the description of the algorithm."""

import dataclasses

import numpy as np

from twins.networks import Adam, Network

LAMBDA = 0.95  # of the generalised advantages


@dataclasses.dataclass(frozen=True)
class Options:
    """gust's options of the same names, with the defaults of the preset scg-2022."""

    environments: int = 4
    rollout: int = 100
    epochs: int = 10
    minibatch: int = 64
    hidden: int = 64
    log_std: float = -0.5
    discount: float = 0.99
    use_gae: bool = False
    value_target: str = "return"
    advantage_scale: str = "rollout"
    clip: float = 0.2
    value_clip: float = 0
    target_kl: float = 0.01
    entropy: float = 0.01
    actor_rate: float = 3e-4
    critic_rate: float = 1e-3
    rate_decay: str = "none"
    adam_epsilon: float = 1e-8
    max_grad_norm: float = 0


@dataclasses.dataclass(frozen=True)
class Rollout:
    """What happened: steps x environments, then the numbers of each."""

    observation: np.ndarray
    action: np.ndarray
    reward: np.ndarray
    done: np.ndarray
    cut: np.ndarray  # ended by time alone
    last: np.ndarray  # the observation after the step, before any new episode
    final: np.ndarray  # environments: the observation that comes next


def standardised(advantage):
    return (advantage - advantage.mean()) / (advantage.std() + 1e-6)


def bounded(gradient, limit):
    """With a common L2 norm of at most the limit; 0 is none."""
    norm = np.sqrt(sum((slope**2).sum() for slope in gradient))
    return [slope * limit / norm for slope in gradient] if 0 < limit < norm else gradient


class Learner:
    """An actor and a critic that learn from rollouts. What a test may get wrong is a method of its own."""

    adam = Adam

    def __init__(self, options, observations, actions, rng):
        self.options, self.rng, self.epochs = options, rng, 0
        hidden = [options.hidden] * 2
        self.actor = Network([observations, *hidden, actions], rng.split("actor"))
        self.critic = Network([observations, *hidden, 1], rng.split("critic"))
        self.log_std = np.full(actions, options.log_std)
        self.actor_adam = self.adam([*self.actor.parameters, self.log_std], options.actor_rate, options.adam_epsilon)
        self.critic_adam = self.adam(self.critic.parameters, options.critic_rate, options.adam_epsilon)

    def noise(self, clock):
        """Standard normal draws of a rollout that begins at step `clock`; each environment has its own stream."""
        options, actions = self.options, len(self.log_std)
        draws = clock * actions + np.arange(options.rollout * actions)
        streams = [self.rng.split("policy").split(lane) for lane in range(options.environments)]
        return np.stack([stream.normal(draws).reshape(-1, actions) for stream in streams], axis=1)

    def act(self, observation, noise):
        return self.actor(observation) + np.exp(self.log_std) * noise

    def log_density(self, action, mean):
        error = (action - mean) / np.exp(self.log_std)
        return (-error**2 / 2 - self.log_std - np.log(2 * np.pi) / 2).sum(axis=-1)

    def value(self, observation):
        return self.critic(observation)[..., 0]

    # Returns and advantages.

    def bootstrap(self, rollout):
        """Rewards; an episode that time cut off goes on in the critic's opinion of its end."""
        return rollout.reward + np.where(rollout.cut, self.options.discount * self.value(rollout.last), 0)

    def returns(self, rollout):
        """Returns, and the generalised advantages, steps x environments."""
        reward, value = self.bootstrap(rollout), self.value(rollout.observation)
        total = following = self.value(rollout.final)
        advantage, totals, advantages = 0, [], []
        for step in reversed(range(len(reward))):
            keep = self.options.discount * ~rollout.done[step]
            total = reward[step] + keep * total
            advantage = reward[step] + keep * following - value[step] + LAMBDA * keep * advantage
            following = value[step]
            totals.append(total)
            advantages.append(advantage)
        return np.array(totals[::-1]), np.array(advantages[::-1])

    def targets(self, rollout):
        """What the critic should have said, and the advantages."""
        returns, generalised = self.returns(rollout)
        value = self.value(rollout.observation)
        advantage = generalised if self.options.use_gae else returns - value
        return advantage + value if self.options.value_target == "td_lambda" else returns, advantage

    # One gradient step.

    def policy_slope(self, advantage, ratio):
        """Of -mean(min(ratio A, clip(ratio) A)) at the log densities."""
        clip = self.options.clip
        active = np.where(advantage >= 0, ratio <= 1 + clip, ratio >= 1 - clip)
        return -np.where(active, advantage * ratio, 0) / len(ratio)

    def value_slope(self, value, target, old):
        """Of the halved mean square at the values; with a clip, of the worse of the value and the one moved less."""
        error, clip = value - target, self.options.value_clip
        if clip > 0:
            near = old + np.clip(value - old, -clip, clip) - target
            error = np.where(near**2 > error**2, np.where(np.abs(value - old) < clip, near, 0), error)
        return error / len(value)

    def actor_gradient(self, batch, layers, slope):
        error = (batch["action"] - layers[-1]) / np.exp(self.log_std)
        gradient, _ = self.actor.gradients(layers, slope[:, None] * error / np.exp(self.log_std))
        return [*gradient, slope @ (error**2 - 1) - self.options.entropy]

    def too_far(self, old, new):
        """Whether the policy has moved too far for this minibatch to move it."""
        return 0 < 1.5 * self.options.target_kl < (old - new).mean()

    def step(self, batch, share):
        layers = self.actor.layers(batch["observation"])
        density = self.log_density(batch["action"], layers[-1])
        if not self.too_far(batch["density"], density):
            slope = self.policy_slope(batch["advantage"], np.exp(density - batch["density"]))
            gradient = self.actor_gradient(batch, layers, slope)
            self.actor_adam.step(bounded(gradient, self.options.max_grad_norm), share)
        layers = self.critic.layers(batch["observation"])
        slope = self.value_slope(layers[-1][:, 0], batch["target"], batch["value"])
        gradient, _ = self.critic.gradients(layers, slope[:, None])
        self.critic_adam.step(bounded(gradient, self.options.max_grad_norm), share)

    # A whole rollout.

    def samples(self, rollout):
        """Its samples one after the other, step by step, with all that a gradient step asks of them."""
        target, advantage = self.targets(rollout)
        found = {"observation": rollout.observation, "action": rollout.action, "target": target, "advantage": advantage,
                 "value": self.value(rollout.observation),
                 "density": self.log_density(rollout.action, self.actor(rollout.observation))}
        return {name: values.reshape(-1, *values.shape[2:]) for name, values in found.items()}

    def update(self, samples, share=1):
        count, size = len(samples["advantage"]), self.options.minibatch
        for _ in range(self.options.epochs if count >= size else 0):
            order = self.rng.split("minibatches").split(self.epochs).permutation(count)
            self.epochs += 1
            for first in range(0, count - size + 1, size):
                batch = {name: values[order[first:first + size]] for name, values in samples.items()}
                if self.options.advantage_scale == "minibatch":
                    batch["advantage"] = standardised(batch["advantage"])
                self.step(batch, share)

    def scaled(self, advantage):
        return standardised(advantage) if self.options.advantage_scale == "rollout" else advantage

    def learn(self, rollout, share=1):
        samples = self.samples(rollout)
        self.update({**samples, "advantage": self.scaled(samples["advantage"])}, share)
