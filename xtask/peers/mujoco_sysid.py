"""MuJoCo's system identification on logs of a moving arm: a peer of `cargo xtask peers-moving`.

    python3 -m pip install "mujoco[sysid]"
    python3 mujoco_sysid.py record FOLDER       writes arm.xml (nominal), truth.json, CASE.csv and CASE-second.csv
    python3 mujoco_sysid.py fit FOLDER CASE     prints a line of JSON: what it identifies from CASE.csv, in what time

The arm has seven joints and is invented, as are all its numbers. MuJoCo itself moves it, with armature, damping and
dry friction that differ from the nominal model by up to 40 %, and in two of the cases with what neither that model nor
the 21 fitted parameters can hold: a payload, or encoders that are read late.
"""

import contextlib
import json
import logging
import sys
import time
from pathlib import Path

import mujoco
import numpy as np

JOINTS = 7
RATE_HZ = 500
DURATION_S = 20.0
ENCODER_SD_RAD = 2e-5
TORQUE_SD_NM = 0.05
PAYLOAD_KG = 1.0
DELAY_S = 0.010
CASES = {"clean": {}, "payload": {"payload_kg": PAYLOAD_KG}, "delay": {"delay_s": DELAY_S}}
FITTED = ("armature", "damping", "frictionloss")
# Links: place of the joint in the parent's frame, axis, mass, centre of mass, principal inertia.
LINKS = [
    ((0, 0, 0.16), (0, 0, 1), 3.1, (0, -0.02, 0.09), (0.021, 0.019, 0.009)),
    ((0, 0, 0.18), (0, 1, 0), 3.4, (0.01, 0.03, 0.12), (0.034, 0.033, 0.010)),
    ((0, 0, 0.22), (0, 0, 1), 2.3, (0.02, 0, 0.10), (0.016, 0.015, 0.006)),
    ((0.05, 0, 0.19), (0, 1, 0), 2.0, (-0.02, 0.02, 0.09), (0.013, 0.012, 0.005)),
    ((-0.05, 0, 0.20), (0, 0, 1), 1.5, (0, 0.01, 0.08), (0.008, 0.008, 0.003)),
    ((0, 0, 0.19), (0, 1, 0), 1.2, (0.03, 0, 0.03), (0.003, 0.004, 0.003)),
    ((0.07, 0, 0.05), (0, 0, 1), 0.5, (0, 0, 0.05), (0.0008, 0.0008, 0.0006)),
]
FLANGE = (0, 0, 0.09)
NOMINAL = {
    "armature": (0.60, 0.60, 0.45, 0.45, 0.18, 0.15, 0.12),
    "damping": (9.0, 9.0, 6.0, 6.0, 2.5, 2.5, 2.0),
    "frictionloss": (1.6, 1.8, 1.2, 1.2, 0.6, 0.5, 0.4),
}
TRUE = {
    "armature": (0.72, 0.51, 0.54, 0.36, 0.21, 0.12, 0.15),
    "damping": (11.5, 7.4, 7.5, 4.6, 3.1, 3.2, 1.5),
    "frictionloss": (1.3, 2.3, 1.5, 0.9, 0.8, 0.4, 0.5),
}
# Position actuators, as the drives of such arms have them: stiffness and damping of the loop.
LOOP = ((3000, 150), (3000, 150), (2000, 90), (2000, 90), (700, 25), (600, 20), (400, 12))
# Middle of each joint's motion, and how far it goes to either side, in rad.
MIDDLE = (0.0, 0.5, 0.0, 1.1, 0.0, 0.7, 0.0)
SWING = (0.9, 0.5, 0.8, 0.6, 0.9, 0.6, 1.0)


def arm_xml(numbers, payload_kg=0.0):
    """The arm as MJCF, with these armatures, dampings and dry frictions."""
    text = lambda values: " ".join(f"{value:g}" for value in values)
    xml = '<mujoco model="arm7">\n'
    xml += f'  <option timestep="{1 / RATE_HZ:g}" integrator="implicitfast"/>\n  <worldbody>\n'
    for joint, (place, axis, mass, centre, inertia) in enumerate(LINKS):
        attributes = " ".join(f'{name}="{numbers[name][joint]:g}"' for name in FITTED)
        indent = "    " + "  " * joint
        xml += f'{indent}<body name="link{joint + 1}" pos="{text(place)}">\n'
        xml += f'{indent}  <inertial pos="{text(centre)}" mass="{mass:g}" diaginertia="{text(inertia)}"/>\n'
        xml += f'{indent}  <joint name="joint{joint + 1}" axis="{text(axis)}" {attributes}/>\n'
    indent = "    " + "  " * JOINTS
    xml += f'{indent}<site name="flange" pos="{text(FLANGE)}"/>\n'
    if payload_kg > 0.0:
        small = text([4e-4 * payload_kg] * 3)
        xml += f'{indent}<body name="payload" pos="0.02 0 0.15">\n{indent}  <inertial pos="0 0 0" mass="{payload_kg:g}" '
        xml += f'diaginertia="{small}"/>\n{indent}</body>\n'
    for joint in reversed(range(JOINTS)):
        xml += "    " + "  " * joint + "</body>\n"
    xml += "  </worldbody>\n  <actuator>\n"
    for joint, (stiffness, damping) in enumerate(LOOP):
        xml += f'    <position name="drive{joint + 1}" joint="joint{joint + 1}" kp="{stiffness}" kv="{damping}"/>\n'
    return xml + "  </actuator>\n</mujoco>\n"


def commands(motion, times):
    """Joint angles asked for: from rest in the middle, five sines a joint with frequencies of 0.1 to 1 Hz."""
    random = np.random.default_rng(motion)
    rise = np.clip(times / 2.0, 0.0, 1.0)
    rise = rise**3 * (10.0 + rise * (6.0 * rise - 15.0))
    angles = []
    for middle, swing in zip(MIDDLE, SWING):
        frequencies = random.uniform(0.1, 1.0, 5)
        parts = random.uniform(0.5, 1.0, 5) / frequencies
        phases = random.uniform(0.0, 2.0 * np.pi, 5)
        waves = parts[:, None] * np.sin(2.0 * np.pi * frequencies[:, None] * times + phases[:, None])
        wave = waves.sum(axis=0)
        angles.append(middle + swing * rise * wave / np.abs(wave).max())
    return np.array(angles).T


def record(path, motion, payload_kg=0.0, delay_s=0.0):
    """Moves the true arm and writes what its log holds: angles, the drives' torques, commands."""
    model = mujoco.MjModel.from_xml_string(arm_xml(TRUE, payload_kg))
    data = mujoco.MjData(model)
    rest_s = 2.0  # the arm sags to its rest before the log begins
    before = int(rest_s * RATE_HZ)
    times = np.arange(int(DURATION_S * RATE_HZ)) / RATE_HZ
    asked = commands(motion, times)
    data.qpos[:] = asked[0]
    angles, torques = [], []
    loop_damping = np.array(LOOP)[:, 1]
    for step in range(-before, len(times)):
        data.ctrl[:] = asked[max(step, 0)]
        angles.append(data.qpos.copy())
        before_step = data.qvel.copy()
        mujoco.mj_step(model, data)
        # the step is implicit: what moves the arm has the loop's damping at the speed after it
        torques.append(data.actuator_force - loop_damping * (data.qvel - before_step))
    late = before - round(delay_s * RATE_HZ)
    random = np.random.default_rng(1000 + motion)
    angles = np.array(angles)[late : late + len(times)]
    angles = angles + random.normal(0.0, ENCODER_SD_RAD, angles.shape)
    torques = np.array(torques)[before:]
    torques = torques + random.normal(0.0, TORQUE_SD_NM, torques.shape)
    names = ["t_s"]
    for stem, unit in (("theta", "rad"), ("torque", "nm"), ("command", "rad")):
        names += [f"{stem}{joint + 1}_{unit}" for joint in range(JOINTS)]
    table = np.column_stack([times, angles, torques, asked])
    np.savetxt(path, table, delimiter=",", header=",".join(names), comments="", fmt="%.7g")


def record_all(folder):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "arm.xml").write_text(arm_xml(NOMINAL))
    truth = {"cases": CASES, "true": TRUE, "nominal": NOMINAL}
    (folder / "truth.json").write_text(json.dumps(truth, indent=1) + "\n")
    for case, effects in CASES.items():
        record(folder / f"{case}.csv", 1, **effects)
        record(folder / f"{case}-second.csv", 2, **effects)


def write_number(joint, kind, value):
    """Since MuJoCo 4 damping is a polynomial in the speed, of which `damping="..."` writes the first coefficient."""
    if np.ndim(getattr(joint, kind)) == 0:
        setattr(joint, kind, value)
    else:
        getattr(joint, kind)[0] = value


class Warnings(logging.Handler):
    """What the library warns of while it fits and judges its answer."""

    def __init__(self):
        super().__init__(logging.WARNING)
        self.texts = []

    def emit(self, entry):
        self.texts.append(entry.getMessage())


def fit(folder, case):
    """MuJoCo's own way: 21 parameters, each between 0 and ten times its nominal value, simulated angles against the
    log's. The drives' torques follow from angles and commands, whose loop the model has: they add nothing."""
    from mujoco import sysid

    started = time.perf_counter()
    with open(folder / f"{case}.csv") as file:
        names = file.readline().strip().split(",")
    table = np.loadtxt(folder / f"{case}.csv", delimiter=",", skiprows=1)
    column = lambda stem: table[:, [i for i, name in enumerate(names) if name.startswith(stem)]]
    times, angles, asked = table[:, 0], column("theta"), column("command")
    spec = mujoco.MjSpec.from_file(str(folder / "arm.xml"))
    model = spec.compile()
    parameters = sysid.ParameterDict()
    for kind in FITTED:
        for joint in range(JOINTS):
            nominal = NOMINAL[kind][joint]
            name = f"joint{joint + 1}"
            write = lambda spec, p, name=name, kind=kind: write_number(spec.joint(name), kind, p.value[0])
            parameters.add(
                sysid.Parameter(f"{kind}{joint + 1}", nominal, 0.0, 10.0 * nominal, modifier=write)
            )
    observed = [(f"joint{joint + 1}", sysid.SignalType.MjStateQPos) for joint in range(JOINTS)]
    start = sysid.create_initial_state(model, angles[0], np.zeros(JOINTS))
    sequence = sysid.ModelSequences(
        "arm7",
        spec,
        case,
        start,
        sysid.TimeSeries.from_control_names(times, asked, model),
        sysid.TimeSeries.from_names(times, angles, model, names=observed),
        allow_missing_sensors=True,
    )
    residual = sysid.build_residual_fn(models_sequences=[sequence])
    before = np.concatenate(residual(parameters.as_vector(), parameters.copy())[0])
    warnings = Warnings()
    logging.getLogger("absl").addHandler(warnings)
    with contextlib.redirect_stdout(sys.stderr):
        found, result = sysid.optimize(parameters, residual, optimizer="mujoco", verbose=False)
    seconds = time.perf_counter() - started
    after = residual(result.x, found)[0]
    intervals = sysid.calculate_intervals(after, np.asarray(result.jac))[1]
    low, high = found.get_bounds()
    values = found.as_vector()
    bounded = np.minimum(values - low, high - values) <= 1e-3 * (high - low)
    rms = lambda residuals: float(np.sqrt(np.mean(np.square(residuals))))
    names = found.get_non_frozen_parameter_names()
    answer = {
        "version": mujoco.__version__,
        "seconds": seconds,
        "values": dict(zip(names, map(float, values))),
        "half_widths_95": dict(zip(names, map(float, intervals))),
        "at_bound": [name for name, at in zip(names, bounded) if at],
        "warnings": warnings.texts,
        "relative_rms_before": rms(before),
        "relative_rms_after": rms(np.concatenate(after)),
    }
    print(json.dumps(answer))


def main():
    match sys.argv[1:]:
        case ["record", folder]:
            record_all(Path(folder))
        case ["fit", folder, case]:
            fit(Path(folder), case)
        case _:
            sys.exit(__doc__)


if __name__ == "__main__":
    main()
