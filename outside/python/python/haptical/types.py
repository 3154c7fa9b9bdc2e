"""Types of what the functions take and give."""

from __future__ import annotations

import os
from typing import Any, Callable, Dict, List, Literal, Mapping, Optional, Protocol, Sequence, Tuple, TypedDict, Union

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
"""Array of numbers."""

Source = Union[str, "os.PathLike[str]", Mapping[str, Any]]
"""A path (.toml, .urdf), the text of a TOML file, or a dictionary with its keys."""

class Frame(Protocol):
    """A frame of pandas or polars: columns by name."""

    @property
    def columns(self) -> Any: ...
    def __getitem__(self, name: Any, /) -> Any: ...


class Table(Protocol):
    """A table of pyarrow."""

    @property
    def column_names(self) -> List[str]: ...


Log = Union[
    str, "os.PathLike[str]", Mapping[str, Union[npt.ArrayLike, Sequence[Optional[str]]]], Frame, Table, npt.NDArray[np.void]
]
"""A path (CSV, gzip, Parquet, MCAP), or columns by name: arrays with one number or text for each row, a frame of pandas or
polars, a table of pyarrow, a structured array; NaN and None are no readings."""

Progress = Union[None, bool, Callable[[float], None]]
"""True shows the seconds on standard error; a function is called with them, some twenty times a second."""

Tip = Union[None, str, Sequence[str]]
"""The link at which the chain of a URDF ends, or one for each hand."""

Method = Literal["joint", "two-step"]
Noise = Literal["estimated", "stated"]
Loss = Literal["auto", "squares", "huber", "cauchy", "tukey", "student-t"]
Effect = str
"""`EFFECT` or `EFFECT@JOINT` of `haptical.effects()`, a path of a gap.json, or for `identify` the word "dynamics"."""
Match = Literal["auto", "pose", "position"]
Form = Literal["rust", "c-header", "json", "toml", "urdf", "mjcf", "ros2-control", "kinematics-yaml"]
Program = Literal["pinocchio", "drake", "isaac", "moveit"]
Criterion = Literal["d", "a", "o1", "task-position", "task-force"]
Spread = Literal["uniform", "normal"]
Status = Literal["identifiable", "combination", "weak", "invisible", "dependent", "held"]
Convergence = Literal[
    "small-cost-change", "small-step", "exact-fit", "no-further-descent", "iteration-limit", "rank-lost"
]


class Term(TypedDict):
    """A change of a parameter that acts like a unit change of a dependent one, together with the other terms."""

    parameter: int
    """Position among the candidates of the fit."""
    name: str
    coefficient: float


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
    deviation: Array
    """Identified minus nominal values, [P]."""
    standard_deviation: Array
    ci95: Array
    """95 % intervals, [P, 2]; `Identification.intervals` says how they were made."""
    plausible_size: Array
    """Sizes that deviations may plausibly have, [P]."""
    status: List[Status]
    combination: List[Optional[List[Term]]]
    """For a dependent parameter: what acts like a unit change of it."""
    reason: List[Optional[str]]
    """Why the data do not fix the parameter."""


class NotIdentified(TypedDict):
    """A candidate that kept its nominal value."""

    name: str
    status: Status
    reason: str


class Channel(TypedDict):
    """Residuals of one channel in its unit, before and after."""

    channel: str
    joint: Optional[int]
    """Joint, from 1, of an external encoder."""
    unit: str
    readings: int
    outside_range: int
    """Readings left out, because a polynomial was outside its range there."""
    rms_before: float
    sd_before: float
    rms_after: float
    sd_after: float
    rms_before_good: float
    """As `rms_before`, outliers left out."""
    rms_after_good: float
    """As `rms_after`, outliers left out."""
    outliers: int
    noise_floor: float
    """Root mean square of the stated noise, quantization included."""
    reduction_percent: Optional[float]
    """Share of the gap that was closed, noise taken out; None where there was no gap."""
    reduction_percent_good: Optional[float]
    """As `reduction_percent`, outliers left out."""
    rows: npt.NDArray[np.int64]
    """Rows of the log, from 0."""
    before: Array
    after: Array


class TransmissionForm(TypedDict, total=False):
    """A form of the transmission error; `degree` stands beside "polynomial" alone."""

    form: Literal[
        "none",
        "offset",
        "offset-ratio",
        "offset-eccentricity",
        "offset-ratio-eccentricity",
        "capstan",
        "zeroed-capstan",
        "polynomial",
    ]
    degree: int


class Evidence(TypedDict):
    """One form with its evidence; lower criteria are better."""

    terms: TransmissionForm
    parameters: int
    rms: float
    leave_one_out_rms: float
    aicc: float
    bic: float


class Observability(TypedDict):
    """Observability indices, larger is better: Borm & Menq's o1 to Sun & Hollerbach's o5."""

    o1: float
    o2: float
    o3: float
    o4: float
    o5: float


class Rank(TypedDict):
    """Rank and conditioning of the derivative matrix.

    A device without links has one problem for each transmission: then ranks and candidates are sums, and the
    figures of a single matrix are None.
    """

    rank: int
    candidates: int
    singular_rank: int
    """Rank by the singular values of the unit-norm columns; another one than `rank` where the data are on the edge."""
    condition_unit_norm: Optional[float]
    singular_values: Array
    """Of the visible columns at unit norm, largest first; empty where there is none to show."""
    gap: Optional[Array]
    """Remainders between which the rank's tolerance lies, [2]: smallest kept, largest dropped."""
    observability: Optional[Observability]


class Identifiability(Rank):
    """Rank and conditioning at the solution, and at the given device."""

    at_nominal: Rank


class Transmission(TypedDict):
    """One transmission with an external encoder."""

    joint: int
    """From 1."""
    terms: TransmissionForm
    range_rad: Array
    """Lowest and highest reading that the form was found from, [2]."""
    evidence: List[Evidence]
    """Forms that were weighed; empty where the form was given."""
    convergence: Optional[Convergence]
    parameters: Parameters
    """Those of this joint, from the last fit."""
    polynomial_monomials: Optional[Array]
    """Powers k0 .. kn of the angle that equal the polynomial, in rad/rad^i; None for another form."""
    identifiability: Optional[Rank]
    """Of the transmission's own fit to its external encoder."""


class Intervals(TypedDict):
    """How the intervals in `ci95` were made: for the whole fit, or for the first transmission without one."""

    level: float
    kind: str
    """In words: which distribution, by which noise."""
    degrees_of_freedom: int
    considered: List[str]
    """Parameters that were not fitted and whose plausible errors widen the intervals."""
    checked: bool
    """Whether the ends were compared with the sum of squares there; not for very many readings."""
    profile_likelihood: List[str]
    """Parameters whose interval is by profile likelihood, because the linearised one differs."""
    open: List[str]
    """Those of them without an end on one side or both, and so without an interval."""


class Search(TypedDict):
    """Searches from other places than the device's own values, where the first one was doubted."""

    doubt: Optional[str]
    """Why the first search was doubted; None where it was not, and then no other place was tried."""
    doubt_that_remains: Optional[str]
    """Why the fit that was kept is doubted still."""
    tried: int
    reached_best: int
    """How many of the random places led to the lowest minimum that any reached."""
    replaced: bool
    """Whether a random place led to the fit that was kept."""
    rivals: int
    """How many places led to other plausible values that fit as well."""
    seed: int


class ForceDirection(TypedDict):
    """How far the force of the calibrated device may still lean from the wanted direction."""

    rms_rad: float
    ci95_rad: Array
    """95 % interval of `rms_rad` by the parameters' covariance, [2]."""
    postures: int
    left_out: int
    """Postures of the log that are nearly singular."""
    locked_joint: Optional[int]
    """Joint, from 1, taken as locked, of a device with seven."""
    open_through: List[str]
    """Parameters that the log does not fix and that turn the force: no figure above contains them."""
    rms_with_open_rad: float
    """The same angle if those err by their plausible sizes as well."""


class ChannelNoise(TypedDict):
    """Noise of a channel."""

    stated: float
    """Standard deviation by the device file, in the channel's unit."""
    factor: float
    """Factor on it that the residuals show and the fit used."""


class RobustScale(TypedDict):
    """Noise of a channel by its good readings."""

    channel: str
    scale: float
    """Standard deviation; of an axis for positions and orientations."""
    variance_factor: float


class LossUsed(TypedDict):
    """What large residuals cost in the end."""

    used: Literal["squares", "huber", "cauchy", "tukey", "student-t"]
    rounds: int
    """Reweighted fits; 0 for least squares."""
    settled: bool
    scales: List[RobustScale]
    """Empty for least squares."""


class Outliers(TypedDict):
    """Readings that noise does not explain, farthest first, where a robust loss was used; K of them."""

    line: npt.NDArray[np.int64]
    """Lines of the log; the first row is line 2, as in a CSV log."""
    channel: List[str]
    residual: Array
    """Model minus measurement in the channel's unit, [K]; the length for positions and orientations."""
    deviations: Array
    """The same in standard deviations of the good readings, [K]."""


class Summand(TypedDict):
    """One parameter of a combination."""

    name: str
    coefficient: float
    """In the unit of the sum over the parameter's own."""


class Combination(TypedDict):
    """A sum that the data fix, where they do not fix its first parameter alone."""

    terms: List[Summand]
    unit: str
    value: float
    standard_deviation: float
    ci95: Tuple[float, float]


class Moved(TypedDict):
    """How far a number is from the given device's; of a URDF's arm a shift or a turn of a joint's origin."""

    name: str
    unit: str
    deviation: float
    ci95: Tuple[float, float]
    plausible_size: float
    """Entries are in the order of the deviation over it, the largest first."""


class Identification(TypedDict):
    """What `identify` gives: the fields of identified.json, the device file, and no record of files."""

    answer: str
    """The result in a line."""
    method: Method
    rows: int
    held_out: str
    """Which rows the fit did not see, in words."""
    convergence: Optional[Convergence]
    iterations: int
    channels: dict[str, Channel]
    """On rows that the fit did not see; on those of the fit where none were held out."""
    channels_fit: dict[str, Channel]
    transmissions: List[Transmission]
    parameters: Parameters
    moved: List[Moved]
    """Those that moved most first."""
    combinations: List[Combination]
    not_identified: List[NotIdentified]
    intervals: Optional[Intervals]
    """None where nothing was fitted."""
    search: Optional[Search]
    """None where nothing but transmissions was fitted."""
    identifiability: Identifiability
    correlations_above_0_95: List[Tuple[str, str, float]]
    """Pairs of parameters whose errors go together, the highest correlation first."""
    force_direction: Optional[ForceDirection]
    """None where the device or the log does not tell."""
    noise: dict[str, ChannelNoise]
    """By channel."""
    loss: LossUsed
    outliers: Outliers
    warnings: List[str]
    """About the device file, the log and the result, in this order."""
    rank: int
    """That of `identifiability`."""
    candidates: int
    identified_toml: str
    """A device file with the identified values."""


class ParametersTold(TypedDict):
    """What a rig tells of P parameters."""

    name: List[str]
    unit: List[str]
    plausible_size: Array
    """Plausible sizes of the deviations from nominal, [P]."""
    status: List[Status]
    standard_deviation: Array
    """Standard deviations (Cramér-Rao), [P]; NaN for a dependent and an invisible parameter."""
    reason: List[Optional[str]]
    """Why the rig does not identify the parameter."""


class Remedy(TypedDict):
    """A further measurement that identifies a parameter."""

    measure: str
    instead_of: Optional[str]
    """The measurement of the rig in whose place it is; none where it is one more."""
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


class ReplayedChannel(TypedDict):
    """What a model predicts of one channel, beside what was measured."""

    channel: str
    unit: str
    readings: int
    rms: float
    """Root mean square of the residuals of one axis."""
    noise_floor: float
    """The same of the noise that the device file states."""
    rows: Array
    """Rows of the log [N], from 0."""
    residuals: Array
    """Prediction minus measurement [N, axes]."""


class Replay(TypedDict):
    """What `replay` gives."""

    channels: Dict[str, ReplayedChannel]
    warnings: List[str]
