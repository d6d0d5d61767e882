"""gust list, describe, help and completion: what there is, said from the program itself."""

import json
import shutil
import subprocess
import tomllib

import pytest
from conftest import PROGRAM, in_terminal

KINDS = ["plants", "policies", "waveforms", "effects", "agents", "distributions", "metrics", "presets", "sites", "commands"]


def names(gust, kind):
    return [item["name"] for item in json.loads(gust("list", kind, "--json").stdout)]


def test_list_names_every_kind(gust):
    everything = json.loads(gust("list", "--json").stdout)
    assert list(everything) == KINDS
    assert "cartpole" in names(gust, "plants") and "ppo" in names(gust, "agents")
    assert {"white", "uniform", "step", "impulse", "sawtooth", "triangle", "sine", "constant", "scg_impulse",
            "scg_periodic"} <= set(names(gust, "waveforms"))
    assert names(gust, "preset") == ["scg-2022", "scg-default", "modern", "wcpg", "wcpg-fixed", "raac", "raac-fixed"]
    assert names(gust, "sites") == ["observation", "action", "dynamics"]
    assert {"run", "plan", "trial", "report", "show", "export", "train", "eval", "validate", "list", "describe", "preview",
            "store", "completion", "version", "help"} <= set(names(gust, "commands"))
    for kind in KINDS:
        for item in everything[kind]:
            assert item["summary"]
            if kind in ("plants", "waveforms", "effects", "agents", "distributions", "metrics"):
                assert item["source"]


def test_list_as_text_is_a_line_each(gust):
    text = gust("list", "waveforms").stdout
    assert [line.split()[0] for line in text.splitlines() if not line.startswith("    ")] == names(gust, "waveforms")
    assert all(len(line) <= 100 for line in text.splitlines())
    assert gust("list").stdout.count("\n\n") == len(KINDS) - 1


@pytest.mark.parametrize("kind", ["plant", "waveform", "agent", "distribution", "metric", "preset", "site"])
def test_every_thing_is_described_with_its_options_and_an_example_in_toml(gust, kind):
    for name in names(gust, kind):
        said = json.loads(gust("describe", kind, name, "--json").stdout)
        assert said["kind"] == kind and said["name"] == name and said["summary"]
        tomllib.loads(said["example"])
        for option in said["options"]:
            assert option["help"] and option["default"] and option["type"]
            tomllib.loads(f"value = {option['default']}")
        text = gust("describe", kind, name).stdout
        assert said["summary"].split()[0] in text and "example" in text
        for option in said["options"]:
            assert f"{option['name']} = {option['default']}" in text


def test_every_policy_is_described_with_its_keys_and_an_example_that_is_a_study(gust, tmp_path):
    assert names(gust, "policies") == ["lqr", "pd", "gain", "pid", "zero", "onnx", "train"]
    for name in names(gust, "policies"):
        said = json.loads(gust("describe", "policy", name, "--json").stdout)
        assert said["summary"] and said["source"] and tomllib.loads(said["example"])["policy"][0]["kind"] == name
        text = gust("describe", "policy", name).stdout
        for option in said["options"]:
            assert option["help"] and option["default"] and option["type"]
            assert f"{option['name']} = {option['default']}" in text
        if name == "onnx":
            continue  # it names files that are not there
        plant = "" if "plant = " in said["example"] else 'plant = { kind = "cartpole" }\n'
        (tmp_path / "x.toml").write_text(f'schema = 1\nname = "x"\n{plant}{said["example"]}\n')
        assert "evaluate" in gust("plan", "x.toml").stdout


def test_describe_says_units_and_ranges(gust):
    options = {option["name"]: option for option in
               json.loads(gust("describe", "plant", "cartpole", "--json").stdout)["options"]}
    assert options["pole_length"] == {"name": "pole_length", "type": "number", "unit": "m", "range": "> 0",
                                      "default": "0.5", "help": "pivot to the pole's centre of mass, half the rod"}
    assert options["tap_point"]["range"] == "one of com, tip"


def test_description_of_a_preset_is_the_preset(gust):
    content = json.loads(gust("describe", "preset", "scg-default", "--json").stdout)["content"]
    assert tomllib.loads(content)["cartpole"]["plant"]["physics_rate"] == 50.0


def test_every_command_has_help_with_an_example(gust):
    for name in names(gust, "commands"):
        helped = gust("help", name).stdout
        assert f"Usage: gust {name}" in helped
        assert helped == gust(name, "--help").stdout
        assert name == "store" or f"gust {name}" in helped[helped.index("Example"):]
    for name in ("pack", "unpack"):
        helped = gust("help", "store", name).stdout
        assert f"Usage: gust store {name}" in helped and f"  gust store {name}" in helped
    assert gust("help").stdout == gust("--help").stdout


def test_version_is_said_in_both_ways(gust):
    assert gust("version").stdout == gust("--version").stdout
    assert gust("version").stdout.startswith("gust 0.")


def complete_in_bash(gust, line):
    """What bash would offer for the last word of a line."""
    script = gust("completion", "bash").stdout
    words = line.split(" ")
    driver = f"""{script}
COMP_WORDS=({' '.join(repr(word) for word in words)}); COMP_CWORD={len(words) - 1}; _gust
printf '%s\\n' "${{COMPREPLY[@]}}" """
    done = subprocess.run(["bash", "-c", driver], capture_output=True, text=True, check=True)
    assert done.stderr == ""
    return done.stdout.split()


def test_bash_completes_commands_options_and_names(gust):
    assert complete_in_bash(gust, "gust ev") == ["eval"]
    assert complete_in_bash(gust, "gust eval --wave") == ["--waveform"]
    assert complete_in_bash(gust, "gust eval --waveform saw") == ["sawtooth"]
    assert complete_in_bash(gust, "gust eval --preset scg-2") == ["scg-2022"]
    assert complete_in_bash(gust, "gust list metr") == ["metrics"]
    assert complete_in_bash(gust, "gust train pp") == ["ppo"]
    assert complete_in_bash(gust, "gust store pa") == ["pack"]


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_other_shells_have_a_script_with_everything(gust, tmp_path, shell):
    script = gust("completion", shell).stdout
    for name in [*names(gust, "commands"), "sawtooth", "scg-2022"]:
        assert name in script
    assert ("--waveform" if shell == "zsh" else "-l waveform") in script
    if shutil.which(shell):
        (tmp_path / "script").write_text(script)
        subprocess.run([shell, "-n", tmp_path / "script"], check=True)


@pytest.mark.parametrize("columns", [60, 80, 200])
def test_help_and_lists_reflow_to_the_terminal(gust, tmp_path, columns):
    for arguments in (["help", "eval"], ["help"], ["export", "--help"], ["list"], ["describe", "metric", "length"]):
        lines = in_terminal([PROGRAM, *arguments], tmp_path, columns).splitlines()
        words = [line for line in lines if line.strip().count(" ") > 0 and not line.lstrip().startswith(("-", "{", "["))]
        assert max(map(len, words)) <= min(columns, 100), arguments
