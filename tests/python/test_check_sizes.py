"""scripts/check-sizes finds what is too long or too large, and is not misled by braces that open no function."""

import subprocess

import pytest
from conftest import ROOT

IDENTITY = ["-c", "user.name=nobody", "-c", "user.email=nobody@example.org", "-c", "commit.gpgsign=false"]
LINE = "  ++i;\n"


def check(tree, *arguments):
    """What the script says of a tree, without what it skips."""
    done = subprocess.run([ROOT / "scripts/check-sizes", tree, *arguments], capture_output=True, text=True, timeout=60)
    said = [line for line in done.stdout.splitlines() if line and not line.startswith("skipped")]
    assert done.returncode == (1 if said else 0), done.stderr
    return "\n".join(said)


def check_text(tree, name, text):
    """The same of a tree with one file."""
    (tree / name).parent.mkdir(parents=True)
    (tree / name).write_text(text)
    return check(tree)


@pytest.mark.parametrize(("text", "line"), [
    ("void f(int i) {\n" + LINE * 59 + "}\n", 1),
    ("void f(int i) {" + "\n" * 60 + "}\n", 1),
    ("namespace gust {\nnamespace {\n\nint f() noexcept(true) {\n" + LINE * 59 + "}\n}\n}\n", 4),
    ("template <class T>\nvoid f(T i)\n{\n" + LINE * 57 + "}\n", 1),
    ("auto f() -> std::vector<int> {\n" + LINE * 59 + "}\n", 1),
    ("void f(Options o = {}, int i = 3) {\n" + LINE * 59 + "}\n", 1),
    ('TEST_CASE("a brace } in a name") {\n' + LINE * 59 + "}\n", 1),
    ("class A {\n public:\n  A(int i) : a_{i}, b_(i), c_{1, {2}} {\n" + LINE * 59 + "  }\n};\n", 3),
    ("struct A : B<decltype(f())> {\n  int operator()(int i) const& override {\n" + LINE * 59 + "  }\n};\n", 2),
    ("struct stat info() {\n" + LINE * 59 + "}\n", 1),
    ("void f() {\n  const auto g = [](int i) {\n" + LINE * 57 + "  };\n}\n", 1),
    ("const auto f = [](int i) {\n" + LINE * 59 + "};\n", 1),
    ("const int kOne = f([] {\n" + LINE * 59 + "});\n", 1),
    ("const Table kTable = {\n    {1, [](int i) { ++i; }},\n    {2,\n     [](int i) {\n" + LINE * 58 + "     }},\n};\n", 3),
    ("void f() {\n  g(R\"(}} \")\", 1'000, '}', \"\\\"}\", u8'}');  // }\n  /* } */\n" + LINE * 57 + "}\n", 1),
    ("#define OPEN {\n#define BOTH(x) \\\n  }} x\nvoid f() {\n" + LINE * 59 + "}\n", 4),
])
def test_a_function_of_61_lines_is_named(tmp_path, text, line):
    assert check_text(tmp_path, "gust/one.cpp", text).startswith(f"gust/one.cpp:{line}: 61 lines; a function has at most 60: ")


@pytest.mark.parametrize("text", [
    "void f(int i) {\n" + LINE * 58 + "}\n",
    "void f() {\n" + LINE * 29 + "}\nvoid g() {\n" + LINE * 29 + "}\n",
    "class alignas(64) A final : public B<C> {\n" + "  int f() const { return 1; }\n" * 70 + "};\n",
    "namespace gust {\n" + "void f();\n" * 70 + "}\n",
    'extern "C" {\n' + "void f();\n" * 70 + "}\n",
    "enum class Kind : int {\n" + "  a,\n" * 70 + "};\n",
    "const std::pair<int, int> kTable[] = {\n" + "    {1, f(2)},\n" * 70 + "};\n",
    "constexpr std::array<double, size(70)> kTable{\n" + "    1.5,\n" * 70 + "};\n",
    "struct A {\n  static constexpr std::tuple kFields = {\n" + '      field("a", &A::a, "{", positive),\n' * 70 + "  };\n};\n",
    "const char* kText = R\"x(void f() {\n" + LINE * 59 + "})\" )x\";\n",
    "/* void f() {\n" + LINE * 59 + "} */\n" + "// void f() {\n" * 70,
    "/// A long comment.\n" * 70 + "void f() {}\n",
    "#define F(x) void f() { \\\n" + "  x; \\\n" * 70 + "  }\n",
    "const auto kAll = all({\n" + "    [](int i) { return i; },\n" * 70 + "});\n",
])
def test_what_only_looks_like_a_long_function_passes(tmp_path, text):
    assert check_text(tmp_path, "gust/one.h", text) == ""


@pytest.mark.parametrize("name", [f"{folder}/one.{kind}" for folder in ("gust/a/b", "bench", "fuzz", "tests/a") for kind in ("cpp", "h")])
def test_functions_are_found_in_each_folder(tmp_path, name):
    assert check_text(tmp_path, name, "void f(int i) {\n" + LINE * 59 + "}\n").startswith(f"{name}:1: 61 lines")


@pytest.mark.parametrize("text", ["void f() {\n", "}\n", "} void f() {\n"])
def test_braces_that_do_not_match_are_an_error_and_not_passed_over(tmp_path, text):
    assert check_text(tmp_path, "gust/one.cpp", text).startswith("gust/one.cpp: ")


@pytest.mark.parametrize(("name", "text", "line"), [
    ("tests/cli/test_one.py", "x = 1\n\n\ndef f():\n" + "    x = '{'\n" * 60, 4),
    ("tests/cli/test_one.py", "class A:\n    async def f(self):\n" + "        x = 1\n" * 60, 2),
    ("scripts/one", "#!/usr/bin/env python3\ndef f():\n    def g():\n" + "        x = 1\n" * 59, 2),
    ("web/one.js", "const a = 1;\nexport function f(x) {\n" + "  x = /[}]'/.test(`}${x ? `}` : {}}`) && '}';\n" * 59 + "}\n", 2),
    ("web/one.js", "export const one = {\n  two: async (x) => {\n" + "  x += 1\n" * 59 + "  },\n}\n", 2),
])
def test_functions_of_scripts_and_pages_are_found_too(tmp_path, name, text, line):
    assert check_text(tmp_path, name, text).startswith(f"{name}:{line}: 61 lines; a function has at most 60: ")


@pytest.mark.parametrize(("name", "text"), [
    ("tests/cli/test_one.py", "def f():\n" + "    x = 1\n" * 59),
    ("tests/cli/test_one.py", "class A:\n" + "    def f(self): pass\n" * 70 + "TEXT = '''\ndef f():\n" + "    x = 1\n" * 70 + "'''\n"),
    ("scripts/one", "#!/bin/sh\nf() {\n" + "  :\n" * 70 + "}\n"),
    ("web/one.js", "export const one = {\n" + "  a: (x) => ({ y: x }),\n" * 70 + "}\n"),
])
def test_short_ones_pass(tmp_path, name, text):
    assert check_text(tmp_path, name, text) == ""


@pytest.mark.parametrize("name", ["gust/a/one.h", "gust/list.inc", "tests/one.c", "web/page.css", "cmake/one.cmake", "scripts/one", "bench/one.cpp"])
def test_a_file_of_401_lines_is_named(tmp_path, name):
    assert check_text(tmp_path, name, "\n" * 401) == f"{name}: 401 lines; at most 400"
    (tmp_path / name).write_text("\n" * 400)
    assert check(tmp_path) == ""


@pytest.fixture
def repository(tmp_path):
    """A repository with a long subject, and after it the commit from which subjects are checked."""
    git(tmp_path, "init", "-q")
    commit(tmp_path, "A" * 90 + "; then the rule begins")
    git(tmp_path, "tag", "begin")
    return tmp_path


def git(folder, *arguments):
    subprocess.run(["git", *IDENTITY, *arguments], cwd=folder, check=True, capture_output=True, timeout=60)


def commit(folder, subject):
    git(folder, "commit", "-q", "--allow-empty", "-m", subject + "\n\nA body may be longer than any subject; it has semicolons, and lines of any length.\n")


@pytest.mark.parametrize("subject", ["A" * 73, "Add one; remove another"])
def test_a_subject_that_is_long_or_has_a_semicolon_is_named(repository, subject):
    commit(repository, subject)
    commit(repository, "Add " + "ü" * 68)
    said = check(repository, "begin")
    assert said.startswith("commit ") and said.endswith(f": {subject}") and "\n" not in said


def test_a_large_tracked_file_is_named_but_packs_of_trainings_and_files_that_are_not_tracked(repository):
    for name, size in {"docs/a b.png": 5_000_001, "docs/b.png": 5_000_000, "results/trainings/a.pack": 5_000_001,
                       "results/a.pack": 5_000_001}.items():
        (repository / name).parent.mkdir(parents=True, exist_ok=True)
        (repository / name).write_bytes(b"0" * size)
    git(repository, "add", ".")
    (repository / "docs/not tracked.png").write_bytes(b"0" * 5_000_001)
    assert check(repository, "begin").splitlines() == ["docs/a b.png: 5.0 MB; at most 5", "results/a.pack: 5.0 MB; at most 5"]


def test_without_a_history_it_says_what_it_skips_and_passes(repository, tmp_path_factory):
    (repository / "large").write_bytes(b"0" * 6_000_000)
    git(repository, "add", ".")
    commit(repository, "A" * 73)
    clone, bare = tmp_path_factory.mktemp("clone"), tmp_path_factory.mktemp("bare")
    git(clone, "clone", "-q", "--depth", "1", f"file://{repository}", ".")
    (bare / "large").write_bytes(b"0" * 6_000_000)
    for tree, skipped, code in ((clone, 1, 1), (bare, 2, 0)):
        done = subprocess.run([ROOT / "scripts/check-sizes", tree], capture_output=True, text=True, timeout=60)
        assert done.stdout.count("skipped") == skipped and done.returncode == code
        assert ("large: 6.0 MB" in done.stdout) == (tree == clone) and "commit " not in done.stdout.replace("commits", "")
