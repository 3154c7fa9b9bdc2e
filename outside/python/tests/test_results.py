"""Result objects: dictionaries as before, attributes, a report, tables, figures, pickles."""

import pathlib
import pickle
import time

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
    assert found.to_pandas().equals(frame)
    pytest.importorskip("pyarrow")
    empty = haptical.Columns(name=["a", "b"], reason=[None, None]).to_arrow()
    assert str(empty.schema.field("reason").type) == "string"


def test_every_result_is_a_table(device, found):
    pytest.importorskip("pandas")
    log = recording(0.3012, 0.1991)
    path = {name: log[name][:9] for name in ["theta1_rad", "theta2_rad"]}
    plan = haptical.plan(device, ["position"], poses=5, candidates=50)
    wanted = [
        (found, "standard_deviation", found.parameters.rows),
        (haptical.diagnose(device, log), "rms_before", 1),
        (plan, "theta2_rad", 5),
        (haptical.plan(device, ["position"]), "standard_deviation", plan.rigs[0].parameters.rows),
        (haptical.replay(found.device, log), "noise_floor", 1),
        (haptical.correct(device, found.device, path, within_m=1e-3), "theta1_rad", 9),
        (haptical.simulate(device, path, measure="position"), "x_m", 9),
    ]
    for result, column, rows in wanted:
        frame = result.to_pandas()
        assert column in frame and len(frame) == rows, (type(result), frame)


def test_a_name_alone_is_a_list_of_one(device):
    log = recording(0.3012, 0.1991)
    assert haptical.identify(device, log, hold="a1").identified_toml == haptical.identify(device, log, hold=["a1"]).identified_toml
    with pytest.raises(ValueError, match="did you mean `backlash`"):
        haptical.diagnose(device, log, without="backlsh")


def test_a_package_that_is_missing_is_named_with_its_extra(found, monkeypatch):
    import sys

    for name, call, extra in [("matplotlib.pyplot", found.plot, "plots"), ("pandas", found.to_pandas, "frames"), ("pyarrow", found.to_arrow, "frames")]:
        monkeypatch.setitem(sys.modules, name, None)
        with pytest.raises(ModuleNotFoundError, match=rf"is not installed; pip install .haptical\[{extra}\]"):
            call()


def test_a_long_table_is_shown_in_part():
    table = haptical.Columns(name=[f"row {row}" for row in range(2000)], value=np.arange(2000.0))
    shown = table._repr_html_()
    assert shown.count("<tr>") == 61 and "the first 60 of 2000 rows" in shown and "overflow-x" in shown
    assert repr(table) == "<haptical.Columns: 2000 rows of name, value>"


@pytest.mark.parametrize("library", ["pandas", "polars", "lazy", "pyarrow", "numpy"])
def test_logs_come_from_frames(device, library):
    module = pytest.importorskip("polars" if library == "lazy" else library)
    columns = recording(0.3012, 0.1991)
    columns["x_m"] = np.where(np.arange(len(columns["x_m"])) % 7 == 0, np.nan, columns["x_m"])
    columns["y_m"] = np.where(np.isnan(columns["x_m"]), np.nan, columns["y_m"])
    columns["z_m"] = np.where(np.isnan(columns["x_m"]), np.nan, columns["z_m"])
    if library == "numpy":
        log = np.rec.fromarrays(list(columns.values()), names=",".join(columns))
    elif library == "pyarrow":
        log = module.table(columns)
    elif library == "lazy":
        log = module.LazyFrame(columns)
    else:
        log = module.DataFrame(columns)
    told = haptical.identify(device, log)
    assert told.identified_toml == haptical.identify(device, columns).identified_toml


def test_what_is_no_log_is_refused_in_words(device):
    log = recording(0.3012, 0.1991, rows=60)
    dates = np.datetime64("2026-01-01T00:00:00") + (1e3 * log["t_s"]).astype("timedelta64[ms]")
    # beside the times a date is a column as any other
    assert haptical.identify(device, log | {"date": dates}).identified_toml == haptical.identify(device, log).identified_toml
    for given, said in [
        (log | {"t_s": dates}, "column `t_s` is of the type datetime64.*times in seconds"),
        (",".join(log) + "\n0,0,0,0,0,0\n", "the log is a text; write it to a file"),
        (np.zeros((9, 6)), "an array without names of columns"),
        ([log, log], "a list where one log is expected; .*diagnose"),
        (5, "of the type int; give a path"),
    ]:
        with pytest.raises(ValueError, match=said):
            haptical.identify(device, given)
    with pytest.raises(ValueError, match="the readings are a dictionary; give an array"):
        haptical.forward_kinematics(device, log)


def test_a_result_stands_for_its_device(device, found):
    log = recording(0.3012, 0.1991)
    alone = haptical.replay(found.device, log).channels["position"].rms
    assert haptical.replay(found, log).channels["position"].rms == alone
    gap = haptical.diagnose(device, log, model=found)
    assert gap.device is None
    with pytest.raises(ValueError, match="names no cause that is part of a device"):
        haptical.replay(gap, log)


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


@pytest.mark.parametrize("call", [haptical.identify, haptical.diagnose])
def test_what_was_interrupted_is_worked_out_no_more(device, call):
    log = recording(0.3012, 0.1991, rows=400_000)
    begun = time.process_time()
    call(device, log)
    whole = time.process_time() - begun

    def stop(_seconds):
        raise KeyboardInterrupt

    begun = time.process_time()
    with pytest.raises(KeyboardInterrupt):
        call(device, log, progress=stop)
    # of all threads; without an end it would be the whole
    time.sleep(2 * whole)
    assert time.process_time() - begun < 0.5 * whole


def test_ctrl_c_is_heard(device, tmp_path):
    import signal
    import subprocess
    import sys

    program = tmp_path / "long.py"
    tests = pathlib.Path(__file__).parent
    program.write_text(
        f"import sys; sys.path.insert(0, {str(tests)!r})\n"
        "import haptical\nfrom conftest import planar, recording\n"
        "log = recording(0.3012, 0.1991, rows=400000)\nprint('now', flush=True)\n"
        "try:\n    haptical.diagnose(planar(), log)\nexcept KeyboardInterrupt:\n    print('heard', flush=True)\n",
        encoding="utf-8",
    )
    with subprocess.Popen([sys.executable, str(program)], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout.readline() == "now\n"
        time.sleep(0.3)
        begun = time.perf_counter()
        child.send_signal(signal.SIGINT)
        assert child.stdout.readline() == "heard\n"
        assert time.perf_counter() - begun < 1.0
        assert child.wait(10) == 0
