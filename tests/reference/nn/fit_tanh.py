"""Fits tanh(x) by x p(x^2) / q(x^2) over |x| <= END, smallest largest error, and prints the coefficients of
gust/nn/activation.h, lowest power first, with the error in exact arithmetic. Needs NumPy."""

import numpy as np
from numpy.polynomial import polynomial

END, POWERS_P, POWERS_Q = 7.9, 3, 4

nodes = END / 2 * (1 - np.cos(np.pi * (np.arange(4000) + 0.5) / 4000))
square = (nodes / END) ** 2
target = np.tanh(nodes)
weight, q_values, best = np.ones_like(nodes), np.ones_like(nodes), None
for _ in range(1500):  # Lawson: least squares, weighted ever more where the error is large
    columns = np.hstack([nodes[:, None] * square[:, None] ** np.arange(POWERS_P + 1),
                         -target[:, None] * square[:, None] ** np.arange(1, POWERS_Q + 1)])
    scale = np.sqrt(weight) / np.abs(q_values)
    solution = np.linalg.lstsq(columns * scale[:, None], target * scale, rcond=1e-16)[0]
    p, q = solution[:POWERS_P + 1], np.concatenate([[1.0], solution[POWERS_P + 1:]])
    q_values = polynomial.polyval(square, q)
    error = np.abs(nodes * polynomial.polyval(square, p) / q_values - target)
    if best is None or error.max() < best[0]:
        best = (error.max(), p, q)
    weight *= error / error.max() + 1e-3
    weight /= weight.mean()

print("p", *(f"{c / END ** (2 * i):.9g}" for i, c in enumerate(best[1])))
print("q", *(f"{c / END ** (2 * i):.9g}" for i, c in enumerate(best[2])))
print(f"largest error {best[0]:.2g}")
