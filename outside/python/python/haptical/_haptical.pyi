"""The compiled module; `haptical` is what to import."""

import os
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union, final

import numpy.typing as npt

from .types import Array, Criterion, Effect, Form, Log, Loss, Match, Method, Noise, Program, Source, Spread, Tip

__all__ = [
    "Device",
    "HapticalError",
    "__version__",
    "command",
    "correct",
    "diagnose",
    "doctor",
    "effects",
    "export",
    "forward_kinematics",
    "identify",
    "jacobian",
    "joint_values",
    "plan",
    "replay",
    "simulate",
    "torques",
]

__version__: str

class HapticalError(Exception):
    """The numbers are sound, but nothing can be identified from them."""

@final
class Device:
    """A device, read once and used many times; what other functions take in the place of a file."""

    def __new__(
        cls, source: Source, *, base: Optional[str] = None, tip: Tip = None, rig: Optional[Source] = None
    ) -> Device: ...
    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> int: ...
    @property
    def columns(self) -> List[str]: ...
    @property
    def warnings(self) -> List[str]: ...
    def to_toml(self) -> str: ...

def identify(
    device: Union[Device, Source],
    log: Log,
    *,
    method: Method = "joint",
    held_out: float = 0.2,
    folds: Optional[int] = None,
    with_: Sequence[Effect] = ...,
    hold: Sequence[str] = ...,
    deviation: Mapping[str, float] = ...,
    degree: Union[int, str, None] = None,
    noise: Noise = "estimated",
    loss: Loss = "auto",
    validate: Optional[Log] = None,
    band_hz: Optional[float] = None,
    input_drum_denominator_m: Optional[float] = None,
    paper_preset: bool = False,
    progress: Optional[Callable[[float], None]] = None,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Dict[str, Any]: ...
def diagnose(
    device: Union[Device, Source],
    log: Union[Log, Sequence[Log]],
    *,
    model: Union[Device, Source, None] = None,
    validate: Optional[Log] = None,
    without: Sequence[str] = ...,
    with_: Sequence[Effect] = ...,
    hold: Sequence[str] = ...,
    deviation: Mapping[str, float] = ...,
    loss: Loss = "auto",
    repair: bool = False,
    progress: Optional[Callable[[float], None]] = None,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Tuple[str, Dict[str, bytes]]: ...
def doctor(
    path: "str | os.PathLike[str]",
    *,
    units: Optional[str] = None,
    state: Optional[str] = None,
    action: Optional[str] = None,
) -> str: ...
def plan(
    device: Union[Device, Source],
    measure: Sequence[str],
    *,
    poses: Optional[int] = None,
    criterion: Criterion = "d",
    region: Optional[npt.ArrayLike] = None,
    candidates: Optional[int] = None,
    seed: Optional[int] = None,
    spread: Spread = "uniform",
    workspace: Optional[npt.ArrayLike] = None,
    cable_length: Optional[npt.ArrayLike] = None,
    link_radius: Optional[float] = None,
    known_transmissions: bool = False,
    log: Union[Log, Sequence[Log], None] = None,
    settle: Any = None,
    rows: Optional[int] = None,
    press: Optional[float] = None,
    progress: Optional[Callable[[float], None]] = None,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Dict[str, Any]: ...
def replay(
    device: Union[Device, Source],
    log: Log,
    *,
    progress: Optional[Callable[[float], None]] = None,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Dict[str, Any]: ...
def simulate(
    device: Union[Device, Source],
    poses: Optional[Log] = None,
    *,
    measure: Optional[str] = None,
    truth: Union[Device, Source, None] = None,
    deviate: Optional[float] = None,
    effects: Optional[str] = None,
    seconds: float = 100.0,
    rate_hz: float = 1000.0,
    seed: int = 1,
    progress: Optional[Callable[[float], None]] = None,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Dict[str, Any]: ...
def command(words: Sequence[str]) -> int: ...
def correct(
    device: Union[Device, Source],
    model: Union[Device, Source],
    waypoints: Log,
    *,
    match_: Match = "auto",
    within_m: float = 1e-6,
    within_rad: float = 1e-6,
    progress: Optional[Callable[[float], None]] = None,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Dict[str, Any]: ...
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
) -> Tuple[str, List[str]]: ...
def effects() -> List[Dict[str, Any]]: ...
def forward_kinematics(
    device: Union[Device, Source],
    readings: Array,
    *,
    effects: bool = False,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Tuple[Array, Array]: ...
def joint_values(
    device: Union[Device, Source],
    readings: Array,
    *,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Array: ...
def jacobian(
    device: Union[Device, Source],
    readings: Array,
    *,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Array: ...
def torques(
    device: Union[Device, Source],
    readings: Array,
    velocities: Optional[Array] = None,
    accelerations: Optional[Array] = None,
    *,
    base: Optional[str] = None,
    tip: Tip = None,
    rig: Optional[Source] = None,
) -> Array: ...
