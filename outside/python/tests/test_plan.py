"""Plans: against derivatives by differences, limits measured by forward kinematics, and the command's own JSON."""

import math

import haptical
import numpy as np
import pytest
from conftest import planar, recording

ROWS = [(0.2, 0.7, 0.1), (0.25, -1.1, 0.05), (0.2, 0.9, -0.04), (0.15, 0.4, 0.08)]
SD_M = 1e-4


@pytest.fixture
def arm():
    """Three joints without any special angle, a cable encoder and a tracker of the position."""
    joint = {"lower_rad": -1.2, "upper_rad": 1.0, "transmission": "direct", "external_encoder_sd_rad": 1e-4}
    return {
        "device": {"name": "arm", "dof": 3},
        "link": [{"a_m": a, "alpha_rad": alpha, "d_m": d, "theta_offset_rad": 0.0} for a, alpha, d in ROWS],
        "joint": [joint, joint, joint],
        "cable_encoder": {"distance_sd_m": 1e-5, "scale_sd": 0.0},
        "tracker": {"base": "known", "tool": "known", "position_sd_m": SD_M, "scale_sd": 0.0},
    }


def small(device, measure, **further):
    return haptical.plan(device, measure, candidates=150, known_transmissions=True, **further)


def cramer_rao(device, readings, names):
    """Standard deviations of Denavit-Hartenberg numbers from positions at readings, by differences."""
    keys = {"a": "a_m", "alpha": "alpha_rad", "d": "d_m", "theta": "theta_offset_rad"}
    step, columns = 1e-6, []
    for name in names:
        row, key = int(name[-1]), keys[name[:-1]]
        ends = []
        for sign in (1, -1):
            links = [dict(link) for link in device["link"]]
            links[row][key] += sign * step
            ends.append(haptical.forward_kinematics({**device, "link": links}, readings)[0].ravel())
        columns.append((ends[0] - ends[1]) / (2 * step))
    jacobian = np.stack(columns, axis=1) / SD_M
    return np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))


def test_predicted_deviations_are_those_of_the_chosen_poses(arm):
    plan = small(arm, "position", poses=25)
    chosen = plan["next_poses"]
    readings = chosen["readings"]
    assert readings.shape == (25, 3) and readings.dtype == np.float64
    assert (readings > -1.2).all() and (readings < 1.0).all()
    assert len(np.unique(readings, axis=0)) == 25
    told = chosen["parameters"]
    expected = cramer_rao(arm, readings, told["name"])
    np.testing.assert_allclose(told["standard_deviation"], expected, rtol=1e-5)
    assert chosen["figures"]["o1"] > chosen["random"]["o1"]
    assert chosen["contact"] is None and chosen["plane"] is None
    assert len(told["name"]) == plan["rigs"][0]["rank"]


def test_more_candidates_than_poses_are_better_than_none_to_choose_from(arm):
    def deviations(candidates):
        plan = haptical.plan(arm, "position", poses=25, candidates=candidates, known_transmissions=True)
        return plan["next_poses"]["parameters"]["standard_deviation"]

    few, many = deviations(25), deviations(500)
    assert np.log(many).mean() < np.log(few).mean() - 0.1


def test_columns_of_parameters_have_one_entry_each(arm):
    plan = small(arm, ["cable", "cable,pose"])
    assert plan["poses"] == 200 and plan["next_poses"] is None and plan["measured_poses"] == 0
    assert [rig["measure"] for rig in plan["rigs"]] == ["cable", "cable,pose"]
    ranks = [rig["rank"] for rig in plan["rigs"]]
    assert ranks[0] < ranks[1]
    for rig in plan["rigs"]:
        table = rig["parameters"]
        count = len(table["name"])
        assert all(len(table[column]) == count for column in ["unit", "status", "reason"])
        assert table["standard_deviation"].shape == table["plausible_size"].shape == (count,)
        told = np.array([status in ("identifiable", "weak") for status in table["status"]])
        np.testing.assert_array_equal(np.isfinite(table["standard_deviation"]), told)
        assert [status == "identifiable" for status in table["status"]] == [reason is None for reason in table["reason"]]
        open_ones = [name for name, reason in zip(table["name"], table["reason"]) if reason]
        assert [found["parameter"] for found in rig["suggestions"]] == open_ones
    best = plan["rigs"][0]["suggestions"][0]["remedies"]
    assert best and [one["standard_deviation"] for one in best] == sorted(one["standard_deviation"] for one in best)


def test_a_device_s_own_rigs_are_compared_where_none_are_given(arm):
    plan = small(arm, ())
    assert [rig["measure"] for rig in plan["rigs"]] == ["out,cable", "out,position", "out,pose"]


@pytest.mark.parametrize(
    ("keywords", "flags"),
    [
        ({"poses": 60, "seed": 3}, ["--poses=60", "--seed=3"]),
        ({"criterion": "a", "poses": 60, "spread": "normal"}, ["--criterion=a", "--poses=60", "--spread=normal"]),
        (
            {
                "criterion": "task-position",
                "poses": 60,
                "region": np.array([0.8, -0.09, 0.17, 0.1]),
                "link_radius": 0.01,
                "cable_length": (0.2, 0.9),
            },
            ["--criterion=task-position", "--poses=60", "--region=0.8,-0.09,0.17,0.1", "--link-radius=0.01", "--cable-length=0.2,0.9"],
        ),
        (
            {"criterion": "task-position", "poses": 60, "region": [[-1, 1], [-0.5, 0.5], (0, 1)], "workspace": [[-1] * 3, [1] * 3]},
            ["--criterion=task-position", "--poses=60", "--region=-1:1,-0.5:0.5,0:1", "--workspace=-1,-1,-1,1,1,1"],
        ),
    ],
)
def test_the_command_says_the_same(arm, command, keywords, flags):
    measure = ["out,cable", "contact:2:0.2"]
    rigs = [f"--measure={rig}" for rig in measure]
    text = haptical.Device(arm).to_toml()
    theirs, out = command("plan", text, None, *rigs, "--candidates=200", *flags)
    ours = haptical.plan(arm, measure, candidates=200, **keywords)
    assert (ours["poses"], ours["measured_poses"]) == (theirs["poses"], theirs["measured_poses"])
    for mine, other in zip(ours["rigs"], theirs["rigs"], strict=True):
        assert mine["suggestions"] == other["suggestions"]
        assert (mine["rank"], mine["readings_per_pose"]) == (other["rank"], other["readings_per_pose"])
        same_columns(mine["parameters"], other["parameters"])
    mine, other = ours["next_poses"], theirs["next_poses"]
    same_columns(mine["parameters"], other["parameters"])
    for field in ["measure", "criterion", "count", "candidates", "figures", "random", "exchanges"]:
        assert mine[field] == other[field], field
    written = np.loadtxt(out / "poses.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(mine["readings"], written)


def same_columns(table, entries):
    """A table of columns has the numbers and texts of a list of entries."""
    for column, cells in table.items():
        expected = [entry[column] for entry in entries]
        if isinstance(cells, np.ndarray):
            expected = [math.nan if cell is None else cell for cell in expected]
            np.testing.assert_array_equal(cells, expected, err_msg=column)
        else:
            assert cells == expected, column


def test_poses_keep_within_the_limits_that_are_given(arm):
    box = np.array([[0.2, -0.4, -0.3], [0.7, 0.3, 0.6]])
    plan = small(arm, "cable", poses=40, workspace=box, cable_length=[0.3, 0.6])
    position, _ = haptical.forward_kinematics(arm, plan["next_poses"]["readings"])
    assert (position >= box[0]).all() and (position <= box[1]).all()
    length = np.linalg.norm(position, axis=1)
    assert (length >= 0.3).all() and (length <= 0.6).all()
    free, _ = haptical.forward_kinematics(arm, small(arm, "cable", poses=40)["next_poses"]["readings"])
    assert ((free < box[0]) | (free > box[1])).any(), "the box must leave something out"


def test_poses_for_a_region_are_better_there(arm):
    ball = {"criterion": "task-position", "region": [0.8, -0.09, 0.17, 0.1], "poses": 30}
    found = small(arm, "cable", **ball)["next_poses"]
    assert found["figures"]["root_mean_square"] < found["random"]["root_mean_square"] < 1e-2
    assert small(arm, "cable", poses=30)["next_poses"]["figures"]["root_mean_square"] is None


def test_poses_of_a_log_add_to_what_is_told(arm):
    random = np.random.default_rng(2)
    log = {f"theta{joint}_rad": random.uniform(-1, 1, size=40) for joint in (1, 2, 3)}
    alone, besides = small(arm, "cable", poses=20), small(arm, "cable", poses=20, log=log)
    assert (alone["measured_poses"], besides["measured_poses"]) == (0, 40)
    first, second = (plan["rigs"][0]["parameters"]["standard_deviation"] for plan in (alone, besides))
    told = np.isfinite(first)
    assert (second[told] < first[told]).all() and told.sum() > 5


def test_poses_that_touch_name_what_they_touch(arm):
    found = small(arm, "contact:2:0.2", poses=60)["next_poses"]
    assert len(found["contact"]) == 60 and len(set(found["contact"])) == 2 and found["plane"] is None
    position, _ = haptical.forward_kinematics(arm, found["readings"])
    for socket in set(found["contact"]):
        at = position[np.array(found["contact"]) == socket]
        assert np.ptp(at, axis=0).max() < 1e-6, "the handle sits in one socket at one place"


def test_the_seed_decides(arm):
    first, again, other = (small(arm, "cable", poses=20, seed=seed)["next_poses"]["readings"] for seed in (4, 4, 5))
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)


def test_bad_arguments_are_value_errors(arm):
    for match, keywords in [
        ("measurement `cabel`", {"measure": "cabel"}),
        ("there is no joint 9", {"measure": ["out9"]}),
        ("criterion is \"e\"; one of these is expected: d, a", {"criterion": "e"}),
        ("spread is \"even\"", {"spread": "even"}),
        ("poses is 0; a whole number from 1", {"poses": 0}),
        ("poses is -3; a whole number from 1", {"poses": -3}),
        ("poses is 2.5; a whole number from 1", {"poses": 2.5}),
        ("candidates is many", {"candidates": "many"}),
        ("seed is -1", {"seed": -1}),
        ("region is .*a ball x, y, z, r in m", {"region": [1, 2, 3]}),
        ("region is .*a ball x, y, z, r in m", {"region": "everywhere"}),
        ("region has NaN in it", {"region": [0, 0, math.nan, 1]}),
        ("workspace is .*a pair", {"workspace": [0, 0, 0, 1, 1, 1]}),
        ("a side of the workspace", {"workspace": [[1, 0, 0], [0, 1, 1]]}),
        ("cable_length has inf in it", {"cable_length": [0, math.inf]}),
        ("the longest cable", {"cable_length": [2, 1]}),
        ("link_radius is -1", {"link_radius": -1.0}),
        ("ask for more candidates", {"poses": 10, "candidates": 5}),
        ("ask for at least", {"poses": 2}),
        ("joint|range", {"criterion": "task-position", "poses": 30, "region": [[-1, 1]]}),
    ]:
        with pytest.raises(ValueError, match=match):
            haptical.plan(arm, **{"measure": "cable", "known_transmissions": True, "candidates": 100, **keywords})
    with pytest.raises(ValueError, match="only out can be seen"):
        haptical.plan("[[joint]]\n", "pose")


def test_a_rig_that_tells_nothing_is_an_error_of_its_own(arm):
    with pytest.raises(haptical.HapticalError, match="no free parameter") as error:
        small(arm, "out", poses=10)
    assert not isinstance(error.value, ValueError)


def test_a_log_of_the_planar_device_leads_to_its_next_poses():
    plan = haptical.plan(planar(), "out,position", poses=15, candidates=100, log=recording(0.3, 0.2))
    assert plan["measured_poses"] == 400
    assert plan["next_poses"]["readings"].shape == (15, 2)
