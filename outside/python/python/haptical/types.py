"""Types of what the functions take and give."""

from __future__ import annotations

import os
from typing import Any, List, Literal, Mapping, Optional, Sequence, TypedDict, Union

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
"""Array of numbers."""

Source = Union[str, "os.PathLike[str]", Mapping[str, Any]]
"""A path (.toml, .urdf), the text of a TOML file, or a dictionary with its keys."""

Log = Union[str, "os.PathLike[str]", Mapping[str, Union[npt.ArrayLike, Sequence[Optional[str]]]]]
"""A path (CSV, gzip, Parquet, MCAP), or columns by name: arrays with one number or text for each row; NaN and
None are no readings."""

Method = Literal["joint", "two-step"]
Noise = Literal["estimated", "stated"]
Loss = Literal["auto", "squares", "huber", "cauchy", "tukey", "student-t"]
Effect = Literal["joint-compliance"]
Criterion = Literal["d", "a", "o1", "task-position", "task-force"]
Spread = Literal["uniform", "normal"]


class Parameters(TypedDict):
    """Candidates for identification; P of them. NaN stands for "none": the data do not fix the parameter."""

    name: List[str]
    key: List[str]
    """Key in the device file."""
    unit: List[str]
    nominal: Array
    """Values in the given device, [P]."""
    value: Array
    """Identified values, [P]."""
    standard_deviation: Array
    ci95: Array
    """95 % intervals, [P, 2]."""
    status: List[Literal["identifiable", "weak", "invisible", "dependent"]]
    reason: List[Optional[str]]
    """Why the data do not fix the parameter."""


class Channel(TypedDict):
    """Residuals of one channel in its unit, before and after."""

    unit: str
    joint: Optional[int]
    """Joint, from 1, of an external encoder."""
    readings: int
    rms_before: float
    rms_after: float
    noise_floor: float
    reduction_percent: Optional[float]
    rows: npt.NDArray[np.int64]
    """Rows of the log, from 0."""
    before: Array
    after: Array


class LossUsed(TypedDict):
    """What large residuals cost in the end."""

    used: Literal["squares", "huber", "cauchy", "tukey", "student-t"]
    rounds: int
    """Reweighted fits; 0 for least squares."""
    settled: bool


class Outliers(TypedDict):
    """Readings that noise does not explain, farthest first, where a robust loss was used; K of them."""

    line: npt.NDArray[np.int64]
    """Lines of the log; the first row is line 2, as in a CSV log."""
    channel: List[str]
    residual: Array
    """Model minus measurement in the channel's unit, [K]; the length for positions and orientations."""
    deviations: Array
    """The same in standard deviations of the good readings, [K]."""


class Identification(TypedDict):
    """What `identify` gives."""

    parameters: Parameters
    channels: dict[str, Channel]
    """On rows that the fit did not see; on those of the fit where none were held out."""
    channels_fit: dict[str, Channel]
    held_out: str
    rows: int
    rank: int
    candidates: int
    iterations: int
    loss: LossUsed
    outliers: Outliers
    warnings: List[str]
    identified_toml: str
    """A device file with the identified values."""


class ParametersTold(TypedDict):
    """What a rig tells of P parameters."""

    name: List[str]
    unit: List[str]
    plausible_size: Array
    """Plausible sizes of the deviations from nominal, [P]."""
    status: List[Literal["identifiable", "weak", "combination", "invisible"]]
    standard_deviation: Array
    """Standard deviations (Cramér-Rao), [P]; NaN for a combination and an invisible parameter."""
    reason: List[Optional[str]]
    """Why the rig does not identify the parameter."""


class Remedy(TypedDict):
    """A further measurement that identifies a parameter."""

    measure: str
    standard_deviation: float


class Suggestion(TypedDict):
    """A parameter that a rig does not identify, and what would."""

    parameter: str
    unit: str
    reason: str
    not_told_from: List[str]
    remedies: List[Remedy]
    """Best first; empty where nothing that was tried identifies it."""


class RigTells(TypedDict):
    """What one rig tells."""

    measure: str
    readings_per_pose: int
    rank: int
    parameters: ParametersTold
    suggestions: List[Suggestion]


class Figures(TypedDict):
    """What a set of poses tells, in figures without units."""

    geometric_mean_sd: float
    """Geometric mean of the standard deviations over plausible sizes."""
    o1: float
    """Observability index O1."""
    root_mean_square: Optional[float]
    """Root of a quadratic criterion: sd over plausible size for "a", position error in m, angle of force in rad."""


class Predicted(TypedDict):
    """Standard deviations that the chosen poses give the parameters that the rig identifies."""

    name: List[str]
    unit: List[str]
    plausible_size: Array
    standard_deviation: Array


class NextPoses(TypedDict):
    """The chosen poses."""

    measure: str
    criterion: Criterion
    count: int
    candidates: int
    figures: Figures
    random: Optional[Figures]
    """Medians over random choices of as many candidates."""
    exchanges: int
    parameters: Predicted
    readings: Array
    """The joints' readings, [count, n], in rad (m where a joint slides), each pose near the one before."""
    contact: Optional[List[str]]
    """The socket that the handle sits in at each pose."""
    plane: Optional[List[str]]
    """The plane that it touches at each pose."""


class Plan(TypedDict):
    """What `plan` gives."""

    poses: int
    """Number of poses that the rigs' standard deviations are for."""
    measured_poses: int
    rigs: List[RigTells]
    next_poses: Optional[NextPoses]
    """None where no poses were asked for."""
    warnings: List[str]
