"""Identification: every field of the command's identified.json, number by number, from the same device and log."""

import copy
import csv
import json
import math
import subprocess

import haptical
import numpy as np
import pytest
from conftest import ROOT, planar, recording
from logs import SOMEWHERE, TOUCHES, touching, wild, yielding

ONLY_THE_COMMAND = {"haptical_version", "device", "log", "provenance"}
ONLY_PYTHON = {"rank", "candidates", "identified_toml"}
RESIDUALS = {"rows", "before", "after"}

HAPTIC7 = ROOT / "fixtures/devices/haptic7.toml"


def haptic7(rows=None):
    """Columns of a log of the seven-joint device: four external encoders and one cable."""
    text = (ROOT / "fixtures/logs/haptic7-sample.csv").read_text(encoding="utf-8")
    header, *cells = csv.reader(text.splitlines())
    return dict(zip(header, np.array(cells[:rows], dtype=float).T, strict=True))


def capstans(rows=300):
    """Two joints without links, and their external encoders: a capstan with known errors, a parallelogram."""
    limits = {"lower_rad": -1.0, "upper_rad": 1.0, "external_encoder_sd_rad": 1e-5}
    kinds = [{"transmission": "capstan", "drum_distance_m": 0.0675}, {"transmission": "parallelogram"}]
    joints = [{**limits, "transmission_ratio": 10.8, **kind} for kind in kinds]
    random = np.random.default_rng(4)
    q1, q2 = (0.95 * np.sin(speed * np.arange(rows)) for speed in (0.05, 0.083))
    outs = [1.002 * q1, q2 + 1e-3 * (q2**2 - 0.4 * q2)]
    noisy = [out + 1e-5 * random.normal(size=rows) for out in outs]
    log = {"theta1_rad": q1, "theta2_rad": q2, "out1_rad": noisy[0], "out2_rad": noisy[1]}
    return {"device": {"name": "two drives", "dof": 2}, "joint": joints}, log


def same(ours, theirs, where):
    """Asserts that a value from the package is the same as one of JSON; NaN in an array stands for null."""
    if isinstance(ours, np.ndarray):
        assert isinstance(theirs, list), where
        assert ours.dtype in (np.float64, np.int64), where
        numbers = [math.nan if number is None else number for number in theirs]
        np.testing.assert_array_equal(ours, np.array(numbers, dtype=ours.dtype), err_msg=where)
    elif isinstance(theirs, dict):
        assert set(ours) == set(theirs), where
        for key, entry in theirs.items():
            same(ours[key], entry, f"{where}.{key}")
    elif isinstance(theirs, list):
        assert len(ours) == len(theirs), where
        for index, (mine, entry) in enumerate(zip(ours, theirs)):
            same(mine, entry, f"{where}[{index}]")
    else:
        assert type(ours) is type(theirs) and ours == theirs, f"{where}: {ours!r}, {theirs!r}"


def same_columns(ours, theirs, where):
    """The same for records of JSON that are columns of the package."""
    for column, cells in ours.items():
        expected = [entry[column] for entry in theirs]
        if column == "ci95":
            assert cells.shape == (len(theirs), 2) and cells.dtype == np.float64, where
            expected = [[None, None] if pair is None else pair for pair in expected]
            cells = list(cells)
        same(cells, expected, f"{where}.{column}")
    assert all(set(entry) == set(ours) for entry in theirs), where


def same_channels(ours, theirs, where):
    """The same for channels, which the package has by name and with their residuals."""
    assert list(ours) == [entry["channel"] for entry in theirs], where
    for entry in theirs:
        mine = ours[entry["channel"]]
        same({key: cell for key, cell in mine.items() if key not in RESIDUALS}, entry, f"{where}.{entry['channel']}")
        assert math.isclose(np.sqrt(np.mean(mine["after"] ** 2)), entry["rms_after"], rel_tol=1e-12), where
        assert mine["before"].shape == mine["after"].shape, where


def same_identification(ours, theirs):
    assert set(ours) - ONLY_PYTHON == set(theirs) - ONLY_THE_COMMAND
    ours, theirs = copy.copy(ours), copy.deepcopy(theirs)
    for name in ["channels", "channels_fit"]:
        same_channels(ours.pop(name), theirs.pop(name), name)
    for name in ["parameters", "outliers"]:
        same_columns(ours.pop(name), theirs.pop(name), name)
    for mine, entry in zip(ours["transmissions"], theirs["transmissions"], strict=True):
        # the command leaves this key out where there is no polynomial
        entry.setdefault("polynomial_monomials", None)
        mine = dict(mine)
        same_columns(mine.pop("parameters"), entry.pop("parameters"), "transmission's parameters")
        same(mine, entry, "transmission")
    for name in set(theirs) - ONLY_THE_COMMAND - {"transmissions"}:
        same(ours[name], theirs[name], name)
    ranks = ours["identifiability"]
    assert (ours["rank"], ours["candidates"]) == (ranks["rank"], ranks["candidates"])


def without_comments(toml):
    return [line for line in toml.splitlines() if line and not line.startswith("#")]


CASES = {
    "plain": (planar(), recording(0.3012, 0.1991), {}, []),
    "tracker somewhere": (planar() | SOMEWHERE, recording(0.3012, 0.1991), {}, []),
    "folds": (planar(), recording(0.3012, 0.1991), {"folds": 4, "noise": "stated"}, ["--folds=4", "--noise=stated"]),
    "compliance": (planar(), yielding([2e-3, 5e-3]), {"with_": ["joint-compliance"]}, ["--with=joint-compliance"]),
    "wild": (planar(), wild(), {}, []),
    "huber": (planar(), wild(), {"loss": "huber", "held_out": 0.3}, ["--loss=huber", "--held-out=0.3"]),
    "touches": (planar() | TOUCHES, touching(), {}, []),
    "another arm": (planar(), recording(1.1, 0.4), {}, []),
    "transmissions alone": (*capstans(), {}, []),
    "seven joints": (HAPTIC7, haptic7(), {}, []),
    "two steps": (HAPTIC7, haptic7(), {"method": "two-step", "degree": 6}, ["--method=two-step", "--degree=6"]),
    "short": (HAPTIC7, haptic7(rows=90), {"held_out": 0.0}, ["--held-out=0"]),
}


@pytest.mark.parametrize("case", CASES)
def test_the_command_says_the_same(command, case):
    device, log, keywords, flags = CASES[case]
    theirs, out = command("identify", haptical.Device(device).to_toml(), log, *flags)
    ours = haptical.identify(device, log, **keywords)
    same_identification(ours, theirs)
    written = (out / "identified.toml").read_text(encoding="utf-8")
    assert without_comments(written) == without_comments(ours["identified_toml"])


def test_warnings_are_the_same_from_the_same_files(command, monkeypatch):
    # beyond the limits of a joint, and a column that means nothing
    log = recording(0.3012, 0.1991) | {"note": np.arange(400.0)}
    log["theta1_rad"][7] = 2.9
    theirs, out = command("identify", haptical.Device(planar()).to_toml(), log)
    monkeypatch.chdir(out.parent)
    ours = haptical.identify("device.toml", "log.csv")
    assert ours["warnings"] == theirs["warnings"] and len(ours["warnings"]) >= 2
    same_identification(ours, theirs)


def test_millimetres_are_refused_in_the_same_words(command):
    log = haptic7()
    log["cable_m"] *= 1000.0
    with pytest.raises(subprocess.CalledProcessError) as refused:
        command("identify", haptical.Device(HAPTIC7).to_toml(), log)
    theirs = json.loads(refused.value.stdout)["error"]
    assert theirs["kind"] == "looks-like-millimetres"
    with pytest.raises(ValueError) as ours:
        haptical.identify(HAPTIC7, log)
    assert str(ours.value) == f"the log:{theirs['line']}: {theirs['what']}; {theirs['next']}"


def test_what_the_cases_show():
    """The cases have something to compare in every field."""
    results = {case: haptical.identify(device, log, **keywords) for case, (device, log, keywords, _) in CASES.items()}
    seven, two_steps = results["seven joints"], results["two steps"]
    alone, another = results["transmissions alone"], results["another arm"]
    lean = seven["force_direction"]
    low, high = lean["ci95_rad"]
    assert lean["locked_joint"] == 3 and 0 < low < lean["rms_rad"] < high
    assert results["plain"]["force_direction"] is None, "an arm of direct drives"
    forms = {entry["terms"]["form"] for entry in seven["transmissions"]}
    assert forms == {"capstan", "polynomial"}
    assert seven["intervals"]["level"] == 0.95 and "Student" in seven["intervals"]["kind"]
    assert "stated noise" in results["folds"]["intervals"]["kind"]
    assert any(name.startswith("ratio_deviation") for name in two_steps["intervals"]["considered"])
    assert alone["search"] is None and len(alone["transmissions"]) == 2
    assert alone["identifiability"]["condition_unit_norm"] is None and alone["identifiability"]["gap"] is None
    assert seven["search"]["tried"] == 0 and seven["search"]["doubt"] is None
    assert another["search"]["tried"] > 0 and another["search"]["doubt"]
    assert {scale["channel"] for scale in results["wild"]["loss"]["scales"]} == {"position"}
    assert results["plain"]["loss"]["scales"] == []
    assert any(result["correlations_above_0_95"] for result in results.values())
    assert any(any(table["combination"]) for table in (result["parameters"] for result in results.values()))


def test_a_polynomial_is_the_same_in_powers_of_the_angle():
    for transmission in haptical.identify(HAPTIC7, haptic7())["transmissions"]:
        powers, terms = transmission["polynomial_monomials"], transmission["terms"]
        if terms["form"] != "polynomial":
            assert powers is None
            continue
        low, high = transmission["range_rad"]
        angle = np.linspace(low, high, 9)
        value = transmission["parameters"]["value"]
        chebyshev = np.polynomial.Chebyshev(value, domain=[low, high])(angle)
        assert len(powers) == terms["degree"] + 1
        np.testing.assert_allclose(np.polynomial.Polynomial(powers)(angle), chebyshev, atol=1e-12)


def test_the_noise_found_is_the_factor_on_what_was_stated():
    # twice as noisy as the device file says
    noise = haptical.identify(planar(), recording(0.3012, 0.1991, sd_m=2e-4), held_out=0.0)["noise"]
    assert set(noise) == {"position"} and noise["position"]["stated"] == 1e-4
    # the standard deviation of 1200 readings is known to 2 %
    assert noise["position"]["factor"] == pytest.approx(2.0, rel=0.06)
