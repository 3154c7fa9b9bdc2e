"""Identifies a fleet of simulated devices through Dask, and says how long it took.

    pip install haptical[fleet]
    python examples/fleet.py --devices 1000

Each device deviates from its drawing by other lengths and joint offsets; its log is simulated by forward
kinematics of the true device, with noise. One task is one device: the log goes in as arrays, numbers come out,
and a device that cannot be identified is a line of the result, not the end of the run. The same lines run on a
cluster: give the address of a Dask scheduler with `--scheduler` (needs `pip install distributed`).
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import dask
import dask.bag
import haptical
import numpy as np

POSITION_SD_M = 1e-4
JOINTS = 3


def device(lengths_m: Any = (0.25, 0.2, 0.1), offsets_rad: Any = (0.0, 0.0, 0.0)) -> dict[str, Any]:
    """A spatial arm of three joints: a column, then two links in a vertical plane."""
    twist = np.pi / 2
    links: list[dict[str, float]] = [{"a_m": 0.0, "alpha_rad": 0.0, "d_m": 0.0}]
    for index, (length, offset) in enumerate(zip(lengths_m, offsets_rad)):
        column, arm = (float(length), 0.0) if index == 0 else (0.0, float(length))
        row = {"a_m": arm, "alpha_rad": twist if index == 0 else 0.0, "d_m": column}
        links.append(row | {"theta_offset_rad": float(offset)})
    joint = {"lower_rad": -2.0, "upper_rad": 2.0, "transmission": "direct"}
    return {
        "device": {"name": "arm", "dof": JOINTS},
        "link": links,
        "joint": [joint] * JOINTS,
        "tracker": {"base": "known", "tool": "known", "position_sd_m": POSITION_SD_M},
    }


def simulated(serial: int, rows: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """The true device with this serial number, and its log."""
    random = np.random.default_rng([7, serial])
    lengths = np.array([0.25, 0.2, 0.1]) + 1e-3 * random.normal(size=JOINTS)
    offsets = 5e-3 * random.normal(size=JOINTS)
    truth = device(lengths, offsets)
    readings = random.uniform(-1.5, 1.5, size=(rows, JOINTS))
    position, _ = haptical.forward_kinematics(truth, readings)
    position += POSITION_SD_M * random.normal(size=position.shape)
    log: dict[str, Any] = {f"theta{joint + 1}_rad": readings[:, joint] for joint in range(JOINTS)}
    log |= dict(zip(["x_m", "y_m", "z_m"], position.T))
    return truth, log


def calibrate(serial: int, rows: int = 200) -> dict[str, Any]:
    """One task: simulate, identify, compare the handle on postures that the log does not have."""
    truth, log = simulated(serial, rows)
    started = time.perf_counter()
    try:
        result = haptical.identify(device(), log)
    except (ValueError, haptical.HapticalError) as error:
        return {"serial": serial, "error": str(error)}
    seconds = time.perf_counter() - started
    postures = np.random.default_rng(1).uniform(-1.5, 1.5, size=(100, JOINTS))
    true = haptical.forward_kinematics(truth, postures)[0]

    def rms_m(model: Any) -> float:
        found = haptical.forward_kinematics(model, postures)[0]
        return float(np.sqrt(np.mean(np.sum((found - true) ** 2, axis=1))))

    return {
        "serial": serial,
        "before_m": rms_m(device()),
        "after_m": rms_m(result["identified_toml"]),
        "rank": result["rank"],
        "seconds": seconds,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--devices", type=int, default=1000)
    parser.add_argument("--rows", type=int, default=200)
    parser.add_argument("--workers", type=int, default=None, help="processes; as many as processors without it")
    parser.add_argument("--scheduler", default=None, help="address of a Dask scheduler")
    arguments = parser.parse_args()
    tasks = dask.bag.from_sequence(range(arguments.devices), partition_size=25)
    tasks = tasks.map(calibrate, rows=arguments.rows)
    started = time.perf_counter()
    if arguments.scheduler:
        from distributed import Client

        with Client(arguments.scheduler):
            results = tasks.compute()
    else:
        # processes: each has an interpreter of its own; threads serve as well, as the lock is released
        options = {} if arguments.workers is None else {"num_workers": arguments.workers}
        results = tasks.compute(scheduler="processes", **options)
    seconds = time.perf_counter() - started
    done = [result for result in results if "error" not in result]
    for result in results:
        if "error" in result:
            print(f"device {result['serial']}: {result['error']}")
    before = np.array([result["before_m"] for result in done])
    after = np.array([result["after_m"] for result in done])
    alone = sum(result["seconds"] for result in done)
    print(f"{len(done)} of {arguments.devices} devices identified in {seconds:.1f} s, Dask {dask.__version__}")
    print(f"{seconds / arguments.devices * 1e3:.1f} ms for each device; identification alone {alone / max(len(done), 1) * 1e3:.1f} ms")
    if done:
        print(f"handle before: median {np.median(before) * 1e3:.3f} mm, worst {before.max() * 1e3:.3f} mm")
        print(f"handle after:  median {np.median(after) * 1e3:.4f} mm, worst {after.max() * 1e3:.4f} mm")


if __name__ == "__main__":
    main()
