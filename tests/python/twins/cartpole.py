"""The cart-pole of safe-control-gym and the environments of a training, in double precision."""

import dataclasses

import numpy as np


@dataclasses.dataclass(frozen=True)
class CartPole:
    """Equations, constants and reward of the preset scg-2022; SI units, the state (x, x', theta, theta')."""

    control_rate: float = 50
    physics_rate: float = 1000
    action_scale: float = 10  # newton for an action of 1
    force_limit: float = 10
    start_range: tuple = (0.3, 0, 0.1, 0)
    state_weights: tuple = (5, 0, 1, 0)
    action_weight: float = 1e-4
    steps: int = 250
    pole_length: float = 0.5
    pole_mass: float = 0.1
    cart_mass: float = 1.0
    pole_thickness: float = 0.05
    gravity: float = 9.8

    def accelerations(self, state, force, pull):
        """x'' and theta'' under a force at the cart and a pull (x, z) at the middle of the pole."""
        x, speed, angle, turn = state.T
        sine, cosine = np.sin(angle), np.cos(angle)
        moment = self.pole_mass * self.pole_length
        inertia = self.pole_mass / 12 * (self.pole_thickness**2 + (2 * self.pole_length)**2)
        matrix = np.array([[np.full_like(x, self.cart_mass + self.pole_mass), moment * cosine],
                           [moment * cosine, np.full_like(x, inertia + moment * self.pole_length)]])
        lever = self.pole_length * (pull[:, 0] * cosine - pull[:, 1] * sine)
        right = np.array([force + pull[:, 0] + moment * sine * turn**2, moment * self.gravity * sine + lever])
        return np.linalg.solve(matrix.transpose(2, 0, 1), right.T[:, :, None])[:, :, 0]

    def advance(self, state, force, pull):
        """One control step by semi-implicit Euler."""
        state, dt = state.copy(), 1 / self.physics_rate
        for _ in range(round(self.physics_rate / self.control_rate)):
            state[:, 1::2] += dt * self.accelerations(state, force, pull)
            state[:, ::2] += dt * state[:, 1::2]
        return state

    def reward(self, state, force):
        error = state.copy()
        error[:, 2] = (error[:, 2] + np.pi) % (2 * np.pi) - np.pi
        return np.exp(-(error**2 @ np.array(self.state_weights) + self.action_weight * force**2))

    def failed(self, state):
        return (np.abs(state[:, 0]) > 2.4) | (np.abs(state[:, 2]) > np.pi / 2)


SCG_2022 = CartPole()
SCG_DEFAULT = CartPole(physics_rate=50, action_scale=1, start_range=(0.05,) * 4, state_weights=(1,) * 4)


class Environments:
    """Episodes side by side; one that ends is followed at once by the next."""

    def __init__(self, plant, count, rng):
        self.plant, self.rng = plant, rng
        self.episode = np.zeros(count, dtype=int)
        self.age = np.zeros(count, dtype=int)
        self.state = np.zeros((count, 4))
        for lane in range(count):
            self.begin(lane)

    def begin(self, lane):
        draws = self.rng.split(lane).split(self.episode[lane]).split("start").uniform(np.arange(4))
        self.state[lane] = np.array(self.plant.start_range) * (2 * draws - 1)
        self.age[lane] = 0

    def next(self, lane):
        self.episode[lane] += 1
        self.begin(lane)

    def restart(self):
        for lane in range(len(self.state)):
            self.next(lane)

    def step(self, action, pull=0, nudge=0):
        """Rewards, who failed, who was cut off by time, and the states before any new episode.

        The actuator saturates after the adversary's share is added; the reward charges the command without it.
        """
        plant = self.plant
        wanted = plant.action_scale * action[:, 0]
        force = np.clip(wanted + nudge, -plant.force_limit, plant.force_limit)
        self.state = plant.advance(self.state, force, np.broadcast_to(pull, (len(force), 2)))
        self.age += 1
        reward = plant.reward(self.state, np.clip(wanted, -plant.force_limit, plant.force_limit))
        failed = plant.failed(self.state)
        cut = (self.age >= plant.steps) & ~failed
        last = self.state.copy()
        for lane in np.flatnonzero(failed | cut):
            self.next(lane)
        return reward, failed, cut, last
