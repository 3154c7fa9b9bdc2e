"""A fleet: many logs, one call, one table; a failure is a row."""

import pathlib
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


def recordings(folder, count):
    """Folders of logs, twelve episodes each; in the odd ones a joint reads 0.3 rad more from episode 7 on."""
    random = np.random.default_rng(4)
    time_s = np.arange(240) / 30.0
    paths = []
    for number in range(count):
        path = folder / f"set_{number}"
        path.mkdir()
        for episode in range(12):
            phases = random.uniform(0, 6, (2, 3))
            command = sum(0.2 * np.sin(np.outer(time_s, [1.0 + 0.9 * wave, 1.3 + wave]) + phases[:, wave]) for wave in range(3))
            position = np.vstack([np.repeat(command[:1], 3, axis=0), command[:-3]]) + 1e-3 * random.normal(size=command.shape)
            position[:, 1] += 0.3 * (number % 2 == 1 and episode >= 7)
            np.savetxt(path / f"take_{episode}.csv", np.c_[time_s, position, command], delimiter=",", comments="",
                       header="t_s,theta1_rad,theta2_rad,command1_rad,command2_rad")
        paths.append(str(path))
    return paths


def test_a_doctor_needs_no_device(tmp_path):
    sound, faulty = recordings(tmp_path, 2)
    assert haptical.doctor(sound)["joints"][1]["findings"] == []
    found = haptical.doctor(faulty)["joints"][1]["findings"]
    assert [finding["effect"] for finding in found] == ["joint-offset"]
    assert found[0]["since_episode"] == 7 and abs(found[0]["parameters"]["offset_rad"]["value"] - 0.3) < 0.01
    with pytest.raises(ValueError, match="neither meta/info.json"):
        haptical.doctor(tmp_path / "..")
    with pytest.raises(ValueError, match="units are"):
        haptical.doctor(sound, units="gradians")


def doctored(table, paths):
    assert table["ok"] == [True, True, False, True, True]
    assert [table["effect"][place] for place in (0, 1, 3, 4)] == [None, "joint-offset", None, "joint-offset"]
    assert list(table["since_episode"])[1] == 7 and list(table["leave_out"])[1] == 5
    assert "no such file" in table["error"][2]


def with_one_missing(tmp_path):
    paths = recordings(tmp_path, 4)
    return [*paths[:2], str(tmp_path / "missing"), *paths[2:]]


def test_doctors_of_many_recordings_go_on_where_they_stopped(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    paths, out = with_one_missing(tmp_path), tmp_path / "table.parquet"

    def stop(row):
        if row["log"] == paths[2]:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        haptical.fleet(None, paths, call="doctor", workers=1, out=out, on_row=stop)
    kept = (tmp_path / "table.parquet.jsonl").read_text().splitlines()
    assert len(kept) == 3 and not out.exists()
    # the rows that are kept are not worked on again: their recordings may be gone
    for name in sorted(pathlib.Path(paths[0]).iterdir()):
        name.unlink()
    table = haptical.fleet(None, paths, call="doctor", workers=1, out=out, resume=True)
    doctored(table, paths)
    assert not (tmp_path / "table.parquet.jsonl").exists()
    assert parquet.read_table(out).column("effect").to_pylist()[1] == "joint-offset"
    with pytest.raises(ValueError, match="needs no device"):
        haptical.fleet(DEVICE, paths, call="doctor")


def test_doctors_on_two_local_workers_of_dask(tmp_path):
    distributed = pytest.importorskip("distributed")
    paths = with_one_missing(tmp_path)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            doctored(haptical.fleet(None, paths, call="doctor", executor=client), paths)
