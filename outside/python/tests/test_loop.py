"""From a gap to a corrected model: the program of docs/python.md, on a simulated device whose second cable stretches."""

import os
import pathlib
import re
import subprocess

import haptical
import numpy as np
import pytest
from conftest import ROOT, recording


def test_a_replay_predicts_what_the_device_would_read(device):
    right = recording(0.3, 0.2)
    channel = haptical.replay(device, right)["channels"]["position"]
    assert channel["residuals"].shape == (400, 3) and list(channel["rows"][:2]) == [0, 1]
    assert channel["rms"] == pytest.approx(1e-4, rel=0.1)
    assert channel["rms"] == pytest.approx(np.sqrt(np.mean(channel["residuals"] ** 2)))
    # a link of 201 mm where the device file has 200: prediction minus measurement is 1 mm towards the base
    angle = right["theta1_rad"] + right["theta2_rad"]
    short = haptical.replay(device, recording(0.3, 0.201))["channels"]["position"]["residuals"]
    along = short[:, 0] * np.cos(angle) + short[:, 1] * np.sin(angle)
    assert np.mean(along) == pytest.approx(-1e-3, rel=0.05)


def test_a_clean_log_corrects_nothing(device):
    assert haptical.diagnose(device, recording(0.3012, 0.1991))["corrected_toml"] is None


def test_a_replay_of_nothing_is_a_value_error(device):
    log = recording(0.3, 0.2)
    with pytest.raises(ValueError):
        haptical.replay(device, {name: log[name] for name in ["t_s", "theta1_rad", "theta2_rad"]})


def test_the_program_of_the_page_closes_the_loop(tmp_path, monkeypatch, capsys):
    program = os.environ.get("HAPTICAL_COMMAND")
    if not program:
        pytest.skip("HAPTICAL_COMMAND is not set")
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    code = next(code for code in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "corrected_toml" in code)
    assert len([line for line in code.splitlines() if line.strip()]) <= 12
    nominal = ROOT / "fixtures" / "devices" / "haptic7.toml"
    (tmp_path / "device.toml").write_bytes(nominal.read_bytes())
    for seed, name in enumerate(["log.csv", "fresh.csv"], start=1):
        flags = ["--truth", ROOT / "fixtures" / "devices" / "haptic7-deviating.toml"]
        flags += ["--effects", ROOT / "fixtures" / "effects" / "stretching-cable.toml"]
        flags += ["--seconds", "60", "--rate-hz", "100", "--seed", seed, "--out", name]
        arguments = [program, "simulate", "--device", "device.toml", *flags]
        subprocess.run([str(argument) for argument in arguments], cwd=tmp_path, check=True, capture_output=True)
    monkeypatch.chdir(tmp_path)
    exec(compile(code, "docs/python.md", "exec"), {})
    answer, *lines = capsys.readouterr().out.splitlines()
    assert "capstan-compliance at joint 2" in answer
    *channels, verdict = lines
    assert verdict == "no-gap"
    cable = next(line.split() for line in channels if line.startswith("cable"))
    before, after, floor = map(float, cable[1:])
    assert before > 20 * floor and after < 2 * floor
    assert "stiffness_nm_per_rad" in pathlib.Path("corrected.toml").read_text(encoding="utf-8")
