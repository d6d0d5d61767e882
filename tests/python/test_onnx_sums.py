"""Operators of several inputs, or without a kernel in onnxruntime: Sum, Mean, CastLike; Swish and RMSNormalization."""

import numpy as np
import onnx
import pytest
from onnx import TensorProto
from onnx.reference import ReferenceEvaluator

from onnx_graphs import FLOAT, Graph, Refused, compare, in_double, run_gust, run_onnxruntime
from test_onnx_operators import between_layers


@pytest.mark.parametrize("kind", ("Sum", "Mean"))
@pytest.mark.parametrize("opset", (8, 13, 21))
@pytest.mark.parametrize("count", (1, 2, 3, 7))
def test_sums_and_means_of_any_number_of_inputs_agree_with_onnxruntime(build, tmp_path, kind, opset, count):
    def join(g, x):
        parts = [x, g.op("Tanh", x), g.const(g.normal(6)), g.op("Mul", x, x), x, g.const(g.normal(1, 6)), g.op("Sin", x)]
        return g.op(kind, *parts[:count])

    compare(build, tmp_path, between_layers(join, opset=opset))


@pytest.mark.parametrize("kind", ("Sum", "Mean"))
def test_sums_and_means_broadcast_as_in_numpy(build, tmp_path, kind):
    """The first input need not have the shape of the result, nor any single one.

    onnx's reference adds into its first input, so the truth is onnxruntime alone.
    """
    def join(g, x):
        rows = g.op("Reshape", x, g.integers(0, 2, 3))
        column = g.op("Reshape", g.op("ReduceMean", x, g.integers(1)), g.integers(0, 1, 1))
        joined = g.op(kind, g.const(np.float32(0.7)), g.const(g.normal(2, 1)), column, rows, g.const(g.normal(1, 1, 3)))
        return g.op("Reshape", g.op(kind, g.const(g.normal(2, 1)), joined), g.integers(0, 6))

    model = between_layers(join)
    onnx.save(model, tmp_path / "model.onnx")
    observations = np.random.default_rng(1).uniform(-2, 2, (203, 4)).astype(np.float32)

    ours, _ = run_gust(build, tmp_path / "model.onnx", observations)

    theirs = run_onnxruntime(model, observations)
    assert np.all(np.abs(ours - theirs) <= 1e-6 * np.ptp(theirs, axis=0))


@pytest.mark.parametrize("kind", ("Sum", "Mean"))
def test_sums_and_means_of_constants_are_constants(build, tmp_path, kind):
    """As weights of a layer, which must not depend on the observation."""
    def multiply(g, x):
        return g.op("MatMul", x, g.op(kind, g.const(g.normal(6, 5)), g.const(g.normal(1, 5)), g.const(np.float32(0.1))))

    assert compare(build, tmp_path, between_layers(multiply, width=5)) == "program"


@pytest.mark.parametrize("opset", (15, 19, 21))
def test_values_cast_to_the_type_of_another_agree_with_onnxruntime(build, tmp_path, opset):
    """CastLike as PyTorch's newer exporter writes it for constants, truths and integers."""
    def cast(g, x):
        doubled = g.op("CastLike", g.const(np.float64(0.3)), x)
        truths = g.op("CastLike", g.op("Greater", x, g.const(np.float32(0))), x)
        whole = g.op("CastLike", g.integers(3), x)
        floored = g.op("CastLike", g.op("Cast", x, to=TensorProto.INT64), x)
        wide = g.op("Cast", g.op("CastLike", x, g.const(np.float64(1))), to=FLOAT)
        return g.op("Add", g.op("Mul", doubled, truths), g.op("Sub", g.op("Div", floored, whole), wide))

    compare(build, tmp_path, between_layers(cast, opset=opset))


def test_values_cast_to_the_type_of_integers_and_truths_agree_with_onnxruntime(build, tmp_path):
    def cast(g, x):
        whole = g.op("CastLike", g.op("Mul", x, g.const(np.float32(1.7))), g.integers(1))
        some = g.op("CastLike", x, g.const(np.array([True])))
        truths = g.op("CastLike", g.op("Floor", x), g.op("Less", x, g.const(np.float32(0))))
        weights = g.op("CastLike", g.op("CastLike", g.const(g.normal(6, scale=3.0)), g.integers(1)), x)
        counted = g.op("Add", g.op("Cast", whole, to=FLOAT), g.op("Cast", g.op("And", some, truths), to=FLOAT))
        return g.op("Mul", counted, weights)

    compare(build, tmp_path, between_layers(cast))


# onnxruntime 1.32 has no kernel for the operators below: the truth is onnx's own reference, in float64.
def compare_with_reference(build, folder, model):
    """Checks gust against the reference, to 1e-6 of the range and what float32 rounds of the largest output."""
    observations = np.random.default_rng(1).uniform(-2, 2, (203, 4)).astype(np.float32)
    onnx.save(model, folder / "model.onnx")

    ours, _ = run_gust(build, folder / "model.onnx", observations)

    exact = ReferenceEvaluator(in_double(model)).run(["action"], {"obs": observations.astype(np.float64)})[0]
    assert ours.shape == exact.shape
    assert np.all(np.abs(ours - exact) <= 1e-6 * np.ptp(exact, axis=0) + 2 * np.spacing(np.float32(np.abs(exact).max())))
    return observations, ours


@pytest.mark.parametrize("alpha", ({}, {"alpha": 1.0}, {"alpha": 0.4}, {"alpha": 1.702}, {"alpha": -1.0}))
def test_swish_agrees_with_the_reference(build, tmp_path, alpha):
    compare_with_reference(build, tmp_path, between_layers(lambda g, x: g.op("Swish", x, **alpha), opset=24))


def test_swish_stays_finite_far_from_zero(build, tmp_path):
    g = Graph(opset=24)
    onnx.save(g.model(g.op("Swish", g.op("Mul", "obs", g.const(np.float32(1e3))), alpha=2.0)), tmp_path / "model.onnx")
    observations = np.array([[-3e4, -1, 0, 3e4]], np.float32)

    ours, _ = run_gust(build, tmp_path / "model.onnx", observations)

    assert np.array_equal(ours, np.array([[0, 0, 0, 3e7]], np.float32))


@pytest.mark.parametrize("epsilon", ({}, {"epsilon": 1e-3}, {"epsilon": 0.5}))
def test_root_mean_square_normalisation_agrees_with_the_reference(build, tmp_path, epsilon):
    compare_with_reference(build, tmp_path, between_layers(
        lambda g, x: g.op("RMSNormalization", x, g.const(g.normal(6)), **epsilon), opset=23))


@pytest.mark.parametrize("axis, scale", ((-1, (3,)), (2, (1, 3)), (-2, (2, 3)), (1, (2, 3)), (1, (3,)), (-1, (2, 3))))
def test_root_mean_square_normalisation_takes_all_axes_from_the_one_named(build, tmp_path, axis, scale):
    """Against x / sqrt(mean(x^2) + epsilon) in NumPy, where the scale broadcasts as numpy does."""
    g = Graph(opset=23, seed=30)
    weights, gain, last = g.normal(4, 6), g.normal(*scale), g.normal(6, 2)
    cube = g.op("Reshape", g.op("MatMul", "obs", g.const(weights)), g.integers(0, 2, 3))
    plain = g.op("RMSNormalization", cube, g.const(gain), axis=axis, epsilon=1e-4)
    action = g.op("MatMul", g.op("Reshape", plain, g.integers(0, 6)), g.const(last))
    onnx.save(g.model(action), tmp_path / "model.onnx")
    observations = np.random.default_rng(2).normal(size=(60, 4)).astype(np.float32)

    ours, _ = run_gust(build, tmp_path / "model.onnx", observations)

    x = (observations.astype(np.float64) @ weights).reshape(-1, 2, 3)
    axes = tuple(range(axis % 3, 3))
    exact = (x / np.sqrt(np.mean(x**2, axis=axes, keepdims=True) + 1e-4) * gain).reshape(-1, 6) @ last
    assert np.abs(ours - exact).max() <= 1e-6 * np.ptp(exact)


def test_root_mean_square_normalisation_across_the_batch_is_refused(build, tmp_path):
    onnx.save(between_layers(lambda g, x: g.op("RMSNormalization", x, g.const(g.normal(6)), axis=0), opset=23),
              tmp_path / "model.onnx")

    with pytest.raises(Refused, match="works along the batch"):
        run_gust(build, tmp_path / "model.onnx", np.zeros((1, 4), np.float32))
