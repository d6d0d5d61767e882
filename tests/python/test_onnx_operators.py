"""Every operator that gust reads agrees with onnxruntime to a millionth of the output's range; see test_onnx_sums.py for
those of several inputs, test_onnx_exporters.py for graphs as exporters write them."""

import numpy as np
import onnx
import onnxruntime
import pytest
from onnx import helper

from onnx_graphs import FLOAT, Graph, Refused, compare, run_gust, run_onnxruntime

# Functions of one number, with their parameters.
UNARY = {
    "Abs": {}, "Atan": {}, "Asinh": {}, "Ceil": {}, "Celu": {"alpha": 0.7}, "Cos": {}, "Cosh": {}, "Elu": {"alpha": 0.6},
    "Erf": {}, "Exp": {}, "Floor": {}, "HardSigmoid": {"alpha": 0.3, "beta": 0.4}, "HardSwish": {}, "LeakyRelu": {},
    "LogSoftmax": {}, "Mish": {}, "Neg": {}, "Relu": {}, "Round": {}, "Selu": {}, "Shrink": {"lambd": 0.4, "bias": 0.1},
    "Sigmoid": {}, "Sign": {}, "Sin": {}, "Sinh": {}, "Softmax": {}, "Softplus": {}, "Softsign": {}, "Tanh": {},
    "ThresholdedRelu": {"alpha": 0.3}, "Identity": {}, "Dropout": {},
}
REDUCTIONS = ("ReduceL1", "ReduceL2", "ReduceMax", "ReduceMean", "ReduceMin", "ReduceProd", "ReduceSum", "ReduceSumSquare")


def between_layers(make, opset=18, seed=20, **options):
    """A network that applies make(g, x) to six numbers x; it gives `options["width"]` numbers, or six."""
    width = options.pop("width", 6)
    g = Graph(opset=opset, seed=seed, **options)
    value = g.op("Gemm", "obs", g.const(g.normal(4, 6, scale=0.5)), g.const(g.normal(6)))
    return g.model(g.op("MatMul", make(g, value), g.const(g.normal(width, 2))))


@pytest.mark.parametrize("kind", UNARY)
def test_functions_agree_with_onnxruntime(build, tmp_path, kind):
    compare(build, tmp_path, between_layers(lambda g, x: g.op(kind, x, **UNARY[kind])))


@pytest.mark.parametrize("kind", ("Acos", "Asin", "Tan"))
def test_functions_of_a_bounded_number_agree_with_onnxruntime(build, tmp_path, kind):
    compare(build, tmp_path, between_layers(lambda g, x: g.op(kind, g.op("Tanh", x))))


@pytest.mark.parametrize("kind", ("Log", "Sqrt", "Reciprocal"))
def test_functions_of_a_positive_number_agree_with_onnxruntime(build, tmp_path, kind):
    positive = lambda g, x: g.op("Add", g.op("Abs", x), g.const(np.float32(0.1)))  # noqa: E731
    compare(build, tmp_path, between_layers(lambda g, x: g.op(kind, positive(g, x))))


@pytest.mark.parametrize("approximate", ("none", "tanh"))
def test_gelu_agrees_with_onnxruntime(build, tmp_path, approximate):
    compare(build, tmp_path, between_layers(lambda g, x: g.op("Gelu", x, approximate=approximate), opset=20))


@pytest.mark.parametrize("exponent", (2.0, 3.0, 0.5, 1.5, -1.0))
def test_powers_agree_with_onnxruntime(build, tmp_path, exponent):
    positive = lambda g, x: g.op("Add", g.op("Abs", x), g.const(np.float32(0.2)))  # noqa: E731
    compare(build, tmp_path,
            between_layers(lambda g, x: g.op("Pow", positive(g, x), g.const(np.float32(exponent)))))
    if exponent == int(exponent) and exponent > 0:
        compare(build, tmp_path, between_layers(lambda g, x: g.op("Pow", x, g.const(np.float32(exponent)))))


@pytest.mark.parametrize("slopes", ((1,), (6,), (1, 6)))
def test_prelu_agrees_with_onnxruntime(build, tmp_path, slopes):
    compare(build, tmp_path, between_layers(lambda g, x: g.op("PRelu", x, g.const(g.normal(*slopes)))))


@pytest.mark.parametrize("kind", ("Greater", "Less", "GreaterOrEqual", "LessOrEqual", "Equal"))
def test_comparisons_and_choices_agree_with_onnxruntime(build, tmp_path, kind):
    def choose(g, x):
        whole = g.op("Floor", x)
        first = g.op(kind, whole, g.const(np.float32(0)))
        second = g.op("And", first, g.op("Not", g.op("Greater", x, g.const(np.float32(1.5)))))
        weight = g.op("Cast", g.op("Xor", first, g.op("Or", second, g.op("Less", x, g.const(g.normal(6))))), to=FLOAT)
        return g.op("Add", weight, g.op("Where", second, g.op("Mul", x, x), g.const(np.float32(0.3))))

    compare(build, tmp_path, between_layers(choose))


def test_what_is_not_a_number_can_be_replaced(build, tmp_path):
    def replace(g, x):
        broken = g.op("Log", x)  # NaN below 0
        clean = g.op("Where", g.op("IsNaN", broken), g.const(np.float32(-1)), broken)
        return g.op("Where", g.op("IsInf", clean), g.const(np.float32(0)), clean)

    compare(build, tmp_path, between_layers(replace))


@pytest.mark.parametrize("kind", REDUCTIONS)
@pytest.mark.parametrize("opset", (11, 18))
def test_reductions_agree_with_onnxruntime(build, tmp_path, kind, opset):
    as_input = opset >= 18 or kind == "ReduceSum" and opset >= 13

    def reduce(g, x):
        cube = g.op("Reshape", x, g.integers(-1, 2, 3))
        axes = [g.integers(1)] if as_input else []
        kept = {} if as_input else {"axes": [1]}
        rows = g.op(kind, cube, *axes, keepdims=0, **kept)
        return g.op("Concat", rows, g.op(kind, x, *([g.integers(-1)] if as_input else []),
                                         **({} if as_input else {"axes": [-1]})), axis=1)

    compare(build, tmp_path, between_layers(reduce, opset=opset, width=4))


@pytest.mark.parametrize("opset", (11, 18))
@pytest.mark.parametrize("keepdims", (0, 1))
def test_logarithms_of_sums_agree_with_onnxruntime(build, tmp_path, opset, keepdims):
    def reduce(g, x):
        axis = ([g.integers(-1)], {}) if opset >= 18 else ([], {"axes": [-1]})
        positive = g.op("Add", g.op("Abs", x), g.const(np.float32(0.1)))
        large = g.op("Mul", x, g.const(np.float32(60)))
        logarithms = [g.op(kind, value, *axis[0], keepdims=keepdims, **axis[1])
                      for kind, value in (("ReduceLogSum", positive), ("ReduceLogSumExp", large))]
        return g.op("Concat", *(g.op("Reshape", value, g.integers(-1, 1)) for value in logarithms), axis=1)

    compare(build, tmp_path, between_layers(reduce, opset=opset, width=2))


@pytest.mark.parametrize("p", (1, 2))
@pytest.mark.parametrize("axis", (-1, 1, 2))
def test_values_scaled_to_a_length_of_one_agree_with_onnxruntime(build, tmp_path, p, axis):
    """Zeros stay zeros."""
    def scale(g, x):
        cube = g.op("Reshape", g.op("Mul", x, g.const(np.array([1, 1, 1, 0, 0, 0], np.float32))), g.integers(0, 2, 3))
        return g.op("Reshape", g.op("LpNormalization", cube, axis=axis, p=p), g.integers(0, 6))

    compare(build, tmp_path, between_layers(scale))


@pytest.mark.parametrize("groups", (1, 2, 3, 6))
def test_group_normalisation_agrees_with_onnxruntime(build, tmp_path, groups):
    """Of opset 21, where scale and shift belong to a channel."""
    compare(build, tmp_path, between_layers(lambda g, x: g.op(
        "GroupNormalization", x, g.const(g.normal(6)), g.const(g.normal(6)), num_groups=groups, epsilon=0.5), opset=21))


def test_group_normalisation_of_opset_18_scales_groups(build, tmp_path):
    """Against NumPy."""
    g = Graph(opset=18, seed=33)
    weights, scale, shift, last = g.normal(4, 6), g.normal(3), g.normal(3), g.normal(6, 2)
    plain = g.op("GroupNormalization", g.op("MatMul", "obs", g.const(weights)), g.const(scale), g.const(shift), num_groups=3)
    onnx.save(g.model(g.op("MatMul", plain, g.const(last))), tmp_path / "model.onnx")
    observations = np.random.default_rng(3).normal(size=(60, 4)).astype(np.float32)

    ours, _ = run_gust(build, tmp_path / "model.onnx", observations)

    x = (observations.astype(np.float64) @ weights).reshape(-1, 3, 2)
    x = (x - x.mean(axis=2, keepdims=True)) / np.sqrt(x.var(axis=2, keepdims=True) + 1e-5)
    exact = (x * scale[:, None] + shift[:, None]).reshape(-1, 6) @ last
    assert np.abs(ours - exact).max() <= 1e-5 * np.ptp(exact)  # pairs: the difference of two floats over itself


def test_means_of_channels_agree_with_onnxruntime(build, tmp_path):
    def pool(g, x):
        return g.op("Reshape", g.op("GlobalAveragePool", g.op("Reshape", x, g.integers(0, 2, 3))), g.integers(0, 2))

    compare(build, tmp_path, between_layers(pool, width=2))


@pytest.mark.parametrize("equation, shape", (
    ("bi,ij->bj", (6, 5)), ("bi,ji->bj", (5, 6)), ("ij,bi->bj", (6, 5)), ("bi,ij", (6, 5)), ("bi,i->bi", (6,)),
    ("b i , i j -> j b", (6, 5)), ("bi,->bi", ()), ("Bi,ijk->Bkj", (6, 2, 3)), ("bi,k->bik", (3,))))
def test_sums_of_products_with_weights_agree_with_onnxruntime(build, tmp_path, equation, shape):
    width = {"bi,->bi": 6, "bi,i->bi": 6, "Bi,ijk->Bkj": 6, "bi,k->bik": 18}.get(equation, 5)

    def multiply(g, x):
        weights = g.const(g.normal(*shape) if shape else np.float32(1.7))
        terms = [weights, x] if equation.startswith("ij,") else [x, weights]
        value = g.op("Einsum", *terms, equation=equation)
        return g.op("Reshape", g.op("Transpose", value) if equation.endswith("j b") else value, g.integers(-1, width))

    compare(build, tmp_path, between_layers(multiply, width=width))


@pytest.mark.parametrize("equation, width", (
    ("bij,bjk->bik", 4), ("bij,bkj->bki", 4), ("bij,bij->bi", 2), ("bij,bij->b", 1), ("bij,bkl->bikjl", 36),
    ("bij,bkj->bk", 2)))
def test_sums_of_products_of_values_agree_with_onnxruntime(build, tmp_path, equation, width):
    def multiply(g, x):
        left = g.op("Reshape", x, g.integers(0, 2, 3))
        turned = equation.startswith("bij,bj")
        right = g.op("Reshape", g.op("Sin", x), g.integers(0, 3, 2) if turned else g.integers(0, 2, 3))
        return g.op("Reshape", g.op("Einsum", left, right, equation=equation), g.integers(-1, width))

    compare(build, tmp_path, between_layers(multiply, width=width))


@pytest.mark.parametrize("equation, width", (
    ("bij->bji", 6), ("bij->bi", 2), ("bij->bj", 3), ("jbi->bij", 6), ("bij->b", 1)))
def test_sums_of_one_value_agree_with_onnxruntime(build, tmp_path, equation, width):
    def turn(g, x):
        cube = g.op("Reshape", x, g.integers(0, 2, 3))
        cube = g.op("Transpose", cube, perm=[2, 0, 1]) if equation.startswith("jb") else cube
        return g.op("Reshape", g.op("Einsum", cube, equation=equation), g.integers(-1, width))

    compare(build, tmp_path, between_layers(turn, width=width))


@pytest.mark.parametrize("shift", (True, False))
def test_layer_normalisation_agrees_with_onnxruntime(build, tmp_path, shift):
    compare(build, tmp_path, between_layers(lambda g, x: g.op(
        "LayerNormalization", x, g.const(g.normal(6)), *([g.const(g.normal(6))] if shift else []), epsilon=1e-3)))


@pytest.mark.parametrize("opset", (9, 17))
def test_batch_normalisation_agrees_with_onnxruntime(build, tmp_path, opset):
    def normalise(g, x):
        numbers = [g.normal(6), g.normal(6), g.normal(6), np.abs(g.normal(6)) + 0.3]
        return g.op("BatchNormalization", x, *(g.const(row) for row in numbers), epsilon=1e-3)

    compare(build, tmp_path, between_layers(normalise, opset=opset))


def test_batch_normalisation_in_training_is_refused(build, tmp_path):
    rows = lambda g: [g.const(np.abs(g.normal(6))) for _ in range(4)]  # noqa: E731
    model = between_layers(lambda g, x: g.op("BatchNormalization", x, *rows(g), outputs=3, training_mode=1)[0])
    onnx.save(model, tmp_path / "model.onnx")

    with pytest.raises(Refused, match="model.eval"):
        run_gust(build, tmp_path / "model.onnx", np.zeros((1, 4), np.float32))


def test_instance_normalisation_agrees_with_onnxruntime(build, tmp_path):
    def normalise(g, x):
        groups = g.op("Reshape", x, g.integers(0, 2, -1))
        plain = g.op("InstanceNormalization", groups, g.const(g.normal(2)), g.const(g.normal(2)))
        return g.op("Reshape", plain, g.integers(0, 6))

    compare(build, tmp_path, between_layers(normalise))


def test_single_elements_are_picked_as_pytorch_writes_it(build, tmp_path):
    """x[:, [4, 1]] of the newer exporter: the batch is moved away and back."""
    def pick(g, x):
        columns = g.op("Transpose", x, perm=[1, 0])
        rows = g.op("GatherND", columns, g.const(np.array([[4], [1]], np.int64)))
        return g.op("Transpose", rows, perm=[1, 0])

    compare(build, tmp_path, between_layers(pick, width=2))


def test_gather_and_scatter_of_elements_agree_with_onnxruntime(build, tmp_path):
    def swap(g, x):
        where = g.const(np.array([[5, 0]], np.int64))
        taken = g.op("GatherElements", x, where, axis=1)
        return g.op("ScatterElements", x, where, g.op("Tanh", taken), axis=1)

    compare(build, tmp_path, between_layers(swap, batch=1))


def test_constants_join_the_observation_in_every_lane(build, tmp_path):
    """A goal of the network itself, expanded to the batch as PyTorch writes it."""
    def join(g, x):
        batch = g.op("Unsqueeze", g.op("Gather", g.op("Shape", x), g.const(np.int64(0))), g.integers(0))
        shape = g.op("Concat", batch, g.integers(3), axis=0)
        ones = g.op("ConstantOfShape", g.op("Shape", shape), value=helper.make_tensor("one", 7, [1], [1]))
        open_size = g.op("Equal", shape, g.op("Mul", ones, g.const(np.int64(-1))))
        goal = g.op("Expand", g.const(g.normal(1, 3)), g.op("Where", open_size, ones, shape))
        tiled = g.op("Tile", g.const(g.normal(1, 1)), g.op("Concat", batch, g.integers(1), axis=0))
        return g.op("Concat", x, goal, tiled, axis=1)

    compare(build, tmp_path, between_layers(join, width=10))


def test_products_with_the_weights_on_the_left_agree_with_onnxruntime(build, tmp_path):
    def gain(g, x):
        column = g.op("Unsqueeze", x, g.integers(2))
        force = g.op("Squeeze", g.op("MatMul", g.const(g.normal(3, 6)), column), g.integers(2))
        return g.op("Add", force, g.op("Transpose", g.op("MatMul", g.const(g.normal(3, 6)), g.op("Transpose", x))))

    compare(build, tmp_path, between_layers(gain, width=3))


def test_angles_are_wrapped_as_exporters_write_it(build, tmp_path):
    def wrap(g, x):
        turn = g.const(np.float32(2 * np.pi))
        floor = g.op("Floor", g.op("Div", x, turn))
        rest = g.op("Mod", x, g.const(np.float32(1.5)), fmod=1)
        return g.op("Add", rest, g.op("Sub", x, g.op("Mul", floor, turn)))

    compare(build, tmp_path, between_layers(wrap))


def test_graphs_of_opset_9_are_read_as_unity_writes_them(build, tmp_path):
    """Normalised and clipped observations, Swish, and constants among the outputs."""
    g = Graph(opset=9, seed=22)
    deviation = g.op("Sqrt", g.op("Div", g.const(np.abs(g.normal(4)) + 1), g.const(np.float32(3))))
    observation = g.op("Clip", g.op("Div", g.op("Sub", "obs", g.const(g.normal(4))), deviation), min=-5.0, max=5.0)
    hidden = g.op("Gemm", observation, g.const(g.normal(4, 8)), g.const(g.normal(8)))
    hidden = g.op("Mul", hidden, g.op("Sigmoid", hidden))
    mean = g.op("Gemm", hidden, g.const(g.normal(8, 2)), g.const(g.normal(2)))
    model = g.model(g.op("Div", g.op("Clip", mean, min=-3.0, max=3.0), g.const(np.float32(3))),
                    output_name="deterministic_continuous_actions")
    model.graph.node.append(helper.make_node("Identity", [g.const(np.array([3], np.float32))], ["version_number"]))
    outputs = [helper.make_tensor_value_info("version_number", FLOAT, [1]), *model.graph.output]
    del model.graph.output[:]
    model.graph.initializer.append(g.initializers[-1])
    model.graph.output.extend(outputs)
    onnx.save(model, tmp_path / "unity.onnx")
    observations = np.random.default_rng(4).normal(size=(50, 4)).astype(np.float32)

    ours, _ = run_gust(build, tmp_path / "unity.onnx", observations)

    session = onnxruntime.InferenceSession(tmp_path / "unity.onnx", providers=["CPUExecutionProvider"])
    theirs = session.run(["deterministic_continuous_actions"], {"obs": observations})[0]
    assert np.abs(ours - theirs).max() <= 1e-6 * np.ptp(theirs)


@pytest.mark.parametrize("norm", ("L1", "L2"))
def test_normalised_observations_of_scikit_learn_are_read(build, tmp_path, norm):
    g = Graph(seed=24)
    scaled = g.op("Normalizer", g.op("Mul", "obs", g.const(np.float32(3))), domain="ai.onnx.ml", norm=norm)
    model = g.model(g.op("MatMul", scaled, g.const(g.normal(4, 2))))
    model.opset_import.append(helper.make_opsetid("ai.onnx.ml", 1))
    onnx.save(model, tmp_path / "model.onnx")
    observations = np.vstack([np.zeros(4), np.random.default_rng(5).normal(size=(50, 4))]).astype(np.float32)

    ours, _ = run_gust(build, tmp_path / "model.onnx", observations)

    theirs = run_onnxruntime(model, observations)
    assert np.abs(ours - theirs).max() <= 1e-6 * np.ptp(theirs)


def test_linear_models_of_scikit_learn_are_read(build, tmp_path):
    """A scaled choice of the observation, as skl2onnx writes it."""
    g = Graph(seed=23)
    numbers = [row.tolist() for row in (g.normal(4), np.abs(g.normal(4)) + 0.5, g.normal(6), g.normal(2))]
    scaled = g.op("Scaler", "obs", domain="ai.onnx.ml", offset=numbers[0], scale=numbers[1])
    chosen = g.op("ArrayFeatureExtractor", scaled, g.integers(3, 0, 2), domain="ai.onnx.ml")
    action = g.op("LinearRegressor", chosen, domain="ai.onnx.ml", coefficients=numbers[2], intercepts=numbers[3], targets=2)
    model = g.model(action)
    model.opset_import.append(helper.make_opsetid("ai.onnx.ml", 1))
    onnx.save(model, tmp_path / "model.onnx")
    observations = np.random.default_rng(5).normal(size=(50, 4)).astype(np.float32)

    ours, _ = run_gust(build, tmp_path / "model.onnx", observations)

    theirs = run_onnxruntime(model, observations)
    assert np.abs(ours - theirs).max() <= 1e-6 * np.ptp(theirs)
