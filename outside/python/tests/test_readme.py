"""The programs in README.md and docs/python.md run as they stand there."""

import os
import pathlib
import re
import shutil
import subprocess

import pytest

HERE = pathlib.Path(__file__).resolve()
README = HERE.parents[1] / "README.md"
DOCS = HERE.parents[3] / "docs" / "python.md"


def programs(path):
    return re.findall(r"```python\n(.*?)```", path.read_text(encoding="utf-8"), re.DOTALL)


def test_the_program_of_the_readme_runs(capsys):
    found = programs(README)
    assert len(found) == 1
    exec(compile(found[0], str(README), "exec"), {})
    verdict, *parameters = capsys.readouterr().out.splitlines()
    assert verdict in {"no-gap", "named", "ambiguous", "unknown"}
    statuses = {line.split()[1] for line in parameters}
    assert "identifiable" in statuses and statuses <= {"identifiable", "combination", "weak", "dependent", "invisible", "held"}


@pytest.mark.filterwarnings("ignore")
def test_the_programs_of_the_docs_run(tmp_path, monkeypatch, capsys):
    pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    command = os.environ.get("HAPTICAL_COMMAND")
    if not command:
        pytest.skip("HAPTICAL_COMMAND is not set")
    subprocess.run([command, "init", "demo", "--example", "gap"], cwd=tmp_path, capture_output=True, check=True)
    subprocess.run([command, "init", "arm", "--example", "moving-arm"], cwd=tmp_path, capture_output=True, check=True)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "demo" / "second.csv").rename("fresh.csv")
    (tmp_path / "demo" / "device.toml").rename("device.toml")
    for name in ["log.csv", "a.csv", "b.csv"]:
        shutil.copy(tmp_path / "demo" / "log.csv", name)
    (tmp_path / "c.csv").write_text("theta1_rad\nnone\n")
    # those of a URDF's chain and of clusters need what is not here
    elsewhere = ["robot.urdf", "import Client", "import ray"]
    found = [program for program in programs(DOCS) if not any(word in program for word in elsewhere)]
    assert len(found) >= 6
    names = {}
    for program in found:
        exec(compile(program, str(DOCS), "exec"), names)
    said = capsys.readouterr().out
    assert "payload None" in said and "<mujoco" in names["model"]
    assert "capstan-compliance at joint 2" in said and "out,cable 51 of 55" in said
    assert (tmp_path / "fleet.parquet").stat().st_size > 0
    assert (tmp_path / "corrected.toml").read_text().count("[[effect]]") == 1
