"""Writes the recordings in this folder: a planar quadrotor under controllers that believe in another plant.

python3 make.py. An implementation of its own, from the equations: those of the plant as in Glossop et al. 2022 and
safe-control-gym (thrust acts along the attitude of one integration step ago), those of its PD controller, and
u = u_goal - K (observation - goal). Nothing here is shared with gust.
"""

import json
import math
import pathlib
import random

FOLDER = pathlib.Path(__file__).parent
STATES = ("x", "x_dot", "z", "z_dot", "theta", "theta_dot")
LOW, HIGH = 0.056323375552892685, 0.2966828942298889
GAINS = {"kx": 0.15, "kdx": 0.2, "th_max": 0.3, "kz": 4.0, "kdz": 3.0, "kth": 100.0, "kq": 20.0}
STEPS, CONTROL, PHYSICS = 60, 50, 1000


class Quadrotor:
    """M x'' = T sin th, M z'' = T cos th - M g, I th'' = a (T2 - T1), semi-implicit Euler."""

    def __init__(self, mass, inertia, arm, gravity, state):
        self.mass, self.inertia, self.arm, self.gravity = mass, inertia, arm, gravity
        self.state = list(state)
        self.old_theta = state[4]

    def step(self, t1, t2):
        dt = 1.0 / PHYSICS
        for _ in range(PHYSICS // CONTROL):
            x, x_dot, z, z_dot, theta, theta_dot = self.state
            moment = self.arm * (t2 - t1) * math.cos(theta - self.old_theta)
            direction, self.old_theta = self.old_theta, theta
            x_dot += dt * (t1 + t2) * math.sin(direction) / self.mass
            z_dot += dt * ((t1 + t2) * math.cos(direction) / self.mass - self.gravity)
            theta_dot += dt * moment / self.inertia
            self.state = [x + dt * x_dot, x_dot, z + dt * z_dot, z_dot, theta + dt * theta_dot, theta_dot]


def pd(belief, goal, seen):
    """Thrusts of the two pairs of rotors, from the mass, inertia, arm and gravity that the controller believes in."""
    e = [r - s for r, s in zip(goal, seen)]
    wanted = 6 * GAINS["kx"] * e[0] + 3 * GAINS["kdx"] * e[1]
    wanted = max(-GAINS["th_max"], min(GAINS["th_max"], wanted))
    thrust = belief["M"] * (belief["gravity"] + 2 * GAINS["kz"] * e[2] + GAINS["kdz"] * e[3])
    moment = belief["Iyy"] * (GAINS["kth"] * (wanted + e[4]) + GAINS["kq"] * e[5])
    turn = moment / belief["arm"]
    return [(thrust - turn) / 2, (thrust + turn) / 2]


def lqr(gain, u_goal, goal, seen):
    return [u_goal[i] - sum(gain[i][j] * (seen[j] - goal[j]) for j in range(6)) for i in range(2)]


def record(name, plant, act, description, noise=0.0, wobble=0.0):
    """Runs the loop, with noise on what the controller sees [SI units] and on its actions [N], and writes both files."""
    rng = random.Random(name)
    goal = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    charged = description.get("u_goal") or [plant.mass * plant.gravity / 2] * 2
    start = list(plant.state)

    def observe():
        return [s + noise * rng.gauss(0, 1) for s in plant.state]

    seen = observe()
    columns = ["k", "t"] + [f"{a}{i}" for a in ("a_raw", "a_phys", "a_noisy", "a_applied") for i in (0, 1)]
    columns += ["f_x", "f_z", *STATES, *(f"obs{i}" for i in range(6)), "reward", "sq_err", "out_of_bounds", "done", "timelimit"]
    rows = [[0, 0.0] + [""] * 10 + plant.state + seen + ["", "", 0, 0, 0]]
    for k in range(1, STEPS + 1):
        asked = act(goal, seen)
        noisy = [a + wobble * rng.gauss(0, 1) for a in asked]
        applied = [min(HIGH, max(LOW, a)) for a in noisy]
        plant.step(*applied)
        seen = observe()
        error = [s - g for s, g in zip(plant.state, goal)]
        reward = math.exp(-sum(e * e for e in error) - 0.1 * sum((a - u) ** 2 for a, u in zip(noisy, charged)))
        last = int(k == STEPS)
        rows.append([k, k / CONTROL, *asked, *asked, *noisy, *applied, 0.0, 0.0, *plant.state, *seen, reward,
                     error[0] ** 2 + error[2] ** 2, 0, last, last])
    text = "\n".join(",".join(str(cell) for cell in row) for row in [columns, *rows])
    (FOLDER / f"{name}.csv").write_text(text + "\n")
    common = {"plant": "quad2d", "ctrl_freq": CONTROL, "pyb_freq": PHYSICS, "steps": STEPS, "gravity": plant.gravity,
              "plant_params": {"M": plant.mass, "Iyy": plant.inertia, "arm": plant.arm}, "init_state": start,
              "task": "stabilization", "goal": goal, "goal_tolerance": 0.0, "normalized_action": False,
              "action_bounds": [[LOW, LOW], [HIGH, HIGH]], "rew_state_weight": 1.0, "rew_act_weight": 0.1,
              "rew_exponential": True, "sq_err_weights": [1.0, 0.0, 1.0, 0.0, 0.0, 0.0]}
    (FOLDER / f"{name}.json").write_text(json.dumps({**common, **description}, indent=1) + "\n")


def main():
    start = [0.1, -0.3, 1.0, 0.2, 0.1, 0.4]
    simple = {"M": 0.027, "Iyy": 1.4e-5, "arm": 0.028, "gravity": 9.8}
    told = {key: value for key, value in simple.items() if key != "gravity"}
    record("pd_believes_less_mass", Quadrotor(0.03, 1.4e-5, 0.028, 9.8, start),
           lambda goal, seen: pd(simple, goal, seen),
           {"policy": {"type": "pd"}, "pd_gains": {**GAINS, **told}})
    record("pd_believes_another_drone", Quadrotor(0.03, 1.8e-5, 0.031, 9.81, start),
           lambda goal, seen: pd(simple, goal, seen),
           {"policy": {"type": "pd"}, "pd_gains": {**GAINS, **simple}, "u_goal": [0.1323, 0.1323]}, 0.002, 0.001)
    up, turn = 0.027 / 2, 1.4e-5 / 0.056
    outer = [6 * GAINS["kx"], 3 * GAINS["kdx"], 0, 0, 1, 0]
    gain = [[s * GAINS["kth"] * turn * o for o in outer] for s in (-1, 1)]
    for row, s in zip(gain, (-1, 1)):
        row[2], row[3], row[5] = 2 * GAINS["kz"] * up, GAINS["kdz"] * up, s * GAINS["kq"] * turn
    u_goal = [0.027 * 9.8 / 2] * 2
    record("lqr_believes_less_mass", Quadrotor(0.03, 1.4e-5, 0.028, 9.8, start),
           lambda goal, seen: lqr(gain, u_goal, goal, seen),
           {"policy": {"type": "lqr"}, "lqr_gain": gain[0] + gain[1], "u_goal": u_goal}, 0.001)


main()
