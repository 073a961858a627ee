"""Ring 2: many encounters; the same bytes as the program."""

import hashlib
import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from conftest import needed

import fga

CAMPAIGN = """name = "small"
seeds = [1]
policies = ["turn-aware", "none"]
[[grid]]
family = "threats"
count = [1, 2]
first_seen_m = [300]
speed_mps = [[5, 20]]
"""


@pytest.fixture
def encounters(tmp_path):
    rng = np.random.default_rng(4)
    rows = ["encounter,obstacle,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,radius_m,kind"]
    for encounter in range(120):
        for obstacle in range(2):
            time_s = rng.uniform(8, 20)
            x, y = rng.uniform(100, 300), rng.uniform(-200, 200)
            kind = ["straight", "aircraft", "uas"][encounter % 3]
            rows.append(
                f"{encounter},{obstacle},{x:.6f},{y:.6f},0,{(15 * time_s - x) / time_s:.6f},{-y / time_s:.6f},0,30,{kind}"
            )
    path = tmp_path / "encounters.csv"
    path.write_text("\n".join(rows) + "\n")
    return path


@pytest.fixture
def campaign_file(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(CAMPAIGN)
    return path


def test_batch_gives_the_bytes_of_the_program(encounters, fga_program, tmp_path):
    fga_program("batch", encounters, "--out", tmp_path / "out")
    table = fga.batch(encounters, threads=2)
    assert table.to_csv() == (tmp_path / "out" / "results.csv").read_bytes()
    assert len(table) == 120 and table.column_names[:2] == ["encounter", "separated"]


def test_oracle_gives_the_bytes_of_the_program(encounters, fga_program, tmp_path):
    few = tmp_path / "few.csv"
    few.write_text("".join(encounters.read_text().splitlines(keepends=True)[:13]))
    fga_program("oracle", few, "--out", tmp_path / "out")
    assert fga.oracle(few, threads=2).to_csv() == (tmp_path / "out" / "oracle.csv").read_bytes()


def test_a_run_writes_the_files_of_the_program(root, fga_program, tmp_path):
    file = root / "scenarios" / "first-flight.toml"
    fga_program("run", file, "--overlay", "none", "--out", tmp_path / "program")
    fga.run(file, overlay=["none"]).write(tmp_path / "python")
    for name in ("track.csv", "events.jsonl", "overview.svg", "replay.html", "flight.json"):
        assert (tmp_path / "python" / name).read_bytes() == (tmp_path / "program" / name).read_bytes(), name
    times = {"begun_unix_s", "wall_s", "decision_median_us", "decision_p99_us", "decision_max_us"}
    documents = [json.loads((tmp_path / kind / "run.json").read_text()) for kind in ("python", "program")]
    python, program = ({k: v for k, v in d.items() if k not in times} for d in documents)
    assert python == program


def test_tables_go_out_and_come_in_through_arrow(encounters):
    pa = needed("pyarrow")
    pl = needed("polars")
    pd = needed("pandas")
    expected = fga.batch(encounters, threads=2)
    assert pa.table(expected).num_rows == 120
    assert pl.DataFrame(expected)["min_margin_m"].min() == pa.table(expected)["min_margin_m"].to_numpy().min()
    frame = pd.read_csv(encounters)
    assert fga.batch(pl.read_csv(encounters), threads=2).to_csv() == expected.to_csv()
    assert fga.batch(pa.Table.from_pandas(frame), threads=2).to_csv() == expected.to_csv()
    if hasattr(frame, "__arrow_c_stream__"):
        assert fga.batch(frame, threads=2).to_csv() == expected.to_csv()
    chunked = pa.concat_tables([pa.Table.from_pandas(frame[:100]), pa.Table.from_pandas(frame[100:])])
    assert fga.batch(chunked, threads=2).to_csv() == expected.to_csv()


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda t: t.drop_columns(["x_m"]), "the column x_m is missing"),
        (lambda t: t.set_column(2, "x_m", [["a"] * 240]), "column x_m is of type"),
        (lambda t: t.set_column(2, "x_m", [[None] + [1.0] * 239]), "has 1 empty fields"),
        (lambda t: t.set_column(2, "x_m", [[float("nan")] * 240]), "row 0: column x_m holds NaN"),
        (lambda t: t.set_column(8, "radius_m", [[-1.0] * 240]), "radius of 0 metres or more"),
        (lambda t: t.set_column(1, "obstacle", [[-1] * 240]), "column obstacle"),
        (lambda t: t.set_column(1, "obstacle", [[1] * 240]), "second obstacle 1"),
        (lambda t: t.set_column(9, "kind", [["bird"] * 240]), "still, straight, aircraft or uas"),
        (lambda t: t.slice(0, 0), "no encounter"),
    ],
)
def test_wrong_tables_are_said_in_a_sentence(encounters, change, sentence):
    pa = needed("pyarrow")
    csv = needed("pyarrow.csv")
    table = csv.read_csv(encounters)
    assert isinstance(table, pa.Table)
    with pytest.raises(ValueError, match=sentence):
        fga.batch(change(table))


def test_a_campaign_gives_the_bytes_of_the_program(campaign_file, fga_program, tmp_path):
    fga_program("campaign", "run", campaign_file, "--encounters", 600, "--out", tmp_path / "program")
    seen = []
    flown = fga.campaign(
        campaign_file, tmp_path / "python", encounters=600, threads=2, progress=lambda *p: seen.append(p)
    )
    for name in ("results.parquet", "summary.csv", "summary.json", "campaign.json"):
        ours = (tmp_path / "python" / name).read_bytes()
        assert ours == (tmp_path / "program" / name).read_bytes(), name
    assert flown.sha256 == hashlib.sha256((tmp_path / "python" / "results.parquet").read_bytes()).hexdigest()
    assert seen[-1] == (600, 600)
    assert len(flown.table()) == 1200
    again = fga.campaign(campaign_file, tmp_path / "python", encounters=600)
    assert again.sha256 == flown.sha256


def test_blocks_flown_one_by_one_give_the_same_bytes(campaign_file, tmp_path):
    import pickle

    campaign = pickle.loads(pickle.dumps(fga.Campaign(campaign_file, encounters=600)))
    whole = fga.campaign(campaign_file, tmp_path / "whole", encounters=600)
    folder = tmp_path / "blocks"
    campaign.open(folder)
    for block in reversed(range(campaign.blocks)):
        name, rows, data = campaign.fly_block(block, threads=1)
        assert campaign.block_of(name) == block and rows == 2 * (campaign.range_of(block)[1] - campaign.range_of(block)[0])
        (folder / "blocks" / name).write_bytes(data)
    assert campaign.merge(folder) == whole.sha256


def test_ctrl_c_ends_a_campaign_and_it_goes_on(campaign_file, tmp_path):
    """An interrupt in the middle raises KeyboardInterrupt; finished blocks stay."""
    script = (
        "import fga, sys\n"
        "def show(done, total):\n"
        "    if done > 0: print('going', flush=True)\n"
        f"fga.campaign({str(campaign_file)!r}, {str(tmp_path / 'out')!r}, encounters=40_000, threads=2, progress=show)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline() == "going\n"
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=120)
    assert process.returncode != 0 and "KeyboardInterrupt" in errors
    assert list((tmp_path / "out" / "blocks").glob("*.parquet"))


def test_a_file_in_place_of_the_folder_is_a_clear_error(campaign_file, tmp_path):
    place = tmp_path / "file"
    place.write_text("")
    with pytest.raises(OSError, match="file"):
        fga.campaign(campaign_file, place, encounters=10)


def test_progress_that_raises_ends_the_work(encounters):
    class Enough(Exception):
        pass

    def show(done, total):
        raise Enough

    begun = time.monotonic()
    with pytest.raises(Enough):
        fga.batch(encounters, threads=1, progress=show)
    assert begun and os.getpid()


@pytest.mark.skipif(not os.path.isdir("/proc/self/task"), reason="counts threads in /proc")
def test_no_thread_outlives_its_call(encounters):
    before = len(os.listdir("/proc/self/task"))
    fga.batch(encounters, threads=64)
    # The system may list a thread for a moment after it was joined.
    for _ in range(50):
        if len(os.listdir("/proc/self/task")) <= before:
            break
        time.sleep(0.1)
    assert len(os.listdir("/proc/self/task")) <= before


def test_the_replay_page_shows_in_a_notebook(root):
    page = fga.replay(fga.run(root / "scenarios" / "first-flight.toml"))
    shown = page._repr_html_()
    assert shown.startswith("<iframe srcdoc=") and "&lt;" in shown and "http" not in shown.split("srcdoc")[0]
