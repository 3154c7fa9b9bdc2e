"""Calibration of robots from their own logs: identification, diagnosis, forward kinematics.

Numbers are in SI units; columns of logs and keys of device files are those of the command `haptical`.
Bad input is a ValueError that says what, where and what to do; `HapticalError` says that sound numbers fix
nothing. The interpreter's lock is released while numbers are worked out.
"""

from __future__ import annotations

import json as _json
from typing import TYPE_CHECKING, Any, Optional, Sequence, Union

import numpy as _np

from . import _haptical
from ._haptical import Device, HapticalError, __version__

if TYPE_CHECKING:
    import numpy.typing as _npt

    from .types import Array, Identification, Log, Loss, Method, Noise, Source

__all__ = ["Device", "HapticalError", "__version__", "diagnose", "forward_kinematics", "identify"]


def identify(
    device: Union[Device, Source],
    log: Log,
    *,
    method: Method = "joint",
    held_out: float = 0.2,
    degree: Union[int, str] = "evidence",
    noise: Noise = "estimated",
    loss: Loss = "squares",
    tip: Optional[str] = None,
    rig: Optional[Source] = None,
) -> Identification:
    """Identify the parameters of `device` from `log`, as `haptical identify` does.

    Arguments have the names, the meaning and the defaults of the command's flags; `rig` holds the sensors
    around the device, `tip` is the link at which the chain of a URDF ends.

    Raises ValueError for bad input, HapticalError where nothing can be identified.
    """
    return _haptical.identify(
        device,
        log,
        method=method,
        held_out=held_out,
        degree=degree,
        noise=noise,
        loss=loss,
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
    tip: Optional[str] = None,
    rig: Optional[Source] = None,
) -> dict[str, Any]:
    """Identify, then say which effect causes what is left: the fields of gap.json, as `haptical diagnose`.

    `model` is a device identified earlier, `validate` a second log on which the shrink is measured, `without`
    names effects to leave out.

    Raises ValueError for bad input, HapticalError where nothing can be identified.
    """
    text = _haptical.diagnose(
        device, log, model=model, validate=validate, without=list(without), tip=tip, rig=rig
    )
    answer: dict[str, Any] = _json.loads(text)
    return answer


def forward_kinematics(
    device: Union[Device, Source],
    readings: _npt.ArrayLike,
    *,
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
    return _haptical.forward_kinematics(device, rows, tip=tip, rig=rig)
