"""scripts/install-deps on a machine that lacks packages."""

import os
import subprocess

from conftest import ROOT


def install(tmp_path, what, **programs):
    """Runs the script where these programs are shell scripts; returns the finished process."""
    folder = tmp_path / "bin"
    folder.mkdir()
    for name, text in programs.items():
        path = folder / name.replace("_", "-")
        path.write_text(f"#!/bin/sh\n{text}\n")
        path.chmod(0o755)
    clean = {"PATH": f"{folder}:/usr/bin:/bin", "HOME": str(tmp_path / "no-home")}
    return subprocess.run([ROOT / "scripts/install-deps", what], env=clean, capture_output=True, text=True, timeout=60)


def test_without_root_it_names_the_one_line_to_run(tmp_path):
    done = install(tmp_path, "build", dpkg_query="exit 1", id="echo 1000", sudo="exit 1", npm="")
    assert done.returncode == 1
    assert done.stdout.startswith("apt-get install -y --no-install-recommends g++ cmake ninja-build ")
    assert done.stdout.count("\n") == 1
    assert "As root, run:" in done.stderr


def test_only_what_is_missing_is_installed_by_root(tmp_path):
    log = tmp_path / "log"
    done = install(tmp_path, "build", dpkg_query='[ "$4" = libfmt-dev ] || echo "install ok installed"', id="echo 0",
                   apt_get=f'echo "$@" >> {log}', npm="")
    assert done.returncode == 0, done.stderr
    assert log.read_text() == "update -qq\ninstall -y --no-install-recommends libfmt-dev\n"


def test_with_a_sudo_that_asks_nothing_it_installs(tmp_path):
    log = tmp_path / "log"
    done = install(tmp_path, "bench", dpkg_query='[ "$4" = libbenchmark-dev ] || echo "install ok installed"',
                   id="echo 1000", sudo=f'[ "$1" = -n ] || echo "$@" >> {log}', npm="")
    assert done.returncode == 0, done.stderr
    assert log.read_text() == "apt-get update -qq\napt-get install -y --no-install-recommends libbenchmark-dev\n"


def test_where_all_is_there_it_says_nothing(tmp_path):
    done = install(tmp_path, "check", dpkg_query='echo "install ok installed"', id="echo 1000", npm="")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_an_unknown_purpose_is_a_usage_error(tmp_path):
    assert install(tmp_path, "everything").returncode == 2
    assert os.access(ROOT / "scripts/install-deps", os.X_OK)
