"""Small ONNX graphs of many forms, and two ways to run them: gust and onnxruntime."""

import subprocess

import numpy as np
import onnx
import onnxruntime
from onnx import TensorProto, helper, numpy_helper
from onnx.reference import ReferenceEvaluator

FLOAT = TensorProto.FLOAT
DOUBLE = TensorProto.DOUBLE


class Graph:
    """Builds a graph node by node. Values are named by number; `dims` follows the width of the last value."""

    def __init__(self, inputs=4, opset=17, batch="N", dtype=FLOAT, seed=0):
        self.rng = np.random.default_rng(seed)
        self.opset = opset
        self.inputs = inputs
        self.batch = batch
        self.dtype = dtype
        self.nodes = []
        self.initializers = []
        self.count = 0

    def name(self, stem="v"):
        self.count += 1
        return f"{stem}{self.count}"

    def normal(self, *dims, scale=1.0):
        return (scale * self.rng.standard_normal(dims)).astype(np.float32)

    def const(self, array, form="raw"):
        """A constant as an initializer (raw or typed data) or as a Constant node."""
        array = np.asarray(array)
        name = self.name("c")
        if form == "typed":
            kind = helper.np_dtype_to_tensor_dtype(array.dtype)
            self.initializers.append(helper.make_tensor(name, kind, array.shape, array.flatten().tolist()))
        elif form == "raw":
            self.initializers.append(numpy_helper.from_array(array, name))
        else:
            self.nodes.append(helper.make_node("Constant", [], [name], value=numpy_helper.from_array(array, name)))
        return name

    def integers(self, *values):
        return self.const(np.array(values, dtype=np.int64))

    def op(self, kind, *inputs, outputs=1, **attributes):
        """Appends a node and gives the name of its output, or their names."""
        names = [self.name() for _ in range(outputs)]
        self.nodes.append(helper.make_node(kind, list(inputs), names, name=self.name("n"), **attributes))
        return names[0] if outputs == 1 else names

    def model(self, output, dims=None, output_name="action"):
        """The model whose action is a value of the graph."""
        self.nodes.append(helper.make_node("Identity", [output], [output_name], name="last"))
        shape = [self.batch, *(self.inputs if isinstance(self.inputs, tuple) else (self.inputs,))]
        obs = helper.make_tensor_value_info("obs", self.dtype, shape)
        action = helper.make_tensor_value_info(output_name, self.dtype, dims)
        graph = helper.make_graph(self.nodes, "policy", [obs], [action], self.initializers)
        opsets = [helper.make_opsetid("", self.opset)]
        return helper.make_model(graph, opset_imports=opsets, ir_version=8)


def mlp(sizes=(4, 16, 2), activation="Tanh", seed=0, **options):
    """A chain of Gemm with an activation between any two."""
    g = Graph(inputs=sizes[0], seed=seed, **options)
    value = "obs"
    for layer, (n, m) in enumerate(zip(sizes, sizes[1:])):
        if layer > 0:
            value = g.op(activation, value)
        value = g.op("Gemm", value, g.const(g.normal(m, n, scale=n**-0.5)), g.const(g.normal(m)), transB=1)
    return g.model(value)


def run_onnxruntime(model, observations):
    """The actions, one observation at a time where the file fixes the batch to one."""
    options = onnxruntime.SessionOptions()
    options.log_severity_level = 3
    options.intra_op_num_threads = 1
    session = onnxruntime.InferenceSession(model.SerializeToString(), options, providers=["CPUExecutionProvider"])
    return in_blocks(model, observations, session)


def run_exactly(model, observations):
    """The actions of the same graph in float64."""
    return in_blocks(model, observations, ReferenceEvaluator(in_double(model)), np.float64)


def in_blocks(model, observations, session, dtype=None):
    """Runs a session over all observations, in batches of the size that the file asks for."""
    entry = model.graph.input[0]
    dims = [dim.dim_value for dim in entry.type.tensor_type.shape.dim]
    if dtype is None:
        dtype = np.float64 if entry.type.tensor_type.elem_type == DOUBLE else np.float32
    names = [output.name for output in model.graph.output]
    action = [name for name in names if name in ("action", "actions")] or names
    data = observations.astype(dtype)
    size = 1 if len(dims) == 1 else dims[0] or len(data)
    shape = dims if len(dims) == 1 else [-1, *dims[1:]]
    blocks = [data[i : i + size].reshape(shape) for i in range(0, len(data), size)]
    results = [session.run(action[:1], {entry.name: block})[0] for block in blocks]
    return np.concatenate([np.reshape(result, -1) for result in results]).reshape(len(data), -1)


class Refused(Exception):
    """What gust says about a file that it does not take."""


def run_program(build, *arguments, data=b""):
    done = subprocess.run([build / "onnx_run", *map(str, arguments)], input=data, capture_output=True, timeout=60)
    if done.returncode == 2:
        raise Refused(done.stderr.decode().strip())
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout


def run_gust(build, path, observations, output=None):
    """The actions, and whether the network is a plain chain ("mlp") or not ("program")."""
    choice = ["--output", output] if output else []
    out = run_program(build, *choice, path, data=observations.astype(np.float32).tobytes())
    header, _, actions = out.partition(b"\n")
    n, m, kind = header.decode().split()
    assert int(n) == observations.shape[1]
    return np.frombuffer(actions, dtype=np.float32).reshape(-1, int(m)), kind


def in_double(model):
    """The same graph in float64."""
    wide = onnx.ModelProto()
    wide.CopyFrom(model)
    constants = [a.t for node in wide.graph.node for a in node.attribute if a.HasField("t")]
    for tensor in [*wide.graph.initializer, *constants]:
        if tensor.data_type == FLOAT:
            array = numpy_helper.to_array(tensor).astype(np.float64)
            tensor.CopyFrom(numpy_helper.from_array(array, tensor.name))
    for node in wide.graph.node:
        for attribute in node.attribute:
            if node.op_type == "Cast" and attribute.i == FLOAT:
                attribute.i = DOUBLE
    for info in [*wide.graph.input, *wide.graph.output]:
        info.type.tensor_type.elem_type = DOUBLE
    return wide


def compare(build, folder, model, observations=None):
    """Checks gust against onnxruntime, and gives the kind of network that gust saw.

    They agree to 1e-6 of the output's range, and twice what onnxruntime itself is off the same graph in float64: where
    large sums cancel, no float32 program can do better.
    """
    shape = model.graph.input[0].type.tensor_type.shape
    dims = [dim.dim_value for dim in shape.dim]
    width = int(np.prod(dims[1:])) if len(dims) > 1 else dims[0]
    if observations is None:
        observations = np.random.default_rng(1).uniform(-2, 2, (203, width)).astype(np.float32)
    path = folder / "model.onnx"
    onnx.save(model, path)
    ours, kind = run_gust(build, path, observations)
    theirs = run_onnxruntime(model, observations)
    exact = run_exactly(model, observations)
    assert ours.shape == theirs.shape == exact.shape
    rounding = 2 * np.spacing(np.abs(theirs).max())  # of an output that hardly moves
    allowed = 1e-6 * np.ptp(theirs, axis=0) + 2 * np.abs(theirs - exact).max(axis=0) + rounding
    assert np.all(np.abs(ours - theirs) <= allowed), f"off by {np.abs(ours - theirs).max(axis=0)}, allowed {allowed}"
    return kind
