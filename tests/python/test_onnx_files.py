"""ONNX files from elsewhere: reference policies, exports of Stable-Baselines3, and what gust refuses with a reason."""

import os
import pathlib

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper

from onnx_graphs import Graph, Refused, compare, mlp, run_gust, run_onnxruntime, run_program

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

    model = onnx.load(path)
    output = model.graph.output[0].name

    ours, _ = run_gust(build, path, np.ascontiguousarray(table[:, :4]), output)

    assert np.abs(ours[:, 0] - table[:, column]).max() <= 1e-6 * np.ptp(table[:, column])
    del model.graph.output[1:]  # PPO's value and log-probability
    compare(build, tmp_path, model)


def test_several_outputs_are_listed_with_their_shapes(build):
    message = refusal(build, REFERENCE / "sb3_policies/ppo.onnx")

    assert "'53' [1, 1], '24' [1, 1], '51' [1]" in message and "--output NAME" in message


def refusal(build, path):
    with pytest.raises(Refused) as refused:
        run_gust(build, path, np.zeros((1, 4), np.float32))
    message = str(refused.value)
    assert message.startswith(str(path)) and "\n" not in message
    return message


@pytest.mark.parametrize("one_file", (True, False))
def test_weights_beside_the_file_are_those_within_it(build, tmp_path, one_file):
    model = mlp(seed=6)
    observations = np.random.default_rng(6).normal(size=(20, 4)).astype(np.float32)
    onnx.save(model, tmp_path / "whole.onnx")
    onnx.save(model, tmp_path / "policy.onnx", save_as_external_data=True, size_threshold=0,
              all_tensors_to_one_file=one_file, location="policy.onnx.data" if one_file else None)

    (tmp_path / "policy.onnx").rename(tmp_path / "renamed.onnx")
    ours, _ = run_gust(build, tmp_path / "renamed.onnx", observations)

    assert np.array_equal(ours, run_gust(build, tmp_path / "whole.onnx", observations)[0])


def outside(folder, location="policy.onnx.data"):
    """A policy whose weights are to be read from `location`, and the path of those weights."""
    path, data = folder / "policy.onnx", folder / "policy.onnx.data"
    onnx.save(mlp(), path, save_as_external_data=True, size_threshold=0, location=data.name)
    model = onnx.load(path, load_external_data=False)
    for tensor in model.graph.initializer:
        tensor.external_data[0].value = location
    onnx.save(model, path)
    return path, data


@pytest.mark.parametrize("location", ("../policy.onnx.data", "/etc/passwd", "weights/policy.onnx.data", ".."))
def test_weights_are_looked_for_in_the_folder_of_the_file_alone(build, tmp_path, location):
    path, _ = outside(tmp_path, location)

    assert "only a file in the folder of the ONNX file itself is read" in refusal(build, path)


def test_weights_that_are_missing_cut_short_or_no_file_are_refused(build, tmp_path):
    path, data = outside(tmp_path)
    whole = data.read_bytes()

    data.write_bytes(whole[:-4])
    assert "which has" in refusal(build, path)
    data.unlink()
    assert "'policy.onnx.data', which is not beside it" in refusal(build, path)
    data.mkdir()
    assert "no regular file" in refusal(build, path)
    data.rmdir()
    os.mkfifo(data)
    assert "no regular file" in refusal(build, path)


def test_a_link_to_weights_may_not_lead_out_of_the_folder(build, tmp_path):
    (tmp_path / "policies").mkdir()
    path, data = outside(tmp_path / "policies")
    observations = np.zeros((1, 4), np.float32)

    data.rename(data.with_name("weights"))
    data.symlink_to("weights")
    run_gust(build, path, observations)

    data.with_name("weights").rename(tmp_path / "weights")
    data.unlink()
    data.symlink_to("../weights")
    assert "a link that leads out of the folder" in refusal(build, path)

    data.unlink()
    (tmp_path / "weights").rename(data)
    (tmp_path / "latest.onnx").symlink_to("policies/policy.onnx")
    run_gust(build, tmp_path / "latest.onnx", observations)


def test_a_recurrent_network_is_refused_by_the_name_of_its_node(build, tmp_path):
    g = Graph()
    g.nodes.append(helper.make_node("LSTM", ["obs", g.const(g.normal(1, 8, 4))], ["y"], name="memory"))
    onnx.save(g.model("y"), tmp_path / "model.onnx")

    message = refusal(build, tmp_path / "model.onnx")

    assert "'memory'" in message and "'LSTM'" in message and "feed-forward" in message


def test_an_operator_that_is_not_supported_is_named_with_its_node(build, tmp_path):
    g = Graph()
    g.nodes.append(helper.make_node("TopK", ["obs"], ["y"], name="largest"))
    onnx.save(g.model("y"), tmp_path / "model.onnx")

    message = refusal(build, tmp_path / "model.onnx")

    assert "'largest'" in message and "'TopK'" in message and "Gemm" in message


def test_the_operators_that_are_documented_are_those_that_are_read(build):
    text = (REFERENCE.parent.parent / "docs/formats.md").read_text()
    listed = text.split("Operators that are read: ")[1].split(".\n")[0]

    assert " ".join(listed.split()) == run_program(build, "--operators").decode().strip()


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
    onnx.save(mlp(opset=6), tmp_path / "model.onnx")

    assert "opset 6" in refusal(build, tmp_path / "model.onnx")


def test_what_is_no_onnx_file_is_refused(build, tmp_path):
    contents = {"page.html": b"<!doctype html>" * 50, "weights.pt": bytes(range(256)), "empty.onnx": b""}
    for name, content in contents.items():
        (tmp_path / name).write_bytes(content)

        refusal(build, tmp_path / name)
