"""Graphs as exporters write them, rebuilt node by node, agree with onnxruntime to a millionth of the output's range.

The real files were made once, with the releases that docs/formats.md names; what they held and nothing else here has
is kept as the graphs below."""

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper

from onnx_graphs import FLOAT, Graph, Refused, compare, run_gust, run_onnxruntime
from test_onnx_operators import between_layers
from test_onnx_sums import compare_with_reference


@pytest.mark.parametrize("opset", (9, 13, 17))
def test_layer_normalisation_of_keras_2(build, tmp_path, opset):
    """tf2onnx: the batch becomes the channels of a BatchNormalization whose mean and variance are the lane's."""
    sizes = {"axes": [0, 2, 3]}

    def normalise(g, x):
        shape = g.op("Cast", g.op("Shape", x), to=TensorProto.INT64)
        wide = g.op("Reshape", x, g.integers(1, -1, 6, 1))
        first = g.op("Slice", shape, g.integers(0), g.integers(1), g.integers(0)) if opset > 9 else g.op(
            "Slice", shape, starts=[0], ends=[1], axes=[0])
        ones = g.op("Expand", g.const(np.ones(1, np.float32)), first)
        zeros = g.op("ConstantOfShape", first, value=helper.make_tensor("zero", FLOAT, [1], [0.0]))
        mean = g.op("ReduceMean", wide, keepdims=1, **sizes)
        squares = g.op("ReduceSumSquare", g.op("Sub", wide, mean), keepdims=0, **sizes)
        lanes = g.op("Squeeze", mean, g.integers(0, 2, 3)) if opset >= 13 else g.op("Squeeze", mean, **sizes)
        count = g.op("ReduceProd", g.op("Gather", g.op("Shape", wide), g.integers(0, 2, 3)), axes=[0], keepdims=0)
        variance = g.op("Div", squares, g.op("Cast", count, to=FLOAT))
        plain = g.op("BatchNormalization", wide, ones, zeros, lanes, variance, epsilon=1e-3)
        back = g.op("Reshape", plain, shape)
        return g.op("Add", g.op("Mul", back, g.const(g.normal(6))), g.const(g.normal(6)))

    compare(build, tmp_path, between_layers(normalise, opset=opset))


def test_softmax_of_jax(build, tmp_path):
    """jax2onnx: the largest number is compared with minus infinity."""
    def softmax(g, x):
        largest = g.op("Max", g.const(np.float32(-np.inf)), g.op("ReduceMax", x, g.integers(1), keepdims=1))
        powers = g.op("Exp", g.op("Sub", x, g.op("Min", g.const(np.float32(np.inf)), largest)))
        return g.op("Div", powers, g.op("ReduceSum", powers, g.integers(1), keepdims=1))

    compare(build, tmp_path, between_layers(softmax))


def test_standard_deviation_of_jax(build, tmp_path):
    """jax2onnx: NaN stands where there would be too few numbers to divide by."""
    def normalise(g, x):
        mean = g.op("ReduceMean", x, g.integers(1), keepdims=1)
        squares = g.op("ReduceSumSquare", g.op("Sub", x, mean), g.integers(1), keepdims=1)
        count = g.op("Cast", g.op("Gather", g.op("Shape", x), g.const(np.int64(1))), to=FLOAT)
        enough = g.op("Greater", count, g.const(np.float32(0)))
        variance = g.op("Where", enough, g.op("Div", squares, count), g.const(np.float32(np.nan)))
        return g.op("Div", x, g.op("Sqrt", variance))

    compare(build, tmp_path, between_layers(normalise))


@pytest.mark.parametrize("broken", (np.nan, np.inf))
def test_weights_that_are_no_numbers_are_still_refused(build, tmp_path, broken):
    weights = np.ones(6, np.float32)
    weights[2] = broken
    for op in ("Add", "Mul", "Div", "Sub", "Pow"):
        onnx.save(between_layers(lambda g, x: g.op(op, x, g.const(weights))), tmp_path / "model.onnx")

        with pytest.raises(Refused, match="infinite or not a number"):
            run_gust(build, tmp_path / "model.onnx", np.zeros((1, 4), np.float32))


def test_a_reversed_observation_of_jax(build, tmp_path):
    """Against onnx's reference: onnxruntime 1.32 makes Gather by a falling Range an empty slice when it optimises."""
    def reverse(g, x):
        size = g.op("Gather", g.op("Shape", x), g.const(np.int64(1)))
        last = g.op("Sub", size, g.const(np.int64(1)))
        order = g.op("Range", last, g.const(np.int64(-1)), g.const(np.int64(-1)))
        return g.op("Gather", x, order, axis=1)

    compare_with_reference(build, tmp_path, between_layers(reverse))


@pytest.mark.parametrize("width", (4, 6))
def test_godot_hands_a_state_on(build, tmp_path, width):
    """Godot RL Agents: inputs obs and state_ins, outputs output and state_outs."""
    g = Graph(inputs=width, seed=31)
    hidden = g.op("Tanh", g.op("Gemm", "obs", g.const(g.normal(8, width)), g.const(g.normal(8)), transB=1))
    mean = g.op("Gemm", hidden, g.const(g.normal(2, 8)), g.const(g.normal(2)), transB=1)
    model = g.model(g.op("Clip", mean, g.const(np.float32(-1)), g.const(np.float32(1))), output_name="output")
    model.graph.node.append(helper.make_node("Identity", ["state_ins"], ["state_outs"]))
    model.graph.input.append(helper.make_tensor_value_info("state_ins", FLOAT, ["N"]))
    model.graph.output.append(helper.make_tensor_value_info("state_outs", FLOAT, ["N"]))
    onnx.save(model, tmp_path / "model.onnx")
    observations = np.random.default_rng(6).normal(size=(50, width)).astype(np.float32)

    ours, _ = run_gust(build, tmp_path / "model.onnx", observations)

    del model.graph.node[-1], model.graph.input[-1], model.graph.output[-1]
    theirs = run_onnxruntime(model, observations)
    assert np.abs(ours - theirs).max() <= 1e-6 * np.ptp(theirs)


@pytest.mark.parametrize("op, reason", (
    ("Erfc", "operator of TensorFlow"), ("Expm1", "operator of TensorFlow"), ("RandomNormalLike", "samples at random"),
    ("DynamicQuantizeLinear", "before it is quantised"), ("MatMulInteger", "before it is quantised")))
def test_what_is_not_read_is_refused_with_the_way_out(build, tmp_path, op, reason):
    g = Graph()
    g.nodes.append(helper.make_node(op, ["obs"], ["y"], name="culprit"))
    (tmp_path / "model.onnx").write_bytes(g.model("y").SerializeToString())

    with pytest.raises(Refused, match=f"'culprit' of type '{op}': .*{reason}"):
        run_gust(build, tmp_path / "model.onnx", np.zeros((1, 4), np.float32))


@pytest.mark.parametrize("op", ("LSTM", "GRU", "RNN", "Loop", "Scan"))
def test_recurrent_graphs_are_refused_by_name(build, tmp_path, op):
    g = Graph()
    g.nodes.append(helper.make_node(op, ["obs"], ["y"], name="memory"))
    (tmp_path / "model.onnx").write_bytes(g.model("y").SerializeToString())

    with pytest.raises(Refused, match=f"'memory' of type '{op}': is recurrent.*feed-forward"):
        run_gust(build, tmp_path / "model.onnx", np.zeros((1, 4), np.float32))


def test_a_quantised_network_is_refused_with_the_way_out(build, tmp_path):
    """onnxruntime's QDQ form: weights of int8 beside their scale."""
    g = Graph()
    weights = g.op("DequantizeLinear", g.const(np.ones((4, 2), np.int8)), g.const(np.float32(0.1)), g.const(np.int8(0)))
    onnx.save(g.model(g.op("MatMul", "obs", weights)), tmp_path / "model.onnx")

    with pytest.raises(Refused, match="int8; save the policy as float32, before it is quantised"):
        run_gust(build, tmp_path / "model.onnx", np.zeros((1, 4), np.float32))
