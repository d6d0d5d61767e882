"""docs/extending.md is followed to the letter: its files are put where it says, compiled, linked, tested and used.

All of that happens in a copy of the sources. What the document does not touch is taken from the build tree as it is: its libraries,
and the objects of the program and of the conformance tests. A block begins with the path of its file; blocks of shell are commands.
"""

import json
import os
import re
import shlex
import shutil
import subprocess
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from conftest import BUILD, ROOT

BLOCK = re.compile(r"^```(?P<language>\w+)\n(?:(?://|#) (?P<path>[\w./-]+\.\w+)\n)?(?P<text>.*?)^```$", re.M | re.S)
DOCUMENT = (ROOT / "docs/extending.md").read_text()
BLOCKS = [match.groupdict() for match in BLOCK.finditer(DOCUMENT)]
FILES = [block for block in BLOCKS if block["path"]]
SHELL = [block["text"] for block in BLOCKS if block["language"] == "sh"]
LISTED = {"loops": "plants"}  # a loop takes the place of a plant; other kinds are listed by the name of their folder
KINDS = [
    (LISTED.get(folder := Path(block["path"]).parent.name, folder), name)
    for block in FILES if block["path"].endswith("/list.inc") for name in re.findall(r"GUST_ENTRY\((\w+)\)", block["text"])
]
PRESETS = "cmake_minimum_required(VERSION 3.25)\nproject(presets LANGUAGES NONE)\ninclude(cmake/embed.cmake)\n" \
    "add_custom_target(presets)\ngust_embed_presets(presets)\n"


def run(command, folder, **options):
    """The standard output of a command, which must succeed."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=500, **options)
    if done.returncode != 0:
        pytest.fail(f"{shlex.join(map(str, command))}\n{done.stdout}\n{done.stderr}", pytrace=False)
    return done.stdout


def write(folder, language, path, text):
    """A file of the document: a new one, lines for the end of one, or a `diff` whose lines with - give way to those with +."""
    file = folder / path
    file.parent.mkdir(parents=True, exist_ok=True)
    if language != "diff":
        file.write_text((file.read_text() + "\n" if file.exists() else "") + text)
        return
    old, new = ("".join(line[1:] for line in text.splitlines(True) if line[0] in (sign, " ")) for sign in "-+")
    assert file.read_text().count(old) == 1, f"{path} has no lines\n{old}"
    file.write_text(file.read_text().replace(old, new))


def copied(folder):
    """The paths of the document's files in a copy of the sources; those that were there before are marked True."""
    for name in ("cmake", "gust", "studies", "tests"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    existed = {block["path"]: (folder / block["path"]).exists() for block in FILES}
    for block in FILES:
        write(folder, **block)
    return existed


def to_compile(folder, existed):
    """The sources that need compiling: those of the document, those that include a list of it, and the presets."""
    paths = {path for path in existed if path.endswith(".cpp")}
    for path in existed:
        if existed[path] and path.endswith(".inc"):
            users = [file for file in (folder / "gust").rglob("*.cpp") if f'#include "{path}"' in file.read_text()]
            assert users, f"nothing includes {path}"
            paths |= {file.relative_to(folder).as_posix() for file in users}
    if any(path.startswith("studies/presets/") for path in existed):
        (folder / "CMakeLists.txt").write_text(PRESETS)
        run(["cmake", "-S", folder, "-B", folder / "build", "-G", "Ninja"], folder)
        paths.add("build/generated/gust/setup/preset_files.cpp")
    return sorted(paths)


def command_of(source):
    """How the build tree compiles this source, or the one nearest to it, which like it is a test or not."""
    entries = json.loads((BUILD / "compile_commands.json").read_text())
    commands = {re.sub(r".*/(?=(gust|tests)/)", "", entry["file"]): entry["command"] for entry in entries}
    alike = [known for known in commands if known.endswith("_test.cpp") == source.endswith("_test.cpp")]
    return shlex.split(commands[max(alike, key=lambda known: len(os.path.commonprefix([known, source])))])


def compiled(folder, source):
    """The object of a source. Paths are relative, so that a compiler cache knows the source from another folder."""
    words = command_of(source.removeprefix("build/generated/"))
    flags = ["-I.", *words[1:words.index("-o")]]
    target = folder / "objects" / (source.replace("/", ".") + ".o")
    run([*filter(None, [shutil.which("ccache")]), words[0], *flags, "-o", target, "-c", source], folder)
    return target


def link(target, objects, program):
    """Links what a target of the build tree consists of, after these objects: they win over what the libraries have of their names."""
    last = run(["ninja", "-t", "commands", target], BUILD).splitlines()[-1]
    words = shlex.split(last.removeprefix(": && ").partition(" && ")[0])
    words[words.index("-o") + 1] = program
    run([words[0], *objects, *words[1:]], BUILD)
    return program


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The sources with what the document adds, and in it `program/gust` and `program/tests`, which are built from both."""
    folder = tmp_path_factory.mktemp("extended")
    sources = to_compile(folder, copied(folder))
    (folder / "objects").mkdir()
    (folder / "program").mkdir()
    with ThreadPoolExecutor(2) as pool:
        objects = dict(zip(sources, pool.map(lambda source: compiled(folder, source), sources)))
    library = [made for source, made in objects.items() if not source.endswith("_test.cpp")]
    link("gust", library, folder / "program/gust")
    link("conformance_test", objects.values(), folder / "program/tests")
    return folder


@pytest.fixture
def gust(folder):
    """Runs the extended program among the extended sources."""
    return lambda *arguments: run([folder / "program/gust", *arguments], folder)


def test_every_block_of_the_document_is_used_and_every_list_of_kinds_has_an_example():
    assert len(re.findall("^```", DOCUMENT, re.M)) == 2 * len(BLOCKS)
    assert [block for block in BLOCKS if not block["path"] and block["language"] != "sh"] == []

    lists = {path.relative_to(ROOT).as_posix() for path in (ROOT / "gust").rglob("list.inc")}

    assert lists == {block["path"] for block in FILES if "GUST_ENTRY(" in block["text"]}


def test_its_tests_pass_and_its_kinds_keep_what_every_kind_has_to_keep(folder):
    ours = {name for block in FILES for name in re.findall(r'^TEST_CASE\("(.*)"\)', block["text"], re.M)}
    cases = run([folder / "program/tests", "--list-test-cases"], folder).splitlines()
    assert ours and ours <= {*cases}
    assert any("every kind" in case for case in cases)

    run([folder / "program/tests"], folder)


@pytest.mark.parametrize(("catalogue", "name"), KINDS)
def test_a_kind_is_listed_and_described_and_its_example_runs(gust, folder, catalogue, name):
    assert name in {one["name"] for one in json.loads(gust("list", catalogue, "--json"))}
    if catalogue == "commands":
        assert "Example" in gust("help", name)
        return
    described = json.loads(gust("describe", catalogue, name, "--json"))
    assert described["name"] == name and described["summary"]

    example = tomllib.loads(described["example"])
    rest = {"plant": 'plant = { kind = "cartpole" }', "policy": 'policy = [{ name = "nothing", kind = "zero" }]'}
    study = ["schema = 1", f'name = "{name}"', *(text for key, text in rest.items() if key not in example), described["example"]]
    (folder / f"{name}-example.toml").write_text("\n".join(study))
    short = [f"policy.{one['name']}.agent.steps=2000" for one in example.get("policy", []) if one["kind"] == "train"]
    gust("run", f"{name}-example.toml", "--set", "evaluate.episodes=2", *(word for one in short for word in ("--set", one)))

    assert name in (folder / f"{name}.gust/report.html").read_text()


@pytest.mark.parametrize("commands", SHELL, ids=[text.splitlines()[0] for text in SHELL])
def test_its_commands_work(folder, commands):
    environment = {**os.environ, "PATH": f"{folder / 'program'}:{os.environ['PATH']}"}

    run(["bash", "-ec", commands], folder, env=environment)
