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
    warnings: List[str]
    identified_toml: str
    """A device file with the identified values."""
