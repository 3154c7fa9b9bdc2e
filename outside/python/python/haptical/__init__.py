"""Calibration of robots from their own logs: identification, diagnosis, planning, replay, forward kinematics.

Numbers are in SI units; columns of logs and keys of device files are those of the command `haptical`.
Bad input is a ValueError that says what, where and what to do; `HapticalError` says that sound numbers fix
nothing. The interpreter's lock is released while numbers are worked out.
"""

from __future__ import annotations

import json as _json
from typing import TYPE_CHECKING, Any, Mapping, Optional, Sequence, Union

import numpy as _np

from . import _haptical
from ._haptical import Device, HapticalError, __version__

if TYPE_CHECKING:
    import numpy.typing as _npt

    from .types import Array, Criterion, Effect, Identification, Log, Loss, Method, Noise, Plan, Replay, Source, Spread

__all__ = ["Device", "HapticalError", "__version__", "diagnose", "forward_kinematics", "identify", "plan", "replay"]


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
    base: Optional[str] = None,
    tip: Optional[str] = None,
    rig: Optional[Source] = None,
) -> Identification:
    """Identify the parameters of `device` from `log`, as `haptical identify` does.

    Arguments have the names, the meaning and the defaults of the command's flags: `folds` (2 to 100) takes the
    place of `held_out`, `with_=["joint-compliance"]` fits what joints yield to their torque too, `hold` keeps numbers
    of the links (`["offsets"]`, `["a3"]`), `deviation` says how far such numbers may plausibly be off, in m or rad
    (`{"offsets": 0.06}`), `loss="auto"` is least squares unless single readings lie farther out than noise explains. `rig` holds the sensors around the
    device, `base` and `tip` are the links between which the chain of a URDF runs: without `base` it begins at the
    root link, without both the longest chain is taken.

    The result has the fields of identified.json under the same names: parameters and outliers as columns, channels
    by name and with their residuals, lists of numbers as arrays. `haptical.types.Identification` says what each
    holds.

    Raises ValueError for bad input, HapticalError where nothing can be identified.
    """
    return _haptical.identify(
        device,
        log,
        method=method,
        held_out=held_out,
        folds=folds,
        with_=list(with_),
        hold=list(hold),
        deviation=dict(deviation or {}),
        degree=degree,
        noise=noise,
        loss=loss,
        base=base,
        tip=tip,
        rig=rig,
    )


def diagnose(
    device: Union[Device, Source],
    log: Log,
    *,
    model: Union[Device, Source, None] = None,
    validate: Optional[Log] = None,
    without: Sequence[str] = (),
    with_: Sequence[Effect] = (),
    hold: Sequence[str] = (),
    deviation: Optional[Mapping[str, float]] = None,
    loss: Loss = "auto",
    base: Optional[str] = None,
    tip: Optional[str] = None,
    rig: Optional[Source] = None,
) -> dict[str, Any]:
    """Identify, then say which effect causes what is left: the fields of gap.json, as `haptical diagnose`, and
    `corrected_toml`, the device with the causes as effects (None where no cause is part of a device).

    `model` is a device identified earlier, `validate` a second log on which the shrink is measured, `without`
    names effects to leave out. `with_`, `hold`, `deviation` and `loss` are those of `identify`, for the model that
    the gap is measured from.

    Raises ValueError for bad input, HapticalError where nothing can be identified.
    """
    text = _haptical.diagnose(
        device,
        log,
        model=model,
        validate=validate,
        without=list(without),
        with_=list(with_),
        hold=list(hold),
        deviation=dict(deviation or {}),
        loss=loss,
        base=base,
        tip=tip,
        rig=rig,
    )
    answer: dict[str, Any] = _json.loads(text)
    return answer


def plan(
    device: Union[Device, Source],
    measure: Union[str, Sequence[str]] = (),
    *,
    poses: Optional[int] = None,
    criterion: Criterion = "d",
    region: Optional[_npt.ArrayLike] = None,
    candidates: int = 2000,
    seed: int = 1,
    spread: Spread = "uniform",
    workspace: Optional[_npt.ArrayLike] = None,
    cable_length: Optional[_npt.ArrayLike] = None,
    link_radius: Optional[float] = None,
    known_transmissions: bool = False,
    log: Optional[Log] = None,
    base: Optional[str] = None,
    tip: Optional[str] = None,
    rig: Optional[Source] = None,
) -> Plan:
    """Say which rig tells which parameters, and choose the poses to measure next, as `haptical plan` does.

    `measure` are rigs to compare, each a text as "out,cable2:0.4,0,0.3" (`haptical plan --help` has the kinds);
    without it what the device describes, beside a position and a pose. `poses` is how many poses to choose for
    the first rig; without it none are chosen, and standard deviations are for 200. They are chosen among
    `candidates` so that the `criterion` is best, where a task's criterion is about a `region`: a ball x, y, z, r
    in m, [4], or low and high of each joint's reading, [n, 2].

    Limits of the poses: `workspace`, lowest and highest x, y, z of the handle in frame (-1) in m, [2, 3];
    `cable_length`, shortest and longest length of every cable in m; `link_radius` in m. `spread` is how
    candidates lie between the joint limits. `known_transmissions` takes the transmissions as known. `log` holds
    poses that were measured with the first rig already: those chosen add to them.

    Raises ValueError for bad input, HapticalError for a rig that identifies nothing.
    """
    return _haptical.plan(
        device,
        [measure] if isinstance(measure, str) else list(measure),
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
        log=log,
        base=base,
        tip=tip,
        rig=rig,
    )


def replay(
    device: Union[Device, Source],
    log: Log,
    *,
    base: Optional[str] = None,
    tip: Optional[str] = None,
    rig: Optional[Source] = None,
) -> Replay:
    """Run the motion, the loads and the times of `log` through `device` with its effects, without fitting anything,
    as `haptical simulate --replay` does.

    `channels` has, by name ("out2", "cable", "position"), `unit`, `rms` and `noise_floor` of one axis, `rows` [N] and
    `residuals` [N, axes], prediction minus measurement; of an orientation the rotation vector in rad.

    Raises ValueError for bad input.
    """
    return _haptical.replay(device, log, base=base, tip=tip, rig=rig)


def forward_kinematics(
    device: Union[Device, Source],
    readings: _npt.ArrayLike,
    *,
    base: Optional[str] = None,
    tip: Optional[str] = None,
    rig: Optional[Source] = None,
) -> tuple[Array, Array]:
    """Handle positions [N, 3] in m and rotations [N, 3, 3] in frame (-1).

    `readings` are the motor-side readings [N, n] of the n joints, in rad (m where a joint slides); one posture
    may be given as [n]. Transmission errors of the device are in the model.

    Raises ValueError for readings that are not finite, or of another number of joints.
    """
    rows = _np.atleast_2d(_np.asarray(readings, dtype=_np.float64))
    if rows.ndim != 2:
        raise ValueError(f"the readings have {rows.ndim} dimensions; give one row for each posture")
    return _haptical.forward_kinematics(device, rows, base=base, tip=tip, rig=rig)
