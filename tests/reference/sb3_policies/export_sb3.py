"""Writes this folder's ONNX files as the documentation of Stable-Baselines3 tells its users to, and what the policies do.

Run with torch 2.15.0, stable-baselines3 2.9.2, onnx 1.23.2. The networks are untrained.
"""

import numpy as np
import gymnasium
import onnx
import torch
from stable_baselines3 import PPO, SAC, TD3

OBSERVATIONS = 32
OPTIONS = {"opset_version": 17, "input_names": ["input"], "dynamo": False}


class Space(gymnasium.Env):
    """Only the shapes matter."""

    observation_space = gymnasium.spaces.Box(-1.0, 1.0, (4,), np.float32)
    action_space = gymnasium.spaces.Box(-1.0, 1.0, (1,), np.float32)

    def reset(self, *, seed=None, options=None):
        return self.observation_space.sample(), {}

    def step(self, action):
        return self.observation_space.sample(), 0.0, False, False, {}


class Deterministic(torch.nn.Module):
    def __init__(self, network, **options):
        super().__init__()
        self.network = network
        self.options = options

    def forward(self, observation):
        return self.network(observation, **self.options)


def small_actor(kind):
    return kind("MlpPolicy", Space(), seed=1, policy_kwargs={"net_arch": [32, 32]}).policy.actor


def main():
    policies = {
        "ppo": Deterministic(PPO("MlpPolicy", Space(), seed=1).policy, deterministic=True),
        "sac": Deterministic(small_actor(SAC), deterministic=True),
        "td3": Deterministic(small_actor(TD3)),
    }
    observations = torch.rand((OBSERVATIONS, 4), generator=torch.Generator().manual_seed(7)) * 4 - 2
    columns = [observations.numpy()]
    for name, policy in policies.items():
        torch.onnx.export(policy, torch.zeros((1, 4)), f"{name}.onnx", **OPTIONS)
        model = onnx.load(f"{name}.onnx")
        for node in model.graph.node:
            node.ClearField("doc_string")  # line numbers of the machine that exported
        onnx.save(model, f"{name}.onnx")
        with torch.no_grad():
            out = policy(observations)
        columns.append((out[0] if isinstance(out, tuple) else out).numpy())
    header = "x,x_dot,theta,theta_dot," + ",".join(policies)
    np.savetxt("actions.csv", np.hstack(columns), delimiter=",", header=header, comments="", fmt="%.9g")


main()
