"""Logs as people have them: paths, dictionaries, frames of pandas and polars, tables of pyarrow, structured arrays."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np

__all__ = ["columns", "missing_package"]


def columns(log: Any) -> Any:
    """What the module takes: a path, or a dictionary of columns; a list of logs stays one."""
    if isinstance(log, str) and "\n" in log:
        raise ValueError("the log is a text; write it to a file and give its path, or give its columns")
    if isinstance(log, (str, os.PathLike, dict)):
        return log
    if hasattr(log, "collect_schema") and hasattr(log, "collect"):  # a lazy frame of polars
        log = log.collect()
    if isinstance(log, (list, tuple)):
        return [columns(own) for own in log]
    if isinstance(log, np.ndarray):
        names = log.dtype.names
        if names is None:
            raise ValueError("there is an array without names of columns; give a dictionary, a frame or a structured array")
        return {name: log[name] for name in names}
    # pyarrow's `columns` are not names
    names = getattr(log, "column_names", None)
    if names is None:
        names = getattr(log, "columns", None)
    if names is not None and hasattr(log, "__getitem__"):
        return {str(name): _cells(log[name]) for name in names}
    if isinstance(log, Mapping):
        return dict(log)
    # the module says what it is, and what is wanted
    return log


def missing_package(missing: ModuleNotFoundError, extra: str) -> ModuleNotFoundError:
    """The error with what to install."""
    return ModuleNotFoundError(f'{missing.name} is not installed; pip install "haptical[{extra}]"', name=missing.name)


def _cells(column: Any) -> Any:
    """The cells of one column: numbers as numbers, also where some are missing."""
    if type(column).__module__.partition(".")[0] == "pandas":
        kind = getattr(column.dtype, "kind", "O")
        if not column.isna().any():
            return column.to_numpy()
        if kind in "iufb":
            return column.to_numpy(dtype=float, na_value=np.nan)
        return column.astype(object).where(column.notna(), None).to_numpy()
    return column.to_numpy() if hasattr(column, "to_numpy") else column
