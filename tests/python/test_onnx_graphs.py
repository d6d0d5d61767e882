"""gust runs feed-forward ONNX graphs as onnxruntime does: every operator, and random graphs of them."""

import numpy as np
import onnx
import onnxruntime
import pytest
from onnx import helper

from onnx_graphs import DOUBLE, FLOAT, Graph, compare, mlp, run_gust, run_onnxruntime, run_program

FORMS = ("raw", "typed", "node")
OPSETS = (11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21)


def random_function(g, value, rng):
    kind = rng.choice(["Tanh", "Relu", "LeakyRelu", "Elu", "Sigmoid", "Softplus", "Clip", "ClipLow", "ClipHigh"])
    low, high = g.const(np.float32(-0.7)), g.const(np.float32(0.9), rng.choice(FORMS))
    if kind == "Clip":
        return g.op("Clip", value, low, high)
    if kind == "ClipLow":
        return g.op("Clip", value, low)
    if kind == "ClipHigh":
        return g.op("Clip", value, "", high)
    if kind in ("LeakyRelu", "Elu") and rng.random() < 0.5:
        return g.op(kind, value, alpha=float(rng.uniform(0.05, 1.5)))
    return g.op(kind, value)


def random_gemm(g, value, n, m, rng):
    attributes = {}
    if rng.random() < 0.5:
        attributes["alpha"] = float(rng.uniform(-2, 2))
    if rng.random() < 0.5:
        attributes["beta"] = float(rng.uniform(-2, 2))
    weights = g.normal(n, m, scale=n**-0.5)
    if rng.random() < 0.5:
        weights, attributes["transB"] = weights.T.copy(), 1
    shape = [(m,), (1, m), (1,), (1, 1), ()][rng.integers(5)]
    bias = [g.const(g.normal(*shape), rng.choice(FORMS))] if rng.random() < 0.8 else []
    return g.op("Gemm", value, g.const(weights, rng.choice(FORMS)), *bias, **attributes)


def random_matmul(g, value, n, m, rng):
    weights = g.normal(n, m, scale=n**-0.5)
    if rng.random() < 0.3:
        matrix = g.op("Transpose", g.const(weights.T.copy()), perm=[1, 0])
    elif rng.random() < 0.3:
        matrix = g.op("Cast", g.const(weights.astype(np.float64), rng.choice(FORMS)), to=FLOAT)
    else:
        matrix = g.const(weights, rng.choice(FORMS))
    value = g.op("MatMul", value, matrix)
    bias = g.const(g.normal(*[(m,), (1, m), ()][rng.integers(3)]))
    return g.op("Add", value, bias) if rng.random() < 0.5 else g.op("Add", bias, value)


def random_affine(g, value, n, rng):
    """Running means and deviations, as a normalised observation has them."""
    mean, scale = g.normal(n), np.abs(g.normal(1, n)) + 0.5
    value = g.op("Sub", value, g.const(mean, rng.choice(FORMS)))
    if rng.random() < 0.5:
        return g.op("Div", value, g.const(scale))
    return g.op("Mul", g.const(scale), value)


def random_detour(g, value, n, rng):
    """Nodes that change nothing, or only the order of things."""
    kind = rng.choice(["Identity", "Cast", "Flatten", "Reshape", "Squeeze", "Split", "Slice", "Gather", "Residual"])
    if kind == "Identity":
        return g.op("Identity", value)
    if kind == "Cast":
        return g.op("Cast", g.op("Cast", value, to=DOUBLE), to=FLOAT)
    if kind == "Flatten":
        return g.op("Flatten", value)
    if kind == "Reshape":
        return g.op("Reshape", value, g.integers(*[(-1, n), (0, n), (0, -1)][rng.integers(3)]))
    if kind == "Squeeze":
        if g.opset < 13:
            return g.op("Squeeze", g.op("Unsqueeze", value, axes=[1]), axes=[1])
        return g.op("Squeeze", g.op("Unsqueeze", value, g.integers(1)), g.integers(1))
    if kind == "Split" and n >= 2:
        part = int(rng.integers(1, n))
        sizes = {"split": [part, n - part]} if g.opset < 13 else {}
        inputs = [] if g.opset < 13 else [g.integers(part, n - part)]
        first, second = g.op("Split", value, *inputs, outputs=2, axis=1, **sizes)
        return g.op("Concat", second, first, axis=-1)
    if kind == "Slice" and n >= 2:
        head = g.op("Slice", value, g.integers(0), g.integers(1), g.integers(1))
        tail = g.op("Slice", value, g.integers(-1), g.integers(0), g.integers(-1), g.integers(-1))
        return g.op("Concat", head, tail, axis=1)
    if kind == "Gather":
        return g.op("Gather", value, g.integers(*rng.permutation(n)), axis=1)
    return g.op("Add", value, g.op("Mul", value, g.const(np.float32(0.3))))


def random_model(seed):
    rng = np.random.default_rng(seed)
    hidden = [int(n) for n in rng.integers(1, 40, rng.integers(0, 4))]
    sizes = [int(rng.integers(1, 9)), *hidden, int(rng.integers(1, 5))]
    batch = 1 if rng.random() < 0.3 else "N"
    g = Graph(inputs=sizes[0], opset=int(rng.choice(OPSETS)), batch=batch, seed=seed)
    value = "obs"
    if rng.random() < 0.5:
        value = random_affine(g, value, sizes[0], rng)
    for layer, (n, m) in enumerate(zip(sizes, sizes[1:])):
        if layer > 0:
            value = random_function(g, value, rng)
        if rng.random() < 0.4:
            value = random_detour(g, value, n, rng)
        value = (random_gemm if rng.random() < 0.6 else random_matmul)(g, value, n, m, rng)
    if rng.random() < 0.5:
        value = g.op("Add", g.op("Mul", g.op("Tanh", value), g.const(g.normal(sizes[-1]))), g.const(np.float32(0.2)))
    return g.model(value)


@pytest.mark.parametrize("block", range(12))
def test_random_graphs_agree_with_onnxruntime(build, tmp_path, block):
    for seed in range(25 * block, 25 * (block + 1)):
        compare(build, tmp_path, random_model(seed))


@pytest.mark.parametrize("opset", OPSETS)
def test_a_plain_chain_is_taken_for_one_in_every_opset(build, tmp_path, opset):
    assert compare(build, tmp_path, mlp(opset=opset)) == "mlp"


@pytest.mark.parametrize("activation", ("Tanh", "Relu", "LeakyRelu"))
def test_a_rewritten_file_is_an_ordinary_model_of_the_same_bits(build, tmp_path, activation):
    model = mlp((5, 32, 24, 3), activation, seed=3)
    onnx.helper.set_model_props(model, {"gust.plant": "cartpole", "note": "ü"})
    onnx.save(model, tmp_path / "model.onnx")
    observations = np.random.default_rng(2).normal(size=(65, 5)).astype(np.float32)

    (tmp_path / "ours.onnx").write_bytes(run_program(build, "--rewrite", tmp_path / "model.onnx"))
    ours = onnx.load(tmp_path / "ours.onnx")

    onnx.checker.check_model(ours, full_check=True)
    assert [(info.name, dims(info)) for info in ours.graph.input] == [("obs", ["N", 5])]
    assert [(info.name, dims(info)) for info in ours.graph.output] == [("action", ["N", 3])]
    assert {entry.key: entry.value for entry in ours.metadata_props} == {"gust.plant": "cartpole", "note": "ü"}
    assert np.array_equal(run_onnxruntime(ours, observations), run_onnxruntime(model, observations))
    first, second = (run_gust(build, tmp_path / name, observations) for name in ("model.onnx", "ours.onnx"))
    assert np.array_equal(first[0], second[0]) and first[1] == second[1] == "mlp"
    assert run_program(build, "--rewrite", tmp_path / "ours.onnx") == (tmp_path / "ours.onnx").read_bytes()


def dims(info):
    return [dim.dim_param or dim.dim_value for dim in info.type.tensor_type.shape.dim]


@pytest.mark.parametrize("activation", ("Tanh", "Relu"))
def test_trained_sizes_agree_to_a_millionth_of_the_range(build, tmp_path, activation):
    for seed in range(5):
        model = mlp((4, 64, 64, 1), activation, seed=seed)
        onnx.save(model, tmp_path / "model.onnx")
        observations = np.random.default_rng(seed).uniform(-1, 1, (1000, 4)).astype(np.float32)

        ours, kind = run_gust(build, tmp_path / "model.onnx", observations)

        theirs = run_onnxruntime(model, observations)
        assert kind == "mlp"
        assert np.abs(ours - theirs).max() <= 1e-6 * np.ptp(theirs)


@pytest.mark.parametrize("chain", (True, False))
def test_bits_do_not_depend_on_the_number_of_lanes(build, tmp_path, chain):
    model = mlp((4, 33, 7, 2), seed=5) if chain else random_model(6)
    onnx.save(model, tmp_path / "model.onnx")
    width = model.graph.input[0].type.tensor_type.shape.dim[1].dim_value
    observations = np.random.default_rng(3).normal(size=(150, width)).astype(np.float32)

    together, kind = run_gust(build, tmp_path / "model.onnx", observations)

    assert kind == ("mlp" if chain else "program")
    for first, last in ((0, 1), (1, 4), (9, 73), (149, 150)):
        alone, _ = run_gust(build, tmp_path / "model.onnx", observations[first:last])
        assert np.array_equal(alone, together[first:last])


def test_an_input_in_float64_is_rounded(build, tmp_path):
    g = Graph(dtype=DOUBLE, seed=8)
    first, bias, second = (g.normal(*dims).astype(np.float64) for dims in ((4, 8), (8,), (8, 2)))
    hidden = g.op("Tanh", g.op("Gemm", "obs", g.const(first), g.const(bias)))
    action = g.op("MatMul", hidden, g.const(second, "typed"))

    assert compare(build, tmp_path, g.model(action)) == "mlp"


def test_an_observation_of_several_dimensions_is_taken_flat(build, tmp_path):
    g = Graph(inputs=(2, 3), seed=9)
    action = g.op("Gemm", g.op("Flatten", "obs"), g.const(g.normal(6, 2)))
    assert compare(build, tmp_path, g.model(action)) == "mlp"

    g = Graph(inputs=(2, 3), seed=9)
    rows = g.op("MatMul", g.op("Mul", "obs", g.const(g.normal(2, 1))), g.const(g.normal(3, 4)))
    action = g.op("Reshape", g.op("Add", rows, g.const(g.normal(2, 4))), g.integers(0, -1))
    assert compare(build, tmp_path, g.model(action)) == "program"


def test_a_model_without_a_batch_runs_lane_by_lane(build, tmp_path):
    g = Graph(seed=10)
    hidden = g.op("Relu", g.op("MatMul", "obs", g.const(g.normal(4, 8))))
    model = g.model(g.op("MatMul", hidden, g.const(g.normal(8))))
    del model.graph.input[0].type.tensor_type.shape.dim[0]

    assert compare(build, tmp_path, model) == "mlp"


def test_values_broadcast_as_in_numpy(build, tmp_path):
    g = Graph(inputs=3, seed=11)
    one = g.op("MatMul", "obs", g.const(g.normal(3, 1)))
    wide = g.op("Mul", one, g.const(g.normal(1, 5)))
    sums = g.op("Add", wide, one)
    scalar = g.op("Mul", g.const(np.float32(2)), g.const(g.normal(5)))

    assert compare(build, tmp_path, g.model(g.op("Sub", scalar, sums))) == "program"


def test_sizes_computed_from_the_batch_are_understood(build, tmp_path):
    """What exporters write for x.view(x.size(0), -1) and for a distribution's mean."""
    g = Graph(inputs=(2, 2), opset=17, seed=12)
    batch = g.op("Unsqueeze", g.op("Gather", g.op("Shape", "obs"), g.const(np.int64(0))), g.integers(0))
    flat = g.op("Reshape", "obs", g.op("Concat", batch, g.integers(-1), axis=0))
    mean = g.op("Gemm", flat, g.const(g.normal(4, 2)))
    zeros = g.op("ConstantOfShape", g.op("Shape", mean), value=helper.make_tensor("zero", FLOAT, [1], [0.0]))
    deviation = g.op("Exp", g.op("Clip", g.op("Gemm", flat, g.const(g.normal(4, 2))), g.const(np.float32(-20))))
    action = g.op("Expand", mean, g.op("Shape", g.op("Add", g.op("Add", zeros, mean), deviation)))

    # The deviation is used for its shape alone, so what is left is the one Gemm.
    assert compare(build, tmp_path, g.model(action)) == "mlp"


def test_what_the_action_does_not_need_may_be_anything(build, tmp_path):
    model = mlp(seed=13)
    model.graph.node.append(helper.make_node("Hardmax", [model.graph.node[0].output[0]], ["log_prob"], name="tail"))
    model.graph.output.append(helper.make_tensor_value_info("log_prob", FLOAT, None))
    model.graph.output.reverse()

    assert compare(build, tmp_path, model) == "mlp"


def test_a_summand_of_gemm_may_depend_on_the_observation(build, tmp_path):
    g = Graph(seed=14)
    weights = g.op("Gemm", g.const(g.normal(3, 4)), g.const(g.normal(3, 6)), g.const(g.normal(6)), transA=1, alpha=0.5)
    first = g.op("MatMul", "obs", weights)
    action = g.op("Gemm", "obs", g.const(g.normal(4, 6)), first, beta=-0.5)

    assert compare(build, tmp_path, g.model(action)) == "program"


def test_a_conditional_policy_runs_with_and_without_its_risk_level(build, tmp_path):
    onnx.save(mlp((5, 32, 2), "Relu", seed=4), tmp_path / "plain.onnx")
    observations = np.random.default_rng(5).normal(size=(40, 4)).astype(np.float32)

    path = tmp_path / "conditional.onnx"
    path.write_bytes(run_program(build, "--conditional", 0.3, tmp_path / "plain.onnx"))
    model = onnx.load(path)

    onnx.checker.check_model(model, full_check=True)
    assert [(info.name, dims(info)) for info in model.graph.input] == [("obs", ["N", 4]), ("alpha", [1])]
    session = onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])
    standard = session.run(["action"], {"obs": observations})[0]
    ours, kind = run_gust(build, path, observations)
    assert kind == "mlp"
    assert np.abs(ours - standard).max() <= 1e-6 * np.ptp(standard)
    for alpha in (0.3, 0.9):
        told = session.run(["action"], {"obs": observations, "alpha": np.array([alpha], np.float32)})[0]
        level = np.full((40, 1), alpha, np.float32)
        plain, _ = run_gust(build, tmp_path / "plain.onnx", np.hstack([observations, level]))
        assert np.abs(told - plain).max() <= 1e-6 * np.ptp(plain)
        assert np.array_equal(told, standard) == (alpha == 0.3)
