"""Nothing of the environment but what is documented for gust reaches a number, and no limit ends in a crash."""

import ctypes
import os
import resource
import subprocess

import pytest
from conftest import PROGRAM, ROOT

SETTINGS = ["policy.ppo.agent.steps=8000", "policy.ppo.seeds=[1, 2]", "evaluate.episodes=3"]
TRAIN = ["train", "ppo", "--plant", "cartpole", "--steps", "20000", "--seed", "1", "--out", "a.onnx"]

FMA = "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX512F,-AVX512VL,-AVX512BW,-AVX512DQ,-ERMS,-BMI2"
HOSTILE = [
    *({"LIBXSMM_TARGET": target} for target in ("0", "1", "sse3", "wsm", "snb", "hsw", "skx", "cpx", "nonsense")),
    {"LIBXSMM_VERBOSE": "-1", "LIBXSMM_SE": "1", "LIBXSMM_GEMM_PREFETCH": "9", "LIBXSMM_DUMP": "1"},
    {"OMP_NUM_THREADS": "1", "OMP_STACKSIZE": "1k", "OMP_PROC_BIND": "true", "GOMP_CPU_AFFINITY": "0"},
    {"MALLOC_PERTURB_": "165", "MALLOC_ARENA_MAX": "1", "MALLOC_CHECK_": "3", "MALLOC_TOP_PAD_": "1"},
    {"GLIBC_TUNABLES": "glibc.malloc.perturb=90:glibc.malloc.mmap_threshold=1:glibc.malloc.tcache_count=0"},
    {"GLIBC_TUNABLES": FMA},
    {"GLIBC_TUNABLES": "glibc.pthread.stack_cache_size=0:glibc.rtld.optional_static_tls=0"},
    {"LC_ALL": "de_DE.UTF-8", "LANG": "tr_TR", "LC_NUMERIC": "fr_FR", "LANGUAGE": "ar"},
    {"TZ": ":/dev/zero", "TMPDIR": "/nonexistent", "HOME": "/nonexistent", "COLUMNS": "1", "LINES": "0"},
    {"LD_BIND_NOW": "1", "TERM": "", "CLICOLOR_FORCE": "1", "POSIXLY_CORRECT": "1", "EIGEN_NUM_THREADS": "7"},
]


def refuse_executable_memory():
    """As systemd's MemoryDenyWriteExecute does."""
    pr_set_mdwe, refuse_exec_gain = 65, 1
    os._exit(77) if ctypes.CDLL(None).prctl(pr_set_mdwe, refuse_exec_gain, 0, 0, 0) != 0 else None


def limited(which, size):
    return lambda: resource.setrlimit(which, (size, size))


def gust(folder, *arguments, environment=None, before=None):
    command = [PROGRAM, *map(str, arguments)]
    return subprocess.run(
        command, cwd=folder, env={**os.environ, **(environment or {})}, preexec_fn=before, capture_output=True, timeout=300
    )


def run_demo(folder, **how):
    """What the demo leaves, small: its trials and its table."""
    sets = [word for setting in SETTINGS for word in ("--set", setting)]
    done = gust(folder, "run", ROOT / "studies/demo.toml", "--out", "out", "--threads", 2, *sets, **how)
    assert done.returncode == 0, done.stderr
    assert gust(folder, "export", "out", "--csv", "table.csv", **how).returncode == 0
    shown = gust(folder, "show", "out", "--json", **how).stdout
    files = {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.glob("out/store/[et]*/*/*"))}
    return files, (folder / "table.csv").read_bytes(), shown


@pytest.fixture(scope="module")
def calm(tmp_path_factory):
    return run_demo(tmp_path_factory.mktemp("calm"))


@pytest.fixture(scope="module")
def policy(tmp_path_factory):
    folder = tmp_path_factory.mktemp("policy")
    assert gust(folder, *TRAIN).returncode == 0
    return (folder / "a.onnx").read_bytes()


@pytest.mark.parametrize("environment", HOSTILE, ids=lambda set: " ".join(set))
def test_no_variable_changes_a_bit_of_a_study(tmp_path, calm, environment):
    assert run_demo(tmp_path, environment=environment) == calm
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out", "table.csv"]


@pytest.mark.parametrize("kilobytes", [128, 200, 1024, 1 << 30])
def test_no_size_of_the_stack_changes_a_bit_of_a_study(tmp_path, calm, kilobytes):
    assert run_demo(tmp_path, before=limited(resource.RLIMIT_STACK, kilobytes << 10)) == calm


def test_without_executable_memory_it_trains_to_the_same_bits_and_says_so_once(tmp_path, policy):
    done = gust(tmp_path, *TRAIN, before=refuse_executable_memory)

    if done.returncode == 77:
        pytest.skip("this kernel cannot refuse executable memory")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "a.onnx").read_bytes() == policy
    assert done.stderr.count(b"memory may not be executed here") == 1


@pytest.mark.parametrize("megabytes", [24, 32, 40, 48, 56, 60, 64, 72, 80, 90, 100, 120, 150, 200, 400])
def test_little_memory_gives_the_same_bits_or_one_sentence(tmp_path, policy, megabytes):
    done = gust(tmp_path, *TRAIN, before=limited(resource.RLIMIT_AS, megabytes << 20))

    if done.returncode == 0:
        assert (tmp_path / "a.onnx").read_bytes() == policy
    else:
        assert done.returncode in (1, 2, 127), done.stderr  # 127: too little for the dynamic linker
        assert b"internal error" not in done.stderr and done.stderr.count(b"\n") == 1
        assert not (tmp_path / "a.onnx").exists()
