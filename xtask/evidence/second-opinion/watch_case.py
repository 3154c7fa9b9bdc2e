"""One stream through the watch of watch.py, for the tests of haptical-monitor (docs/equations.md, A calibration that is watched):

    python3 watch_case.py > ../../../fixtures/watch/python.json

needs numpy and scipy (versions in README.md). The stream is made of integers, so that any language has the same numbers."""
import json

import numpy as np
from scipy import special

from watch import RATES, features, reference

ROWS, CHANGE, SHIFT = 30000, 24000, 0.02
PRIOR = 100.0


def stream():
    """x = 0.75 x + u, u uniform from a 64-bit congruential generator (Knuth's constants)."""
    seed, x, rows = 1, 0.0, []
    for _ in range(ROWS):
        seed = (seed * 6364136223846793005 + 1442695040888963407) % 2**64
        x = 0.75 * x + ((seed >> 11) / 2**53 - 0.5)
        rows.append(x)
    return np.array(rows)


def since(z):
    """Probability of every first block: the evidence of each shape by the matrix of the blocks since, written out."""
    count = len(z)
    logs = np.zeros((count, 2))
    for first in range(count):
        part = z[first:]
        length = len(part)
        def evidence(shape):
            # log N(column; 0, I + PRIOR s s') - log N(column; 0, I)
            square, products = shape @ shape, shape @ part
            return sum(-0.5 * np.log1p(PRIOR * square) + 0.5 * PRIOR * products**2 / (1 + PRIOR * square))
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
        "features": [dict(zip(["mean", "sd", "correlation", "margin", "widened"], map(float, one))) for one in own],
        "evidence_until_change": evidence[: (CHANGE - end) // length],
        "judged_blocks": blocks, "since": first, "step_probability": steps,
    }, indent=1))


main()
