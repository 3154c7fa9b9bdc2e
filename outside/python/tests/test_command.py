"""The wheel's command is the program `haptical`."""

import pathlib
import subprocess
import sys

import haptical

COMMAND = pathlib.Path(sys.executable).with_name("haptical")


def run(*words, cwd=None):
    return subprocess.run(words, cwd=cwd, capture_output=True, text=True)


def test_the_script_and_the_module_are_the_command(tmp_path):
    for words in [[str(COMMAND)], [sys.executable, "-m", "haptical"]]:
        said = run(*words, "--version")
        assert (said.returncode, said.stdout) == (0, f"haptical {haptical.__version__}\n")
        refused = run(*words, "check", "no-such.toml", "log.csv", cwd=tmp_path)
        assert refused.returncode == 2
        assert [line.split(":")[0].strip() for line in refused.stderr.splitlines()] == ["error", "where", "next"]


def test_names_that_are_no_unicode_are_passed_on(tmp_path):
    refused = run(sys.executable, "-m", "haptical", "check", b"\xff.toml", "log.csv", cwd=tmp_path)
    assert refused.returncode == 2 and ".toml" in refused.stderr


def test_the_command_and_the_package_give_the_same(tmp_path):
    assert run(str(COMMAND), "init", ".", "--example", "sockets", cwd=tmp_path).returncode == 0
    words = ["identify", "--device", "arm6.urdf", "--rig", "rig.toml", "--log", "log.csv", "--out", "fit"]
    assert run(str(COMMAND), *words, cwd=tmp_path).returncode == 0
    result = haptical.identify(tmp_path / "arm6.urdf", tmp_path / "log.csv", rig=tmp_path / "rig.toml")
    numbers = {number.name: number.value for number in result.parameters.records()}
    assert len(numbers) == result.parameters.rows > 20
    model = haptical.Device(tmp_path / "fit" / "identified.toml")
    assert model.joints == 6
    written = (tmp_path / "fit" / "identified.toml").read_text(encoding="utf-8")
    ours = [line for line in written.splitlines() if not line.startswith("#")]
    assert ours == [line for line in result.identified_toml.splitlines() if not line.startswith("#")]
