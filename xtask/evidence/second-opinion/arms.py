"""Arms, motions, noises and logs for judging intervals from outside: products of four-by-four matrices, the law of a
capstan by complex numbers, the files written by hand. Nothing of it comes from the crates."""
import numpy as np

# Plausible sizes, docs/assumptions.md: lengths in m, angles in rad, a ratio in shares of itself, eccentricities in m.
LENGTH, ANGLE, RATIO, OUTPUT, INPUT = 5e-3, 0.02, 0.05, 1e-3, 1e-4


class Arm:
    """Rows (a, alpha, d, theta, beta), joints (home, half range, ratio, drum distance or 0); row 0 is the base's."""

    def __init__(self, name, rows, joints, is_modified=False):
        self.name, self.is_modified = name, is_modified
        self.rows = [dict(zip(("a", "alpha", "d", "theta", "beta"), list(map(float, row)) + [0.0] * (5 - len(row)))) for row in rows]
        self.joints = [dict(zip(("home", "half", "ratio", "drum"), joint)) for joint in joints]
        # offset, ratio deviation, output drum x, y, input drum x, y
        self.drums = [np.zeros(6) for _ in joints]

    def copy(self):
        other = Arm(self.name, [], [], self.is_modified)
        other.rows = [dict(row) for row in self.rows]
        other.joints = [dict(joint) for joint in self.joints]
        other.drums = [own.copy() for own in self.drums]
        return other


def paper():
    """The seven-joint device of the paper, its joint 4 without the parallelogram."""
    q = np.pi / 2
    rows = [(.25, -q, 0, 0), (0, -q, .35, 0), (0, q, 0, 0), (0, -q, .18, 0), (0, q, 0, 0), (0, -q, .28, 0), (0, q, 0, 0), (.02, 0, .02, 0)]
    degrees = [(-150, 90), (90, 90), (0, 75), (90, 45), (0, 90), (-90, 75), (-30, 120)]
    drums = [(8, .0675), (8, .0675), (8, .0675), (12, .0975), (1, 0), (1, 0), (1, 0)]
    return Arm("paper", rows, [(np.radians(h), np.radians(r), *drum) for (h, r), drum in zip(degrees, drums)])


def parallel():
    """An arm like the UR10: joints 2, 3 and 4 are parallel."""
    q, p = np.pi / 2, np.pi
    rows = [(0, 0, 0, 0), (0, 0, .1273, 0), (0, q, 0, p), (.612, 0, 0, 0), (.5723, 0, .163941, 0), (0, -q, .1157, 0), (.07, q, .0922, p)]
    return Arm("parallel", rows, [(0, 2.0, 1, 0)] * 6, True)


def turned(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    m = np.zeros((len(angle), 4, 4))
    m[:, axis, axis] = m[:, 3, 3] = 1
    i, j = (axis + 1) % 3, (axis + 2) % 3
    m[:, i, i] = m[:, j, j] = c
    m[:, j, i], m[:, i, j] = s, -s
    return m


def moved(axis, length, count):
    m = np.tile(np.eye(4), (count, 1, 1))
    m[:, axis, 3] = length
    return m


def drum_error(arm, j, reading):
    """What the output turns beyond the reading: the ratio's error and how far the line of the drums' centres turns."""
    joint, (offset, deviation, xo, yo, xi, yi) = arm.joints[j], arm.drums[j]
    error = offset - deviation / (joint["ratio"] + deviation) * reading
    for x, y, turns in ((xo, yo, 1.0), (xi, yi, joint["ratio"])):
        if joint["drum"]:
            centre = lambda angle: (x + 1j * y) * np.exp(1j * angle)
            seen = lambda angle: np.angle(1 / (joint["drum"] - centre(angle).real - 1j * centre(angle).imag))
            error = error + seen(turns * reading) - seen(0.0)
    return error


def poses(arm, readings):
    """Poses (n, 4, 4) of the last frame in that of row 0."""
    n = len(readings)
    whole = np.tile(np.eye(4), (n, 1, 1))
    for i, row in enumerate(arm.rows):
        angle = np.full(n, row["theta"])
        if i:
            own = readings[:, i - 1]
            angle = angle + arm.joints[i - 1]["home"] + own + drum_error(arm, i - 1, own)
        rz, tz = turned(2, angle), moved(2, row["d"], n)
        tx, rx, ry = moved(0, row["a"], n), turned(0, np.full(n, row["alpha"])), turned(1, np.full(n, row["beta"]))
        own = [tx, rx, ry, rz, tz] if arm.is_modified else [rz, tx, tz, rx, ry]
        for m in own:
            whole = whole @ m
    return whole


def deviating(arm, rng, length=LENGTH, angle=ANGLE):
    """A true arm: normal deviations of the plausible sizes in every number of a link and every drum."""
    true = arm.copy()
    for row in true.rows:
        row["a"] += length * rng.standard_normal()
        row["d"] += length * rng.standard_normal()
        row["alpha"] += angle * rng.standard_normal()
        row["theta"] += angle * rng.standard_normal()
    for joint, own in zip(true.joints, true.drums):
        if joint["drum"]:
            own[:] = rng.standard_normal(6) * [angle, RATIO * joint["ratio"], OUTPUT, OUTPUT, INPUT, INPUT]
    return true


def random_motion(arm, n, rng):
    half = np.array([joint["half"] for joint in arm.joints])
    return np.clip(rng.standard_normal((n, len(half))) / 3, -1, 1) * half


def plain(arm):
    """The arm without drums."""
    other = arm.copy()
    for joint in other.joints:
        joint["drum"], joint["ratio"] = 0, 1
    return other


def smooth_motion(arm, n, rng):
    """Each joint: two to five cosines of half a period to four periods over the log."""
    t = np.arange(n) / n
    readings = np.empty((n, len(arm.joints)))
    for j, joint in enumerate(arm.joints):
        waves = [(rng.uniform(.3, 1), rng.uniform(.5, 4), rng.uniform(0, 6.28)) for _ in range(rng.integers(2, 6))]
        path = sum(size * np.cos(2 * np.pi * periods * t + phase) for size, periods, phase in waves)
        readings[:, j] = .95 * joint["half"] * path / np.abs(path).max()
    return readings


class Noise:
    """Errors in stated standard deviations: memory, a drift over the log, a size that depends on a joint's angle."""

    def __init__(self, memory=0.0, drift=0.0, uneven=1.0, name=None):
        self.memory, self.drift, self.uneven = memory, drift, uneven
        self.name = name or "white"

    def __call__(self, readings, rng, joint=None):
        n = len(readings)
        e = rng.standard_normal(n + 200)
        for k in range(1, n + 200):
            e[k] = self.memory * e[k - 1] + np.sqrt(1 - self.memory ** 2) * e[k]
        e = e[200:]
        size = np.ones(n)
        if self.uneven > 1:
            x = readings[:, rng.integers(readings.shape[1]) if joint is None else joint] * rng.choice([-1, 1])
            edge = np.quantile(x, rng.uniform(.4, .75))
            size = np.where(x > edge, self.uneven, 1.0)
        drift = self.drift * np.sqrt(np.mean(size ** 2)) * rng.choice([-1, 1])
        return e * size + drift * (np.arange(n) / (n - 1) - .5)


def device_text(arm, sensors="", encoders=True, links=True):
    """The device file."""
    out = [f'[device]\nname = "{arm.name}"\ndof = {len(arm.joints)}']
    if arm.is_modified:
        out.append('convention = "modified"')
    for row in arm.rows if links else []:
        out.append("\n[[link]]\n" + "\n".join(
            f"{key} = {float(row[name])!r}" for key, name in
            (("a_m", "a"), ("alpha_rad", "alpha"), ("d_m", "d"), ("theta_offset_rad", "theta"), ("beta_rad", "beta"))))
    for joint in arm.joints:
        kind = "capstan" if joint["drum"] else "direct"
        text = (f'\n[[joint]]\nhome_rad = {float(joint["home"])!r}\nlower_rad = {-float(joint["half"])!r}\n'
                f'upper_rad = {float(joint["half"])!r}\ntransmission = "{kind}"\ntransmission_ratio = {float(joint["ratio"])!r}')
        if joint["drum"]:
            text += f'\ndrum_distance_m = {joint["drum"]!r}'
            if encoders:
                text += f"\nexternal_encoder_sd_rad = {OUT_SD!r}"
        out.append(text)
    return "\n".join(out) + "\n" + sensors


OUT_SD, CABLE_SD, TRACKER_SD, ROTATION_SD = 1e-4, 1e-5, 5e-5, 1e-4
CABLE = f"\n[cable_encoder]\ndrum_radius_m = 0.015\ncounts_per_rev = 20000\ndistance_sd_m = {CABLE_SD!r}\n"


def tracker(base="known", tool="known", extra=""):
    return (f'\n[tracker]\nbase = "{base}"\ntool = "{tool}"\nposition_sd_m = {TRACKER_SD!r}\n'
            f"rotation_sd_rad = {ROTATION_SD!r}\n{extra}")


def quaternion(rotation):
    """w, x, y, z of rotations (n, 3, 3), by the eigenvector of Bar-Itzhack's matrix."""
    out = np.empty((len(rotation), 4))
    for k, r in enumerate(rotation):
        m = np.array([[r[0, 0] - r[1, 1] - r[2, 2], 0, 0, 0], [r[0, 1] + r[1, 0], r[1, 1] - r[0, 0] - r[2, 2], 0, 0],
                      [r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], r[2, 2] - r[0, 0] - r[1, 1], 0],
                      [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], r[0, 0] + r[1, 1] + r[2, 2]]]) / 3
        x, y, z, w = np.linalg.eigh(m)[1][:, -1]
        out[k] = np.array([w, x, y, z]) * (1 if w >= 0 else -1)
    return out


def log_of(arm, readings, rng, noise=Noise(), sensors=("out", "cable"), times=True):
    """Columns of a log, by name."""
    columns = {}
    n = len(readings)
    if times:
        columns["t_s"] = np.arange(n) * (100.0 / n)
    for j in range(readings.shape[1]):
        columns[f"theta{j + 1}_rad"] = readings[:, j]
    if "out" in sensors:
        for j, joint in enumerate(arm.joints):
            if joint["drum"]:
                columns[f"out{j + 1}_rad"] = readings[:, j] + drum_error(arm, j, readings[:, j]) + OUT_SD * noise(readings, rng, j)
    pose = poses(arm, readings)
    if "cable" in sensors:
        columns["cable_m"] = np.linalg.norm(pose[:, :3, 3], axis=1) + CABLE_SD * noise(readings, rng)
    if "position" in sensors or "pose" in sensors:
        for axis, name in enumerate("xyz"):
            columns[f"{name}_m"] = pose[:, axis, 3] + TRACKER_SD * noise(readings, rng)
    if "pose" in sensors:
        w = ROTATION_SD * np.stack([noise(readings, rng) for _ in range(3)], 1)
        small = turned(2, w[:, 2]) @ turned(1, w[:, 1]) @ turned(0, w[:, 0])
        columns.update(zip(("qw", "qx", "qy", "qz"), quaternion((pose @ small)[:, :3, :3]).T))
    return columns


def write_log(path, columns):
    """Numbers with 12 digits, text as it is."""
    names = list(columns)
    cells = [[value if isinstance(value, str) else ("" if value != value else f"{value:.12g}") for value in columns[name]] for name in names]
    with open(path, "w") as file:
        file.write(",".join(names) + "\n")
        file.writelines(",".join(row) + "\n" for row in zip(*cells))


def truth_of(arm, name):
    """True value of a parameter by the name that `identify` gives it; none of those that have no one truth."""
    for short, key in (("alpha", "alpha"), ("theta", "theta"), ("beta", "beta"), ("a", "a"), ("d", "d")):
        if name.startswith(short) and name[len(short):].isdigit():
            return arm.rows[int(name[len(short):])][key]
    for k, short in enumerate(("offset", "ratio_deviation", "output_drum_x", "output_drum_y", "input_drum_x", "input_drum_y")):
        if name.startswith(short) and name[len(short):].isdigit():
            return arm.drums[int(name[len(short):]) - 1][k]
    return None
