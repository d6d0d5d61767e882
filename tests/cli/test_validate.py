"""gust validate: what it prints, what it leaves as exit code, and what it says of recordings that are none."""

import json
import pathlib
import shutil

import pytest

RECORDINGS = pathlib.Path(__file__).parent.parent / "reference" / "traj"
CARTPOLES = sorted(RECORDINGS.glob("d_cp_*.json"))


@pytest.fixture
def copy(tmp_path):
    """A recording that a test may change: copy(name, edit) gives the path of its JSON file."""

    def make(name, edit=lambda description: None):
        for ending in (".json", ".csv"):
            shutil.copy(RECORDINGS / (name + ending), tmp_path)
        path = tmp_path / (name + ".json")
        description = json.loads(path.read_text())
        edit(description)
        path.write_text(json.dumps(description))
        return path

    return make


def test_all_cartpole_recordings_pass_a_line_each(gust):
    assert len(CARTPOLES) == 10
    done = gust("validate", *CARTPOLES)
    assert done.returncode == 0 and done.stderr == ""
    assert all(len(line) <= 80 for line in done.stdout.splitlines())
    lines = [line for line in done.stdout.splitlines() if line.startswith("d_cp_")]
    assert [line.split()[0] for line in lines] == [path.stem for path in CARTPOLES]
    assert all("pass" in line for line in lines)
    assert sum("open loop" in line for line in lines) == 4


def test_all_quadrotor_recordings_pass_and_nothing_is_claimed_beyond_the_ground(gust):
    quadrotors = sorted(RECORDINGS.glob("d_q2_*.json"))
    assert len(quadrotors) == 6
    got = {one["recording"]: one for one in json.loads(gust("validate", *quadrotors, "--json").stdout)}
    assert all(one["passed"] and max(one["one_step"].values()) <= 1e-12 for one in got.values())
    closed = [one["closed_loop"] for one in got.values() if one["closed_loop"]]
    assert len(closed) == 5 and all(max(errors.values()) <= 1e-10 for errors in closed)
    judged = {name: one["judged"] for name, one in got.items() if one["judged"] < one["steps"]}
    assert judged == {"d_q2_circle_ground_50_1000": 233}


def test_json_has_the_errors_of_every_state(gust):
    (got,) = json.loads(gust("validate", RECORDINGS / "d_cp_lqr_15_750.json", "--json").stdout)
    assert set(got["one_step"]) == set(got["closed_loop"]) == {"x", "x_dot", "theta", "theta_dot"}
    assert max(got["one_step"].values()) <= 1e-12 and max(got["closed_loop"].values()) <= 1e-10
    assert got["passed"] is True and got["flags_equal"] is True and got["reward"] <= 1e-12
    (got,) = json.loads(gust("validate", RECORDINGS / "d_cp_passive_50_1000.json", "--json").stdout)
    assert got["closed_loop"] is None and "open loop" in got["note"]


def test_wrong_plant_fails_with_exit_code_3_and_the_others_are_still_checked(gust, copy):
    wrong = copy("d_cp_lqr_15_750", lambda description: description.update(gravity=9.81))
    done = gust("validate", wrong, CARTPOLES[-1], code=3)
    assert done.returncode == 3
    assert "FAIL: x_dot is off by" in done.stdout or "FAIL: theta_dot is off by" in done.stdout
    assert f"{CARTPOLES[-1].stem}  pass" in done.stdout
    assert gust("validate", wrong, "--tolerance-step", "0.1", "--tolerance-loop", "0.1").returncode == 0


def refused(gust, *arguments):
    done = gust("validate", *arguments, code=2)
    assert done.returncode == 2 and done.stdout == "" and done.stderr.count("\n") == 1
    return done.stderr


def test_what_is_no_recording_is_one_error_and_nothing_is_checked(gust, copy, tmp_path):
    good = RECORDINGS / "d_cp_lqr_15_750.json"
    assert "cannot read" in refused(gust, good, tmp_path / "none.json")
    assert "'gravity' is missing" in refused(gust, good, copy("d_cp_rail_50_1000", lambda d: d.pop("gravity")))
    assert "unknown plant 'quad'" in refused(gust, copy("d_cp_rail_50_1000", lambda d: d.update(plant="quad")))
    assert "'steps'" in refused(gust, copy("d_cp_rail_50_1000", lambda d: d.update(steps=5)))
    assert "is named by its JSON file" in refused(gust, RECORDINGS / "d_cp_lqr_15_750.csv")
    assert "number >= 0" in refused(gust, good, "--tolerance-step", "-1")
    assert "number >= 0" in refused(gust, good, "--tolerance-loop", "nan")


def test_records_that_are_missing_or_damaged_are_named(gust, copy):
    path = copy("d_cp_random_50_50")
    records = path.with_suffix(".csv")
    text = records.read_text()
    records.write_text(text.replace("theta_dot", "thetadot", 1))
    assert "d_cp_random_50_50.csv:1:1: the column 'theta_dot' is missing; is it the one called 'thetadot'?" in refused(gust, path)
    records.write_text(text.replace("\n7,", "\n7,,", 1))
    assert "d_cp_random_50_50.csv:9:1: 24 cells; the header has 23" in refused(gust, path)
    records.write_text(text[: len(text) // 2])
    assert "d_cp_random_50_50.csv" in refused(gust, path)
    records.unlink()
    assert "lie beside it" in refused(gust, path)


def test_nothing_judged_has_not_passed(gust, copy):
    path = copy("d_q2_hover_50_1000", lambda description: description.pop("init_state"))
    records = path.with_suffix(".csv")
    lines = [line.split(",") for line in records.read_text().splitlines()]
    z = lines[0].index("z")
    on_the_floor = [line[:z] + ["-0.03"] + line[z + 1:] for line in lines[1:]]
    records.write_text("\n".join(map(",".join, [lines[0], *on_the_floor])) + "\n")
    done = gust("validate", path, code=3)
    assert "0 of 250 steps judged: near the ground from k = 1" in done.stdout and "pass" not in done.stdout
    (got,) = json.loads(gust("validate", path, "--json", code=3).stdout)
    assert got["passed"] is False and got["judged"] == 0
    assert got["one_step"] is None and got["closed_loop"] is None and got["flags_equal"] is None


def test_a_robots_log_is_judged_by_what_it_has(gust, copy):
    path = copy("d_cp_lqr_15_750")
    records = path.with_suffix(".csv")
    lines = [line.split(",") for line in records.read_text().splitlines()]
    kept = [lines[0].index(name) for name in ("t", "x", "x_dot", "theta", "theta_dot", "a_applied")]
    records.write_text("\n".join(",".join(line[i] for i in kept) for line in lines) + "\n")
    line = " ".join(gust("validate", path).stdout.split())
    assert "pass (not recorded, not judged: applied, reward, sq_err, flags, closed loop; no force recorded: taken as 0)" in line
    (got,) = json.loads(gust("validate", path, "--json").stdout)
    assert got["passed"] is True and got["judged"] == got["steps"] and max(got["one_step"].values()) <= 1e-12
    assert got["reward"] is None and got["sq_err"] is None and got["flags_equal"] is None and got["closed_loop"] is None
    assert "not judged: applied, reward, sq_err, flags, closed loop" in got["note"]


def test_controllers_that_believe_in_another_plant_agree(gust):
    believers = sorted((RECORDINGS.parent / "belief").glob("*.json"))
    assert len(believers) == 3
    for one in json.loads(gust("validate", *believers, "--json").stdout):
        assert one["judged"] == 60 and max(one["closed_loop"].values()) <= 1e-10 and one["reward"] <= 1e-12


def test_other_separators_and_encodings_are_named(gust, copy):
    path = copy("d_cp_lqr_15_750")
    records = path.with_suffix(".csv")
    text = records.read_text()
    records.write_text(text.replace(",", ";"))
    assert "csv:1:2: cells are separated by ; here: commas are needed" in refused(gust, path)
    records.write_text(text, encoding="utf-16")
    assert "csv:1:1: is UTF-16; save it as UTF-8" in refused(gust, path)
    records.write_text(text)
    path.write_text(path.read_text(), encoding="utf-16")
    assert "json:1:1: is UTF-16; save it as UTF-8" in refused(gust, path)
    study = path.with_suffix(".toml")
    study.write_text("schema = 1\n", encoding="utf-16")
    assert "toml:1:1: is UTF-16; save it as UTF-8" in gust("plan", study, code=2).stderr
