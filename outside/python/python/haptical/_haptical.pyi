"""The compiled module; `haptical` is what to import."""

from typing import List, Mapping, Optional, Sequence, Union, final

import numpy.typing as npt

from .types import Array, Criterion, Effect, Identification, Log, Loss, Method, Noise, Plan, Replay, Source, Spread

__all__ = ["Device", "HapticalError", "__version__", "diagnose", "forward_kinematics", "identify", "plan", "replay"]

__version__: str

class HapticalError(Exception):
    """The numbers are sound, but nothing can be identified from them."""

@final
class Device:
    """A device, read once and used many times; what other functions take in the place of a file."""

    def __new__(
        cls, source: Source, *, base: Optional[str] = None, tip: Optional[str] = None, rig: Optional[Source] = None
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
    base: Optional[str] = None,
    tip: Optional[str] = None,
    rig: Optional[Source] = None,
) -> Identification: ...
def diagnose(
    device: Union[Device, Source],
    log: Log,
    *,
    model: Union[Device, Source, None] = None,
    validate: Optional[Log] = None,
    without: Sequence[str] = ...,
    with_: Sequence[Effect] = ...,
    hold: Sequence[str] = ...,
    deviation: Mapping[str, float] = ...,
    loss: Loss = ...,
    base: Optional[str] = None,
    tip: Optional[str] = None,
    rig: Optional[Source] = None,
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
    log: Optional[Log] = None,
    base: Optional[str] = None,
    tip: Optional[str] = None,
    rig: Optional[Source] = None,
) -> Plan: ...
def replay(
    device: Union[Device, Source],
    log: Log,
    *,
    base: Optional[str] = None,
    tip: Optional[str] = None,
    rig: Optional[Source] = None,
) -> Replay: ...
def forward_kinematics(
    device: Union[Device, Source],
    readings: Array,
    *,
    base: Optional[str] = None,
    tip: Optional[str] = None,
    rig: Optional[Source] = None,
) -> tuple[Array, Array]: ...
