"""Logs of touched points: postures at which the handle of an arm is at a point, by damped Gauss-Newton steps."""
import numpy as np

import arms

POINTS, TOUCHES, TOUCH_SD = 4, 30, 1e-4


def place(arm, readings):
    """Handle (n, 3) and its derivatives by the joints (n, 3, joints), of an arm without drums in the standard convention."""
    n = len(readings)
    frame = np.tile(np.eye(4), (n, 1, 1))
    axes, origins = [], []
    for i, row in enumerate(arm.rows):
        angle = np.full(n, row["theta"])
        if i:
            axes.append(frame[:, :3, 2].copy())
            origins.append(frame[:, :3, 3].copy())
            angle = angle + arm.joints[i - 1]["home"] + readings[:, i - 1]
        c, s, ca, sa = np.cos(angle), np.sin(angle), np.cos(row["alpha"]), np.sin(row["alpha"])
        own = np.zeros((n, 4, 4))
        own[:, 0] = np.stack([c, -s * ca, s * sa, row["a"] * c], 1)
        own[:, 1] = np.stack([s, c * ca, -c * sa, row["a"] * s], 1)
        own[:, 2, 1], own[:, 2, 2], own[:, 2, 3], own[:, 3, 3] = sa, ca, row["d"], 1
        frame = frame @ own
    handle = frame[:, :3, 3]
    return handle, np.stack([np.cross(axis, handle - origin) for axis, origin in zip(axes, origins)], 2)


def moved_to(arm, readings, target, steps, damping):
    for _ in range(steps):
        handle, slope = place(arm, readings)
        square = slope @ slope.transpose(0, 2, 1) + damping * np.eye(3)
        readings = readings + np.einsum("nij,nj->ni", slope.transpose(0, 2, 1), np.linalg.solve(square, (target - handle)[:, :, None])[:, :, 0])
    return readings, np.linalg.norm(target - place(arm, readings)[0], axis=1)


def postures_at(arm, point, rng):
    """Postures within the limits; none where the point is out of reach."""
    half = np.array([joint["half"] for joint in arm.joints])
    found = []
    for _ in range(20):
        readings, miss = moved_to(arm, rng.uniform(-.8, .8, (120, len(half))) * half, point, 25, 1e-5)
        found.extend(readings[(miss < 1e-8) & (np.abs(readings) < half).all(1)])
        if len(found) >= TOUCHES:
            return np.array(found[:TOUCHES])
    return None


def touched(rng, pair_sd):
    """A log of touches of unknown points, of which two are at a distance that is known to `pair_sd`; none for no known distance."""
    arm = arms.plain(arms.paper())
    true = arms.deviating(arm, rng)
    true.rows[0] = dict(arm.rows[0])
    middle = place(true, np.zeros((1, 7)))[0][0]
    points, rows, names = [], [], []
    while len(points) < POINTS:
        point = middle + rng.uniform(-.12, .12, 3)
        readings = postures_at(true, point, rng)
        if readings is not None:
            readings, _ = moved_to(true, readings, point + TOUCH_SD * rng.standard_normal((TOUCHES, 3)), 4, 1e-9)
            names += [f"p{len(points)}"] * TOUCHES
            points.append(point)
            rows.append(readings)
    readings = np.concatenate(rows)
    columns = {"t_s": np.arange(len(readings)) * 1.0, **{f"theta{j + 1}_rad": readings[:, j] for j in range(7)}, "contact": names}
    device = arms.device_text(arm, encoders=False) + f"\n[contact]\nsd_m = {TOUCH_SD}\n"
    if pair_sd is not None:
        distance = np.linalg.norm(points[0] - points[1]) + pair_sd * rng.standard_normal()
        device += f'\n[[contact_pair]]\na = "p0"\nb = "p1"\ndistance_m = {distance}\nsd_m = {pair_sd}\n'
    return device, columns, (), true
