"""The types of the package, judged by mypy."""

import subprocess
import sys

import pytest

USE = """
import haptical
import numpy as np

result: haptical.Identification = haptical.identify("device.toml", {"theta1_rad": np.zeros(3)}, method="two-step")
value: float = float(result["parameters"]["value"][0])
same: float = float(result.parameters["value"][0])
rank: int = result.rank
level: float = result.intervals.level if result.intervals is not None else 0.0
after: float = result.channels["position"].rms_after
kind: str = result["intervals"]["kind"] if result["intervals"] is not None else ""
tried: int = result["search"]["tried"] if result["search"] is not None else 0
lean = result["force_direction"]
if lean is not None:
    low, high = lean["ci95_rad"]
factors: dict[str, float] = {channel: noise["factor"] for channel, noise in result["noise"].items()}
largest: float = float(result["identifiability"]["at_nominal"]["singular_values"].max())
position, rotation = haptical.forward_kinematics(haptical.Device("device.toml"), [[0.0]])
shape: tuple[int, ...] = position.shape
verdict: str = haptical.diagnose("device.toml", "log.csv")["verdict"]
plan: haptical.Plan = haptical.plan("device.toml", ["out,cable"], poses=20, criterion="task-position", region=[0.3, 0, 0, 0.1])
next_poses = plan["next_poses"]
if next_poses is not None:
    rows: tuple[int, ...] = next_poses["readings"].shape
replayed = haptical.replay("device.toml", "log.csv")["channels"]["cable"]
left: float = replayed["rms"] / replayed["noise_floor"] + float(replayed["residuals"].max())
commands = haptical.correct("device.toml", "model.toml", {"theta1_rad": np.zeros(3)}, match_="position")
largest_rest: float = float(commands.rest_m.max())
text: str = haptical.export("device.toml", "urdf", for_="drake")
table: haptical.Fleet = haptical.fleet("device.toml", ["a.csv", "b.csv"], call="diagnose")
deviations: float = float(plan["rigs"][0]["parameters"]["standard_deviation"].max())
"""


def mypy(tmp_path, text):
    pytest.importorskip("mypy")
    path = tmp_path / "use.py"
    path.write_text(text, encoding="utf-8")
    arguments = ["--strict", "--cache-dir", str(tmp_path / "cache"), str(path)]
    return subprocess.run([sys.executable, "-m", "mypy", *arguments], capture_output=True, text=True, check=False)


def test_right_use_passes(tmp_path):
    done = mypy(tmp_path, USE)
    assert done.returncode == 0, done.stdout + done.stderr


def test_wrong_use_does_not(tmp_path):
    done = mypy(tmp_path, USE.replace('"two-step"', '"three-step"').replace("verdict: str", "verdict: str = 3\nother: str"))
    assert done.returncode == 1
    assert "three-step" in done.stdout or "arg-type" in done.stdout, done.stdout


def test_the_stub_has_what_the_module_has(tmp_path):
    pytest.importorskip("mypy")
    names = ["haptical._haptical", "--ignore-disjoint-bases"]
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", *names], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
