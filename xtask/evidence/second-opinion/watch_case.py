"""One stream through the watch of watch.py, for the tests of haptical-monitor (docs/equations.md, A calibration that is watched):

    python3 watch_case.py > ../../../fixtures/watch/python.json

needs numpy and scipy (versions in README.md). The stream is made of integers, so that any language has the same numbers."""
import json

import numpy as np
from scipy import special

from watch import RATES, features, reference

ROWS, CHANGE, SHIFT = 30000, 24000, 0.02
PRIOR = 100.0
SCATTERS = [1, 4, 16, 64, 256]


def stream():
    """x = 0.75 x + u, u uniform from a 64-bit congruential generator (Knuth's constants)."""
    seed, x, rows = 1, 0.0, []
    for _ in range(ROWS):
        seed = (seed * 6364136223846793005 + 1442695040888963407) % 2**64
        x = 0.75 * x + ((seed >> 11) / 2**53 - 0.5)
        rows.append(x)
    return np.array(rows)


def integrated(part, shape, scatter):
    """Of each column the logarithm of the integral over the shift b of N(b; 0, PRIOR) prod N(z; b s, scatter) / N(z; 0, 1), by the
    trapezoidal rule; nearly all of it is within twelve standard deviations of its largest value."""
    precision = shape @ shape / scatter + 1 / PRIOR
    centre = (shape @ part) / scatter / precision
    logs = []
    for column, middle in zip(part.T, centre):
        b = middle + np.linspace(-12, 12, 241) / np.sqrt(precision)
        left = column[:, None] - np.outer(shape, b)
        given = -0.5 * (left**2).sum(0) / scatter - 0.5 * len(column) * np.log(scatter) + 0.5 * (column**2).sum()
        given += -0.5 * b**2 / PRIOR - 0.5 * np.log(2 * np.pi * PRIOR)
        logs.append(special.logsumexp(given) + np.log(b[1] - b[0]))
    return np.array(logs)


def since(z):
    """Probability of every first block: the evidence of each shape, shifts integrated numerically."""
    count = len(z)
    logs = np.zeros((count, 2))
    for first in range(count):
        part = z[first:]
        length = len(part)
        def evidence(shape):
            each = [integrated(part, shape, scatter) for scatter in SCATTERS]
            return float((special.logsumexp(each, axis=0) - np.log(len(SCATTERS))).sum())
        # a step begins within its first block
        steps = [evidence(np.r_[begun, np.ones(length - 1)]) for begun in [0.25, 0.5, 0.75, 1]]
        logs[first] = special.logsumexp(steps) - np.log(4), evidence(np.arange(1, length + 1) / length)
    weights = np.exp(logs - special.logsumexp(logs))
    by_block = weights.sum(1).cumsum()
    return [int(np.argmax(by_block >= share)) for share in [0.025, 0.5, 0.975]], float(weights[:, 0].sum())


def main():
    noise = stream()
    noise[CHANGE:] += SHIFT * 20
    centre, scale, length, own, end = reference(noise, 2000)
    scaled = np.clip((noise[end:] - centre) / scale, -8, 8)
    z = np.stack([(values - one[0]) / one[1] for values, one in zip(features(scaled, length), own)], axis=1)
    sides = np.stack([(z[:, 0] - own[0][3]) / own[0][4], (-z[:, 0] - own[0][3]) / own[0][4], (z[:, 1] - own[1][3]) / own[1][4]])
    weights = np.array([0.25, 0.25, 0.5]) / len(RATES)
    sums, evidence = np.zeros((3, len(RATES))), []
    for block in sides.T:
        sums = (1 + sums) * np.exp(np.minimum(np.outer(block, RATES) - RATES**2 / 2, 300))
        evidence.append(float(weights @ sums.sum(1)))
    blocks = 40 + (CHANGE - end) // length
    first, steps = since(z[:blocks])
    print(json.dumps({
        "rows": ROWS, "change_row": CHANGE, "shift": SHIFT * 20, "reference_rows": 2000, "reference_ends": end,
        "centre": centre, "scale": scale, "block_rows": length,
        "features": [dict(zip(["mean", "sd", "long", "margin", "widened"], map(float, one))) for one in own],
        "evidence_until_change": evidence[: (CHANGE - end) // length],
        "judged_blocks": blocks, "since": first, "step_probability": steps,
    }, indent=1))


main()
