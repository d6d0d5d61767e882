#!/usr/bin/env python3
"""Writes pid.json: closed loops with PID controllers, as python-control and a second program of our own have them.

    pip install numpy==2.4.6 scipy==1.17.1 control==0.10.2
    python make.py

`linear`: the cart-pole linearised by hand (../lqr/make.py) under two loops, of theta and of x, each the transfer function

    C(z) = kp + ki T / (z - 1) + kd (z - 1) / ((Tf + T) z - Tf)

and `cascade`: the loop of x gives the reference of theta. python-control closes the loop and gives its free response from a
state with velocities only, so that no controller has a past. `limited`: one loop at its limits on a first-order plant,
stepped by the equations of docs/policies.md 4 as this file has them.
"""

import json
import pathlib

import control
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
T = 0.02
STEPS = 150


def plant():
    entry = json.loads((HERE / "../lqr/lqr.json").read_text())["cartpoles"][0]
    return np.array(entry["a"]), np.array(entry["b"])


def pid(kp, ki, kd, tf):
    z = control.TransferFunction.z
    z.dt = T
    return kp + ki * T / (z - 1) + (kd * (z - 1) / ((tf + T) * z - tf) if kd else 0)


def free_response(a, b, controller, start):
    """States and actions of u = -controller [x, theta] from a state of the plant."""
    c = np.zeros((2, 4))
    c[0, 0] = c[1, 2] = 1
    p = control.ss(a, b, c, np.zeros((2, 1)), T)
    k = control.ss(controller)
    n = k.nstates
    closed = np.block([[a - b @ k.D @ c, -b @ k.C], [k.B @ c, k.A]])
    loop = control.ss(closed, np.zeros((4 + n, 1)), np.eye(4 + n), np.zeros((4 + n, 1)), T)
    assert np.allclose(np.sort_complex(control.feedback(p, k).poles()), np.sort_complex(loop.poles()), atol=1e-6)
    states = control.initial_response(loop, np.arange(STEPS) * T, np.concatenate([start, np.zeros(n)])).states
    outputs = c @ states[:4]
    action = -(k.C @ states[4:] + k.D @ outputs)
    return states[:4].T.tolist(), action[0].tolist()


def row(*systems):
    """Two single controllers as one of two inputs and one output."""
    return control.append(*[control.ss(s) for s in systems])


def linear():
    a, b = plant()
    loops = [dict(of="x", kp=-30, ki=-4, kd=-40, filter=0.03), dict(of="theta", kp=-220, ki=-60, kd=-48, filter=0.01)]
    both = row(*[pid(l["kp"], l["ki"], l["kd"], l["filter"]) for l in loops])
    summed = control.ss(both.A, both.B, np.ones((1, 2)) @ both.C, np.ones((1, 2)) @ both.D, T)
    start = [0, 0.2, 0, 0.1]
    states, action = free_response(a, b, summed, start)
    return dict(loops=loops, start=start, states=states, action=action)


def cascade():
    a, b = plant()
    outer = dict(of="x", to="theta", kp=0.08, ki=0.01, kd=0.15, filter=0.04)
    inner = dict(of="theta", to="force", kp=-90, ki=-10, kd=-15, filter=0.01, derivative="measurement")
    asked = control.ss(pid(outer["kp"], outer["ki"], outer["kd"], outer["filter"]))
    # theta is asked for -asked x, and only its own motion is damped: u = -(pi (asked x + theta) + damping theta)
    pi, damping = control.ss(pid(inner["kp"], inner["ki"], 0, 0)), control.ss(pid(0, 0, inner["kd"], inner["filter"]))
    gain = lambda *numbers: control.ss([], [], [], [list(numbers)], T)
    mixed = control.parallel(control.series(control.append(asked, gain(1.0)), gain(1.0, 1.0), pi),
                             control.series(gain(0.0, 1.0), damping))
    start = [0, 0.2, 0, 0.1]
    states, action = free_response(a, b, mixed, start)
    return dict(loops=[outer, inner], start=start, states=states, action=action)


def limited(windup):
    """y(k+1) = 0.98 y(k) + 0.01 u(k) from y = -1, to 0 at u within -5 to 1, with a derivative of the measurement."""
    kp, ki, kd, tf, tt, low, high = 4.0, 9.0, 0.3, 0.05, 0.25, -5.0, 1.0
    y, i, d, last, ys, us, memory = -1.0, 0.0, 0.0, -1.0, [], [], []
    for k in range(STEPS):
        d = tf / (tf + T) * d - kd / (tf + T) * (y - last)
        last = y
        v = kp * -y + i + d
        u = low if v < low else high if v > high else v
        if windup == "back":
            i += ki * T * -y + T / tt * (u - v)
        elif windup == "none" or not ((v > high and -ki * y > 0) or (v < low and -ki * y < 0)):
            i += ki * T * -y
        ys.append(y)
        us.append(u)
        memory.append(i)
        y = 0.98 * y + 0.01 * u
    return dict(windup=windup, measured=ys, output=us, integral=memory)


def main():
    data = dict(versions=dict(control=control.__version__, numpy=np.__version__), linear=linear(), cascade=cascade(),
                limited=[limited(word) for word in ("clamp", "back", "none")])
    (HERE / "pid.json").write_text(json.dumps(data) + "\n")
    for name in ("linear", "cascade"):
        print(name, np.abs(data[name]["states"]).max(), data[name]["states"][-1])


if __name__ == "__main__":
    main()
