"""What the documents and the help show is run as it stands there; long work is cut short."""

import json
import os
import re
import shutil
import subprocess

import pytest
from conftest import PROGRAM, ROOT

ELSEWHERE = {"extending.md"}  # tests/python/test_extending.py, with a program that has what it adds
DOCUMENTS = [ROOT / "README.md", *sorted(path for path in (ROOT / "docs").glob("*.md") if path.name not in ELSEWHERE)]
PLACEHOLDER = re.compile(r"(?<![A-Za-z_.-])(N|KIND|NAME|AGENT|STUDY|DIR|FILE|FOLDER)\b")
SHORT = {  # what is added to a command so that it takes a moment
    "run studies/": " --set policy.ppo.agent.steps=4000 --set evaluate.episodes=2",
    "run first-look.toml": " --set policy.ppo.agent.steps=4000 --set evaluate.episodes=2",
    "train ": " --steps 4000",
}


def blocks(language):
    """(document, text) of every fenced block in a language."""
    for path in DOCUMENTS:
        for text in re.findall(rf"^```{language}\n(.*?)^```$", path.read_text(), re.M | re.S):
            yield path.name, text


def commands_of(text, document):
    """The lines of a text that call the program, without comments and placeholders; broken ones are joined."""
    text = re.sub(r" *\\\n +", " ", text)
    for line in re.findall(r"^ *((?:source <\()?gust [^\n]*)", text, re.M):
        command = line.split("  #")[0].strip()
        if not PLACEHOLDER.search(command):
            yield document, command


def documented_commands():
    for document, text in blocks("sh"):
        yield from commands_of(text, document)
    for path in DOCUMENTS:
        for command in re.findall(r"`(gust \w+ [^-`\\][^`\n\\]*)`", path.read_text()):
            yield from commands_of(command, path.name)


def help_pages():
    names = [one["name"] for one in json.loads(subprocess.check_output([PROGRAM, "list", "commands", "--json"]))]
    for name in names:
        for words in [[name], *([[name, "pack"], [name, "unpack"]] if name == "store" else [])]:
            yield " ".join(words), subprocess.check_output([PROGRAM, "help", *words], text=True)


def helped_commands():
    for name, text in help_pages():
        yield from commands_of(text.partition("Example")[2], f"gust help {name}")


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    """A folder that holds what the examples name: the studies, recordings, a result, a policy, logs."""
    folder = tmp_path_factory.mktemp("desk")
    for name in ("studies", "tests"):
        (folder / name).symlink_to(ROOT / name)
    recordings = sorted((ROOT / "tests/reference/traj").glob("*cp_random*"))
    (folder / "logs").mkdir()
    for path in recordings:
        shutil.copy(path, folder / "logs")
    first = next(path for path in recordings if path.suffix == ".json")
    shutil.copy(first, folder / "recording.json")
    shutil.copy(first.with_suffix(".csv"), folder / "recording.csv")
    (folder / "first-look.toml").write_text(next(text for name, text in blocks("toml") if name == "README.md"))
    (folder / "program").mkdir()
    (folder / "program/gust").symlink_to(PROGRAM)
    for command in (
        "gust run studies/demo.toml",
        "gust store pack demo.gust demo.pack",
        "gust export demo.gust --csv rows.csv",
        "gust train ppo --plant cartpole --out ppo.onnx",
    ):
        run(folder, command)
    return folder


def shortened(command):
    if command.startswith("gust run studies/a"):  # every agent, for minutes or hours: here it is enough that it would run
        return command.replace("gust run", "gust plan", 1)
    if command.startswith("gust reproduce paper"):  # hours; the figure without trainings takes a moment
        return re.sub(r" --(only|claim) [\w-]+", "", command) + " --only disturbances"
    added = next((words for start, words in SHORT.items() if command.startswith(f"gust {start}")), "")
    if "--steps" in added:
        command = re.sub(r" --steps \w+", "", command)
    return command + added


def run(folder, command):
    command = " && ".join(map(shortened, command.split(" && ")))
    environment = {**os.environ, "PATH": f"{folder / 'program'}:{os.environ['PATH']}"}
    done = subprocess.run(["bash", "-c", command], cwd=folder, env=environment, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"


COMMANDS = sorted({command: where for where, command in [*documented_commands(), *helped_commands()]}.items())


@pytest.mark.parametrize(("command", "where"), COMMANDS, ids=[f"{where}: {command}" for command, where in COMMANDS])
def test_a_command_that_is_shown_works(desk, command, where):
    run(desk, command)


def test_the_documents_and_the_help_show_commands():
    assert len(list(documented_commands())) >= 10
    shown = {name for name, text in help_pages() if "Example" in text}
    assert len({where for where, _ in helped_commands()}) == len(shown) >= 15


def test_settings_that_the_documents_show_fit_the_demo(desk):
    documents = [path for path in DOCUMENTS if path.name != "agents.md"]  # whose settings are of other studies
    shown = [words for path in documents for words in re.findall(r"`(--set\s[^`]*)`", path.read_text())]
    shown = [" ".join(words.split()) for words in shown if "key=value" not in words]
    assert len(shown) >= 2
    for words in shown:
        run(desk, f"gust plan studies/demo.toml {words}")


STUDIES = [text for name, text in blocks("toml") if "schema" in text]  # whole ones


@pytest.mark.parametrize("text", STUDIES, ids=[re.search(r'name *= "([^"]*)"', text)[1] for text in STUDIES])
def test_a_study_that_is_shown_runs(gust, tmp_path, text):
    (tmp_path / "shown.toml").write_text(text)
    short = ["--set", "policy.ppo.agent.steps=4000"] if '"ppo"' in text else []

    gust("run", "shown.toml", "--set", "evaluate.episodes=2", *short)

    assert (tmp_path / "first-look.gust/report.html").stat().st_size > 100_000


def test_a_formula_that_is_shown_fits_a_study(gust, tmp_path):
    policies = '[[policy]]\nname = "lqr"\nkind = "lqr"\n' + "".join(
        f'[[policy]]\nname = "{agent}"\nkind = "train"\nagent = {{ kind = "{agent}" }}\nseeds = [1, 2]\n' for agent in ("ppo", "sac")
    )
    sweep = '[[sweep]]\nname = "action step"\nsite = "action"\nwaveform = "step"\nlevels = { from = 0, to = 3, count = 4 }\n'
    claims = [text for name, text in blocks("toml") if name == "study.md" and "[[claim]]" in text and "schema" not in text]
    assert claims

    for text in claims:
        (tmp_path / "piece.toml").write_text(HEAD + 'plant = { kind = "cartpole" }\n' + policies + sweep + text)
        assert "trials" in gust("plan", "piece.toml").stderr


PIECES = sorted({text for name, text in blocks("toml") if name == "catalog.md"})
HEAD = 'schema = 1\nname = "piece"\n'
NEEDED = {"plant = ": 'plant = { kind = "cartpole" }\n', "[[policy]]": '[[policy]]\nname = "nothing"\nkind = "zero"\n'}


@pytest.mark.parametrize("text", PIECES, ids=[" ".join(text.split())[:60] for text in PIECES])
def test_a_piece_of_a_study_in_the_catalogue_fits_one(gust, tmp_path, text):
    rest = [piece for start, piece in NEEDED.items() if start not in text]
    plant = [piece for piece in rest if piece.startswith("plant")]
    study = HEAD + "".join(plant) + text + "".join(piece for piece in rest if piece not in plant)
    (tmp_path / "piece.toml").write_text(study)
    (tmp_path / "policies").mkdir()  # of the one that names files
    shutil.copy(ROOT / "tests/reference/scg_policies/scg-2022-ppo-s1.onnx", tmp_path / "policies")

    planned = gust("plan", "piece.toml").stdout

    assert "nominal" in planned
