"""Figures of results; needs matplotlib (`pip install "haptical[plots]"`)."""

from __future__ import annotations

from typing import Any

import numpy as np

from .frames import missing_package

__all__ = ["correction", "diagnosis", "identification", "plan", "replay"]

#: One colour for before and one for after, in every figure.
BEFORE, AFTER = "#9a9a9a", "#2166ac"
_SHOWN = {"m": ("mm", 1e3), "rad": ("mrad", 1e3)}


def _figure(rows: int = 1, columns: int = 1, **options: Any) -> Any:
    """A figure and its axes; closed for pyplot, so that a notebook shows it once."""
    try:
        import matplotlib.pyplot as pyplot
    except ModuleNotFoundError as missing:
        raise missing_package(missing, "plots") from None
    figure, axes = pyplot.subplots(rows, columns, squeeze=False, layout="constrained", **options)
    pyplot.close(figure)
    return figure, axes


def _bars(axes: Any, names: list[str], before: list[float], after: list[float], what: tuple[str, str]) -> None:
    place = np.arange(len(names))
    axes.barh(place - 0.2, before, height=0.38, color=BEFORE, label=what[0])
    axes.barh(place + 0.2, after, height=0.38, color=AFTER, label=what[1])
    axes.set_yticks(place, names)
    axes.invert_yaxis()
    positive = [value for value in [*before, *after] if value > 0]
    if positive and max(positive) > 30 * min(positive):
        axes.set_xscale("log")
    axes.legend(frameon=False)


def identification(result: Any) -> Any:
    """Deviations from nominal with their intervals, by unit, and the channels' errors before and after."""
    table = result["parameters"]
    units = [unit for unit in _SHOWN if unit in table["unit"]]
    figure, axes = _figure(1, len(units) + 1, figsize=(4.5 * (len(units) + 1), 6))
    deviation, interval = np.asarray(table["deviation"]), np.asarray(table["ci95"])
    value = np.asarray(table["value"])
    for own, unit in zip(axes[0], units):
        name, factor = _SHOWN[unit]
        rows = [row for row, (of, x) in enumerate(zip(table["unit"], deviation)) if of == unit and np.isfinite(x)]
        place = np.arange(len(rows))
        # an interval is of the value
        spread = np.abs(interval[rows] - value[rows, None]).T if rows else np.zeros((2, 0))
        spread = np.where(np.isfinite(spread), spread, 0.0)
        own.errorbar(factor * deviation[rows], place, xerr=factor * spread, fmt="o", ms=3, color=AFTER, elinewidth=1)
        own.axvline(0.0, color=BEFORE, lw=1)
        own.set_yticks(place, [table["name"][row] for row in rows], fontsize="small")
        own.invert_yaxis()
        own.set_xlabel(f"deviation from nominal [{name}]")
    channels = result["channels"]
    rms = [[1e3 * float(np.sqrt(np.nanmean(np.square(own[key])))) if np.size(own[key]) else 0.0 for own in channels.values()]
           for key in ("before", "after")]
    _bars(axes[0][-1], list(channels), rms[0], rms[1], ("before", "after"))
    axes[0][-1].set_xlabel("root mean square [mm or mrad]")
    return figure


def diagnosis(result: Any) -> Any:
    """Errors of the base model, and what is left of them, channel by channel."""
    channels = result["gap"]["channels"]
    figure, axes = _figure(figsize=(7, 1.2 + 0.6 * len(channels)))
    before = [own.get("rms_before") or 0.0 for own in channels]
    after = [own.get("rms_after") or 0.0 for own in channels]
    _bars(axes[0][0], [own["channel"] for own in channels], before, after, ("before", "after"))
    axes[0][0].set_title(result["answer"], fontsize="small", loc="left", wrap=True)
    axes[0][0].set_xlabel("root mean square, SI units")
    return figure


def plan(result: Any) -> Any:
    """Standard deviation over plausible size, parameter by parameter, rig by rig."""
    figure, axes = _figure(figsize=(8, 5))
    own = axes[0][0]
    for rig in result["rigs"]:
        table = rig["parameters"]
        share = np.asarray(table["standard_deviation"]) / np.asarray(table["plausible_size"])
        own.plot(share, np.arange(len(share)), "o", ms=3, label=f"{rig['measure']}: {rig['rank']} of {len(share)}")
        own.set_yticks(np.arange(len(share)), table["name"], fontsize="small")
    own.axvline(0.5, color=BEFORE, lw=1)
    own.invert_yaxis()
    own.set_xscale("log")
    own.set_xlabel("standard deviation / plausible size (beyond 0.5: weak)")
    own.legend(frameon=False)
    return figure


def replay(result: Any) -> Any:
    """Prediction minus measurement, row by row."""
    channels = result["channels"]
    figure, axes = _figure(max(len(channels), 1), 1, figsize=(8, 2.2 * max(len(channels), 1)), sharex=True)
    for own, (name, channel) in zip(axes[:, 0], channels.items()):
        shown, factor = _SHOWN.get(channel["unit"], (channel["unit"], 1.0))
        own.plot(channel["rows"], factor * channel["residuals"], ".", ms=2)
        own.set_ylabel(f"{name} [{shown}]")
    axes[-1, 0].set_xlabel("row")
    return figure


def correction(result: Any) -> Any:
    """How far the path's own readings would be off, and what the commands leave."""
    figure, axes = _figure(figsize=(8, 3))
    own = axes[0][0]
    own.plot(1e3 * result["before_m"], color=BEFORE, label="the path's own readings")
    own.plot(1e3 * result["rest_m"], color=AFTER, label="the commands")
    own.set_xlabel("waypoint")
    own.set_ylabel("distance [mm]")
    own.legend(frameon=False)
    return figure
