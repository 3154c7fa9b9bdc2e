"""Result objects: dictionaries as before, attributes, a report, tables, figures, pickles."""

import pathlib
import pickle

import haptical
import numpy as np
import pytest
from conftest import recording


@pytest.fixture(scope="module")
def found():
    from conftest import planar

    return haptical.identify(planar(), recording(0.3012, 0.1991))


def test_a_result_is_a_dictionary_whose_keys_are_attributes(found):
    assert isinstance(found, dict) and isinstance(found, haptical.Identification)
    assert found.parameters is found["parameters"]
    assert found.intervals.level == found["intervals"]["level"] == 0.95
    assert found.device.joints == 2
    with pytest.raises(AttributeError, match="there is no `parametres`; there are: .*parameters"):
        _ = found.parametres
    assert "parameters" in dir(found)
    again = pickle.loads(pickle.dumps(found))
    assert type(again) is haptical.Identification and again.files == found.files
    assert np.array_equal(again.parameters["value"], found.parameters["value"], equal_nan=True)


def test_a_notebook_shows_the_report_and_files_are_the_commands(found, tmp_path):
    page = found.report_html
    assert page.startswith("<!DOCTYPE html>") and found.answer.split(":")[0]
    assert "&lt;!DOCTYPE" in found._repr_html_() and "<iframe" in found._repr_html_()
    # no script of the page leaves its frame
    assert 'sandbox="allow-scripts"' in found._repr_html_()
    paths = found.write(tmp_path / "new")
    assert {"identified.toml", "identified.json", "identify.html"} <= {path.name for path in paths}
    assert (tmp_path / "new" / "identified.toml").read_text().endswith(found.identified_toml)
    assert "a1" in found.parameters._repr_html_()


def test_tables_go_to_pandas_polars_and_arrow(found):
    table = found.parameters
    pandas = pytest.importorskip("pandas")
    frame = table.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and list(frame["name"]) == table["name"]
    assert np.array_equal(frame["ci95_low"], table["ci95"][:, 0], equal_nan=True)
    polars = pytest.importorskip("polars")
    assert isinstance(table.to_polars(), polars.DataFrame) and table.to_polars().height == table.rows


@pytest.mark.parametrize("library", ["pandas", "polars", "pyarrow", "numpy"])
def test_logs_come_from_frames(device, library):
    module = pytest.importorskip(library)
    columns = recording(0.3012, 0.1991)
    columns["x_m"] = np.where(np.arange(len(columns["x_m"])) % 7 == 0, np.nan, columns["x_m"])
    columns["y_m"] = np.where(np.isnan(columns["x_m"]), np.nan, columns["y_m"])
    columns["z_m"] = np.where(np.isnan(columns["x_m"]), np.nan, columns["z_m"])
    if library == "numpy":
        log = np.rec.fromarrays(list(columns.values()), names=",".join(columns))
    elif library == "pyarrow":
        log = module.table(columns)
    else:
        log = module.DataFrame(columns)
    told = haptical.identify(device, log)
    assert told.identified_toml == haptical.identify(device, columns).identified_toml


def test_missing_numbers_of_pandas_are_no_readings(device):
    pandas = pytest.importorskip("pandas")
    columns = recording(0.3012, 0.1991)
    frame = pandas.DataFrame(columns).convert_dtypes()
    frame.loc[3, ["x_m", "y_m", "z_m"]] = pandas.NA
    for name in ["x_m", "y_m", "z_m"]:
        columns[name] = columns[name].copy()
        columns[name][3] = np.nan
    assert haptical.identify(device, frame).identified_toml == haptical.identify(device, columns).identified_toml


def test_figures_are_drawn(device, found):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    log = recording(0.3012, 0.1991)
    gap = haptical.diagnose(device, log)
    plan = haptical.plan(device, ["position", "pose"], poses=5, candidates=50)
    replayed = haptical.replay(found.identified_toml, log)
    path = {name: log[name][:9] for name in ["theta1_rad", "theta2_rad"]}
    corrected = haptical.correct(device, found.identified_toml, path, within_m=1e-3)
    for result in [found, gap, plan, replayed, corrected]:
        figure = result.plot()
        figure.canvas.draw()
        assert len(figure.axes) >= 1 and figure.axes[0].has_data(), type(result)


def test_progress_is_called_and_an_exception_in_it_ends_the_call(device):
    log = recording(0.3012, 0.1991, rows=60000)
    seen = []
    haptical.diagnose(device, log, progress=seen.append)
    assert seen and seen == sorted(seen) and seen[0] < 1.0

    def stop(_seconds):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        haptical.diagnose(device, log, progress=stop)


def test_ctrl_c_is_heard(device, tmp_path):
    import signal
    import subprocess
    import sys
    import time

    program = tmp_path / "long.py"
    tests = pathlib.Path(__file__).parent
    program.write_text(
        f"import sys; sys.path.insert(0, {str(tests)!r})\n"
        "import haptical\nfrom conftest import planar, recording\n"
        "log = recording(0.3012, 0.1991, rows=400000)\nprint('now', flush=True)\n"
        "try:\n    haptical.diagnose(planar(), log)\nexcept KeyboardInterrupt:\n    print('heard', flush=True)\n"
        "    import os; os._exit(7)\n",
        encoding="utf-8",
    )
    with subprocess.Popen([sys.executable, str(program)], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout.readline() == "now\n"
        time.sleep(0.3)
        begun = time.perf_counter()
        child.send_signal(signal.SIGINT)
        assert child.stdout.readline() == "heard\n"
        assert time.perf_counter() - begun < 1.0
        child.wait(10)
