"""Writes pytorch.txt: what PyTorch makes of small networks, of Adam and of PPO's losses, in float64.

Every line is a name and its numbers. Run with PyTorch installed: python make_reference.py > pytorch.txt
"""

import torch

torch.set_default_dtype(torch.float64)
torch.manual_seed(7)

ACTIVATIONS = {"tanh": torch.nn.Tanh, "relu": torch.nn.ReLU, "leaky_relu": torch.nn.LeakyReLU}


def write(name, tensor):
    numbers = " ".join(f"{value:.9g}" for value in tensor.detach().reshape(-1).tolist())
    print(f"{name} {numbers}")


def rounded(tensor):
    """The nearest numbers of nine digits: what the reader of the file will see."""
    return torch.tensor([float(f"{value:.9g}") for value in tensor.reshape(-1).tolist()]).reshape(tensor.shape)


def network(sizes, activation):
    layers = []
    for inputs, outputs in zip(sizes, sizes[1:]):
        layers += [torch.nn.Linear(inputs, outputs), activation()]
    net = torch.nn.Sequential(*layers[:-1])
    with torch.no_grad():
        for parameter in net.parameters():
            parameter.copy_(rounded(parameter))
    return net


def write_parameters(name, tensors):
    """Layer after layer, weights [output][input], then biases."""
    write(name, torch.cat([tensor.reshape(-1) for tensor in tensors]))


def mlp_case(name, sizes, activation, lanes):
    net = network(sizes, ACTIVATIONS[activation])
    x = rounded(torch.randn(lanes, sizes[0])).requires_grad_()
    target = rounded(torch.randn(lanes, sizes[-1]))
    write(f"{name}.sizes", torch.tensor(sizes))
    write_parameters(f"{name}.parameters", list(net.parameters()))
    write(f"{name}.input", x)
    write(f"{name}.target", target)
    y = net(x)
    write(f"{name}.output", y)
    loss = 0.5 * ((y - target) ** 2).mean()
    loss.backward()
    write_parameters(f"{name}.gradient", [parameter.grad for parameter in net.parameters()])
    write(f"{name}.input_gradient", x.grad)
    adam = torch.optim.Adam(net.parameters(), lr=1e-2)
    for _ in range(10):
        adam.zero_grad()
        (0.5 * ((net(x.detach()) - target) ** 2).mean()).backward()
        adam.step()
    write_parameters(f"{name}.after_adam", list(net.parameters()))


def ppo_case(name, lanes, actions):
    mean = rounded(torch.randn(lanes, actions) * 0.3).requires_grad_()
    log_std = rounded(torch.full((actions,), -0.5) + 0.1 * torch.randn(actions)).requires_grad_()
    action = rounded(torch.randn(lanes, actions) * 0.6)
    normal = torch.distributions.Normal(mean, log_std.exp())
    log_density = normal.log_prob(action).sum(-1)
    old = rounded(log_density.detach() + 0.2 * torch.randn(lanes))
    advantage = rounded(torch.randn(lanes))
    ratio = (log_density - old).exp()
    policy_loss = -torch.min(ratio * advantage, ratio.clamp(0.8, 1.2) * advantage).mean()
    entropy = normal.entropy().sum(-1).mean()
    (policy_loss - 0.01 * entropy).backward()
    for key, value in {
        "mean": mean, "log_std": log_std, "action": action, "log_density": log_density, "old": old,
        "advantage": advantage, "policy_loss": policy_loss, "entropy": entropy, "kl": (old - log_density).mean(),
        "mean_gradient": mean.grad, "log_std_gradient": log_std.grad,
    }.items():
        write(f"{name}.{key}", value)

    value = rounded(torch.randn(lanes)).requires_grad_()
    old_value = rounded(value.detach() + 0.3 * torch.randn(lanes))
    returns = rounded(torch.randn(lanes))
    plain = 0.5 * ((value - returns) ** 2).mean()
    (plain_gradient,) = torch.autograd.grad(plain, value)
    bounded = old_value + (value - old_value).clamp(-0.2, 0.2)
    clipped = 0.5 * torch.max((value - returns) ** 2, (bounded - returns) ** 2).mean()
    (clipped_gradient,) = torch.autograd.grad(clipped, value)
    for key, tensor in {
        "value": value, "old_value": old_value, "returns": returns, "value_loss": plain,
        "value_gradient": plain_gradient, "clipped_value_loss": clipped, "clipped_value_gradient": clipped_gradient,
    }.items():
        write(f"{name}.{key}", tensor)


for kind in ACTIVATIONS:
    mlp_case(f"small_{kind}", [5, 7, 6, 3], kind, 9)
mlp_case("wide_tanh", [4, 24, 40, 2], "tanh", 21)
ppo_case("ppo", 24, 2)
