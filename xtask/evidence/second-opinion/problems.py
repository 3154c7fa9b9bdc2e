"""Simulated calibration problems, linearised at a random device: y = X theta + e with theta = 0.

Own forward kinematics (standard DH, rows 0..7 of haptic7: joint i moves row i). Row order of X and y: for
several components (tracker) X has the shape (components, rows, parameters)."""
import numpy as np

A = np.array([.25, 0, 0, 0, 0, 0, 0, .02])
AL = np.array([-1, -1, 1, -1, 1, -1, 1, 0]) * np.pi / 2
D = np.array([0, .35, 0, .18, 0, .28, 0, .02])
HOME = np.array([-150, 90, 0, 90, 0, -90, -30]) * np.pi / 180
HALF = np.array([90, 90, 75, 45, 90, 75, 120]) * np.pi / 180  # half range from home
RATIO, DRUM, DRUM_IN = 8.0, 0.0675, 0.0675


def postures(n, rng):
    """Random postures: normal about home, sd = half range / 3, cut at 3 sd."""
    z = rng.standard_normal((n, 7))
    while (bad := np.abs(z) > 3).any():
        z[bad] = rng.standard_normal(bad.sum())
    return z * HALF / 3


def smooth(n, rng, high=3.0):
    """Sums of 2-4 sines per joint of 1..3 periods over the log (all but the first: 1..high periods)."""
    t = (np.arange(n) + .5) / n
    q = np.empty((n, 7))
    for j in range(7):
        m = rng.integers(2, 5)
        f = rng.uniform(1, high, m)
        f[0] = rng.uniform(1, 3)
        a = rng.uniform(.4, 1, m)
        s = (a[:, None] * np.sin(2 * np.pi * (f[:, None] * t + rng.uniform(0, 1, m)[:, None]))).sum(0)
        q[:, j] = .9 * HALF[j] * s / a.sum()
    return q


def position_jacobian(q, dev):
    """Position of the tip and its 32 columns (theta, d, a, alpha of rows 0..7) by unit twists."""
    a, al, d, th0 = dev
    n = len(q)
    th = np.zeros((n, 8)) + th0
    th[:, 1:] += q + HOME
    R = np.broadcast_to(np.eye(3), (n, 3, 3)).copy()
    p = np.zeros((n, 3))
    w, o = [], []
    for i in range(8):
        z = R[:, :, 2].copy()
        w += [("turn", z, p.copy()), ("slide", z, None)]
        c, s = np.cos(th[:, i])[:, None], np.sin(th[:, i])[:, None]
        x, y = R[:, :, 0] * c + R[:, :, 1] * s, R[:, :, 1] * c - R[:, :, 0] * s
        p = p + d[i] * z + a[i] * x
        w += [("slide", x, None), ("turn", x, p.copy())]
        ca, sa = np.cos(al[i]), np.sin(al[i])
        R = np.stack([x, y * ca + z * sa, z * ca - y * sa], 2)
    J = np.stack([v if k == "slide" else np.cross(v, p - o) for k, v, o in w], 2)
    return p, J  # (n, 3), (n, 3, 32), order per row: theta, d, a, alpha


NAMES = [f"{k}{i}" for i in range(8) for k in ("theta", "d", "a", "alpha")]
ORDER = ([NAMES.index(f"theta{i}") for i in range(1, 8)] + [NAMES.index(f"a{i}") for i in range(8)]
         + [NAMES.index(f"d{i}") for i in range(1, 8)] + [NAMES.index(f"alpha{i}") for i in range(1, 8)]
         + [NAMES.index(k) for k in ("alpha0", "theta0", "d0")])


def identifiable(X, order, tau=1e-9):
    """Columns in order of preference whose remainder after those kept exceeds tau (twice orthogonalised)."""
    Q, keep = np.zeros((len(X), 0)), []
    norm = np.linalg.norm(X, axis=0)
    for k in order:
        if norm[k] <= 1e-11 * norm.max():
            continue
        v = X[:, k] / norm[k]
        for _ in range(2):
            v = v - Q @ (Q.T @ v)
        if (r := np.linalg.norm(v)) > tau:
            Q = np.column_stack([Q, v / r])
            keep.append(k)
    return keep


def capstan_columns(th, rng):
    """Derivatives of eq. (1) with respect to (c, R_e, x_o, y_o, x_i, y_i) at random small eccentricities."""
    def g(phi, x, y, dd):
        nn, dn = (x * np.sin(phi) + y * np.cos(phi)) / dd, 1 - (x * np.cos(phi) - y * np.sin(phi)) / dd
        N = nn ** 2 + dn ** 2
        return ((dn * np.sin(phi) + nn * np.cos(phi)) / (N * dd), (dn * np.cos(phi) - nn * np.sin(phi)) / (N * dd))
    re, xo, yo, xi, yi = rng.normal(0, [.02, 2e-4, 2e-4, 5e-5, 5e-5])
    cols = [np.ones_like(th), -RATIO * th / (RATIO + re) ** 2]
    for x, y, k, dd in ((xo, yo, 1, DRUM), (xi, yi, RATIO, DRUM_IN)):
        a, b = g(k * th, x, y, dd), g(0 * th, x, y, dd)
        cols += [a[0] - b[0], a[1] - b[1]]
    return np.stack(cols, 1)


def problem(kind, motion, n, rng):
    """(X of shape (components, n, p), joint angles (n, 7), names)."""
    q = {"random": lambda: postures(n, rng), "slow": lambda: smooth(n, rng),
         "mixed": lambda: smooth(n, rng, 12.0)}[motion]()
    if kind == "encoder":
        return capstan_columns(q[:, 0], rng)[None], q, ["c", "R_e", "x_o", "y_o", "x_i", "y_i"]
    dev = (A + rng.normal(0, 1e-3, 8), AL + rng.normal(0, 5e-3, 8), D + rng.normal(0, 1e-3, 8),
           rng.normal(0, 1e-2, 8))
    dev[2][0] = 0
    p, J = position_jacobian(q, dev)
    if kind == "cable":
        J = np.einsum("ni,nik->nk", p / np.linalg.norm(p, axis=1)[:, None], J)[None]
    else:
        J = J.transpose(1, 0, 2)
    keep = identifiable(J.reshape(-1, 32), ORDER)
    return J[:, :, keep], q, [NAMES[k] for k in keep]


def ar1(n, rho, rng):
    e = rng.standard_normal(n)
    e[1:] *= np.sqrt(1 - rho ** 2)
    for i in range(1, n):
        e[i] += rho * e[i - 1]
    return e


def noise(spec, comps, q, own, rng):
    """spec: dict with rho (AR(1) of unit variance), share (of AR in the variance; the rest white), drift (end to
    end, in noise sd, random sign per component), walk (sd of a random walk's end in noise sd, added), het (ratio of the
    noise sd in a third of one joint's range; own: that joint or None for a random one), smoothhet."""
    n = len(q)
    out = np.empty((comps, n))
    s = np.ones(n)
    if h := spec.get("het"):
        j = rng.integers(7) if own is None else own
        x = q[:, j] * rng.choice([-1, 1])
        cut = x.min() + rng.uniform(.5, .7) * (x.max() - x.min())
        width = spec.get("width", 0.02) * (x.max() - x.min())
        s = np.exp(np.log(h) / (1 + np.exp(-np.clip((x - cut) / width, -50, 50))))
    for c in range(comps):
        rho = spec.get("rho", 0)
        e = rng.standard_normal(n)
        if rho:
            w = spec.get("share", 1.0)
            e = np.sqrt(w) * ar1(n, rho, rng) + np.sqrt(1 - w) * e
        e = e * s
        if lvl := spec.get("unscaled"):  # AR(1) of its own size beside noise of local size
            e = e + lvl * np.sqrt((s ** 2).mean()) * ar1(n, spec["unscaled_rho"], rng)
        if hum := spec.get("hum"):  # periods over the log
            e = e + np.sin(2 * np.pi * (hum * np.arange(n) / n + rng.uniform()))
        if spec.get("heavy"):
            e = e * np.sqrt(3 / rng.chisquare(5, n))
        size = np.sqrt((s ** 2).mean()) if spec.get("drift_rms", True) else 1
        if d := spec.get("drift"):
            e = e + size * d * rng.choice([-1, 1]) * ((np.arange(n) + .5) / n - .5)
        if wk := spec.get("walk"):
            e = e + size * wk * np.cumsum(rng.standard_normal(n)) / np.sqrt(n)
        out[c] = e
    return out


CONDITIONS = {
    "white": {}, "ar.5": dict(rho=.5), "ar.8": dict(rho=.8), "ar.95": dict(rho=.95),
    "white+ar.95": dict(rho=.95, share=.5),
    "drift3": dict(drift=3), "drift1": dict(drift=1), "walk3": dict(walk=3),
    "het12": dict(het=12), "het4": dict(het=4), "het12wide": dict(het=12, width=.15),
    "ar.7": dict(rho=.7), "ar.9": dict(rho=.9), "drift2": dict(drift=2),
    "hum40": dict(hum=40), "hum5": dict(hum=5), "t5": dict(heavy=1), "ar-.5": dict(rho=-.5),
    "het12|ar.9": dict(het=12, unscaled=.7, unscaled_rho=.9),
    "drift3+ar.8": dict(drift=3, rho=.8), "het12+ar.8": dict(het=12, rho=.8), "het12+ar.95": dict(het=12, rho=.95),
    "het12+drift3": dict(het=12, drift=3), "all": dict(het=12, rho=.8, drift=3),
}
