"""A fleet: many logs, one call, one table; a failure is a row."""

import time

import haptical
import numpy as np
import pytest
from conftest import recording, write_csv


def logs(tmp_path):
    """Two sound logs, one that is none, and one that fixes nothing."""
    paths = []
    for number, lengths in enumerate([(0.3012, 0.1991), (0.2993, 0.2004)]):
        path = tmp_path / f"{number}.csv"
        write_csv(path, recording(*lengths))
        paths.append(str(path))
    broken = tmp_path / "broken.csv"
    broken.write_text("t_s,theta1_rad\n0,zero\n")
    return [paths[0], str(broken), {"theta1_rad": np.zeros(5), "theta2_rad": np.zeros(5)}, paths[1]]


def check(table, paths):
    assert table["ok"] == [True, False, False, True] and table.failed == 2
    assert table["log"][1] == paths[1] and table["log"][2] == "log 3"
    assert "broken.csv" in table["error"][1] and table["error"][0] is None
    alone = haptical.identify(DEVICE, paths[3]).parameters
    place = alone["name"].index("a2")
    assert table["value.a2"][3] == alone["value"][place]
    assert np.isnan(table["value.a2"][1]) and table["answer"][3]


from conftest import planar  # noqa: E402

DEVICE = planar()


def test_threads_and_one_parquet_table(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    paths = logs(tmp_path)
    seen = []
    table = haptical.fleet(DEVICE, paths, workers=2, out=tmp_path / "fleet.parquet", on_row=seen.append)
    check(table, paths)
    assert len(seen) == 4
    read = parquet.read_table(tmp_path / "fleet.parquet")
    assert read.num_rows == 4 and read.column("ok").to_pylist() == table["ok"]
    assert read.column("value.a2").to_pylist()[3] == table["value.a2"][3]


def test_two_local_workers_of_dask(tmp_path):
    distributed = pytest.importorskip("distributed")
    paths = logs(tmp_path)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            table = haptical.fleet(DEVICE, paths, executor=client)
            assert len(client.scheduler_info()["workers"]) == 2
    check(table, paths)


@pytest.mark.filterwarnings("ignore")
def test_two_local_workers_of_ray(tmp_path):
    ray = pytest.importorskip("ray")
    paths = logs(tmp_path)
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        table = haptical.fleet(DEVICE, paths, executor=ray)
    finally:
        ray.shutdown()
    check(table, paths)


def test_logs_are_taken_as_they_are_worked_on():
    taken = []

    def one_by_one():
        for number in range(12):
            taken.append(number)
            yield recording(0.3012, 0.1991, rows=60, seed=number)

    behind = []
    table = haptical.fleet(DEVICE, one_by_one(), workers=2, ahead=3, on_row=lambda row: behind.append((row["log"], len(taken))))
    assert table.rows == 12 and table.failed == 0
    assert [log for log, _ in behind] == [f"log {number + 1}" for number in range(12)]
    assert all(count <= row + 3 for row, (_, count) in enumerate(behind)), behind
    with pytest.raises(ValueError, match="one log; give a list"):
        haptical.fleet(DEVICE, recording(0.3012, 0.1991))


def test_an_executor_that_takes_no_more_keeps_what_was_found(tmp_path):
    from concurrent.futures import Future

    class Broken:
        calls = 0

        def submit(self, call, *arguments):
            self.calls += 1
            if self.calls > 2:
                raise RuntimeError("the pool is broken")
            future = Future()
            future.set_result(call(*arguments))
            return future

    table = haptical.fleet(DEVICE, logs(tmp_path), executor=Broken())
    assert table["ok"] == [True, False, False, False] and table["error"][3] == "RuntimeError: the pool is broken"


def test_ctrl_c_ends_the_logs_that_are_worked_on():
    long = [recording(0.3012, 0.1991, rows=rows) for rows in (60, 400000, 400000)]

    def stop(_row):
        raise KeyboardInterrupt

    begun = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        haptical.fleet(DEVICE, long, call="diagnose", workers=3, on_row=stop)
    assert time.perf_counter() - begun < 5.0


def test_a_diagnosis_of_each(tmp_path):
    paths = logs(tmp_path)
    table = haptical.fleet(haptical.Device(DEVICE), [paths[0], paths[1]], call="diagnose", workers=2)
    assert table["ok"] == [True, False] and table["verdict"][0] == "no-gap" and table["verdict"][1] is None
    with pytest.raises(ValueError, match="one of these is expected: identify, diagnose"):
        haptical.fleet(DEVICE, paths, call="replay")
    with pytest.raises(FileNotFoundError, match="its folder is not there"):
        haptical.fleet(DEVICE, paths, out=tmp_path / "no" / "fleet.parquet")
    with pytest.raises(TypeError, match="metod"):
        haptical.fleet(DEVICE, paths, metod="joint")
    with pytest.raises(ValueError, match="2 devices and 4 logs"):
        haptical.fleet([DEVICE, DEVICE], paths)
