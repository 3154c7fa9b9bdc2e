"""The same call over many logs: one that fails is a row of the table, not the end of the others."""

from __future__ import annotations

import inspect
import pathlib
import sys
import threading
import time
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from itertools import repeat
from typing import Any, Callable, Iterable, Iterator, Literal, Optional

import numpy as np

from .results import Fleet

__all__ = ["fleet"]

#: Columns that every row has.
HEAD = ("log", "ok", "error", "seconds", "answer")


def fleet(
    device: Any,
    logs: Iterable[Any],
    *,
    call: Literal["identify", "diagnose"] = "identify",
    executor: Optional[Any] = None,
    workers: Optional[int] = None,
    ahead: int = 256,
    out: Optional[Any] = None,
    on_row: Optional[Callable[[dict[str, Any]], None]] = None,
    progress: bool = False,
    **options: Any,
) -> Fleet:
    """Identify (or `call="diagnose"`) from every one of `logs`, and put what was found into one table.

    `device` is one device for all, or a list with one for each log. `executor` is whatever has `submit` and gives futures
    with `result`: a `concurrent.futures` executor, or a `dask.distributed.Client`; or the module `ray`. Without it `workers`
    threads of this process, which run side by side because the interpreter's lock is free. `options` are keywords of the call.
    A log that cannot be read, or fixes nothing, or whose worker dies, is a row with `ok` False and its `error`.

    `logs` may be a generator: at most `ahead` of them are handed out at a time, so that memory does not grow with their number.
    `out` is a Parquet file to write (needs pyarrow). `on_row` is called with every row, in the order of the logs;
    `progress=True` shows how many are done on standard error.

    The columns: `log`, `ok`, `error`, `seconds`, `answer`; of `identify` `rank`, `value.NAME` and `sd.NAME` of every parameter,
    `before.CHANNEL` and `after.CHANNEL`, root mean squares; of `diagnose` `verdict`, `cause`, `joint`, `probability`.
    """
    if call not in ("identify", "diagnose"):
        raise ValueError(f'call is "{call}"; one of these is expected: identify, diagnose')
    if isinstance(logs, (str, dict)) or any(hasattr(logs, name) for name in ("__fspath__", "columns", "column_names")):
        raise ValueError("logs is one log; give a list of them")
    if ahead < 1:
        raise ValueError(f"ahead is {ahead}; 1 or more is expected")
    devices: Iterable[Any] = repeat(device)
    if isinstance(device, (list, tuple)):
        logs, devices = list(logs), device
        if len(device) != len(logs):
            raise ValueError(f"there are {len(device)} devices and {len(logs)} logs; give one device, or one for each log")
    import haptical

    # a keyword that is none is the caller's mistake, not one of every log
    inspect.signature(getattr(haptical, call)).bind(device, None, **options)
    if out is not None:
        # said before the work, not after it
        Fleet(log=[]).to_arrow()
        if not pathlib.Path(out).resolve().parent.is_dir():
            raise FileNotFoundError(f"out is {out}; its folder is not there")
    stopped = threading.Event()
    own = None if executor is not None else ThreadPoolExecutor(max_workers=workers)
    submit = _submit(executor if own is None else own)
    extra = {} if own is None else {"progress": _until(stopped)}
    tasks = ((_label(log, index), one, log) for index, (one, log) in enumerate(zip(devices, logs)))
    rows: list[dict[str, Any]] = []
    try:
        for row in _rows(submit, ((call, one, log, label, options | extra) for label, one, log in tasks), ahead):
            rows.append(row)
            if on_row is not None:
                on_row(row)
            if progress:
                print(f"\r{len(rows)} logs done, {sum(not row['ok'] for row in rows)} failed", end="", file=sys.stderr, flush=True)
    finally:
        # after Ctrl-C the logs that are being worked on end too
        stopped.set()
        if own is not None:
            own.shutdown(cancel_futures=True)
        if progress:
            print(file=sys.stderr)
    table = _table(rows)
    if out is not None:
        table.write_parquet(out)
    return table


def _submit(executor: Any) -> Callable[..., Any]:
    """What hands a call to the executor and gives a future."""
    if hasattr(executor, "submit"):
        # Dask takes equal calls for one
        extra = {"pure": False} if hasattr(executor, "scheduler_info") else {}
        return lambda call, *arguments: executor.submit(call, *arguments, **extra)
    if hasattr(executor, "remote"):  # the module ray; its tasks are made of functions
        task = executor.remote(_one)
        return lambda _call, *arguments: task.remote(*arguments).future()
    raise ValueError("the executor has no `submit`; give one of concurrent.futures, a client of Dask, or the module ray")


def _until(stopped: threading.Event) -> Callable[[float], None]:
    """Ends a call that is watched by it."""

    def listen(_seconds: float) -> None:
        if stopped.is_set():
            raise KeyboardInterrupt

    return listen


def _rows(submit: Callable[..., Any], tasks: Iterator[tuple[Any, ...]], ahead: int) -> Iterator[dict[str, Any]]:
    """The rows in the order of the tasks."""
    waiting: deque[tuple[str, Any]] = deque()

    def first() -> dict[str, Any]:
        label, future = waiting.popleft()
        try:
            row: dict[str, Any] = future if isinstance(future, dict) else future.result()
        except Exception as error:  # a worker that died, or a result that cannot be sent
            row = _failure(label, error, 0.0)
        return row

    for task in tasks:
        label = task[3]
        try:
            waiting.append((label, submit(_one, *task)))
        except Exception as error:  # an executor that takes no more, or a log that cannot be sent
            waiting.append((label, _failure(label, error, 0.0)))
        if len(waiting) >= ahead:
            yield first()
    while waiting:
        yield first()


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
