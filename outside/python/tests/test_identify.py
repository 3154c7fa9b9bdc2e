"""Identification: against the truth, least squares, and the command's own JSON."""

import math

import haptical
import numpy as np
import pytest
from conftest import ROOT, planar, planar_position, recording, write_csv


def value(result, name):
    """Value, standard deviation and interval of a parameter."""
    table = result["parameters"]
    index = table["name"].index(name)
    return table["value"][index], table["standard_deviation"][index], table["ci95"][index]


def test_lengths_are_found_within_their_intervals(device):
    result = haptical.identify(device, recording(0.3012, 0.1991))
    for name, truth in [("a1", 0.3012), ("a2", 0.1991)]:
        found, deviation, (low, high) = value(result, name)
        assert abs(found - truth) < 5 * deviation
        assert low < found < high and high - low < 1e-4
    text = result["identified_toml"]
    again = haptical.forward_kinematics(text, [[0.0, 0.0]])[0]
    assert again[0, 0] == pytest.approx(0.5003, abs=1e-4)


def test_residuals_are_measured_minus_closed_form(device):
    log = recording(0.3012, 0.1991)
    result = haptical.identify(device, log, held_out=0.0)
    channel = result["channels"]["position"]
    assert channel["unit"] == "m" and channel["rows"].dtype == np.int64
    q = np.stack([log["theta1_rad"], log["theta2_rad"]], axis=1)
    measured = np.stack([log["x_m"], log["y_m"], log["z_m"]], axis=1)
    ours = np.sort(np.abs(channel["before"]))
    theirs = np.sort(np.abs(measured - planar_position(q)).ravel())
    np.testing.assert_allclose(ours, theirs, atol=1e-12)
    assert math.sqrt(np.mean(channel["after"] ** 2)) < 1.2e-4


def test_columns_of_parameters_have_one_entry_each(device):
    table = haptical.identify(device, recording(0.3012, 0.1991))["parameters"]
    count = len(table["name"])
    assert count > 2
    for column in ["key", "unit", "status", "reason"]:
        assert len(table[column]) == count
    for column in ["nominal", "value", "standard_deviation"]:
        assert table[column].shape == (count,) and table[column].dtype == np.float64
    assert table["ci95"].shape == (count, 2)
    fixed = np.array([status == "identifiable" for status in table["status"]])
    assert np.isfinite(table["value"][fixed]).all()
    lacking = np.isnan(table["value"])
    assert lacking.any(), "a planar arm cannot show every parameter"
    assert all(table["reason"][index] for index in np.flatnonzero(lacking))


def test_the_command_says_the_same(device, command):
    log = recording(0.3012, 0.1991)
    text = haptical.Device(device).to_toml()
    theirs, out = command("identify", text, log)
    ours = haptical.identify(device, log)
    table = ours["parameters"]
    assert table["name"] == [entry["name"] for entry in theirs["parameters"]]
    for column in ["key", "unit", "status", "reason"]:
        assert table[column] == [entry[column] for entry in theirs["parameters"]], column
    for column in ["nominal", "value", "standard_deviation"]:
        expected = [math.nan if entry[column] is None else entry[column] for entry in theirs["parameters"]]
        np.testing.assert_array_equal(table[column], expected)
    assert ours["rank"] == theirs["identifiability"]["rank"]
    assert ours["held_out"] == theirs["held_out"]
    for channel in theirs["channels"]:
        mine = ours["channels"][channel["channel"]]
        assert (mine["rms_before"], mine["rms_after"]) == (channel["rms_before"], channel["rms_after"])
    written = (out / "identified.toml").read_text(encoding="utf-8")
    without_comments = "\n".join(line for line in written.splitlines() if not line.startswith("#")).strip()
    assert without_comments == ours["identified_toml"].strip()


def test_a_log_is_the_same_as_a_dictionary_and_as_a_file(device, tmp_path):
    log = recording(0.3012, 0.1991)
    write_csv(tmp_path / "log.csv", log)
    from_file = haptical.identify(device, tmp_path / "log.csv")
    from_arrays = haptical.identify(haptical.Device(device), log)
    np.testing.assert_array_equal(from_file["parameters"]["value"], from_arrays["parameters"]["value"])
    as_single = {name: np.asarray(cells, dtype=np.float32) for name, cells in log.items()}
    single = haptical.identify(device, as_single)
    assert value(single, "a1")[0] == pytest.approx(0.3012, abs=1e-4)


@pytest.mark.parametrize("name", ["snappy.parquet", "zstd.mcap"])
def test_parquet_and_mcap_are_read_as_their_csv_log(name):
    folder = ROOT / "crates/data/tests/fixtures"
    joint = {"lower_rad": -2.0, "upper_rad": 2.0}
    device = planar()
    device["joint"] = [{"name": "shoulder", **joint}, {"name": "elbow", **joint}]

    def said(path):
        # poses at random fix nothing, and the message has numbers worked out from every reading
        with pytest.raises(haptical.HapticalError) as error:
            haptical.identify(device, path, held_out=0.0)
        return str(error.value)

    assert said(folder / name) == said(folder / "log.csv")


def test_texts_and_gaps_are_taken_from_arrays(device):
    log = recording(0.3012, 0.1991)
    log["x_m"][3] = log["y_m"][3] = log["z_m"][3] = np.nan
    log["run"] = np.repeat([1, 2], 200)
    log["note"] = np.array(["a", None] * 200, dtype=object)
    result = haptical.identify(device, log, held_out=0.0)
    assert 3 not in result["channels"]["position"]["rows"]
    assert any("`note`" in warning for warning in result["warnings"])


def test_bad_input_is_a_value_error_with_place_and_advice(device):
    log = recording(0.3, 0.2)

    def refused(match, **changes):
        columns = {name: cells for name, cells in {**log, **changes}.items() if cells is not None}
        with pytest.raises(ValueError, match=match):
            haptical.identify(device, columns)

    gap = log["theta1_rad"].copy()
    gap[5] = np.nan
    refused(r"the log, line 7, column 2 `theta1_rad`: empty", theta1_rad=gap)
    refused(r"missing `theta2_rad`", theta2_rad=None)
    refused(r"looks like degrees", theta1_rad=np.degrees(log["theta1_rad"]))
    refused(r"`x_m` is of the type complex128", x_m=log["x_m"] * 1j)
    refused(r"`t_s` is of the type datetime64", t_s=np.zeros(400, dtype="datetime64[ns]"))
    refused(r"`x_m` has 2 dimensions", x_m=np.zeros((400, 1)))
    refused(r"`x_m`: the column has 3 rows, the first one 400", x_m=np.zeros(3))
    refused(r"found `abc`", x_m=np.array(["abc"] * 400))
    with pytest.raises(FileNotFoundError, match="no_such.csv"):
        haptical.identify(device, "no_such.csv")
    with pytest.raises(ValueError, match="type int; give a path or a dictionary"):
        haptical.identify(device, 3)
    for keyword, wrong in [("method", "both"), ("noise", "none"), ("loss", "huge"), ("degree", 99), ("held_out", 0.9)]:
        with pytest.raises(ValueError, match=keyword):
            haptical.identify(device, log, **{keyword: wrong})


def test_numbers_that_fix_nothing_are_an_error_of_their_own(device):
    still = {name: np.zeros(400) for name in recording(0.3, 0.2)}
    still["t_s"] = np.arange(400.0)
    with pytest.raises(haptical.HapticalError) as error:
        haptical.identify(device, still)
    assert not isinstance(error.value, ValueError)
    assert str(error.value)
