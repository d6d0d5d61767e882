"""The study of a thermostat and the policy that it names, for the tests of the commands and of the page."""

import pathlib
import shutil
import subprocess
import sys

import numpy as np
import onnx

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "python"))
from onnx_graphs import Graph  # noqa: E402


def save_linear(path, gain):
    """A network that heats by 500 W (1 + gain (20 degC - temperature))."""
    g = Graph(inputs=1)
    product = g.op("MatMul", "obs", g.const(np.array([[-gain]], dtype=np.float32)))
    onnx.save(g.model(g.op("Add", product, g.const(np.array([20 * gain], dtype=np.float32)))), path)


class Room:
    """A folder with room.toml and linear.onnx; room("show", "room.gust") runs the program that knows the thermostat."""

    def __init__(self, build, folder):
        self.program = build / "gust_with_thermostat"
        self.folder = folder
        shutil.copy(HERE / "room.toml", folder)
        save_linear(folder / "linear.onnx", gain=0.4)

    def __call__(self, *arguments, code=0):
        command = [self.program, *map(str, arguments)]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=300)
        assert done.returncode == code, f"{command} exited {done.returncode}\n{done.stdout}\n{done.stderr}"
        return done
