"""Coverage of the 95 % intervals of `haptical identify --json`, counted from outside: arms.py makes devices and logs.

python3 coverage.py HAPTICAL [devices] [name ...] prints a row of a table for each trial whose name holds one of the words."""
import collections
import functools
import json
import multiprocessing
import os
import subprocess
import sys
import tempfile

import numpy as np

import arms
import touches

EXACT = "scale_sd = 0.0\n"
NOISES = [arms.Noise(), arms.Noise(.5, name="memory .5"), arms.Noise(.8, name="memory .8"), arms.Noise(.95, name="memory .95"),
          arms.Noise(drift=2, name="drift of 2 sd"), arms.Noise(drift=3, name="drift of 3 sd"), arms.Noise(uneven=12, name="12 : 1"),
          arms.Noise(.8, 3, 12, name="memory .8, drift of 3 sd, 12 : 1")]


def identified(device, columns, *flags):
    """identified.json, or the refusal."""
    with tempfile.TemporaryDirectory() as folder:
        with open(f"{folder}/device.toml", "w") as file:
            file.write(device)
        arms.write_log(f"{folder}/log.csv", columns)
        command = [sys.argv[1], "identify", "--device", f"{folder}/device.toml", "--log", f"{folder}/log.csv", "--out", f"{folder}/result", "--json"]
        done = subprocess.run([*command, *flags], capture_output=True, text=True, env={**os.environ, "RAYON_NUM_THREADS": "1"})
        return (json.loads(done.stdout), "") if done.returncode == 0 else (None, done.stderr)


def partners(rng, kind):
    """Partners that deviate: the paper's device with d0 alone, with all, with a drum that is off, with few rows; parallel joints."""
    if kind.startswith("parallel"):
        arm = arms.parallel()
        true = arms.deviating(arm, rng)
        rows = int(rng.integers(26, 41)) if kind.endswith("few rows") else 200
        sensor = "pose" if kind.endswith("few rows") or kind.endswith("pose") else "position"
        columns = arms.log_of(true, arms.random_motion(arm, rows, rng), rng, sensors=(sensor,))
        return arms.device_text(arm, arms.tracker(extra=EXACT)), columns, (), true
    arm = arms.paper()
    small = kind in ("d0 of 2.5 mm", "few rows")
    true = arms.deviating(arm, rng, 1e-3, 5e-3) if small else arms.deviating(arm, rng)
    if kind == "d0 of 2.5 mm":
        true.rows[0] = {**arm.rows[0], "d": 2.5e-3}
    is_few = kind == "few rows"
    columns = arms.log_of(true, arms.random_motion(arm, int(rng.integers(26, 41)) if is_few else 200, rng), rng)
    if kind == "drum off":
        columns["cable_m"] = columns["cable_m"] * (1 + 1e-3 * rng.standard_normal())
    sensors = arms.CABLE + ("" if kind == "drum off" else EXACT)
    return arms.device_text(arm, sensors), columns, ("--held-out", "0") if is_few else (), true


def noisy(rng, noise, rig, motion, rows):
    arm = arms.parallel() if rig == "parallel" else arms.paper()
    true = arms.deviating(arm, rng)
    readings = (arms.random_motion if motion == "random" else arms.smooth_motion)(arm, rows, rng)
    if rig.startswith("cable"):
        flags = ("--method", "two-step") if rig == "cable, two steps" else ()
        return arms.device_text(arm, arms.CABLE + EXACT), arms.log_of(true, readings, rng, noise), flags, true
    sensors = ("position",) if rig == "parallel" else ("out", "position")
    return arms.device_text(arm, arms.tracker(extra=EXACT)), arms.log_of(true, readings, rng, noise, sensors), (), true


def trials():
    """Name and maker of each trial."""
    for kind in ("d0 of 2.5 mm", "all partners", "drum off", "few rows", "parallel", "parallel, pose", "parallel, few rows"):
        yield f"partners: {kind}", functools.partial(partners, kind=kind)
    for pair_sd in (1e-4, 1e-3, None):
        words = "no known distance" if pair_sd is None else f"a distance known to {pair_sd * 1e3} mm"
        yield f"touches: {words}", functools.partial(touches.touched, pair_sd=pair_sd)
    for rows in (300, 2000):
        for rig in ("cable", "cable, two steps", "parallel", "tracker"):
            for motion in ("random", "smooth"):
                for noise in NOISES:
                    maker = functools.partial(noisy, noise=noise, rig=rig, motion=motion, rows=rows)
                    yield f"noise: {rows} rows, {rig}, {motion}, {noise.name}", maker


def judged(job):
    """Whether each interval of a device holds the truth: (kind, name, holds, half width, error over half width)."""
    name, make, seed = job
    key = [int(part) for part in name.encode()]
    device, columns, flags, true = make(np.random.default_rng([*key, seed]))
    answer, refusal = identified(device, columns, *flags)
    if answer is None:
        return None, refusal
    members = {sum_["terms"][0]["name"] for sum_ in answer["combinations"]}
    every = {p["name"]: p for step in answer["transmissions"] for p in step["parameters"]}
    every.update((p["name"], p) for p in answer["parameters"])
    found = []

    def look(kind, name, ends, actual):
        half = (ends[1] - ends[0]) / 2
        found.append((kind, name, ends[0] <= actual <= ends[1], half, abs((ends[0] + ends[1]) / 2 - actual) / half))

    for own in every.values():
        actual = arms.truth_of(true, own["name"])
        if own["ci95"] and actual is not None:
            look("member" if own["name"] in members else "alone", own["name"], own["ci95"], actual)
    for sum_ in answer["combinations"]:
        values = [arms.truth_of(true, term["name"]) for term in sum_["terms"]]
        if None not in values:
            actual = sum(term["coefficient"] * value for term, value in zip(sum_["terms"], values))
            look("combination", f"sum of {sum_['terms'][0]['name']}", sum_["ci95"], actual)
    noise = answer["intervals"]["channel_noise"] or []
    said = any(own["has_memory"] or own["drift_sd"] or own["uneven"] for own in noise)
    return (found, said, bool(answer["warnings"]) or bool(answer["intervals"]["length_scales"])), ""


HEADS = ("trial | devices | refused | covered [%] | fixed alone [%] | in a combination [%] | combinations [%] | worst [%] | of | "
         "largest error [half widths] | half width over that of white noise | noise said [%] | warned [%]")


def row(name, answers, white):
    good = [answer for answer, _ in answers if answer is not None]
    every = [entry for found, _, _ in good for entry in found]
    share = lambda entries: 100 * np.mean([entry[2] for entry in entries]) if entries else float("nan")
    by_name = collections.defaultdict(list)
    for entry in every:
        by_name[(entry[0], entry[1])].append(entry)
    often = {key: entries for key, entries in by_name.items() if 5 * len(entries) >= len(good)}
    worst = min(often, key=lambda key: share(often[key]), default=None)
    widths = {key: np.median([entry[3] for entry in entries]) for key, entries in by_name.items() if key[0] == "alone"}
    if name.endswith(", white"):
        white.clear()
        white.update(widths)
    growth = np.median([widths[key] / white[key] for key in widths if key in white]) if name.startswith("noise") else float("nan")
    kinds = [share([entry for entry in every if entry[0] == kind]) for kind in ("alone", "member", "combination")]
    figures = [share(every), *kinds, share(often[worst]) if worst else float("nan")]
    largest = max(every, key=lambda entry: entry[4])
    percent = lambda index: f"{100 * np.mean([answer[index] for answer in good]):.0f}"
    cells = [name, len(answers), len(answers) - len(good), *(f"{figure:.1f}" for figure in figures), worst[1] if worst else "",
             f"{largest[4]:.1f} ({largest[1]})", f"{growth:.2f}", percent(1), percent(2)]
    return "| " + " | ".join(map(str, cells)) + " |"


def main():
    devices, words = int(sys.argv[2]) if len(sys.argv) > 2 else 200, sys.argv[3:]
    print(f"| {HEADS} |\n|{' --- |' * len(HEADS.split('|'))}", flush=True)
    white = {}
    with multiprocessing.Pool() as pool:
        for name, make in trials():
            if not words or any(word in name for word in words):
                answers = pool.map(judged, [(name, make, seed) for seed in range(devices)], chunksize=1)
                print(row(name, answers, white), flush=True)
                for _, refusal in [answer for answer in answers if answer[0] is None][:2]:
                    print("refused:", " ".join(refusal.split())[:200], file=sys.stderr)


if __name__ == "__main__":
    main()
