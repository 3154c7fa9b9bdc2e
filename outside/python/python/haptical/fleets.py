"""The same call over many logs: one that fails is a row of the table, not the end of the others."""

from __future__ import annotations

import inspect
import json
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
    call: Literal["identify", "diagnose", "doctor"] = "identify",
    executor: Optional[Any] = None,
    workers: Optional[int] = None,
    ahead: int = 256,
    out: Optional[Any] = None,
    resume: bool = False,
    on_row: Optional[Callable[[dict[str, Any]], None]] = None,
    progress: bool = False,
    **options: Any,
) -> Fleet:
    """Identify (or `call="diagnose"`, or `call="doctor"`) from every one of `logs`, and put what was found into one table.

    `device` is one device for all, or a list with one for each log; None for `doctor`, whose logs are recordings of many episodes. `executor` is whatever has `submit` and gives futures
    with `result`: a `concurrent.futures` executor, or a `dask.distributed.Client`; or the module `ray`. Without it `workers`
    threads of this process, which run side by side because the interpreter's lock is free. `options` are keywords of the call.
    A log that cannot be read, or fixes nothing, or whose worker dies, is a row with `ok` False and its `error`.

    `logs` may be a generator: at most `ahead` of them are handed out at a time, so that memory does not grow with their number.
    `out` is a Parquet file to write (needs pyarrow). Until then rows are kept in a file of its name with `.jsonl` behind, as they come;
    with `resume=True` the logs that it has, or that an earlier `out` has, are not worked on again unless they failed. `on_row` is called with every row, in the order of the logs;
    `progress=True` shows how many are done on standard error.

    The columns: `log`, `ok`, `error`, `seconds`, `answer`; of `identify` `rank`, `value.NAME` and `sd.NAME` of every parameter,
    `before.CHANNEL` and `after.CHANNEL`, root mean squares; of `diagnose` `verdict`, `cause`, `joint`, `probability`.
    """
    if call not in ("identify", "diagnose", "doctor"):
        raise ValueError(f'call is "{call}"; one of these is expected: identify, diagnose, doctor')
    if call == "doctor" and device is not None:
        raise ValueError("a doctor needs no device; give None")
    if resume and out is None:
        raise ValueError("resume goes on with an `out`; give its path")
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
    given = (None,) if call == "doctor" else (device, None)
    inspect.signature(getattr(haptical, call)).bind(*given, **options)
    if out is not None:
        # said before the work, not after it
        Fleet(log=[]).to_arrow()
        if not pathlib.Path(out).resolve().parent.is_dir():
            raise FileNotFoundError(f"out is {out}; its folder is not there")
    stopped = threading.Event()
    threads = None if executor is not None else ThreadPoolExecutor(max_workers=workers)
    submit = _submit(executor if threads is None else threads)
    extra = {} if threads is None or call == "doctor" else {"progress": _until(stopped)}
    kept = None if out is None else _Kept(out, resume)
    tasks = ((_label(log, index), one, log) for index, (one, log) in enumerate(zip(devices, logs)))
    rows: list[dict[str, Any]] = []
    try:
        work = ((call, one, log, label, options | extra) for label, one, log in tasks)
        for row in _rows(submit, work, ahead, {} if kept is None else kept.before):
            rows.append(row)
            if kept is not None:
                kept.keep(row)
            if on_row is not None:
                on_row(row)
            if progress:
                print(f"\r{len(rows)} logs done, {sum(not row['ok'] for row in rows)} failed", end="", file=sys.stderr, flush=True)
    finally:
        # after Ctrl-C the logs that are being worked on end too
        stopped.set()
        if kept is not None:
            kept.file.close()
        if threads is not None:
            threads.shutdown(cancel_futures=True)
        if progress:
            print(file=sys.stderr)
    table = _table(rows)
    if kept is not None:
        table.write_parquet(out)
        kept.done()
    return table


class _Kept:
    """The rows of a run that is not at its end, one line of JSON each."""

    def __init__(self, out: Any, resume: bool) -> None:
        self.path = pathlib.Path(f"{out}.jsonl")
        self.before: dict[str, dict[str, Any]] = {}
        if resume:
            self._read(pathlib.Path(out))
        self.file = open(self.path, "a" if resume else "w", encoding="utf-8")

    def _read(self, out: pathlib.Path) -> None:
        found: list[dict[str, Any]] = []
        if out.is_file():
            import pyarrow.parquet

            found.extend(pyarrow.parquet.read_table(out).to_pylist())
        if self.path.is_file():
            for line in self.path.read_text(encoding="utf-8").splitlines():
                try:
                    found.append(json.loads(line))
                except ValueError:
                    continue  # a line that was cut off
        self.before = {row["log"]: row for row in found if row.get("ok")}

    def keep(self, row: dict[str, Any]) -> None:
        if row["log"] in self.before:
            return
        self.file.write(json.dumps(row) + "\n")
        self.file.flush()

    def done(self) -> None:
        self.path.unlink()


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


def _rows(
    submit: Callable[..., Any], tasks: Iterator[tuple[Any, ...]], ahead: int, before: dict[str, dict[str, Any]]
) -> Iterator[dict[str, Any]]:
    """The rows in the order of the tasks; those of `before` are there already."""
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
        if label in before:
            waiting.append((label, before[label]))
            if len(waiting) >= ahead:
                yield first()
            continue
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
        found = haptical.doctor(log, **options) if call == "doctor" else getattr(haptical, call)(device, log, **options)
    except Exception as error:
        return _failure(label, error, time.perf_counter() - begun)
    row = {"log": label, "ok": True, "error": None, "seconds": time.perf_counter() - begun, "answer": found["answer"]}
    if call == "doctor":
        return row | _doctored(found)
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


def _doctored(found: dict[str, Any]) -> dict[str, Any]:
    """A recording's row: how much was found, and what is most probable."""
    all_found = [(finding, joint["name"]) for joint in found["joints"] for finding in joint["findings"]]
    row: dict[str, Any] = {"findings": len(all_found) + sum(len(episode["findings"]) for episode in found["episodes"])}
    for verdict in ("use", "look", "leave out"):
        row[verdict.replace(" ", "_")] = sum(episode["verdict"] == verdict for episode in found["episodes"])
    finding, name = max(all_found, key=lambda one: one[0]["probability"], default=({}, None))
    return row | {"effect": finding.get("effect"), "joint": name} | {key: finding.get(key) for key in ("since_episode", "probability")}


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
