"""Soft actor-critic in double precision, written from the description of the algorithm."""

import dataclasses

import numpy as np

from twins.cartpole import Environments
from twins.networks import Adam, Network
from twins.rng import Rng


@dataclasses.dataclass(frozen=True)
class SacOptions:
    """gust's options of the same names, with the defaults of the preset scg-2022."""

    environments: int = 4
    hidden: int = 256
    actor_trunk: str = "scg"
    density: str = "tanh"
    discount: float = 0.99
    batch: int = 64
    warm_up: int = 1000
    update_ratio: float = 1
    burst: int = 100
    polyak: float = 0.005
    temperature: float = 0.2
    auto_temperature: bool = False
    target_entropy: float = -1
    actor_rate: float = 1e-3
    critic_rate: float = 1e-3
    temperature_rate: float = 1e-3
    adam_epsilon: float = 1e-8
    sac_order: str = "upstream"


class Actor:
    """A network with a mean and a log deviation of u; the action is tanh(u) times the half-width of its box."""

    def __init__(self, options, half_width, rng):
        trunk = ("relu", "none" if options.actor_trunk == "scg" else "relu")
        self.network = Network([4, options.hidden, options.hidden, 2], rng.split("actor"), trunk)
        self.adam = Adam(self.network.parameters, options.actor_rate, options.adam_epsilon)
        self.half_width, self.joined = half_width, options.actor_trunk == "scg"
        self.log_width = np.log(half_width) if options.density == "box" else 0

    @property
    def parameters(self):
        """Of the finished policy: the mean's alone; two linear layers are joined."""
        *trunk, weights, biases = self.network.parameters
        weights, biases = weights[:1], biases[:1]
        if self.joined:
            *trunk, below, offset = trunk
            weights, biases = weights @ below, weights @ offset + biases
        return [*trunk, weights, biases]

    def propose(self, observation, noise):
        """Actions, their log density, and what `improve` asks for."""
        layers = self.network.layers(observation)
        mean, log_std = layers[-1].T
        bounded = np.clip(log_std, -20, 2)
        u = mean + np.exp(bounded) * noise
        log_slope = 2 * (np.log(2) - u - np.logaddexp(0, -2 * u))  # ln(1 - tanh(u)^2)
        density = -noise**2 / 2 - bounded - np.log(2 * np.pi) / 2 - log_slope - self.log_width
        return self.half_width * np.tanh(u), density, (layers, noise, u, log_std, bounded)

    def improve(self, proposal, at_action, temperature):
        """A step down mean(temperature log density - value), given the value's slope at the actions."""
        layers, noise, u, log_std, bounded = proposal
        at_u = -at_action * self.half_width * (1 - np.tanh(u)**2) + 2 * temperature * np.tanh(u)
        at_log_std = np.where(log_std == bounded, at_u * np.exp(bounded) * noise - temperature, 0)
        self.adam.step(self.network.gradients(layers, np.stack([at_u, at_log_std], axis=1) / len(u))[0])


class Critic:
    """A judge of observations with actions, and its slow copy."""

    def __init__(self, options, rng):
        sizes = [5, options.hidden, options.hidden, 1]
        self.network, self.slow = (Network(sizes, rng, ("relu", "relu")) for _ in range(2))
        self.adam = Adam(self.network.parameters, options.critic_rate, options.adam_epsilon)
        self.polyak = options.polyak

    def step(self, layers, slope):
        self.adam.step(self.network.gradients(layers, slope[:, None])[0])
        for copy, parameter in zip(self.slow.parameters, self.network.parameters):
            copy += self.polyak * (parameter - copy)


class SacLearner:
    """What a test may get wrong is a method of its own."""

    def __init__(self, options, half_width, rng):
        self.options, self.rng, self.updates = options, rng, 0
        self.actor = Actor(options, half_width, rng.split("actor"))
        self.critics = [Critic(options, rng.split("critic").split(f"critic {k}")) for k in (1, 2)]
        self.log_temperature = np.array([np.log(options.temperature)])
        self.temperature_adam = Adam([self.log_temperature], options.temperature_rate, options.adam_epsilon)

    def temperature(self):
        return np.exp(self.log_temperature[0])

    def update(self, memory):
        rng = self.rng.split("updates").split(self.updates)
        self.updates += 1
        lanes = np.arange(self.options.batch)
        rows = rng.split("replay").below(len(memory["reward"]), lanes)
        batch = {name: np.array([values[row] for row in rows]) for name, values in memory.items()}
        if self.options.sac_order == "original":
            self.teach(batch, rng.split("next").normal(lanes))
        action, density, rest = self.actor.propose(batch["observation"], rng.split("action").normal(lanes))
        if self.options.sac_order == "original":
            self.move_temperature(density)
        self.actor.improve(rest, self.value_at_action(batch, action), self.temperature())
        if self.options.sac_order == "upstream":
            self.move_temperature(density)
            self.teach(batch, rng.split("next").normal(lanes))

    def value_at_action(self, batch, action):
        """The slope of the value at the actions."""
        layers = [critic.network.layers(np.column_stack([batch["observation"], action])) for critic in self.critics]
        shares = self.shares(*(of[-1] for of in layers))
        return sum(critic.network.gradients(of, share)[1][:, 4]
                   for critic, of, share in zip(self.critics, layers, shares))

    def shares(self, first, second):
        """How far each critic's value counts: the lesser does."""
        return first <= second, first > second

    def move_temperature(self, density):
        if self.options.auto_temperature:
            self.temperature_adam.step([-np.mean(density + self.options.target_entropy)[None]])

    def follows(self, batch, action, density):
        """The worth of what comes next, by the target networks."""
        inputs = np.column_stack([batch["next"], action])
        return np.minimum(*(critic.slow(inputs)[:, 0] for critic in self.critics)) - self.temperature() * density

    def alive(self, batch):
        """Only a failure ends what follows."""
        return ~batch["failed"]

    def teach(self, batch, noise):
        action, density, _ = self.actor.propose(batch["next"], noise)
        target = batch["reward"] + self.options.discount * self.alive(batch) * self.follows(batch, action, density)
        for critic in self.critics:
            layers = critic.network.layers(np.column_stack([batch["observation"], batch["action"]]))
            critic.step(layers, self.value_slope(layers[-1][:, 0], target))

    def value_slope(self, value, target):
        """Of the mean square."""
        return 2 * (value - target) / len(value)


class Sac:
    """Environments, a memory of all transitions, and updates that are owed for steps and paid in bursts."""

    def __init__(self, plant, options, seed, learner=SacLearner):
        self.options, self.steps, self.owed = options, 0, 0
        rng = Rng(seed).split("training")
        self.environments = Environments(plant, options.environments, rng.split("environments"))
        self.half_width = plant.force_limit / plant.action_scale
        self.learner = learner(options, self.half_width, rng.split("learner"))
        noise = rng.split("learner").split("actor")
        self.by_chance = [noise.split("warm-up").split(lane) for lane in range(options.environments)]
        self.noise = [noise.split("policy").split(lane) for lane in range(options.environments)]
        self.memory = {name: [] for name in ("observation", "action", "reward", "next", "failed", "cut")}

    def policy(self):
        return self.learner.actor.parameters

    def run(self, steps):
        while self.steps < steps:
            self.step()
            while self.owed >= self.options.burst:
                for _ in range(self.options.burst):
                    self.learner.update(self.memory)
                self.owed -= self.options.burst

    def step(self):
        observation, clock = self.environments.state.copy(), self.steps // self.options.environments
        if self.steps < self.options.warm_up:
            draws = np.array([stream.uniform(clock) for stream in self.by_chance])
            action = self.half_width * (2 * draws - 1)
        else:
            draws = np.array([stream.normal(clock) for stream in self.noise])
            action, _, _ = self.learner.actor.propose(observation, draws)
        reward, failed, cut, last = self.environments.step(action[:, None])
        self.remember((observation, action, reward, last, failed, cut))
        self.steps += self.options.environments
        if self.steps > self.options.warm_up:
            self.owed += self.options.update_ratio * self.options.environments

    def remember(self, transitions):
        for kept, values in zip(self.memory.values(), transitions):
            kept.extend(values)
