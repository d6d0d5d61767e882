"""The installed library is found by CMake and links."""

import pathlib
import subprocess

CONSUMER = pathlib.Path(__file__).parent / "consumer"


def test_find_package_gives_a_consumer_that_builds_and_runs(build, tmp_path):
    prefix = tmp_path / "prefix"
    subprocess.run(["cmake", "--install", build, "--prefix", prefix], check=True, stdout=subprocess.DEVNULL)

    configure = ["cmake", "-S", CONSUMER, "-B", tmp_path / "consumer", f"-DCMAKE_PREFIX_PATH={prefix}"]
    subprocess.run(configure, check=True)
    subprocess.run(["cmake", "--build", tmp_path / "consumer"], check=True)
    said = subprocess.run([tmp_path / "consumer/consumer"], check=True, capture_output=True, text=True).stdout

    assert said.startswith("gust 0.1.0 draws 0.")


def test_the_installed_program_needs_no_library_beyond_the_system_s(build, tmp_path):
    prefix = tmp_path / "prefix"
    subprocess.run(["cmake", "--install", build, "--prefix", prefix], check=True, stdout=subprocess.DEVNULL)

    needed = subprocess.run(["ldd", prefix / "bin/gust"], check=True, capture_output=True, text=True).stdout

    names = {line.split()[0].split(".so")[0] for line in needed.splitlines()}
    system = {"linux-vdso", "libstdc++", "libm", "libgcc_s", "libc", "/lib64/ld-linux-x86-64"}
    assert names <= system, f"also needs {names - system}"
