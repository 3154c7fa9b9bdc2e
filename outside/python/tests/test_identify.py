"""Identification: against the truth, least squares, and what is refused."""

import math

import haptical
import numpy as np
import pytest
from conftest import ROOT, planar, planar_position, recording, write_csv
from logs import SOMEWHERE, TOUCHES, touching, wild, yielding


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
    fixed = np.array([status in ("identifiable", "combination") for status in table["status"]])
    assert np.isfinite(table["value"][fixed]).all()
    lacking = np.isnan(table["value"])
    assert lacking.any(), "a planar arm cannot show every parameter"
    assert all(table["reason"][index] for index in np.flatnonzero(lacking))


def test_compliances_are_found_where_they_are_fitted(device):
    log = yielding([2e-3, 5e-3])
    result = haptical.identify(device, log, with_=["joint-compliance"])
    table = result["parameters"]
    found = [name for name in table["name"] if "compliance" in name]
    assert len(found) == 2
    for name, truth in zip(found, [2e-3, 5e-3]):
        compliance, deviation, (low, high) = value(result, name)
        assert abs(compliance - truth) < 5 * deviation + 1e-4 and low < truth < high
    assert not any("compliance" in name for name in haptical.identify(device, log)["parameters"]["name"])


def test_wild_readings_are_named_and_do_not_count(device):
    robust, plain = (haptical.identify(device, wild(), loss=loss, held_out=0.0) for loss in ["auto", "squares"])
    assert robust["loss"]["used"] == "tukey" and plain["loss"]["used"] == "squares"
    # the header is line 1
    assert set(robust["outliers"]["line"]) == {22, 152, 335}
    assert robust["outliers"]["line"].dtype == np.int64 and plain["outliers"]["line"].shape == (0,)
    assert robust["outliers"]["channel"][0] == "position"
    error = {kind: abs(value(result, "a1")[0] - 0.3012) for kind, result in [("robust", robust), ("plain", plain)]}
    assert error["robust"] < 5e-5 and error["robust"] < error["plain"]


def test_every_turn_of_a_frame_is_a_parameter(device):
    table = haptical.identify(device | SOMEWHERE, recording(0.3, 0.2))["parameters"]
    base = [name for name in table["name"] if name.startswith("tracker_base")]
    assert len(base) == 6 and len(set(table["name"])) == len(table["name"])


def test_touches_are_read_from_columns_of_texts(device):
    result = haptical.identify(device | TOUCHES, touching(), held_out=0.0)
    plane, contact = (result["channels"][channel] for channel in ["plane", "contact"])
    assert (plane["rows"] == np.arange(50)).all() and (contact["rows"] == np.arange(50, 100)).all()
    assert plane["rms_after"] < 1e-4 and contact["rms_after"] < 1e-4
    assert "contact.socket.x" in result["parameters"]["name"]


def test_a_urdf_takes_a_tip_and_a_rig():
    urdf, rig = ROOT / "fixtures/urdf/arm.urdf", {"tracker": {"base": "known", "tool": "known", "position_sd_m": 1e-4}}
    read = haptical.Device(urdf, tip="tool", rig=rig)
    random = np.random.default_rng(6)
    q = random.uniform(-0.5, 0.5, size=(300, read.joints))
    position, _ = haptical.forward_kinematics(urdf, q, tip="tool")
    position += 1e-4 * random.normal(size=position.shape)
    log = dict(zip(read.columns, q.T)) | dict(zip(["x_m", "y_m", "z_m"], position.T))
    by_file, by_device = haptical.identify(urdf, log, tip="tool", rig=rig), haptical.identify(read, log)
    np.testing.assert_array_equal(by_file["parameters"]["value"], by_device["parameters"]["value"])
    assert by_file["channels_fit"]["position"]["rms_before"] == pytest.approx(1e-4, rel=0.1)
    plan = haptical.plan(urdf, "position", poses=30, candidates=100, tip="tool", rig=rig)
    assert plan["next_poses"]["readings"].shape == (30, read.joints)


def test_a_log_is_the_same_as_a_dictionary_and_as_a_file(device, tmp_path):
    log = recording(0.3012, 0.1991)
    write_csv(tmp_path / "log.csv", log)
    from_file = haptical.identify(device, tmp_path / "log.csv")
    from_arrays = haptical.identify(haptical.Device(device), log)
    np.testing.assert_array_equal(from_file["parameters"]["value"], from_arrays["parameters"]["value"])
    as_single = {name: np.asarray(cells, dtype=np.float32) for name, cells in log.items()}
    single = haptical.identify(device, as_single)
    assert value(single, "a1")[0] == pytest.approx(0.3012, abs=1e-4)


FOLDER = ROOT / "crates/data/tests/fixtures"


def from_random_poses():
    """A device for the logs of that folder, poses at random that fit no device, and what CSV says of them."""
    joint = {"lower_rad": -2.0, "upper_rad": 2.0}
    device = planar()
    device["joint"] = [{"name": "shoulder", **joint}, {"name": "elbow", **joint}]
    return device


def test_mcap_is_read_as_its_csv_log():
    def said(path):
        # nothing is fixed, and the message has numbers worked out from every reading
        with pytest.raises(haptical.HapticalError) as error:
            haptical.identify(from_random_poses(), path, held_out=0.0)
        file, message = str(error.value).split(": ", 1)
        assert file == str(path)
        return message

    assert said(FOLDER / "zstd.mcap") == said(FOLDER / "log.csv")


def test_parquet_is_read_as_the_same_columns():
    log = FOLDER / "log.csv"
    names = log.read_text(encoding="utf-8").splitlines()[0].split(",")
    columns = dict(zip(names, np.genfromtxt(log, delimiter=",", skip_header=1).T, strict=True))
    # what its generate.py adds
    columns |= {"run": np.arange(40) // 20, "contact": ["left"] * 20 + [None] * 20}
    device = from_random_poses()
    for link in device["link"]:
        # a tilt that poses at random draw anywhere: no search of it comes to rest
        link["hold"] = ["beta"]
    ours, theirs = (haptical.identify(device, form, held_out=0.0) for form in [columns, FOLDER / "snappy.parquet"])
    assert ours["parameters"]["name"] == theirs["parameters"]["name"]
    assert "contact.left.x" in ours["parameters"]["name"]
    np.testing.assert_array_equal(ours["parameters"]["value"], theirs["parameters"]["value"])
    for channel in ["position", "orientation", "contact"]:
        np.testing.assert_array_equal(ours["channels"][channel]["after"], theirs["channels"][channel]["after"])


def test_texts_and_gaps_are_taken_from_arrays(device):
    log = recording(0.3012, 0.1991)
    log["x_m"][3] = log["y_m"][3] = log["z_m"][3] = np.nan
    log["run"] = np.repeat([1, 2], 200)
    log["note"] = np.array(["a", None] * 200, dtype=object)
    result = haptical.identify(device, log, held_out=0.0)
    assert 3 not in result["channels"]["position"]["rows"]
    assert any("`note`" in warning for warning in result["warnings"])


def millimetres(log):
    return log | {name: 1000 * log[name] for name in ["x_m", "y_m", "z_m"]}


def test_every_function_refuses_millimetres(device):
    log = recording(0.3, 0.2)
    wrong = millimetres(log)
    for refuses in [
        lambda: haptical.identify(device, wrong),
        lambda: haptical.diagnose(device, wrong),
        lambda: haptical.diagnose(device, log, validate=wrong),
        lambda: haptical.plan(device, "position", log=wrong),
    ]:
        with pytest.raises(ValueError, match="looks like millimetres"):
            refuses()


def test_bad_input_is_a_value_error_with_place_and_advice(device):
    log = recording(0.3, 0.2)

    def refused(match, **changes):
        columns = {name: cells for name, cells in {**log, **changes}.items() if cells is not None}
        with pytest.raises(ValueError, match=match):
            haptical.identify(device, columns)

    gap = log["theta1_rad"].copy()
    gap[5] = np.nan
    refused(r"the log:7:2, column `theta1_rad`: empty", theta1_rad=gap)
    refused(r"missing `theta2_rad`", theta2_rad=None)
    refused(r"looks like degrees", theta1_rad=np.degrees(log["theta1_rad"]))
    refused(r"`x_m` is of the type complex128", x_m=log["x_m"] * 1j)
    refused(r"`t_s` is of the type datetime64", t_s=np.zeros(400, dtype="datetime64[ns]"))
    refused(r"`x_m` has 2 dimensions", x_m=np.zeros((400, 1)))
    refused(r"column `x_m`: the column has 3 rows, the first one 400", x_m=np.zeros(3))
    refused(r":72:4, column `x_m`: .* beyond what any device measures", x_m=np.where(np.arange(400) == 70, 1e200, log["x_m"]))
    refused(r"found `abc`", x_m=np.array(["abc"] * 400))
    refused(r"the log:2: `x_m, y_m, z_m` looks like millimetres: .* reaches 0.5000 m", **millimetres(log))
    with pytest.raises(FileNotFoundError, match="no_such.csv"):
        haptical.identify(device, "no_such.csv")
    with pytest.raises(ValueError, match="type int; give a path, a dictionary of columns or a frame"):
        haptical.identify(device, 3)
    for keyword, wrong in [
        ("method", "both"),
        ("noise", "none"),
        ("loss", "huge"),
        ("degree", 99),
        ("held_out", 0.9),
        ("folds", 1),
        ("folds", 2.5),
        ("with_", ["backlsh"]),
    ]:
        with pytest.raises(ValueError, match=keyword.rstrip("_")):
            haptical.identify(device, log, **{keyword: wrong})


def test_numbers_that_fix_nothing_are_an_error_of_their_own(device):
    still = {name: np.zeros(400) for name in recording(0.3, 0.2)}
    still["t_s"] = np.arange(400.0)
    with pytest.raises(haptical.HapticalError) as error:
        haptical.identify(device, still)
    assert not isinstance(error.value, ValueError)
    assert str(error.value)
