"""Forward kinematics against closed forms and an independent product of matrices."""

import math
import pickle
import tomllib

import haptical
import numpy as np
import pytest
from conftest import ROOT, planar, planar_position


def test_a_planar_arm_is_where_trigonometry_puts_it(device):
    q = np.random.default_rng(1).uniform(-2, 2, size=(500, 2))
    position, rotation = haptical.forward_kinematics(device, q)
    assert position.shape == (500, 3) and rotation.shape == (500, 3, 3)
    np.testing.assert_allclose(position, planar_position(q), atol=1e-15)
    angle = q.sum(axis=1)
    np.testing.assert_allclose(rotation[:, 0, 0], np.cos(angle), atol=1e-15)
    np.testing.assert_allclose(rotation[:, 1, 0], np.sin(angle), atol=1e-15)
    np.testing.assert_allclose(rotation[:, 0, 1], -np.sin(angle), atol=1e-15)


def matrix(theta, link):
    """A = Rz(theta) Trans(a, 0, d) Rx(alpha)."""
    c, s = math.cos(theta), math.sin(theta)
    ca, sa = math.cos(link["alpha_rad"]), math.sin(link["alpha_rad"])
    z = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    x = np.array([[1, 0, 0, link["a_m"]], [0, ca, -sa, 0], [0, sa, ca, link["d_m"]], [0, 0, 0, 1.0]])
    return z @ x


def test_the_paper_s_device_is_a_product_of_matrices():
    path = ROOT / "fixtures/devices/haptic7.toml"
    with open(path, "rb") as file:
        tables = tomllib.load(file)
    q = np.random.default_rng(2).uniform(-1, 1, size=(50, 7))
    position, rotation = haptical.forward_kinematics(path, q)
    for row, angles in enumerate(q):
        pose = matrix(tables["link"][0]["theta_offset_rad"], tables["link"][0])
        for angle, joint, link in zip(angles, tables["joint"], tables["link"][1:]):
            pose = pose @ matrix(angle + joint.get("home_rad", 0.0) + link["theta_offset_rad"], link)
        np.testing.assert_allclose(position[row], pose[:3, 3], atol=1e-14)
        np.testing.assert_allclose(rotation[row], pose[:3, :3], atol=1e-14)


def test_every_form_of_a_device_is_the_same_device(device, tmp_path):
    q = np.random.default_rng(4).uniform(-1, 1, size=(5, 2))
    read = haptical.Device(device)
    text = read.to_toml()
    path = tmp_path / "device.toml"
    path.write_text(text, encoding="utf-8")
    assert (read.name, read.joints, read.columns) == ("planar", 2, ["theta1_rad", "theta2_rad"])
    expected = haptical.forward_kinematics(device, q)
    for form in [read, text, path, str(path), pickle.loads(pickle.dumps(read))]:
        for ours, theirs in zip(haptical.forward_kinematics(form, q), expected):
            np.testing.assert_array_equal(ours, theirs)


def test_numpy_s_numbers_are_numbers_of_a_device(device):
    device["link"][2]["a_m"] = np.float64(0.2)
    device["link"][1]["a_m"] = np.array(0.3)
    position, _ = haptical.forward_kinematics(device, [0, 0])
    np.testing.assert_allclose(position, [[0.5, 0, 0]])


def test_a_urdf_is_read_with_its_tip():
    path = ROOT / "fixtures/urdf"
    if not list(path.glob("*.urdf")):
        pytest.skip("no URDF among the fixtures")
    for urdf in path.glob("*.urdf"):
        read = haptical.Device(urdf)
        position, _ = haptical.forward_kinematics(read, np.zeros((1, read.joints)))
        assert np.isfinite(position).all()
        with pytest.raises(ValueError, match="no_such_link"):
            haptical.Device(urdf, tip="no_such_link")


def test_a_chain_runs_between_any_two_links():
    urdf = ROOT / "fixtures/urdf/arm.urdf"
    if not urdf.exists():
        pytest.skip("no URDF among the fixtures")
    there, back = haptical.Device(urdf, base="shoulder", tip="tool"), haptical.Device(urdf, base="tool", tip="shoulder")
    readings = np.array([0.3, -0.4, 0.1, 0.5, -0.6])
    position, rotation = haptical.forward_kinematics(there, readings)
    inverse, turned_back = haptical.forward_kinematics(back, readings[::-1])
    np.testing.assert_allclose(turned_back[0], rotation[0].T, atol=1e-12)
    np.testing.assert_allclose(inverse[0], -rotation[0].T @ position[0], atol=1e-12)
    again, _ = haptical.forward_kinematics(urdf, readings, base="shoulder", tip="tool")
    np.testing.assert_array_equal(again, position)
    with pytest.raises(ValueError, match="needs --tip too; name the tip"):
        haptical.Device(urdf, base="tool")
    with pytest.raises(ValueError, match="base names a link of a URDF; give it where"):
        haptical.forward_kinematics(there, readings, base="tool", tip="shoulder")


def test_what_is_no_posture_or_device_is_refused(device):
    with pytest.raises(ValueError, match="3 columns, and the device has 2 joints"):
        haptical.forward_kinematics(device, np.zeros((1, 3)))
    with pytest.raises(ValueError, match="row 1: the reading of joint 2 is NaN"):
        haptical.forward_kinematics(device, [[0, 0], [0, np.nan]])
    with pytest.raises(ValueError, match="3 dimensions"):
        haptical.forward_kinematics(device, np.zeros((1, 1, 2)))
    with pytest.raises(ValueError, match="type int; give a path"):
        haptical.forward_kinematics(7, [[0, 0]])
    with pytest.raises(FileNotFoundError, match="no_such.toml"):
        haptical.Device("no_such.toml")
    with pytest.raises(ValueError, match="tip names a link of a URDF"):
        haptical.Device(device, tip="hand")
    with pytest.raises(ValueError, match="base names a link of a URDF"):
        haptical.Device(device, base="hand", tip="hand")
    with pytest.raises(ValueError, match="`a_m` is of the type object"):
        haptical.Device(planar(a_m=object()))
    with pytest.raises(ValueError, match="a_m"):
        haptical.Device(planar(a_m="long"))
    deep: dict = {}
    deep["again"] = deep
    with pytest.raises(ValueError, match="levels deep"):
        haptical.Device(deep)
    assert haptical.forward_kinematics(device, np.zeros((0, 2)))[0].shape == (0, 3)
