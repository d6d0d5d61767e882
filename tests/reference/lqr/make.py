#!/usr/bin/env python3
"""Writes lqr.json: what SciPy's solve_discrete_are says about some systems, among them the cart-pole.

    pip install numpy==2.4.6 scipy==1.17.1
    python make.py

The cart-pole is linearised here by hand, about the upright pole: with the coordinates (x, theta) and the force F,

    [M+m  m l    ] [x''    ]   [F          ]
    [m l  I+m l^2] [theta''] = [m g l theta]        I = m/12 (w^2 + 4 l^2)

and semi-implicit Euler at the physics rate, so that one substep is v += dt acc(q, F), q += dt v.
"""

import json
import pathlib

import numpy as np
import scipy
import scipy.linalg


def cartpole(parameters, control_rate, physics_rate):
    """A and B of one control step, states in the order x, x', theta, theta'."""
    l, m, M = parameters["pole_length"], parameters["pole_mass"], parameters["cart_mass"]
    g, w = 9.8, 0.05
    inertia = m / 12 * (w**2 + 4 * l**2) + m * l**2
    mass = np.array([[M + m, m * l], [m * l, inertia]])
    pull = np.linalg.solve(mass, np.array([[0, 0], [0, m * g * l]]))  # acceleration per coordinate
    push = np.linalg.solve(mass, np.array([1.0, 0]))  # acceleration per newton
    dt = 1 / physics_rate
    # In the order (q, v): v' = v + dt (pull q + push F), q' = q + dt v'.
    step = np.block([[np.eye(2) + dt**2 * pull, dt * np.eye(2)], [dt * pull, np.eye(2)]])
    kick = np.concatenate([dt**2 * push, dt * push])
    a, b = np.eye(4), np.zeros(4)
    for _ in range(physics_rate // control_rate):
        a, b = step @ a, step @ b + kick
    order = [0, 2, 1, 3]  # to x, x', theta, theta'
    return a[np.ix_(order, order)], b[order, None]


def solved(a, b, q, r):
    cost = scipy.linalg.solve_discrete_are(a, b, np.diag(q), np.diag(r))
    gain = np.linalg.solve(np.diag(r) + b.T @ cost @ b, b.T @ cost @ a)
    return {"a": a.tolist(), "b": b.tolist(), "q": list(q), "r": list(r), "cost": cost.tolist(), "gain": gain.tolist()}


def main():
    plants = []
    nominal = {"pole_length": 0.5, "pole_mass": 0.1, "cart_mass": 1.0}
    heavy = {"pole_length": 1.2, "pole_mass": 0.4, "cart_mass": 0.7}
    for parameters, rates, q, r in [
        (nominal, (50, 1000), [5, 0.1, 1, 0.1], [1e-4]),
        (nominal, (50, 50), [1, 1, 1, 1], [0.1]),
        (nominal, (15, 750), [1, 1, 1, 1], [0.1]),
        (heavy, (50, 1000), [1, 0.5, 2, 0.25], [0.01]),
    ]:
        a, b = cartpole(parameters, *rates)
        plants.append({"parameters": parameters, "control_rate": rates[0], "physics_rate": rates[1]} | solved(a, b, q, r))

    random = np.random.default_rng(7)
    systems = []
    for states, inputs in [(1, 1), (2, 1), (3, 2), (6, 2), (12, 4)]:
        a = random.normal(size=(states, states)) * 1.2 / np.sqrt(states)
        b = random.normal(size=(states, inputs))
        systems.append(solved(a, b, random.uniform(0.1, 2, states), random.uniform(0.1, 2, inputs)))

    out = {"scipy": scipy.__version__, "cartpoles": plants, "systems": systems}
    pathlib.Path(__file__).with_name("lqr.json").write_text(json.dumps(out, indent=1) + "\n")


if __name__ == "__main__":
    main()
