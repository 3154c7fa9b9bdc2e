#!/usr/bin/env python3
"""False alarms and delays of the watch, by a second implementation: numpy and scipy, written from docs/equations.md
("A calibration that is watched"), with exact quantiles in the place of expansions.

    python xtask/evidence/second-opinion/watch.py [DAYS]

prints the table of docs/evidence/watch.md for one reading a second whose noise is an AR(1) process.
"""
import sys

import numpy as np
from scipy import signal, stats

RATES = np.array([0.25, 0.5, 1.0, 2.0, 4.0])
DAY = 86400
PER_HOUR = [1.0, 0.1, 0.01]


def scales(rows):
    middle = len(rows) // 2  # the upper one of two
    centre = np.partition(rows, middle)[middle]
    far = np.partition(np.abs(rows - centre), middle)[middle]
    return centre, far / stats.norm.ppf(0.75)


def features(scaled, length):
    count = len(scaled) // length
    blocks = scaled[: count * length].reshape(count, length)
    return blocks.mean(1), np.cbrt((blocks**2).mean(1))


def long_variance(values):
    """Variance of a mean of many values, times their number: the largest that means of 1, 2, 4, ... values show."""
    largest, length = 0, 1
    while len(values) >= 64:
        off = values - values.mean()
        square = (off**2).sum()
        common = (off[1:] * off[:-1]).sum() / square + len(values) ** -0.5
        largest = max(largest, length * square / (len(values) - 1) * (1 + 2 * max(common, 0)))
        values = values[: len(values) // 2 * 2].reshape(-1, 2).mean(1)
        length *= 2
    return largest


def largest(both, own):
    """Largest evidence of the test on the blocks of its own reference."""
    z = [(values - one[0]) / one[1] for values, one in zip(both, own)]
    sides = np.stack([(z[0] - own[0][3]) / own[0][4], (-z[0] - own[0][3]) / own[0][4], (z[1] - own[1][3]) / own[1][4]])
    weights, sums, most = np.array([0.25, 0.25, 0.5]) / len(RATES), np.zeros((3, len(RATES))), 0
    for block in sides.T:
        sums = (1 + sums) * np.exp(np.minimum(np.outer(block, RATES) - RATES**2 / 2, 300))
        most = max(most, weights @ sums.sum(1))
    return most


def reference(noise, least):
    """Centre, scale, block length and features of the shortest adequate reference of a stream; where it ends."""
    settle = max(least // 10, 128)
    centre, scale = scales(noise[:settle])
    scaled = np.clip((noise[settle:] - centre) / scale, -8, 8)
    tried = 0
    for base in range(64, len(scaled) // 8):
        if settle + base * 8 < least or base < tried + tried // 20:
            continue
        tried = base
        # more than 4095 blocks are merged in pairs
        length = 8
        while base * 8 // length >= 4096:
            length *= 2
        part = scaled[: base * 8 // length * length]
        while len(part) // length >= 64:
            own = []
            for values in features(part, length):
                count = len(values)
                mean = values.mean()
                long = long_variance(values)
                sd = max(np.sqrt(long), 0.1 / np.sqrt(length))
                level = 1 - 0.05 / 2
                margin = stats.t.ppf(0.5 * (1 + level), count - 1) / np.sqrt(count)
                low = stats.chi2.ppf(0.5 * (1 - level), count - 1) / (count - 1)
                own.append((mean, sd, long / values.var(ddof=1), margin, low**-0.5, values.var(ddof=1) / sd**2))
            worst = max(one[2] for one in own)
            if worst <= 2 and largest(features(part, length), own) < count:
                return centre, scale, length, own, settle + base * 8
            length *= 2
    return None


def alarms(noise, found, per_hour, first=None):
    """Rows of alarms; the sums start anew after each. With `first` only the first alarm."""
    centre, scale, length, own, _ = found
    scaled = np.clip((noise - centre) / scale, -8, 8)
    means, sizes = features(scaled, length)
    z_mean = (means - own[0][0]) / own[0][1]
    z_size = (sizes - own[1][0]) / own[1][1]
    sides = [(z_mean, own[0]), (-z_mean, own[0]), (z_size, own[1])]
    weights = np.repeat([0.25, 0.25, 0.5], len(RATES)) / len(RATES)
    beyond = np.stack([(z - one[3]) / one[4] for z, one in sides])
    factors = np.exp(np.minimum(beyond[:, None, :] * RATES[None, :, None] - RATES[None, :, None] ** 2 / 2, 300))
    factors = factors.reshape(-1, len(z_mean)).T
    threshold = 3600 / per_hour / length
    sums, rows = np.zeros(len(weights)), []
    for block, factor in enumerate(factors):
        sums = (1 + sums) * factor
        if weights @ sums >= threshold:
            rows.append((block + 1) * length)
            if first:
                break
            sums[:] = 0
    return rows


def stream(memory, rows, rng):
    shocks = rng.standard_normal(rows) * np.sqrt(1 - memory**2)
    start = [memory * rng.standard_normal()]
    return signal.lfilter([1], [1, -memory], shocks, zi=start)[0]


def main():
    days = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    rng = np.random.default_rng(20260101)
    for memory in [0.0, 0.5, 0.9, 0.98]:
        counts, lengths, ends = [], [], []
        delays = {shift: [] for shift in [0.25, 0.5, 1.0, 2.0]}
        for _ in range(days):
            past = stream(memory, 4 * DAY, rng)
            found = reference(past, 3600)
            lengths.append(found[2])
            ends.append(found[4])
            noise = stream(memory, DAY, rng)
            counts.append([len(alarms(noise, found, rate)) for rate in PER_HOUR])
            for shift, seen in delays.items():
                rows = alarms(noise + shift, found, PER_HOUR[-1], first=True)
                seen.append(rows[0] if rows else np.inf)
        hours = 24 * days
        print(
            f"memory {memory}: blocks of {np.median(lengths):g} rows, reference of {np.median(ends) / 3600:.1f} h (median), "
            f"{hours} h: "
            + ", ".join(f"{counted} of {rate * hours:g} alarms" for counted, rate in zip(np.sum(counts, 0), PER_HOUR))
        )
        for shift, seen in delays.items():
            median, late = np.quantile(seen, [0.5, 0.9], method="higher")
            print(f"  shift {shift} sd: delay {median:g} s, nine of ten within {late:g} s")


if __name__ == "__main__":
    main()
