"""Intervals where the noise has memory, drifts or is uneven: docs/equations.md, Noise with memory, written a second time.

`python3 noise_memory.py > ../../../fixtures/correlated/python.json` writes the cases that the tests of
haptical-identification compare with; needs numpy and scipy (versions in README.md)."""
import json
import zlib

import numpy as np
from scipy.fft import dct
from scipy.optimize import nnls
from scipy.stats import chi2, f as fdist, t as student

import problems

FIRST, RATIO, LEAST = 4, 1.8, 0.5
ALPHA, DRIFT_ALPHA, GAIN, FLOOR = 0.1, 0.25, 1.0, 0.1
FINE = 8  # rows of a fine bin


def ls(X, y):
    Q, R = np.linalg.qr(X)
    return Q, R, Q.T @ y


def fine_bins(x):
    """Quantile bins of an angle: 4 to 64 of at least FINE rows."""
    n = len(x)
    k = int(np.clip(n // FINE, 4, 64))
    return np.argsort(np.argsort(x, kind="stable"), kind="stable") * k // n, k


def partition(num, den, penalty, least):
    """Segments of adjacent bins with a variance each: least sum of den log(num/den) + penalty per segment, by
    dynamic programming over the ends (Jackson et al. 2005). Segments hold at least `least` (in den)."""
    k = len(num)
    a, b = np.r_[0, np.cumsum(num)], np.r_[0, np.cumsum(den)]
    best, back = np.full(k + 1, np.inf), np.zeros(k + 1, int)
    best[0] = 0
    for e in range(1, k + 1):
        d = b[e] - b[:e]
        with np.errstate(all="ignore"):
            cost = best[:e] + d * np.log((a[e] - a[:e]) / d) + penalty
        cost[d < least] = np.inf
        back[e] = int(np.argmin(cost))
        best[e] = cost[back[e]]
    if not np.isfinite(best[k]):
        return np.array([0, k]), 0.0
    cut = [k]
    while cut[-1]:
        cut.append(back[cut[-1]])
    one = b[k] * np.log(a[k] / b[k]) + penalty
    return np.array(cut[::-1]), one - best[k]


def residual_pieces(X, y, s):
    """Scaled residuals' innovations (memory from the signs, so free of scale) and 1 - leverage."""
    C, n, p = X.shape
    Q, R, b = ls((X / s[:, None]).reshape(-1, p), (y / s).ravel())
    z = y / s - (Q @ b).reshape(C, n)
    sg = np.sign(z)
    rho = np.sin(np.pi / 2 * np.clip((sg[:, 1:] * sg[:, :-1]).mean(), 0, .99))
    u = z.copy()
    u[:, 1:] = (z[:, 1:] - rho * z[:, :-1]) / np.sqrt(1 - rho ** 2)
    return u, np.maximum(1 - (Q ** 2).sum(1).reshape(C, n), .05)


def scale_fit(X, y, q, j, base, rounds=5):
    """Noise sd as a step function of joint j's angle, by weighted fits in turns: base times one size per segment."""
    C, n, p = X.shape
    bin_, k = fine_bins(q[:, j])
    f = np.ones(k)
    for _ in range(rounds):
        u, room = residual_pieces(X, y, base * f[bin_])
        num = np.bincount(bin_, ((u * f[bin_]) ** 2).sum(0), k)
        den = np.bincount(bin_, room.sum(0), k)
        cut, _gain = partition(num, den, 3 * np.log(n), 8)
        for a, b in zip(cut[:-1], cut[1:]):
            f[a:b] = np.sqrt(num[a:b].sum() / den[a:b].sum())
    s = base * f[bin_]
    info = np.array([(1 / f[bin_][(bin_ >= a) & (bin_ < b)] ** 2).sum() for a, b in zip(cut[:-1], cut[1:])])
    info /= info.sum()
    dof = np.array([den[a:b].sum() for a, b in zip(cut[:-1], cut[1:])])
    meier = 4 * (info * (1 - info) / dof).sum()  # Meier 1953: weights that were estimated
    return s / np.exp(np.log(s).mean()), len(cut) - 1, meier


def screen(X, y, q, s):
    u, room = residual_pieces(X, y, s)
    gain = []
    for j in range(q.shape[1]):
        bin_, k = fine_bins(q[:, j])
        gain.append(partition(np.bincount(bin_, (u ** 2).sum(0), k), np.bincount(bin_, room.sum(0), k),
                              3 * np.log(q.shape[0]), 8)[1])
    return gain


def edges(n):
    e = [0, FIRST]
    while e[-1] < n:
        e.append(min(n, int(e[-1] * RATIO) + 1))
    return e


def parts(X, y):
    C, n, p = X.shape
    size = np.linalg.norm(X.reshape(-1, p), axis=0)
    Q, R = np.linalg.qr((X / size).reshape(-1, p))
    b = Q.T @ y.ravel()
    r = y - (Q @ b).reshape(C, n)
    return Q.reshape(C, n, p), np.linalg.inv(R) / size[:, None], b, r


def unmix(ss, d, count, G, tr, channels):
    """Red spectrum per band from residual powers. The fit mixes bands: E ss_b = sum_k A_bk S_k with A = |P_b (I - H) P_k|^2
    (Frobenius), whose rows add up to d_b. Non-negative steps from high to low modes, weighted least squares; a level's
    degrees of freedom are the parts of its bands that are their own, A_bb."""
    A = G @ G.T
    A[np.diag_indices(len(A))] += count - 2 * tr
    up = np.kron(np.eye(channels), np.triu(np.ones((len(A) // channels,) * 2)))  # S = up u, per channel
    fit = ss / d
    for _ in range(3):
        wt = np.sqrt(d) / (d * np.maximum(fit, 1e-3 * fit.max()))
        u = nnls((A @ up) * wt[:, None], ss * wt)[0]
        S = up @ u
        fit = A @ S / d
    last = np.arange(1, len(u)) % (len(u) // channels) == 0
    level = np.cumsum(np.r_[0, (u[:-1] > 1e-9 * S.max()) | last])
    own = np.bincount(level, np.diag(A))
    return S, own[level], level


def bands(Q, r, Ri):
    """Variance of every parameter, its degrees of freedom, and the statistic of equal power in all bands."""
    C, n, p = Q.shape
    V, W, stat, dof = 0, 0, 0.0, 0
    Z, z = dct(Q, axis=1, norm="ortho"), dct(r, axis=1, norm="ortho")
    e = edges(n)
    ss, d = np.zeros((C, len(e) - 1)), np.zeros((C, len(e) - 1))
    G = []
    for c in range(C):
        ss[c] = np.add.reduceat(z[c] ** 2, e[:-1])
        d[c] = np.maximum(np.diff(e) - np.add.reduceat((Z[c] ** 2).sum(1), e[:-1]), FLOOR)
        own = d[c] > 1
        power = ss[c, own].sum() / d[c, own].sum()
        stat += (d[c, own] * (np.log(power) - np.log(ss[c, own] / d[c, own]))).sum()
        dof += own.sum() - 1
        G += [Z[c, a:b].T @ Z[c, a:b] for a, b in zip(e[:-1], e[1:])]
    S, D, level = unmix(ss.ravel(), d.ravel(), np.tile(np.diff(e), C), np.array([g.ravel() for g in G]),
                        np.array([np.trace(g) for g in G]), C)
    x = S[:, None] * np.array([((Ri @ g) * Ri).sum(1) for g in G])
    for l in range(level[-1] + 1):
        xl = x[level == l].sum(0)
        V, W = V + xl, W + 2 * xl ** 2 / max(D[level == l][0], LEAST)
    return V, 2 * V ** 2 / W, stat > chi2.ppf(1 - ALPHA, dof)


def hc2(Q, r, Ri):
    Qf = Q.reshape(-1, Q.shape[2])
    g = Qf * (r.ravel() / np.sqrt(np.maximum(1 - (Qf ** 2).sum(1), .05)))[:, None]
    return ((Ri @ g.T) ** 2).sum(1)


def weights(X, y, q):
    """Local noise sizes: at most two joints, the best first, a step function of each one's angle (estimators.py)."""
    C, n, p = X.shape
    s, used, meier = np.ones(n), [], 0.0
    for _ in range(2):
        gain = np.array(screen(X, y, q, s))
        gain[used] = 0
        j = int(np.argmax(gain))
        if gain[j] <= GAIN * np.log(n):
            break
        s2, segments, m = scale_fit(X, y, q, j, s)
        if segments < 2:
            break
        s, meier = s2, meier + m
        used.append(j)
    return s, used, meier


def intervals(X, y, q):
    C, n, p = X.shape
    nu0 = C * n - p
    Q0, Ri0, b0, r0 = parts(X, y)
    cl0 = student.ppf(.975, nu0) * np.sqrt((r0 ** 2).sum() / nu0 * (Ri0 ** 2).sum(1))
    h = {"classic": (Ri0 @ b0, cl0)}
    s, used, meier = weights(Q0, y, q)
    Xs, ys = X / s[:, None], y / s
    Q, Ri, b, r = parts(Xs, ys)
    Vb, nub, memory = bands(Q, r, Ri)
    line = np.zeros((C, n, C))
    line[range(C), :, range(C)] = ((np.arange(n) + .5) / n - .5) / s
    L = line.reshape(C * n, C) - Q.reshape(C * n, -1) @ (Q.reshape(C * n, -1).T @ line.reshape(C * n, C))
    L = np.linalg.qr(L)[0]  # F test of a line per channel
    gain = ((L.T @ r.ravel()) ** 2).sum()
    F = gain / C / (((r ** 2).sum() - gain) / (nu0 - C))
    drift = memory or F > fdist.ppf(1 - DRIFT_ALPHA, C, nu0 - C)
    if drift:  # a line per channel joins the fit
        Q, Ri, b, r = parts(np.concatenate([Xs, line], 2), ys)
        Vb, nub, memory = bands(Q, r, Ri)
    est, nu = (Ri @ b)[:p], C * n - Q.shape[2]
    cl = (r ** 2).sum() / nu * (Ri ** 2).sum(1)
    Vh = hc2(Q, r, Ri)
    tb, t0 = student.ppf(.975, nub), student.ppf(.975, nu)
    uneq = np.abs(np.log(Vh / cl)).mean() > .25
    half = t0 * np.sqrt(cl)
    if used or uneq:
        half = np.maximum(half, t0 * np.sqrt(Vh))
    if memory:
        half = np.maximum(tb * np.sqrt(Vb), half if used or uneq else 0)
    h["W-bands"] = est, half[:p] * np.sqrt(1 + meier)
    return h, dict(memory=memory, used=len(used), drift=drift, nu=nub[:p] if memory else None)


CASES = [("encoder", 120, "white"), ("encoder", 120, "ar.95"), ("encoder", 150, "het12"), ("encoder", 150, "het12+ar.8"),
         ("encoder", 120, "drift3"), ("tracker", 100, "ar.8")]


def case(kind, rows, condition, device):
    rng = np.random.default_rng([7, zlib.crc32(f"{kind}slow{rows}{condition}".encode()), device])
    X, q, _names = problems.problem(kind, "slow", rows, rng)
    if kind == "tracker":
        X = X[:, :, :5]
    y = problems.noise(problems.CONDITIONS[condition], len(X), q, 0 if kind == "encoder" else None, rng)
    b = np.linalg.lstsq(X.reshape(-1, X.shape[2]), y.ravel(), rcond=None)[0]
    short = lambda values: [float(f"{v:.9g}") for v in values]
    made = dict(name=f"{kind} slow {rows} {condition} {device}",
                derivatives=[[short(c[:, k]) for k in range(X.shape[2])] for c in X],
                residuals=[short(r) for r in X @ b - y], covariates=[short(q[:, j]) for j in range(2)])
    h, info = intervals(np.array(made["derivatives"]).transpose(0, 2, 1), -np.array(made["residuals"]),
                        np.array(made["covariates"]).T)
    step, half = h["W-bands"]
    return made | dict(step=list(map(float, step)), half=list(map(float, half)), classic=list(map(float, h["classic"][1])),
                       memory=bool(info["memory"]), used=int(info["used"]), drift=bool(info["drift"]))


if __name__ == "__main__":
    cases = [case(*of, 0) for of in CASES] + [case("encoder", 150, "het12+ar.8", 2)]
    print(json.dumps(cases, separators=(",", ":")))
