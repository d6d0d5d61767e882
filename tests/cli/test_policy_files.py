"""Policies in files as other programs write them: weights in a second file, several outputs."""

import json

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

EVAL = ("--plant", "cartpole", "--start", "random", "--episodes", "2", "--json")
STUDY = """
schema = 1
name = "files"
question = "Does it hold?"
plant = {{ kind = "cartpole" }}

[evaluate]
episodes = 2

[[policy]]
name = "mine"
kind = "onnx"
file = "policy.onnx"
{extra}
"""


def model(outputs):
    """A linear policy for each output: its gain times (1, 1, 10, 2)."""
    nodes, weights, infos = [], [], []
    for name, gain in outputs.items():
        weights.append(numpy_helper.from_array(gain * np.array([[1], [1], [10], [2]], np.float32), f"w_{name}"))
        nodes.append(helper.make_node("MatMul", ["obs", f"w_{name}"], [name]))
        infos.append(helper.make_tensor_value_info(name, TensorProto.FLOAT, ["N", 1]))
    obs = helper.make_tensor_value_info("obs", TensorProto.FLOAT, ["N", 4])
    graph = helper.make_graph(nodes, "policy", [obs], infos, weights)
    return helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)


def save_outside(path, gain):
    onnx.save(model({"linear": gain}), path, save_as_external_data=True, size_threshold=0, location="weights.data")


def returns(done):
    return [row["return_sum_commanded"] for row in json.loads(done.stdout)]


def test_a_policy_with_its_weights_in_a_second_file_acts_as_in_one(gust, tmp_path):
    onnx.save(model({"linear": 3.0}), tmp_path / "whole.onnx")
    save_outside(tmp_path / "policy.onnx", 3.0)

    ours = gust("eval", "policy.onnx", *EVAL)

    assert returns(ours) == returns(gust("eval", "whole.onnx", *EVAL))
    (tmp_path / "weights.data").unlink()
    assert "policy.onnx: its weights are in the file 'weights.data'" in gust("eval", "policy.onnx", *EVAL, code=2).stderr


def test_a_study_knows_a_policy_by_the_weights_beside_it(gust, tmp_path):
    """Equal ONNX files whose data files differ are different policies; a kept study has its own copy of both."""
    (tmp_path / "study.toml").write_text(STUDY.format(extra=""))
    cells = []
    for gain in (3.0, 0.5):
        save_outside(tmp_path / "policy.onnx", gain)
        gust("run", "study.toml", "--out", "kept.gust")
        (tmp_path / "weights.data").unlink()
        cells.append(returns(gust("eval", "mine", "--study", "kept.gust", "--start", "random", "--json")))
        trials = [path for path in (tmp_path / "kept.gust/store").rglob("manifest.json")]
        assert len(trials) == len(cells)

    assert cells[0] != cells[1]


def test_of_several_outputs_one_is_chosen_by_name(gust, tmp_path):
    onnx.save(model({"value": 0.0, "policy": 3.0}), tmp_path / "policy.onnx")
    onnx.save(model({"action": 3.0}), tmp_path / "one.onnx")

    refused = gust("eval", "policy.onnx", *EVAL, code=2).stderr
    assert "'value' [N, 1], 'policy' [N, 1]" in refused and "--output NAME" in refused
    assert "did you mean 'policy'" in gust("eval", "policy.onnx", *EVAL, "--output", "polcy", code=2).stderr
    chosen = gust("eval", "policy.onnx", *EVAL, "--output", "policy")
    assert returns(chosen) == returns(gust("eval", "one.onnx", *EVAL))
    assert "--output: is for a policy in a file" in gust("eval", "lqr", *EVAL, "--output", "x", code=2).stderr

    (tmp_path / "study.toml").write_text(STUDY.format(extra=""))
    assert "'value' [N, 1], 'policy' [N, 1]" in gust("run", "study.toml", code=2).stderr
    (tmp_path / "study.toml").write_text(STUDY.format(extra='output = "policy"'))
    gust("run", "study.toml", "--out", "kept.gust")


@pytest.mark.parametrize("name", ("Action", "mu", "mean", "ACTIONS", "deterministic_continuous_actions"))
def test_an_output_of_a_known_name_is_the_action(gust, tmp_path, name):
    onnx.save(model({"value": 0.0, name: 3.0, "log_std": 1.0}), tmp_path / "policy.onnx")
    onnx.save(model({"action": 3.0}), tmp_path / "one.onnx")

    assert returns(gust("eval", "policy.onnx", *EVAL)) == returns(gust("eval", "one.onnx", *EVAL))
