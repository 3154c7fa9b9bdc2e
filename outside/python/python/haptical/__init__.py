"""Calibration of robots from their own logs: identification, diagnosis, planning, simulation, correction, export.

Numbers are in SI units; columns of logs and keys of device files are those of the command `haptical`. Results are
dictionaries whose keys are attributes too; a notebook shows their report, `plot()` draws them (matplotlib), tables go to pandas
and polars. Bad input is a ValueError that says what, where and what to do; `HapticalError` says that sound numbers fix
nothing. The interpreter's lock is released while numbers are worked out, and Ctrl-C is heard.
"""

from __future__ import annotations

import json as _json
import os as _os
import sys as _sys
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, Literal, Mapping, Optional, Sequence, Union
from contextlib import contextmanager as _contextmanager

import numpy as _np

from . import _haptical
from ._haptical import Device, HapticalError, __version__
from .fleets import fleet
from .frames import columns as _columns
from .results import Columns, Correction, Diagnosis, Fleet, Identification, Plan, Record, Replay, Result, Simulation

if TYPE_CHECKING:
    import numpy.typing as _npt

    from .types import (
        Array,
        Criterion,
        Effect,
        Form,
        Log,
        Loss,
        Match,
        Method,
        Noise,
        Program,
        Progress,
        Source,
        Spread,
        Tip,
    )

__all__ = [
    "Columns",
    "Correction",
    "Device",
    "Diagnosis",
    "Fleet",
    "HapticalError",
    "Identification",
    "Plan",
    "Record",
    "Replay",
    "Result",
    "Simulation",
    "__version__",
    "correct",
    "diagnose",
    "doctor",
    "effects",
    "export",
    "fleet",
    "forward_kinematics",
    "identify",
    "jacobian",
    "joint_values",
    "plan",
    "replay",
    "simulate",
    "torques",
]


@_contextmanager
def _watched(progress: Progress, what: str) -> Iterator[Optional[Callable[[float], None]]]:
    """What is called with the seconds of a piece of work; a line on standard error is taken away at the end."""
    if progress is not True:
        yield progress or None
        return
    shown = ""

    def show(seconds: float) -> None:
        nonlocal shown
        text = f"{what} {seconds:.0f} s"
        if text != shown:
            shown = text
            print(f"\r{text}", end="", file=_sys.stderr, flush=True)

    try:
        yield show
    finally:
        if shown:
            print("\r" + " " * len(shown) + "\r", end="", file=_sys.stderr, flush=True)


def _words(words: Sequence[str]) -> list[str]:
    """Names in a list; one alone is a list of one."""
    return [words] if isinstance(words, str) else list(words)


def identify(
    device: Union[Device, Source],
    log: Log,
    *,
    method: Method = "joint",
    held_out: float = 0.2,
    folds: Optional[int] = None,
    with_: Sequence[Effect] = (),
    hold: Sequence[str] = (),
    deviation: Optional[Mapping[str, float]] = None,
    degree: Union[int, str] = "evidence",
    noise: Noise = "estimated",
    loss: Loss = "auto",
    validate: Optional[Log] = None,
    band_hz: Optional[float] = None,
    input_drum_denominator_m: Optional[float] = None,
    paper_preset: bool = False,
    progress: Progress = None,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Identification:
    """Identify the parameters of `device` from `log`, as `haptical identify` does.

    Arguments have the names, the meaning and the defaults of the command's flags: `folds` (2 to 100) takes the
    place of `held_out`, `with_=["joint-compliance"]` fits an effect too (`haptical.effects()` has the names), `with_=["dynamics"]`
    masses, friction and a delay from the torques of a motion, with `validate`, a log that is predicted and not fitted, and
    `band_hz`, `hold` keeps numbers
    of the links (`["offsets"]`, `["a3"]`), `deviation` says how far such numbers may plausibly be off, in m or rad
    (`{"offsets": 0.06}`), `loss="auto"` is least squares unless single readings lie farther out than noise explains. `rig` holds the sensors around the
    device, `base` and `tip` are the links between which the chain of a URDF runs: without `base` it begins at the
    root link, without both the longest chain is taken.

    The result has the fields of identified.json under the same names, as keys and as attributes: parameters and outliers as
    columns, channels by name and with their residuals, lists of numbers as arrays. `haptical.types.Identification` says what
    each holds. A notebook shows its report.

    Raises ValueError for bad input, HapticalError where nothing can be identified.
    """
    with _watched(progress, "identifying") as watch:
        found = _haptical.identify(
            device,
            _columns(log),
            method=method,
            held_out=held_out,
            folds=folds,
            with_=_words(with_),
            hold=_words(hold),
            deviation=dict(deviation or {}),
            degree=degree,
            noise=noise,
            loss=loss,
            validate=None if validate is None else _columns(validate),
            band_hz=band_hz,
            input_drum_denominator_m=input_drum_denominator_m,
            paper_preset=paper_preset,
            progress=watch,
            base=base,
            tip=tip,
            rig=rig,
        )
    return Identification(found)


def diagnose(
    device: Union[Device, Source],
    log: Union[Log, Sequence[Log]],
    *,
    model: Union[Device, Source, None] = None,
    validate: Optional[Log] = None,
    without: Sequence[str] = (),
    with_: Sequence[Effect] = (),
    hold: Sequence[str] = (),
    deviation: Optional[Mapping[str, float]] = None,
    loss: Loss = "auto",
    repair: bool = False,
    progress: Progress = None,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Diagnosis:
    """Identify, then say which effect causes what is left: the fields of gap.json, as `haptical diagnose`, and
    `corrected_toml`, the device with the causes as effects (None where no cause is part of a device).

    `model` is a device identified earlier, `validate` a second log on which the shrink is measured, `without`
    names effects to leave out. Several logs of one device, with the same columns, are judged together. `repair` puts
    the log without what is its own fault into `files` (repaired.csv, repaired.json). `with_`, `hold`, `deviation` and `loss` are those of `identify`, for the model that
    the gap is measured from.

    Raises ValueError for bad input, HapticalError where nothing can be identified.
    """
    with _watched(progress, "diagnosing") as watch:
        text, files = _haptical.diagnose(
            device,
            _columns(log),
            model=model,
            validate=None if validate is None else _columns(validate),
            without=_words(without),
            with_=_words(with_),
            hold=_words(hold),
            deviation=dict(deviation or {}),
            loss=loss,
            repair=repair,
            progress=watch,
            base=base,
            tip=tip,
            rig=rig,
        )
    return Diagnosis(_json.loads(text), files)


def doctor(
    path: "str | _os.PathLike[str]",
    *,
    units: Optional[Literal["radians", "degrees", "percent"]] = None,
    state: Optional[str] = None,
    action: Optional[str] = None,
) -> Dict[str, Any]:
    """Which joints and episodes of a recording are sound: what `haptical doctor PATH --json` prints.

    `path` is a LeRobot data set, one of its Parquet files, a log with a column `run`, or a folder of logs. `joints` has the findings of
    each joint with size, interval and `since_episode`, `episodes` a verdict of each, `not_tested` what was not looked for.

    Raises ValueError for what is no recording.
    """
    return _json.loads(_haptical.doctor(path, units=units, state=state, action=action))


def plan(
    device: Union[Device, Source],
    measure: Union[str, Sequence[str]] = (),
    *,
    poses: Optional[int] = None,
    criterion: Criterion = "d",
    region: Optional[_npt.ArrayLike] = None,
    candidates: Optional[int] = None,
    seed: int = 1,
    spread: Spread = "uniform",
    workspace: Optional[_npt.ArrayLike] = None,
    cable_length: Optional[_npt.ArrayLike] = None,
    link_radius: Optional[float] = None,
    known_transmissions: bool = False,
    log: Union[Log, Sequence[Log], None] = None,
    settle: Union[Diagnosis, str, None] = None,
    rows: Optional[int] = None,
    press: Optional[float] = None,
    progress: Progress = None,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Plan:
    """Say which rig tells which parameters, and choose the poses to measure next, as `haptical plan` does.

    `measure` are rigs to compare, each a text as "out,cable2:0.4,0,0.3" (`haptical plan --help` has the kinds);
    without it what the device describes, beside a position and a pose. `poses` is how many poses to choose for
    the first rig; without it none are chosen, and standard deviations are for 200. They are chosen among
    `candidates` (2000) so that the `criterion` is best, where a task's criterion is about a `region`: a ball x, y, z, r
    in m, [4], or low and high of each joint's reading, [n, 2].

    Limits of the poses: `workspace`, lowest and highest x, y, z of the handle in frame (-1) in m, [2, 3];
    `cable_length`, shortest and longest length of every cable in m; `link_radius` in m. `spread` is how
    candidates lie between the joint limits. `known_transmissions` takes the transmissions as known. `log` holds
    poses that were measured with the first rig already: those chosen add to them.

    `settle`, a diagnosis (or the path of its gap.json) that is ambiguous or unknown, chooses the recording that tells its
    candidates apart instead: of at most `rows` rows, with a hand that presses with `press` N; `log` is that of the diagnosis.

    Raises ValueError for bad input, HapticalError for a rig that identifies nothing.
    """
    with _watched(progress, "planning") as watch:
        found = _haptical.plan(
            device,
            _words(measure),
            poses=poses,
            criterion=criterion,
            region=region,
            candidates=candidates,
            seed=seed,
            spread=spread,
            workspace=workspace,
            cable_length=cable_length,
            link_radius=link_radius,
            known_transmissions=known_transmissions,
            log=None if log is None else _columns(log),
            settle=settle,
            rows=rows,
            press=press,
            progress=watch,
            base=base,
            tip=tip,
            rig=rig,
        )
    return Plan(found)


def replay(
    device: Union[Device, Source],
    log: Log,
    *,
    progress: Progress = None,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Replay:
    """Run the motion, the loads and the times of `log` through `device` with its effects, without fitting anything,
    as `haptical simulate --replay` does.

    `channels` has, by name ("out2", "cable", "position"), `unit`, `rms` and `noise_floor` of one axis, `rows` [N] and
    `residuals` [N, axes], prediction minus measurement; of an orientation the rotation vector in rad.

    Raises ValueError for bad input.
    """
    with _watched(progress, "replaying") as watch:
        found = _haptical.replay(device, _columns(log), progress=watch, base=base, tip=tip, rig=rig)
    return Replay(found)


def simulate(
    device: Union[Device, Source],
    poses: Optional[Log] = None,
    *,
    measure: Optional[str] = None,
    truth: Union[Device, Source, None] = None,
    deviate: Optional[float] = None,
    effects: Union[str, Sequence[Mapping[str, Any]], None] = None,
    seconds: float = 100.0,
    rate_hz: float = 1000.0,
    seed: int = 1,
    progress: Progress = None,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Simulation:
    """Simulate a log of a true device, as `haptical simulate` does: of a hand's motion for `seconds` at `rate_hz`, or at
    single `poses` (readings by columns), where the rig `measure` is read.

    The true device is `truth`, or `device` with numbers that are off by the share `deviate` of their plausible errors, or
    `device` itself. `effects` adds effects to a motion: the text of an effects.toml, or its `[[effect]]` tables.

    `result.log` is the log by columns, as `identify` takes it; `result.truth` the true device.

    Raises ValueError for bad input.
    """
    if effects is not None and not isinstance(effects, str):
        effects = "\n".join(_effect(table) for table in effects)
    with _watched(progress, "simulating") as watch:
        found = _haptical.simulate(
            device,
            None if poses is None else _columns(poses),
            measure=measure,
            truth=truth,
            deviate=deviate,
            effects=effects,
            seconds=seconds,
            rate_hz=rate_hz,
            seed=seed,
            progress=watch,
            base=base,
            tip=tip,
            rig=rig,
        )
    return Simulation(found)


def _effect(table: Mapping[str, Any]) -> str:
    """One effect of an effects.toml."""
    lines = (f"{key} = {_json.dumps(value)}" for key, value in table.items())
    return "[[effect]]\n" + "\n".join(lines)


def correct(
    device: Union[Device, Source],
    model: Union[Device, Source],
    waypoints: Log,
    *,
    match_: Match = "auto",
    within_m: float = 1e-6,
    within_rad: float = 1e-6,
    progress: Progress = None,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Correction:
    """The commands that make the corrected arm `model` go where a path of `device` wants it, as `haptical correct` does.

    `waypoints` are readings by columns (their poses are those of the nominal `device`), or poses of the handle `x_m`, `y_m`, `z_m`,
    with `qw`, `qx`, `qy`, `qz` or without, in the frame of the base; with both the poses are wanted and the search starts from
    the readings. `commands` [N, n] are the readings to command, `before_m` how far the path's own would be off, `rest_m` what is
    left; `path` is the table that the command writes.

    Raises ValueError for waypoints out of reach, with their rows.
    """
    with _watched(progress, "correcting") as watch:
        found = _haptical.correct(
            device,
            model,
            _columns(waypoints),
            match_=match_,
            within_m=within_m,
            within_rad=within_rad,
            progress=watch,
            base=base,
            tip=tip,
            rig=rig,
        )
    return Correction(found)


def export(
    device: Union[Device, Source],
    format: Form,
    *,
    urdf: Optional[str] = None,
    mjcf: Optional[str] = None,
    new_joints: bool = False,
    for_: Optional[Program] = None,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> str:
    """The text of a device for a control loop, a simulator, a planner or ROS 2, as `haptical export` writes it.

    `urdf` or `mjcf` is the file that the device came from, whose text is corrected; `base` and `tip` say where its chain ran.
    `for_` is the program that reads a URDF. What the form does not hold is warned of (`warnings`).

    Raises ValueError for a device that the form cannot hold.
    """
    import warnings

    text, told = _haptical.export(
        device, format, urdf=urdf, mjcf=mjcf, new_joints=new_joints, for_=for_, base=base, tip=tip, rig=rig
    )
    for one in told:
        warnings.warn(one, stacklevel=2)
    return text


def effects() -> list[Record]:
    """The effects that can be named and be part of a device: `name`, `meaning`, where it `enters`, what it needs (one list of `needs_any`), its
    `parameters` with units and plausible ranges."""
    return [Record(entry) for entry in _haptical.effects()]


def _rows(readings: _npt.ArrayLike, what: str) -> Array:
    if isinstance(readings, dict):
        raise ValueError(f"the {what} are a dictionary; give an array [N, n], a column for each of `Device.columns`")
    rows = _np.atleast_2d(_np.asarray(readings, dtype=_np.float64))
    if rows.ndim != 2:
        raise ValueError(f"the {what} have {rows.ndim} dimensions; give one row for each posture")
    return rows


def joint_values(
    device: Union[Device, Source],
    readings: _npt.ArrayLike,
    *,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Array:
    """Values of the joints behind their transmissions [N, n], in rad (m where one slides), from readings [N, n] or [n]."""
    return _haptical.joint_values(device, _rows(readings, "readings"), base=base, tip=tip, rig=rig)


def jacobian(
    device: Union[Device, Source],
    readings: _npt.ArrayLike,
    *,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Array:
    """Derivatives of the handle's pose by each reading [N, 6, n], transmissions included: three rows of the way [m/rad], three
    of the turn [rad/rad], in frame (-1)."""
    return _haptical.jacobian(device, _rows(readings, "readings"), base=base, tip=tip, rig=rig)


def torques(
    device: Union[Device, Source],
    readings: _npt.ArrayLike,
    velocities: Optional[_npt.ArrayLike] = None,
    accelerations: Optional[_npt.ArrayLike] = None,
    *,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Array:
    """Torques of the drives [N, n] in N m (N where one slides): those that hold the arm's masses at rest, or with
    `velocities` or `accelerations` [N, n] those of the motion, for which every link has its mass and inertia. Friction is not
    among them.

    Raises ValueError for a device without masses.
    """
    return _haptical.torques(
        device,
        _rows(readings, "readings"),
        None if velocities is None else _rows(velocities, "velocities"),
        None if accelerations is None else _rows(accelerations, "accelerations"),
        base=base,
        tip=tip,
        rig=rig,
    )


def forward_kinematics(
    device: Union[Device, Source],
    readings: _npt.ArrayLike,
    *,
    effects: bool = False,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> tuple[Array, Array]:
    """Handle positions [N, 3] in m and rotations [N, 3, 3] in frame (-1).

    `readings` are the motor-side readings [N, n] of the n joints, in rad (m where a joint slides); one posture
    may be given as [n]. Transmission errors of the device are in the model. With `effects` so is what the arm yields at rest under
    its masses, and every effect of the device that depends on the posture alone; what is left out is warned of.

    Raises ValueError for readings that are not finite, or of another number of joints.
    """
    rows = _rows(readings, "readings")
    return _haptical.forward_kinematics(device, rows, effects=effects, base=base, tip=tip, rig=rig)
