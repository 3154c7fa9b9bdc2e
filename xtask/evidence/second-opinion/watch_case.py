"""One stream through the watch of watch.py, for the tests of haptical-monitor (docs/equations.md, A calibration that is watched):

    python3 watch_case.py > ../../../fixtures/watch/python.json

needs numpy and scipy (versions in README.md). The stream is made of integers, so that any language has the same numbers."""
import json

import numpy as np
from scipy import special

from watch import RATES, features, reference

ROWS, CHANGE, SHIFT = 30000, 24000, 0.02
SIZES = [0.1, 1, 10]
SCATTERS = [1, 2, 4, 8, 16, 32, 64, 128, 256]


def stream():
    """x = 0.75 x + u, u uniform from a 64-bit congruential generator (Knuth's constants)."""
    seed, x, rows = 1, 0.0, []
    for _ in range(ROWS):
        seed = (seed * 6364136223846793005 + 1442695040888963407) % 2**64
        x = 0.75 * x + ((seed >> 11) / 2**53 - 0.5)
        rows.append(x)
    return np.array(rows)


def integrated(z, shape, scatter, size, offset, share):
    """Logarithm of the integral over the shift b of N(b; 0, size^2) times what is left: over the offset a of all blocks in closed form,
    over b by the trapezoidal rule, nearly all of it being within nine standard deviations of its largest value."""
    part, before = z[-len(shape):], z[: len(z) - len(shape)]
    weight = len(before) + len(part) / scatter
    def left(b):
        # of the readings less b times the shape
        total = before.sum() + (part.sum() - b * shape.sum()) / scatter
        squares = (part @ part - 2 * b * (part @ shape) + b**2 * (shape @ shape)) / scatter - part @ part
        return 0.5 * (total**2 * offset**2 / (1 + weight * offset**2) - squares) - 0.5 * np.log(1 + weight * offset**2) - 0.5 * (b / size) ** 2
    # a parabola: its top and width from three values
    low, middle, high = left(np.array([-1.0, 0.0, 1.0]))
    curve = 2 * middle - low - high
    b = (high - low) / 2 / curve + np.linspace(-9, 9, 46) / np.sqrt(curve)
    given = left(b) - 0.5 * share * len(part) * np.log(scatter) - 0.5 * np.log(2 * np.pi * size**2)
    return special.logsumexp(given) + np.log(b[1] - b[0])


def since(z, own):
    """Probability of every first block: the evidence of each shape, shifts integrated numerically."""
    count = len(z)
    # at the widest that the reference allows; a margin is two standard deviations
    columns = [(values / one[4], one[3] / one[4] / 2, one[5]) for values, one in zip(z.T, own)]
    logs = np.zeros((count, 2))
    for first in range(count):
        length = count - first
        def evidence(shape):
            of = [[integrated(values, shape, scatter, size, offset, share) for scatter in SCATTERS for size in SIZES] for values, offset, share in columns]
            return float((special.logsumexp(of, axis=1) - np.log(len(SCATTERS) * len(SIZES))).sum())
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
    first, steps = since(z[:blocks], own)
    print(json.dumps({
        "rows": ROWS, "change_row": CHANGE, "shift": SHIFT * 20, "reference_rows": 2000, "reference_ends": end,
        "centre": centre, "scale": scale, "block_rows": length,
        "features": [dict(zip(["mean", "sd", "long", "margin", "widened", "share"], map(float, one))) for one in own],
        "evidence_until_change": evidence[: (CHANGE - end) // length],
        "judged_blocks": blocks, "since": first, "step_probability": steps,
    }, indent=1))


main()
