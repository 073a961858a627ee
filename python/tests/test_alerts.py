"""Alerts and bands: the bytes of the program, and the monitor step by step."""

import math
import threading

import pytest
from conftest import needed

import fga

CONFIGURATION = """lookahead_time = 180.0 [s]
corrective_region = NEAR
alerters = A
A_alert_1_region = NEAR
A_alert_1_alerting_time = 60.0 [s]
A_alert_1_detector = det_1
A_det_1_D = 2000 [ft]
A_det_1_H = 250 [ft]
A_load_core_detection_det_1 = CDCylinder
"""


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "one.conf"
    path.write_text(CONFIGURATION)
    return path


@pytest.fixture
def recording(tmp_path):
    """Two aircraft head-on, 10 km apart."""
    rows = ["NAME, time, sx, sy, sz, vx, vy, vz", "[none], [s], [m], [m], [m], [m/s], [m/s], [m/s]"]
    for time_s in range(0, 60, 5):
        rows.append(f"own, {time_s}, 0, {50 * time_s}, 1000, 0, 50, 0")
        rows.append(f"intruder, {time_s}, 0, {10000 - 50 * time_s}, 1000, 0, -50, 0")
    path = tmp_path / "head-on.daa"
    path.write_text("\n".join(rows) + "\n")
    return path


def test_alerts_and_bands_are_the_bytes_of_the_program(recording, config, tmp_path, fga_program):
    for name, call, file in [("alerts", fga.alerts, "alerts.csv"), ("bands", fga.bands, "bands.out")]:
        fga_program(name, recording, "--config", config, "--out", tmp_path)
        assert call(recording, config).to_csv() == (tmp_path / file).read_bytes()


def test_rows_say_when_the_alert_begins(recording, config):
    pyarrow = needed("pyarrow")
    rows = pyarrow.table(fga.alerts(recording, config)).to_pylist()
    levels = {row["time_s"]: row["level"] for row in rows}
    # They meet after 100 s at 100 m/s; the volume begins 6.1 s earlier, the alert 60 s before that.
    assert [levels[time_s] for time_s in (30.0, 35.0, 55.0)] == [0, 1, 1]
    assert rows[-1]["violation_s"] == pytest.approx(45.0 - 609.6 / 100.0, abs=1e-6)
    bands = pyarrow.table(fga.bands(recording, config)).to_pylist()
    ahead = [
        band
        for band in bands
        if band["time_s"] == 55.0 and band["quantity"] == "direction_rad" and band["low"] <= 0.0 < band["high"]
    ]
    assert [band["region"] for band in ahead] == ["near"]


def situation(time_s, gap_m, ids=(7,)):
    own = fga.Ownship((0, 50 * time_s, 1000), math.pi / 2, 50.0)
    others = [fga.Obstacle(i, (0, 50 * time_s + gap_m, 1000), 100, (0, -50, 0)) for i in ids]
    return fga.Situation(time_s, own, fga.Mission([]), others)


def test_a_monitor_follows_situations(config):
    monitor = fga.Monitor(config)
    assert monitor.step(situation(0.0, 40_000.0)) == {7: 0}
    assert monitor.highest_level == 0 and monitor.resolutions() == (None, None)
    assert monitor.step(situation(1.0, 4_000.0)) == {7: 1}
    assert monitor.highest_level == 1
    # The course is north: a band of conflict around it, with a way out to the right.
    assert any(low <= 0.0 < high and region == "near" for low, high, region in monitor.bands())
    left, right = monitor.resolutions("direction_rad")
    assert right is not None and 0.0 < right < math.pi
    assert left is None or math.pi < left < 2 * math.pi


def test_wrong_input_of_a_monitor_is_an_exception(config, tmp_path):
    monitor = fga.Monitor(config)
    with pytest.raises(ValueError, match='quantity is "course", expected one of direction_rad'):
        monitor.bands("course")
    with pytest.raises(ValueError):
        monitor.step(situation(0.0, 4_000.0, ids=(7, 7)))
    with pytest.raises(FileNotFoundError, match="none.conf"):
        fga.Monitor(tmp_path / "none.conf")
    with pytest.raises(TypeError):
        __import__("pickle").dumps(monitor)
    failures = []

    def hammer():
        for k in range(200):
            try:
                monitor.step(situation(float(k), 4_000.0))
            except RuntimeError as error:
                failures.append(str(error))

    threads = [threading.Thread(target=hammer) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all("another thread" in text for text in failures)
