"""ONNX files that lie: each is refused with one clear error, exit code 2, little time and little memory."""

import os
import resource
import subprocess

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper

from onnx_graphs import FLOAT, Graph, mlp

MEMORY = 512 << 20  # bytes of address space; a small policy needs a tenth
HUGE = 2**31 - 8


def refusal(build, path):
    """What gust says of a file, in little memory and little time."""
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))  # noqa: E731
    done = subprocess.run([build / "onnx_run", path], input=b"\0" * 16, capture_output=True, timeout=10, preexec_fn=limit)
    message = done.stderr.decode()
    assert done.returncode == 2, (done.returncode, message)
    assert message.startswith(str(path)) and message.count("\n") == 1 and len(message) < 3000
    return message


def outside(folder, **entries):
    """A policy whose weights are said to lie in a data file, with entries such as offset=7."""
    path = folder / "policy.onnx"
    onnx.save(mlp(), path, save_as_external_data=True, size_threshold=0, location="policy.onnx.data")
    model = onnx.load(path, load_external_data=False)
    tensor = model.graph.initializer[0]
    kept = {entry.key: entry.value for entry in tensor.external_data} | {key: str(text) for key, text in entries.items()}
    del tensor.external_data[:]
    for key, text in kept.items():
        tensor.external_data.add(key=key, value=text)
    onnx.save(model, path)
    return path


@pytest.mark.parametrize("entries", (
    {"offset": 2**63}, {"offset": 2**64 - 1, "length": 2}, {"offset": -4}, {"offset": 10**30}, {"offset": "0x10"},
    {"offset": ""}, {"offset": "4 "}, {"length": 2**64 - 1}, {"length": -1}, {"length": HUGE}, {"length": 0},
    {"length": 255}, {"offset": 1, "length": 2**64 - 1}))
def test_a_place_outside_the_data_file_is_refused(build, tmp_path, entries):
    assert "'c" in refusal(build, outside(tmp_path, **entries))


@pytest.mark.parametrize("location", (
    "", ".", "..", "/", "../x", "a/../policy.onnx.data", "./policy.onnx.data", "/etc/passwd",
    "..\\x", "C:\\x", "file:///etc/passwd",
    "policy.onnx.data\n", "x" * 300, "~/x", "\u202e../x"))
def test_a_data_file_elsewhere_is_refused(build, tmp_path, location):
    refusal(build, outside(tmp_path, location=location))


@pytest.mark.parametrize("target", ("/etc/passwd", "/dev/zero", "policy.onnx.data", "../data", "gone"))
def test_a_link_to_another_place_is_refused(build, tmp_path, target):
    folder = tmp_path / "policies"
    folder.mkdir()
    path = outside(folder)
    (folder / "policy.onnx.data").rename(tmp_path / "data")
    os.symlink(target, folder / "policy.onnx.data")

    assert "'policy.onnx.data'" in refusal(build, path)


def test_a_large_data_file_is_not_read(build, tmp_path):
    path = outside(tmp_path)
    with open(tmp_path / "policy.onnx.data", "r+b") as file:
        file.truncate(HUGE)  # sparse

    assert "too large" in refusal(build, path)


@pytest.mark.parametrize("dims", (
    (2**62, 4), (2**32, 2**32), (2**63 - 1,), (-1, 4), (2**31, 2), (0, 2**62), (4, 2**40), (1,) * 500, (HUGE, 1)))
@pytest.mark.parametrize("filled", (True, False))
def test_a_shape_that_claims_more_than_there_is_is_refused(build, tmp_path, dims, filled):
    g = Graph()
    model = g.model(g.op("MatMul", "obs", g.const(g.normal(4, 2))))
    tensor = model.graph.initializer[0]
    del tensor.dims[:]
    tensor.dims.extend(dims)
    if not filled:
        tensor.ClearField("raw_data")
    (tmp_path / "model.onnx").write_bytes(model.SerializeToString())

    assert "'c1'" in refusal(build, tmp_path / "model.onnx")


@pytest.mark.parametrize("length", (2**31 - 1, 2**32 - 1, 2**63 - 1))
def test_a_length_beyond_the_file_is_refused(build, tmp_path, length):
    """Field 7 of the model, its graph, of a length that the file does not have."""
    varint = b""
    rest = length
    while rest > 127:
        varint += bytes([rest & 127 | 128])
        rest >>= 7
    (tmp_path / "model.onnx").write_bytes(b"\x08\x08\x3a" + varint + bytes([rest]) + b"\0" * 64)

    refusal(build, tmp_path / "model.onnx")


@pytest.mark.parametrize("sizes", ((1 << 24, 1 << 24), (1 << 40,), (2**63 - 1, 2), (1 << 23, 4)))
@pytest.mark.parametrize("op", ("Expand", "ConstantOfShape", "Tile", "Reshape"))
def test_a_node_that_would_make_a_huge_value_is_refused(build, tmp_path, sizes, op):
    g = Graph()
    shape = g.integers(*sizes)
    if op == "ConstantOfShape":
        value = g.op(op, shape)
    else:
        value = g.op(op, g.const(g.normal(*[1] * len(sizes))), shape)
    onnx.save(g.model(g.op("Add", "obs", value)), tmp_path / "model.onnx")

    assert f"'{op}'" in refusal(build, tmp_path / "model.onnx")


@pytest.mark.parametrize("bounds", ((0, 2**62, 1), (-(2**63), 2**63 - 1, 1), (0, 5, 0), (0, 2**24 + 1, 1), (2**62, 0, -1)))
def test_a_range_that_is_huge_or_none_is_refused(build, tmp_path, bounds):
    g = Graph()
    numbers = [g.const(np.int64(bound)) for bound in bounds]
    value = g.op("Cast", g.op("Range", *numbers), to=FLOAT)
    onnx.save(g.model(g.op("Add", "obs", g.op("ReduceMax", value))), tmp_path / "model.onnx")

    assert "'Range'" in refusal(build, tmp_path / "model.onnx")


@pytest.mark.parametrize("equation", (
    "", "->", "ij", "ij,jk->ii", "ij,jk->iz", "ii,ij->j", "...j,jk->...k", "ij,jk,kl->il", "ij,j k->i1", "ijk,jk->ik",
    "ij,kl->jl", "ij,jk->jk", "a" * 5000, "ij,jk->ik->ik"))
def test_an_equation_that_does_not_fit_or_mixes_lanes_is_refused(build, tmp_path, equation):
    g = Graph(opset=12)
    onnx.save(g.model(g.op("Einsum", "obs", g.const(g.normal(4, 2)), equation=equation)), tmp_path / "model.onnx")

    refusal(build, tmp_path / "model.onnx")


def test_products_of_an_equation_may_not_be_huge(build, tmp_path):
    g = Graph(opset=12)
    wide = g.const(np.ones((3000,), np.float32))
    onnx.save(g.model(g.op("Einsum", "obs", g.op("Einsum", wide, wide, equation="i,j->ij"), equation="bi,jk->bijk")),
              tmp_path / "model.onnx")

    assert "'Einsum'" in refusal(build, tmp_path / "model.onnx")


@pytest.mark.parametrize("length", (1, 2, 1000))
def test_a_cycle_is_refused(build, tmp_path, length):
    g = Graph()
    for i in range(length):
        g.nodes.append(helper.make_node("Add", ["obs", f"x{(i + 1) % length}"], [f"x{i}"], name=f"turn{i}"))
    (tmp_path / "model.onnx").write_bytes(g.model("x0").SerializeToString())

    assert "cycle" in refusal(build, tmp_path / "model.onnx")


def test_a_chain_of_many_nodes_is_no_recursion(build, tmp_path):
    g = Graph()
    value = "obs"
    for _ in range(200_000):
        value = g.op("Neg", value)
    (tmp_path / "model.onnx").write_bytes(g.model(value).SerializeToString())

    refusal(build, tmp_path / "model.onnx")


@pytest.mark.parametrize("lost", ("initializer", "node", "input", "output"))
def test_a_name_that_nothing_defines_is_refused(build, tmp_path, lost):
    model = mlp()
    del getattr(model.graph, lost)[0]
    (tmp_path / "model.onnx").write_bytes(model.SerializeToString())

    refusal(build, tmp_path / "model.onnx")


def test_doubling_values_end_at_the_limit(build, tmp_path):
    """A few hundred bytes that would ask for 2 to the 60 numbers."""
    g = Graph()
    value, constant = "obs", g.const(g.normal(1, 4))
    for _ in range(60):
        value = g.op("Concat", value, value, axis=1)
        constant = g.op("Concat", constant, constant, axis=1)
    onnx.save(g.model(g.op("Add", value, constant)), tmp_path / "model.onnx")

    assert "limit" in refusal(build, tmp_path / "model.onnx")


@pytest.mark.parametrize("kind", (TensorProto.FLOAT16, TensorProto.BFLOAT16, TensorProto.INT8, TensorProto.UINT8,
                                  TensorProto.STRING, TensorProto.COMPLEX64, TensorProto.INT4, 99))
def test_weights_of_another_type_are_refused_with_the_way_out(build, tmp_path, kind):
    model = mlp()
    model.graph.initializer[0].data_type = kind
    (tmp_path / "model.onnx").write_bytes(model.SerializeToString())

    assert "save the policy as float32" in refusal(build, tmp_path / "model.onnx")


def test_the_program_ends_with_2_before_any_work(program, tmp_path):
    path = outside(tmp_path, offset=2**40)

    done = subprocess.run([program, "eval", path, "--plant", "cartpole"], capture_output=True, timeout=10)
    assert done.returncode == 2 and b"policy.onnx" in done.stderr and not done.stdout

    with open(path, "r+b") as file:
        file.truncate(HUGE)  # sparse
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (2 * MEMORY, 2 * MEMORY))  # noqa: E731
    done = subprocess.run([program, "eval", path, "--plant", "cartpole"], capture_output=True, timeout=10, preexec_fn=limit)
    assert done.returncode == 2 and b"policy.onnx" in done.stderr and not done.stdout
