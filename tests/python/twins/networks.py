"""Networks with their gradients, and Adam."""

import numpy as np

# What a hidden layer does to its sums, and the slope of that from what came out.
ACTIVATIONS = {
    "tanh": (np.tanh, lambda value: 1 - value**2),
    "relu": (lambda total: np.maximum(total, 0), lambda value: value > 0),
    "none": (lambda total: total, lambda value: 1),
}


class Network:
    """Linear layers with an activation after each hidden one, started as PyTorch's are: U(±1/sqrt(inputs))."""

    def __init__(self, sizes, rng, activations=("tanh", "tanh")):
        self.after = [ACTIVATIONS[name] for name in (*activations, "none")]
        self.parameters = []  # weights, biases, weights ...
        for layer, (inputs, outputs) in enumerate(zip(sizes, sizes[1:])):
            for name, shape in (("weights", (outputs, inputs)), ("biases", (outputs,))):
                draws = rng.split(layer).split(name).uniform(np.arange(np.prod(shape)))
                # The training starts from float32, and a hair within the bound.
                start = (1 - 2.0**-24) * (2 * draws - 1) / np.sqrt(inputs)
                self.parameters.append(start.astype(np.float32).astype(float).reshape(shape))

    def layers(self, inputs):
        """The inputs, what each hidden layer makes of them, and the outputs."""
        values = [inputs]
        for weights, biases, (activate, _) in zip(self.parameters[::2], self.parameters[1::2], self.after):
            values.append(activate(values[-1] @ weights.T + biases))
        return values

    def __call__(self, inputs):
        return self.layers(inputs)[-1]

    def gradients(self, layers, slope):
        """A loss's gradients at the parameters and at the inputs, given its slope at the outputs."""
        gradient = []
        for below, above, weights, (_, steepness) in list(zip(layers, layers[1:], self.parameters[::2],
                                                              self.after))[::-1]:
            slope = slope * steepness(above)
            gradient[:0] = [slope.T @ below, slope.sum(axis=0)]
            slope = slope @ weights
        return gradient, slope


class Adam:
    """Moves arrays along their gradients (Kingma and Ba 2015)."""

    def __init__(self, parameters, rate, epsilon):
        self.parameters, self.rate, self.epsilon = parameters, rate, epsilon
        self.mean = [np.zeros_like(parameter) for parameter in parameters]
        self.square = [np.zeros_like(parameter) for parameter in parameters]
        self.steps = 0

    def step(self, gradient, share=1):
        """`share` of the rate is used."""
        self.steps += 1
        for parameter, slope, mean, square in zip(self.parameters, gradient, self.mean, self.square):
            mean += (1 - 0.9) * (slope - mean)
            square += (1 - 0.999) * (slope**2 - square)
            corrected = mean / (1 - 0.9**self.steps), square / (1 - 0.999**self.steps)
            parameter -= share * self.rate * self.direction(*corrected)

    def direction(self, mean, square):
        return mean / (np.sqrt(square) + self.epsilon)
