"""Results: dictionaries as ever, whose keys are attributes too, with a report in a notebook, tables and figures."""

from __future__ import annotations

import csv as _csv
import html as _html
import io as _io
import pathlib as _pathlib
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Optional

import numpy as _np

from ._haptical import Device
from .frames import missing_package as _missing

if TYPE_CHECKING:
    import os

    from .types import Array

__all__ = ["Columns", "Correction", "Diagnosis", "Fleet", "Identification", "Plan", "Record", "Replay", "Result", "Simulation"]


#: Rows of a table that a notebook shows.
_SHOWN = 60


class Record(dict[str, Any]):
    """A dictionary whose keys are attributes too: `result.intervals.level`."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            known = ", ".join(str(key) for key in self)
            raise AttributeError(f"there is no `{name}`; there are: {known}") from None

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *(key for key in self if key.isidentifier())})


class Columns(Record):
    """A table: a column, an array or a list, under each name."""

    @property
    def rows(self) -> int:
        """Number of rows."""
        return max((len(column) for column in self.values()), default=0)

    def records(self) -> Iterator[Record]:
        """The rows one after the other: `for number in result.parameters.records(): print(number.name, number.value)`."""
        for row in range(self.rows):
            yield Record((name, column[row]) for name, column in self.items())

    def _flat(self) -> dict[str, Any]:
        """Columns of one number or text for each row: an interval [P, 2] becomes `_low` and `_high`."""
        flat: dict[str, Any] = {}
        for name, column in self.items():
            if isinstance(column, _np.ndarray) and column.ndim == 2 and column.shape[1] == 2:
                flat[f"{name}_low"], flat[f"{name}_high"] = column[:, 0], column[:, 1]
            elif isinstance(column, _np.ndarray) and column.ndim > 1:
                flat[name] = list(column)
            else:
                flat[name] = column
        return flat

    def to_pandas(self) -> Any:
        """As a pandas.DataFrame; an interval is two columns, `ci95_low` and `ci95_high`."""
        try:
            import pandas
        except ModuleNotFoundError as missing:
            raise _missing(missing, "frames") from None
        return pandas.DataFrame(self._flat())

    def to_polars(self) -> Any:
        """As a polars.DataFrame; an interval is two columns, `ci95_low` and `ci95_high`."""
        try:
            import polars
        except ModuleNotFoundError as missing:
            raise _missing(missing, "frames") from None
        return polars.DataFrame(self._flat(), strict=False)

    def to_arrow(self) -> Any:
        """As a pyarrow.Table; an interval is two columns, `ci95_low` and `ci95_high`."""
        try:
            import pyarrow
        except ModuleNotFoundError as missing:
            raise _missing(missing, "frames") from None

        def array(column: Any) -> Any:
            # a column without any text is one of texts all the same
            is_empty = isinstance(column, list) and all(cell is None for cell in column)
            return pyarrow.array(column, type=pyarrow.string() if is_empty else None)

        return pyarrow.table({name: array(column) for name, column in self._flat().items()})

    def __repr__(self) -> str:
        return f"<haptical.{type(self).__name__}: {self.rows} rows of {', '.join(self)}>"

    def _repr_html_(self) -> str:
        flat = self._flat()
        head = "".join(f"<th>{_html.escape(name)}</th>" for name in flat)

        def cell(value: Any) -> str:
            if isinstance(value, (float, _np.floating)):
                return "" if value != value else f"{value:.6g}"
            return "" if value is None else _html.escape(str(value))

        lines = ("".join(f"<td>{cell(column[row])}</td>" for column in flat.values()) for row in range(min(self.rows, _SHOWN)))
        body = "".join(f"<tr>{line}</tr>" for line in lines)
        more = f"<p>the first {_SHOWN} of {self.rows} rows</p>" if self.rows > _SHOWN else ""
        # a wide table moves below a narrow page, not with it
        frame = f"<table style='white-space:nowrap'><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
        return f'<div style="overflow-x:auto">{frame}</div>{more}'


def _deep(value: Any) -> Any:
    """The same with records in the place of dictionaries; tables by columns stay what they are."""
    if type(value) is dict:
        is_table = bool(value) and all(isinstance(column, (_np.ndarray, list)) for column in value.values())
        lengths = {len(column) for column in value.values()} if is_table else set()
        kind = Columns if len(lengths) == 1 and "name" in value else Record
        return kind({key: _deep(entry) for key, entry in value.items()})
    if type(value) is list:
        return [_deep(entry) for entry in value]
    return value


class Result(Record):
    """What a function found, under the names of the command's files; `files` are those that the command would write."""

    #: Contents of the files by name, as bytes.
    files: dict[str, bytes]
    #: The file that a notebook shows.
    _page = ""

    def __init__(self, content: Any = (), files: Optional[dict[str, bytes]] = None) -> None:
        content = dict(content)
        own = content.pop("_files", None)
        super().__init__({key: _deep(value) for key, value in content.items()})
        self.__dict__["files"] = files if files is not None else (own or {})

    def __reduce__(self) -> Any:
        return (type(self), (dict(self), self.files))

    def __repr__(self) -> str:
        told = self.get("answer") or f"{len(self)} fields: {', '.join(self)}"
        return f"<haptical.{type(self).__name__}: {told}>"

    @property
    def report_html(self) -> Optional[str]:
        """The report as the command writes it, a page without outside references; None where there is none."""
        page = self.files.get(self._page)
        return None if page is None else page.decode("utf-8")

    def write(self, folder: "str | os.PathLike[str]") -> list[_pathlib.Path]:
        """Write the files of the command into a folder, which is made if it is missing; their paths."""
        place = _pathlib.Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        paths = []
        for name, content in self.files.items():
            (place / name).write_bytes(content)
            paths.append(place / name)
        return paths

    def _repr_html_(self) -> str:
        page = self.report_html
        if page is None:
            return f"<p>{_html.escape(repr(self))}</p>{self.table._repr_html_()}"
        frame = 'style="width:100%;height:42em;border:1px solid #8884" sandbox="allow-scripts"'
        return f'<iframe title="report" srcdoc="{_html.escape(page)}" {frame}></iframe>'

    @property
    def table(self) -> Columns:
        """What it is about, as one table."""
        raise NotImplementedError(f"there is no table of a {type(self).__name__}")

    def to_pandas(self) -> Any:
        """`table` as a pandas.DataFrame."""
        return self.table.to_pandas()

    def to_polars(self) -> Any:
        """`table` as a polars.DataFrame."""
        return self.table.to_polars()

    def to_arrow(self) -> Any:
        """`table` as a pyarrow.Table."""
        return self.table.to_arrow()

    def plot(self) -> Any:
        """A matplotlib figure of it."""
        raise NotImplementedError(f"there is no figure of a {type(self).__name__}")


class Identification(Result):
    """What `identify` found: the fields of identified.json. docs/python.md says what each holds."""

    _page = "identify.html"

    answer: str
    method: str
    rows: int
    rank: int
    candidates: int
    parameters: Columns
    channels: dict[str, Record]
    transmissions: list[Any]
    intervals: Optional[Record]
    search: Optional[Record]
    identifiability: Record
    force_direction: Optional[Record]
    noise: dict[str, Record]
    moved: list[Record]
    combinations: list[Record]
    not_identified: list[Record]
    warnings: list[str]
    identified_toml: str

    @property
    def device(self) -> Device:
        """The identified device."""
        return Device(self["identified_toml"])

    @property
    def table(self) -> Columns:
        """The parameters."""
        return Columns(self["parameters"])

    def plot(self) -> Any:
        """Deviations from nominal with their intervals, and the channels' errors before and after."""
        from . import plots

        return plots.identification(self)


class Diagnosis(Result):
    """What `diagnose` found: the fields of gap.json, and `corrected_toml`."""

    _page = "gap.html"

    answer: str
    verdict: str
    causes: list[Record]
    gap: Record
    unexplained_share: float
    corrected_toml: Optional[str]

    @property
    def device(self) -> Optional[Device]:
        """The device with the causes as effects; None where no cause is part of a device."""
        text = self["corrected_toml"]
        return None if text is None else Device(text)

    @property
    def table(self) -> Columns:
        """The channels: a row for each, with its error before and after."""
        return _by_columns(self["gap"]["channels"])

    def plot(self) -> Any:
        """Errors before and after, channel by channel."""
        from . import plots

        return plots.diagnosis(self)


class Plan(Result):
    """What `plan` found: the fields of plan.json, poses as arrays."""

    _page = "plan.html"

    rigs: list[Record]
    next_poses: Optional[Record]
    warnings: list[str]

    @property
    def table(self) -> Columns:
        """The chosen poses, a column for each joint's reading; where none were chosen, what the first rig tells."""
        chosen = self["next_poses"]
        if chosen is None:
            return Columns(self["rigs"][0]["parameters"])
        return table(self.files["poses.csv"].decode("utf-8"))

    def plot(self) -> Any:
        """How well each rig fixes each parameter."""
        from . import plots

        return plots.plan(self)


class Replay(Result):
    """What a model predicts of a log, channel by channel."""

    channels: dict[str, Record]
    warnings: list[str]

    @property
    def table(self) -> Columns:
        """The channels: a row for each, with its error and the noise that the device file states."""
        return _by_columns(list(self["channels"].values()))

    def plot(self) -> Any:
        """Prediction minus measurement, channel by channel."""
        from . import plots

        return plots.replay(self)


class Correction(Result):
    """Commands that make the corrected arm go where the path wants it."""

    commands: "Array"
    before_m: "Array"
    before_rad: "Array"
    rest_m: "Array"
    rest_rad: "Array"
    with_orientations: bool
    warnings: list[str]
    csv: str

    @property
    def path(self) -> Columns:
        """The corrected path as a table, as `haptical correct` writes it."""
        return table(self["csv"])

    @property
    def table(self) -> Columns:
        """The corrected path."""
        return self.path

    def plot(self) -> Any:
        """How far the path's own readings would be off."""
        from . import plots

        return plots.correction(self)


class Simulation(Result):
    """A simulated log: `log` by columns, the true device, the rig file that reads it."""

    csv: str
    truth_toml: str
    rig_toml: Optional[str]
    warnings: list[str]

    @property
    def log(self) -> Columns:
        """The log by columns: as it is for `identify` and `diagnose`."""
        return table(self["csv"])

    @property
    def table(self) -> Columns:
        """The log."""
        return self.log

    @property
    def truth(self) -> Device:
        """The true device."""
        return Device(self["truth_toml"])


class Fleet(Columns):
    """A row for each log of a fleet: `log`, `ok`, `error`, `seconds`, `answer`, and what was found."""

    @property
    def failed(self) -> int:
        """Number of logs of which nothing was found."""
        return int(sum(1 for ok in self["ok"] if not ok))

    def write_parquet(self, path: "str | os.PathLike[str]") -> None:
        """Write the table as Parquet; needs pyarrow."""
        table = self.to_arrow()
        import pyarrow.parquet

        pyarrow.parquet.write_table(table, path)


def _by_columns(rows: list[Any]) -> Columns:
    """Records of one kind as a table of what is one number or text in each."""
    names = [name for name, cell in (rows[0].items() if rows else ()) if not isinstance(cell, (dict, list, _np.ndarray))]
    return Columns({name: [row.get(name) for row in rows] for name in names})


def table(text: str) -> Columns:
    """A CSV table by columns: arrays of numbers, NaN where a cell is empty, or lists of texts."""
    lines = list(_csv.reader(_io.StringIO(text)))
    columns = Columns()
    for name, *cells in zip(*lines):
        try:
            columns[name] = _np.array([float(cell) if cell else _np.nan for cell in cells])
        except ValueError:
            columns[name] = list(cells)
    return columns
