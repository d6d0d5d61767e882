"""ONNX files from elsewhere: reference policies, exports of Stable-Baselines3, and what gust refuses with a reason."""

import pathlib

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper

from onnx_graphs import Graph, Refused, compare, mlp, run_gust, run_onnxruntime

REFERENCE = pathlib.Path(__file__).resolve().parent.parent / "reference"


@pytest.mark.parametrize("name", ("scg-2022-ppo-s1", "scg-default-ppo-s1"))
def test_reference_policies_agree_to_a_millionth_of_the_range(build, name):
    path = REFERENCE / "scg_policies" / f"{name}.onnx"
    spread = np.array([2.4, 3.0, 1.5, 3.0])
    observations = (np.random.default_rng(0).uniform(-1, 1, (5000, 4)) * spread).astype(np.float32)

    ours, kind = run_gust(build, path, observations)

    theirs = run_onnxruntime(onnx.load(path), observations)
    assert kind == "mlp"
    assert np.abs(ours - theirs).max() <= 1e-6 * np.ptp(theirs)


@pytest.mark.parametrize("column, name", enumerate(("ppo", "sac", "td3"), start=4))
def test_exports_of_stable_baselines_act_as_the_policies_do(build, tmp_path, column, name):
    table = np.loadtxt(REFERENCE / "sb3_policies/actions.csv", delimiter=",", skiprows=1, dtype=np.float32)
    path = REFERENCE / "sb3_policies" / f"{name}.onnx"

    ours, _ = run_gust(build, path, np.ascontiguousarray(table[:, :4]))

    assert np.abs(ours[:, 0] - table[:, column]).max() <= 1e-6 * np.ptp(table[:, column])
    compare(build, tmp_path, onnx.load(path))


def refusal(build, path):
    with pytest.raises(Refused) as refused:
        run_gust(build, path, np.zeros((1, 4), np.float32))
    message = str(refused.value)
    assert message.startswith(str(path)) and "\n" not in message
    return message


def test_weights_in_a_second_file_are_refused_with_the_remedy(build, tmp_path):
    path = tmp_path / "model.onnx"
    onnx.save(mlp(), path, save_as_external_data=True, size_threshold=0)

    message = refusal(build, path)

    assert "second file" in message and "external_data=False" in message


def test_an_operator_that_is_not_supported_is_named_with_its_node(build, tmp_path):
    g = Graph()
    g.nodes.append(helper.make_node("LSTM", ["obs", g.const(g.normal(1, 8, 4))], ["y"], name="memory"))
    onnx.save(g.model("y"), tmp_path / "model.onnx")

    message = refusal(build, tmp_path / "model.onnx")

    assert "'memory'" in message and "'LSTM'" in message and "Gemm" in message


def test_a_sub_graph_is_refused_by_the_name_of_its_operator(build, tmp_path):
    g = Graph()
    branch = helper.make_graph([helper.make_node("Identity", ["obs"], ["z"])], "branch", [], [
        helper.make_tensor_value_info("z", TensorProto.FLOAT, None)])
    choice = g.op("If", g.const(np.array(True)), then_branch=branch, else_branch=branch)
    onnx.save(g.model(g.op("Add", "obs", choice)), tmp_path / "model.onnx")

    assert "'If'" in refusal(build, tmp_path / "model.onnx")


def test_half_precision_is_refused_with_the_remedy(build, tmp_path):
    g = Graph(dtype=TensorProto.FLOAT16)
    onnx.save(g.model(g.op("MatMul", "obs", g.const(g.normal(4, 1).astype(np.float16)))), tmp_path / "model.onnx")

    message = refusal(build, tmp_path / "model.onnx")

    assert "float16" in message and "float32" in message


def test_an_older_opset_is_refused(build, tmp_path):
    onnx.save(mlp(opset=9), tmp_path / "model.onnx")

    assert "opset 9" in refusal(build, tmp_path / "model.onnx")


def test_what_is_no_onnx_file_is_refused(build, tmp_path):
    contents = {"page.html": b"<!doctype html>" * 50, "weights.pt": bytes(range(256)), "empty.onnx": b""}
    for name, content in contents.items():
        (tmp_path / name).write_bytes(content)

        refusal(build, tmp_path / name)
