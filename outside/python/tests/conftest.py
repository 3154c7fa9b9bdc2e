"""What the tests share: a planar device, logs of it, and the command to compare with."""

import json
import os
import pathlib
import subprocess

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]


def row(a_m):
    """A Denavit-Hartenberg row in a plane."""
    return {"a_m": a_m, "alpha_rad": 0.0, "d_m": 0.0}


def planar(**last_link):
    """Two revolute joints in a plane, links of 0.3 m and 0.2 m, external encoders, a tracker of the position."""
    joint = {"lower_rad": -2.0, "upper_rad": 2.0, "transmission": "direct", "external_encoder_sd_rad": 1e-4}
    return {
        "device": {"name": "planar", "dof": 2},
        "link": [row(0.0), row(0.3), {**row(0.2), **last_link}],
        "joint": [joint, joint],
        "tracker": {"base": "known", "tool": "known", "position_sd_m": 1e-4, "scale_sd": 0.0},
    }


@pytest.fixture
def device():
    return planar()


def planar_position(q, a1=0.3, a2=0.2):
    """Closed form of the planar device's handle."""
    q1, q12 = q[:, 0], q[:, 0] + q[:, 1]
    x = a1 * np.cos(q1) + a2 * np.cos(q12)
    y = a1 * np.sin(q1) + a2 * np.sin(q12)
    return np.stack([x, y, np.zeros_like(x)], axis=1)


def recording(a1, a2, rows=400, seed=3, sd_m=1e-4):
    """A log of a planar device with these lengths: a slow motion through the workspace."""
    random = np.random.default_rng(seed)
    time = np.arange(rows) * 0.02
    q = np.stack([1.5 * np.sin(0.9 * time), 0.2 + 1.4 * np.sin(1.7 * time + 0.5)], axis=1)
    position = planar_position(q, a1, a2) + sd_m * random.normal(size=(rows, 3))
    columns = {"t_s": time, "theta1_rad": q[:, 0], "theta2_rad": q[:, 1]}
    return {**columns, **dict(zip(["x_m", "y_m", "z_m"], position.T))}


def write_csv(path, columns):
    names = list(columns)
    rows = zip(*(np.asarray(columns[name]).tolist() for name in names))

    def text(cell):
        """A cell; NaN is no reading."""
        return cell if isinstance(cell, str) else "" if cell != cell else repr(cell)

    lines = [",".join(names)] + [",".join(map(text, row)) for row in rows]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


@pytest.fixture
def command(tmp_path):
    """Runs the command in a folder of its own and returns its JSON; HAPTICAL_COMMAND says where it is."""
    program = os.environ.get("HAPTICAL_COMMAND")
    if not program:
        pytest.skip("HAPTICAL_COMMAND is not set")

    def run(name, device_toml, columns, *flags):
        (tmp_path / "device.toml").write_text(device_toml, encoding="utf-8")
        arguments = [program, name, "--device", "device.toml", "--out", "out", "--json"]
        if columns is not None:
            write_csv(tmp_path / "log.csv", columns)
            arguments += ["--log", "log.csv"]
        done = subprocess.run([*arguments, *flags], cwd=tmp_path, capture_output=True, text=True, check=True)
        return json.loads(done.stdout), tmp_path / "out"

    return run
