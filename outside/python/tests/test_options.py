"""Every flag of the command that changes a result is a keyword, and no keyword is anything else."""

import inspect
import os
import re
import subprocess

import haptical
import pytest
from conftest import recording

#: Flags that are about files and the terminal, or whose value is an argument.
OF_FILES = {"device", "log", "out", "force", "json", "help", "version", "list", "model", "waypoints", "format", "poses"}
#: Flags that have a function of their own.
ELSEWHERE = {
    "simulate": {"replay": haptical.replay, "forward": None, "with": None, "controller": None},
}
#: Keywords of Python alone.
OWN = {"progress"}


def flags(command):
    program = os.environ.get("HAPTICAL_COMMAND")
    if not program:
        pytest.skip("HAPTICAL_COMMAND is not set")
    text = subprocess.run([program, command, "--help"], capture_output=True, text=True, check=True).stdout
    # a line of an option begins with it; examples stand elsewhere
    return set(re.findall(r"^\s{2,6}(?:-\w, )?--([a-z-]+)", text, re.MULTILINE))


@pytest.mark.parametrize(
    ("command", "function"),
    [
        ("identify", haptical.identify),
        ("diagnose", haptical.diagnose),
        ("plan", haptical.plan),
        ("simulate", haptical.simulate),
        ("correct", haptical.correct),
        ("export", haptical.export),
    ],
)
def test_every_flag_is_a_keyword(command, function):
    parameters = set(inspect.signature(function).parameters)
    keywords = {name.rstrip("_").replace("_", "-") for name in parameters}
    found = flags(command) - OF_FILES - set(ELSEWHERE.get(command, {}))
    assert len(found) >= 6, found
    assert found - keywords == set()
    arguments = {"device", "log", "model", "waypoints", "format", "poses"}
    assert keywords - found - arguments - OWN == set()


def test_the_defaults_are_the_commands(device):
    log = recording(0.3012, 0.1991)
    explicit = haptical.identify(device, log, held_out=0.2, loss="auto", noise="estimated", degree="evidence")
    assert explicit["identified_toml"] == haptical.identify(device, log)["identified_toml"]
