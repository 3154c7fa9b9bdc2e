"""Logs of the planar device that show one thing each, and what the device file says of it."""

import numpy as np
from conftest import planar_position, recording


def yielding(compliances, rows=400):
    """A log of joints that yield to known torques behind their readings."""
    log = recording(0.3, 0.2, rows=rows)
    read = np.stack([log["theta1_rad"], log["theta2_rad"]], axis=1)
    torque = np.stack([5 * np.cos(0.31 * np.arange(rows)), 3 * np.sin(0.23 * np.arange(rows))], axis=1)
    position = planar_position(read - torque * compliances)
    position += 1e-4 * np.random.default_rng(8).normal(size=position.shape)
    torques = {"torque1_nm": torque[:, 0], "torque2_nm": torque[:, 1]}
    return log | torques | dict(zip(["x_m", "y_m", "z_m"], position.T))


def wild():
    """A log with three readings that noise does not explain."""
    log = recording(0.3012, 0.1991)
    log["x_m"][[20, 150, 333]] += [0.05, -0.04, 0.06]
    return log


def touching(rows=200):
    """A log of postures of which some touch a wall at x = 0.35 m, and some a socket."""
    log = recording(0.3, 0.2, rows=rows)
    q1 = np.linspace(-0.6, 0.2, rows // 4)
    q12 = np.arccos((0.35 - 0.3 * np.cos(q1)) / 0.2)
    wall = np.stack([q1, q12 - q1], axis=1)
    log["theta1_rad"][: rows // 4], log["theta2_rad"][: rows // 4] = wall.T
    log["theta1_rad"][rows // 4 : rows // 2], log["theta2_rad"][rows // 4 : rows // 2] = 0.4, 0.9
    q = np.stack([log["theta1_rad"], log["theta2_rad"]], axis=1)
    position = planar_position(q) + 1e-4 * np.random.default_rng(5).normal(size=(rows, 3))
    plane = np.array(["wall"] * (rows // 4) + [""] * (rows - rows // 4))
    contact = np.array([""] * (rows // 4) + ["socket"] * (rows // 4) + [""] * (rows - rows // 2))
    return log | dict(zip(["x_m", "y_m", "z_m"], position.T)) | {"plane": plane, "contact": contact}


SOMEWHERE = {"tracker": {"base": "unknown", "tool": "known", "position_sd_m": 1e-4}}
TOUCHES = {"plane": {"sd_m": 1e-4}, "contact": {"sd_m": 1e-4}}
