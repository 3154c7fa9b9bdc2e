"""The same call over many logs: one that fails is a row of the table, not the end of the others."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Iterable, Optional

import numpy as np

from .results import Fleet

__all__ = ["fleet"]

#: Columns that every row has.
HEAD = ("log", "ok", "error", "seconds", "answer")


def fleet(
    device: Any,
    logs: Iterable[Any],
    *,
    call: str = "identify",
    executor: Optional[Any] = None,
    workers: Optional[int] = None,
    out: Optional[Any] = None,
    on_row: Optional[Callable[[dict[str, Any]], None]] = None,
    **options: Any,
) -> Fleet:
    """Identify (or `call="diagnose"`) from every one of `logs`, and put what was found into one table.

    `device` is one device for all, or a list with one for each log. `executor` is whatever has `submit` and gives futures
    with `result`: a `concurrent.futures` executor, or a `dask.distributed.Client`; without it `workers` threads of this
    process, which run side by side because the interpreter's lock is free. `options` are keywords of the call. A log that
    cannot be read, or fixes nothing, or whose worker dies, is a row with `ok` False and its `error`. `out` is a Parquet file to
    write (needs pyarrow). `on_row` is called with every row as it comes.

    The columns: `log`, `ok`, `error`, `seconds`, `answer`; of `identify` `rank`, `value.NAME` and `sd.NAME` of every parameter,
    `before.CHANNEL` and `after.CHANNEL`, root mean squares; of `diagnose` `verdict`, `cause`, `joint`, `probability`.
    """
    if call not in ("identify", "diagnose"):
        raise ValueError(f'call is "{call}"; one of these is expected: identify, diagnose')
    logs = list(logs)
    devices = list(device) if isinstance(device, (list, tuple)) else [device] * len(logs)
    if len(devices) != len(logs):
        raise ValueError(f"there are {len(devices)} devices and {len(logs)} logs; give one device, or one for each log")
    own = None if executor is not None else ThreadPoolExecutor(max_workers=workers)
    pool: Any = executor if executor is not None else own
    try:
        # Dask takes equal calls for one
        extra = {"pure": False} if hasattr(pool, "scheduler_info") else {}
        futures = [
            pool.submit(_one, call, one, log, _label(log, index), options, **extra)
            for index, (one, log) in enumerate(zip(devices, logs))
        ]
        rows = []
        for index, future in enumerate(futures):
            try:
                row = future.result()
            except Exception as error:  # a worker that died, or a result that cannot be sent
                row = _failure(_label(logs[index], index), error, 0.0)
            rows.append(row)
            if on_row is not None:
                on_row(row)
    finally:
        if own is not None:
            own.shutdown(cancel_futures=True)
    table = _table(rows)
    if out is not None:
        table.write_parquet(out)
    return table


def _label(log: Any, index: int) -> str:
    """A name for the row: the path, or the place in the list."""
    return str(log) if isinstance(log, str) or hasattr(log, "__fspath__") else f"log {index + 1}"


def _failure(label: str, error: BaseException, seconds: float) -> dict[str, Any]:
    text = f"{type(error).__name__}: {error}"
    return {"log": label, "ok": False, "error": text, "seconds": seconds, "answer": None}


def _one(call: str, device: Any, log: Any, label: str, options: dict[str, Any]) -> dict[str, Any]:
    """One log in a worker."""
    import haptical

    begun = time.perf_counter()
    try:
        found = getattr(haptical, call)(device, log, **options)
    except Exception as error:
        return _failure(label, error, time.perf_counter() - begun)
    row = {"log": label, "ok": True, "error": None, "seconds": time.perf_counter() - begun, "answer": found["answer"]}
    if call == "diagnose":
        cause = found["causes"][0] if found["causes"] else {}
        row["verdict"] = found["verdict"]
        row["cause"] = cause.get("effect")
        row["joint"] = cause.get("joint")
        row["probability"] = cause.get("probability")
        return row
    row["rank"] = found.get("rank")
    table = found.get("parameters")
    if isinstance(table, dict):
        for name, value, sd in zip(table["name"], table["value"], table["standard_deviation"]):
            row[f"value.{name}"], row[f"sd.{name}"] = float(value), float(sd)
    channels = found.get("channels")
    for name, channel in channels.items() if isinstance(channels, dict) else ():
        for key in ("before", "after"):
            residuals = np.asarray(channel[key], dtype=float)
            row[f"{key}.{name}"] = float(np.sqrt(np.nanmean(residuals**2))) if residuals.size else float("nan")
    return row


def _table(rows: list[dict[str, Any]]) -> Fleet:
    """Rows as columns: what a row lacks is NaN among numbers, None among texts."""
    names = list(dict.fromkeys([*HEAD, *(name for row in rows for name in row)]))
    table = Fleet()
    for name in names:
        cells = [row.get(name) for row in rows]
        there = [cell for cell in cells if cell is not None]
        is_number = name not in HEAD and there and all(isinstance(cell, (int, float)) for cell in there)
        if is_number or name == "seconds":
            table[name] = np.array([np.nan if cell is None else float(cell) for cell in cells])
        else:
            table[name] = cells
    return table
