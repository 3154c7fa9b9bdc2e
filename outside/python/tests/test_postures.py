"""Many postures at once: joint values, Jacobians, torques, effects, against closed forms and differences."""

import warnings

import haptical
import numpy as np
import pytest
from conftest import planar, planar_position

RNG = np.random.default_rng(5)


def heavy():
    """Masses at the middle of the links, gravity along -y."""
    device = planar()
    for link, mass, half in zip(device["link"][1:], [2.0, 1.0], [0.15, 0.1]):
        # a centre is behind the row's turn
        link |= {"mass_kg": mass, "centre_of_mass_m": [half, 0.0, 0.0], "inertia_kgm2": [1e-3, 1e-2, 1e-2, 0.0, 0.0, 0.0]}
    device["gravity"] = {"vector_mps2": [0.0, -9.81, 0.0]}
    return device


def test_a_jacobian_is_the_derivative_of_the_pose(device):
    q = RNG.uniform(-1.5, 1.5, size=(20, 2))
    jacobians = haptical.jacobian(device, q)
    assert jacobians.shape == (20, 6, 2)
    step = 1e-6
    for joint in range(2):
        ahead, back = (planar_position(q + sign * step * np.eye(2)[joint]) for sign in (1, -1))
        assert np.allclose(jacobians[:, :3, joint], (ahead - back) / (2 * step), atol=1e-9)
        assert np.allclose(jacobians[:, 3:, joint], [0, 0, 1], atol=1e-15)


def test_joint_values_have_the_transmissions_errors():
    joint = {
        "transmission": "capstan",
        "transmission_ratio": 8.0,
        "drum_distance_m": 0.07,
        "transmission_error": {"offset_rad": 0.01, "ratio_deviation": -0.02, "output_drum_xy_m": [0.0, 0.0], "input_drum_xy_m": [0.0, 0.0]},
    }
    device = {"joint": [joint, {}]}
    q = RNG.uniform(-1.0, 1.0, size=(9, 2))
    values = haptical.joint_values(device, q)
    assert np.array_equal(values[:, 1], q[:, 1])
    # a line: offset and a slope
    slope = np.diff(values[:2, 0]) / np.diff(q[:2, 0])
    assert np.allclose(values[:, 0], values[0, 0] + slope * (q[:, 0] - q[0, 0]), atol=1e-12)
    assert np.allclose(values[:, 0] - slope * q[:, 0], 0.01, atol=1e-12) and abs(slope - 1.0) > 1e-3


def test_torques_hold_and_move_the_arm():
    device = heavy()
    q = RNG.uniform(-1.5, 1.5, size=(20, 2))
    q1, q12 = q[:, 0], q.sum(axis=1)
    outer = 9.81 * 1.0 * 0.1 * np.cos(q12)
    inner = 9.81 * (2.0 * 0.15 + 1.0 * 0.3) * np.cos(q1) + outer
    held = haptical.torques(device, q)
    assert np.allclose(held, np.stack([inner, outer], axis=1), atol=1e-12)
    still = haptical.torques(device, q, np.zeros_like(q))
    assert np.allclose(still, held, atol=1e-9)
    # the outer joint alone: its moment of inertia about the elbow
    moved = haptical.torques(device, q, accelerations=np.tile([0.0, 1.0], (20, 1)))
    assert np.allclose((moved - held)[:, 1], 1.0 * 0.1**2 + 0.0, atol=2e-2)
    assert np.all((moved - held)[:, 1] > 0.01)
    with pytest.raises(ValueError, match="no masses"):
        haptical.torques(planar(), q)
    with pytest.raises(ValueError, match="rows"):
        haptical.torques(device, q, q[:3])


def test_effects_bend_the_arm():
    device = heavy()
    device["effect"] = [
        {"name": "joint-compliance", "joint": 2, "stiffness_nm_per_rad": 100.0},
        {"name": "encoder-latency", "delay_s": 0.001},
    ]
    q = np.array([[0.0, 0.0]])
    rigid, _ = haptical.forward_kinematics(device, q)
    with pytest.warns(UserWarning, match="encoder-latency: it depends on how the arm moves"):
        bent, _ = haptical.forward_kinematics(device, q, effects=True)
    # 0.981 N m on 100 N m/rad at 0.2 m, downwards
    assert abs(bent[0, 1] - rigid[0, 1] + 0.2 * 0.00981) < 2e-7
    assert {effect.name for effect in haptical.effects()} >= {"backlash", "capstan-compliance", "payload"}
    backlash = next(effect for effect in haptical.effects() if effect.name == "backlash")
    assert backlash.parameters[0]["unit"] == "rad" and "reversal" in backlash.meaning


def test_a_corrected_path_lands_and_the_command_says_the_same(device, tmp_path):
    model = planar(a_m=0.203)
    path = {"theta1_rad": np.linspace(-0.5, 0.5, 11), "theta2_rad": np.linspace(0.4, 1.2, 11)}
    q = np.stack(list(path.values()), axis=1)
    found = haptical.correct(device, model, path)
    landed = haptical.forward_kinematics(model, found.commands)[0]
    assert np.allclose(landed, planar_position(q), atol=1e-9)
    assert np.allclose(found.before_m, 0.003, atol=1e-9) and found.rest_m.max() < 1e-9
    assert np.array_equal(found.path["theta1_rad"], found.commands[:, 0])
    poses = dict(zip(["x_m", "y_m", "z_m"], planar_position(q).T))
    assert np.isnan(haptical.correct(device, model, poses).before_m).all()
    with pytest.raises(ValueError, match=r"11 of 11 waypoints .* row 1"):
        haptical.correct(device, model, {**poses, "z_m": poses["z_m"] + 0.3})


def test_a_log_is_simulated_and_read_again(device):
    made = haptical.simulate(device, deviate=0.05, seconds=8.0, rate_hz=50.0, seed=4)
    assert made.log.rows == 400 and set(made.log) >= {"t_s", "theta1_rad", "x_m"}
    found = haptical.identify(device, made.log)
    assert found.rank > 0 and found.answer
    again = haptical.simulate(device, deviate=0.05, seconds=8.0, rate_hz=50.0, seed=4)
    assert again.csv == made.csv
    poses = {"theta1_rad": RNG.uniform(-1, 1, 30), "theta2_rad": RNG.uniform(-1, 1, 30)}
    single = haptical.simulate(device, poses, measure="position", truth=made.truth)
    assert single.log.rows == 30 and "x_m" in single.log
    with pytest.raises(ValueError, match="exclude each other"):
        haptical.simulate(device, truth=made.truth, deviate=0.1)


def test_a_device_is_exported(device):
    header = haptical.export(device, "c-header")
    assert "#ifndef" in header
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        urdf = haptical.export(device, "urdf", for_="drake")
    assert any("1000 is written" in str(one.message) for one in told)
    assert "<transmission" in urdf
    assert "<ros2_control" in haptical.export(device, "ros2-control")
    with pytest.raises(ValueError, match="format is"):
        haptical.export(device, "step")
    with pytest.raises(ValueError, match="--for is for --format urdf"):
        haptical.export(device, "toml", for_="drake")
