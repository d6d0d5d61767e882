"""gust trial: single trials by their ids, in a folder that gust plan --prepare made."""

import json

import pytest

STUDY = """
schema = 1
name   = "single"
seed   = 3
plant  = { kind = "cartpole", preset = "scg-2022" }

[evaluate]
episodes = 2

[[policy]]
name = "lqr"
kind = "lqr"

[[policy]]
name  = "ppo"
kind  = "train"
agent = { kind = "ppo", steps = 400 }
seeds = [1]

[[sweep]]
name     = "white"
site     = "action"
waveform = "white"
levels   = [0, 5]
"""


@pytest.fixture
def prepared(gust, tmp_path):
    """The trials of a study whose folder was made and where nothing has run."""
    (tmp_path / "study.toml").write_text(STUDY)
    return json.loads(gust("plan", "study.toml", "--prepare", "--json").stdout)


def planned(gust):
    return json.loads(gust("plan", "study.toml", "--json").stdout)


def trial(trials, kind, what=""):
    return next(trial for trial in trials if trial["kind"] == kind and what in trial["what"])


def test_the_plan_says_what_a_trial_needs(prepared):
    ids = {item["id"]: item for item in prepared}
    training = trial(prepared, "train")
    assert training["needs"] == []
    assert trial(prepared, "evaluate", "ppo seed 1 · white")["needs"] == [training["id"]]
    assert trial(prepared, "evaluate", "lqr · white")["needs"] == []
    needed = [ids[id]["what"] for id in trial(prepared, "margin", "ppo")["needs"]]
    assert needed == ["evaluate ppo seed 1 · nominal", "evaluate ppo seed 1 · white"]


def test_without_prepare_a_plan_writes_nothing(gust, tmp_path):
    (tmp_path / "study.toml").write_text(STUDY)
    gust("plan", "study.toml")
    assert [path.name for path in tmp_path.iterdir()] == ["study.toml"]


def test_trials_run_after_what_they_need_whatever_their_order(gust, prepared):
    training, evaluation = trial(prepared, "train"), trial(prepared, "evaluate", "ppo seed 1 · white")

    done = gust("trial", "single.gust", evaluation["id"], training["id"], evaluation["id"], "--threads", "2")

    assert done.stdout == f"done     {training['what']}\ndone     {evaluation['what']}\n"
    assert done.stderr == ""
    assert {item["id"] for item in planned(gust) if item["done"]} == {training["id"], evaluation["id"]}


def test_a_trial_that_is_there_is_not_run_again(gust, tmp_path, prepared):
    training = trial(prepared, "train")
    gust("trial", "single.gust", training["id"])
    manifest = tmp_path / "single.gust/store/train" / training["id"] / "manifest.json"
    before = manifest.stat()

    done = gust("trial", "single.gust", training["id"], "--json")

    assert json.loads(done.stdout) == [
        {"id": training["id"], "kind": "train", "what": training["what"], "state": "done", "reason": ""}]
    assert (manifest.stat().st_ino, manifest.stat().st_mtime_ns) == (before.st_ino, before.st_mtime_ns)


def test_a_trial_that_is_damaged_is_run_again(gust, tmp_path, prepared):
    training = trial(prepared, "train")
    gust("trial", "single.gust", training["id"])
    policy = tmp_path / "single.gust/store/train" / training["id"] / "policy.onnx"
    right = policy.read_bytes()
    policy.write_bytes(right[:-1])

    done = gust("trial", "single.gust", training["id"])

    assert "damaged" in done.stderr
    assert policy.read_bytes() == right


@pytest.mark.parametrize(("what", "needed"), [("evaluate ppo seed 1 · nominal", "train ppo seed 1"),
                                               ("margin ppo · white", "evaluate ppo seed 1 · nominal")])
def test_a_trial_without_what_it_needs_is_skipped_and_the_others_run(gust, prepared, what, needed):
    lacking = next(item for item in prepared if item["what"] == what)
    other = trial(prepared, "evaluate", "lqr · nominal")
    missing = next(item for item in prepared if item["what"] == needed)

    done = gust("trial", "single.gust", lacking["id"], other["id"], code=1)

    assert done.stderr == f"gust: {what} was skipped: input missing: {needed} ({missing['id']})\n"
    assert sorted(done.stdout.splitlines()) == sorted([f"skipped  {what}", f"done     {other['what']}"])
    states = {item["id"]: item["state"] for item in
              json.loads(gust("trial", "single.gust", lacking["id"], other["id"], "--json", code=1).stdout)}
    assert states == {lacking["id"]: "skipped", other["id"]: "done"}


def test_a_trial_whose_input_is_damaged_is_skipped_until_that_is_run_again(gust, tmp_path, prepared):
    training, evaluation = trial(prepared, "train"), trial(prepared, "evaluate", "ppo seed 1 · white")
    gust("trial", "single.gust", training["id"])
    (tmp_path / "single.gust/store/train" / training["id"] / "policy.onnx").write_bytes(b"")

    done = gust("trial", "single.gust", evaluation["id"], code=1)

    assert "damaged" in done.stderr and f"input missing: train ppo seed 1 ({training['id']})" in done.stderr
    gust("trial", "single.gust", evaluation["id"], training["id"])


def test_an_unknown_id_is_refused_before_the_others_run(gust, prepared):
    training = trial(prepared, "train")
    wrong = training["id"][:-1] + ("0" if training["id"][-1] != "0" else "1")

    done = gust("trial", "single.gust", training["id"], wrong, code=2)

    assert f"its study has no trial '{wrong}'; did you mean '{training['id']}'?" in done.stderr
    assert not any(item["done"] for item in planned(gust))


def test_a_trial_of_another_study_is_unknown(gust, tmp_path, prepared):
    (tmp_path / "other.toml").write_text(STUDY.replace("seed   = 3", "seed   = 4"))
    other = json.loads(gust("plan", "other.toml", "--json").stdout)
    evaluation = trial(other, "evaluate", "lqr · white")

    done = gust("trial", "single.gust", evaluation["id"], code=2)

    assert f"its study has no trial '{evaluation['id']}'" in done.stderr


def test_the_folder_keeps_settings_and_policy_files(gust, tmp_path, prepared):
    gust("train", "ppo", "--plant", "cartpole", "--preset", "scg-2022", "--steps", "400", "--out", "mine.onnx")
    (tmp_path / "study.toml").write_text(STUDY.replace('kind = "lqr"', 'kind = "onnx"\nfile = "mine.onnx"'))
    arguments = ("study.toml", "--set", "evaluate.episodes=3", "--out", "kept.gust", "--json")
    evaluation = trial(json.loads(gust("plan", *arguments, "--prepare").stdout), "evaluate", "lqr · white")
    (tmp_path / "mine.onnx").unlink()
    (tmp_path / "study.toml").unlink()

    gust("trial", "kept.gust", evaluation["id"])

    assert (tmp_path / "kept.gust/store/evaluate" / evaluation["id"] / "rows.bin").exists()


@pytest.mark.parametrize("folder", [".", "missing", "study.toml"])
def test_a_folder_that_is_none_is_refused_and_the_message_says_how_to_make_one(gust, tmp_path, folder):
    (tmp_path / "study.toml").write_text(STUDY)

    done = gust("trial", folder, "some-id", code=2)

    assert f"{folder}: holds no study; give the folder" in done.stderr and "gust plan --prepare" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["study.toml"]


def test_an_edited_study_is_refused(gust, tmp_path, prepared):
    kept = tmp_path / "single.gust/study.toml"
    kept.write_text(kept.read_text() + "\n")
    assert "is not what the run wrote" in gust("trial", "single.gust", prepared[0]["id"], code=2).stderr


def test_a_paper_is_not_prepared(gust):
    assert "--prepare is for a study" in gust("plan", "paper", "--prepare", code=2).stderr


def test_preparing_leaves_folders_of_others_alone(gust, tmp_path, prepared):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/thesis.tex").write_text("mine")
    done = gust("plan", "study.toml", "--out", "mine", "--prepare", code=2)
    assert "is not empty and no result of gust" in done.stderr
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["thesis.tex"]
