"""Campaigns on Ray: two raylets on this machine, one killed, the driver killed; the same bytes as one process.

FGA_RAY_ENCOUNTERS and FGA_RAY_SHARDS set the sizes; the evidence is made with 200000 and 100000.
"""

import errno
import hashlib
import os
import signal
import stat
import subprocess
import sys
import time

import pytest
from conftest import needed

import fga

ray = needed("ray")
from fga import ray as fga_ray  # noqa: E402
from fga._store import store_of  # noqa: E402
from raylets import Raylets  # noqa: E402

CAMPAIGN = """name = "spread"
seeds = [1]
policies = ["turn-aware"]
[[grid]]
family = "threats"
count = [1]
first_seen_m = [300]
speed_mps = [[5, 20]]
"""
ENCOUNTERS = int(os.environ.get("FGA_RAY_ENCOUNTERS", "6000"))


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "spread.toml"
    path.write_text(CAMPAIGN)
    return path


@pytest.fixture(scope="module")
def cluster():
    # The workers import a policy of one's own from this folder.
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", os.path.dirname(__file__), prepend=os.pathsep)
        # The head flies nothing, so that the killed raylet is another one.
        raylets = Raylets(2)
    yield raylets
    raylets.stop()


DRIVER = """
import sys
from fga import ray
ray.run(sys.argv[1], sys.argv[2], encounters=int(sys.argv[3]), address=sys.argv[4],
        progress=lambda done, total: print(done, flush=True))
"""


def count_of(driver):
    """The next count of encounters that the driver prints; Ray prints other lines."""
    for line in driver.stdout:
        if line.strip().isdigit():
            return int(line)
        print("driver:", line.strip())
    return 0


def test_a_lost_raylet_and_a_lost_driver_cost_no_byte(cluster, file, tmp_path):
    whole = fga.campaign(file, tmp_path / "whole", encounters=ENCOUNTERS)
    out = tmp_path / "spread"
    command = [sys.executable, "-c", DRIVER, str(file), str(out), str(ENCOUNTERS), cluster.address]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as driver:
        assert count_of(driver) > 0, "the first block"
        os.kill(cluster.process_of(0), signal.SIGKILL)
        assert count_of(driver) > 0, "a block after the raylet was lost"
        driver.send_signal(signal.SIGKILL)
    assert not (out / "results.parquet").exists()
    kept = {name for name in os.listdir(out / "blocks") if name.endswith(".parquet")}
    assert len(kept) >= 2
    seen = []
    flown = fga_ray.run(
        file, out, encounters=ENCOUNTERS, address=cluster.address, progress=lambda *p: seen.append(p)
    )
    assert flown.sha256 == whole.sha256
    assert hashlib.sha256((out / "results.parquet").read_bytes()).hexdigest() == whole.sha256
    assert seen[-1][0] == ENCOUNTERS and seen[0][0] > len(kept) * 200, "what was there is not flown again"
    again = fga_ray.run(file, out, encounters=ENCOUNTERS, address=cluster.address)
    assert again.sha256 == whole.sha256


class RightTurn:
    """A policy of one's own, on both sides."""

    def step(self, situation):
        near = any(abs(obstacle.position_m[0] - situation.ownship.position_m[0]) < 2000 for obstacle in situation.obstacles)
        return (situation.ownship.course_rad - 0.3, 0.0) if near else None


def test_a_league_on_ray_has_the_bytes_of_one_here(cluster, tmp_path):
    given = {
        "policies": ["none", "mvp", RightTurn()],
        "intruders": [RightTurn()],
        "sets": ["drawn-1hz", "fleet-1hz"],
        "encounters": 12,
        "worst": 1,
    }
    here = fga.league(tmp_path / "here", **given)
    there = fga_ray.league(tmp_path / "there", address=cluster.address, **given)
    assert here == there and len(here) == 6
    for name in ["league.html", "league.csv", "league.parquet", "drawn-1hz/mvp/results.parquet"]:
        assert (tmp_path / "here" / name).read_bytes() == (tmp_path / "there" / name).read_bytes(), name
    # Nothing is flown a second time.
    assert fga_ray.league(tmp_path / "there", address="nowhere", **given) == here


NOTEBOOK = """
import sys, fga
from fga import ray
class Mine:
    def step(self, situation): return (situation.ownship.course_rad - 0.3, 0.0) if situation.obstacles else None
given = {"policies": [Mine], "sets": ["drawn-1hz"], "encounters": 12, "worst": 0}
out, address = sys.argv[1:3]
assert ray.league(out + "/there", address=address, **given) == fga.league(out + "/here", **given)
"""


def test_a_class_of_a_notebook_flies_on_ray(cluster, tmp_path):
    command = [sys.executable, "-c", NOTEBOOK, str(tmp_path), cluster.address]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "here/league.html").read_bytes() == (tmp_path / "there/league.html").read_bytes()


def test_empty_blocks_take_little_of_the_driver(cluster):
    if not ray.is_initialized():
        ray.init(address=cluster.address, include_dashboard=False, log_to_driver=False)
    told = fga_ray.dry_run(int(os.environ.get("FGA_RAY_SHARDS", "500")))
    print(told)
    assert told["shards"] == int(os.environ.get("FGA_RAY_SHARDS", "500"))
    assert told["driver_grew_mb"] < 200


def test_a_block_that_cannot_be_written_is_a_clear_error_and_loses_nothing(cluster, file, tmp_path, monkeypatch):
    whole = fga.campaign(file, tmp_path / "whole", encounters=ENCOUNTERS)
    fly = fga_ray.fly_block

    def full(configuration, place, block):
        if block >= 5:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return fly(configuration, place, block)

    out = tmp_path / "spread"
    with monkeypatch.context() as patched:
        patched.setattr(fga_ray, "fly_block", full)
        with pytest.raises(OSError, match="No space left"):
            fga_ray.run(file, out, encounters=ENCOUNTERS, address=cluster.address, in_flight=2)
    kept = [name for name in os.listdir(out / "blocks") if name.endswith(".parquet")]
    assert len(kept) >= 4
    flown = fga_ray.run(file, out, encounters=ENCOUNTERS, address=cluster.address)
    assert flown.sha256 == whole.sha256


def test_a_folder_that_is_full_is_a_clear_error_and_loses_nothing(cluster, file, tmp_path):
    """A full disk: a small file system in memory."""
    place = tmp_path / "small"
    place.mkdir()
    whole = fga.campaign(file, tmp_path / "whole", encounters=ENCOUNTERS)
    half = f"size={os.path.getsize(whole.results) // 2}"
    if subprocess.run(["mount", "-t", "tmpfs", "-o", half, "tmpfs", str(place)], capture_output=True).returncode:
        # No package gives this right; the test before it needs none.
        pytest.skip("a file system cannot be mounted here")
    try:
        with pytest.raises(OSError, match="No space left"):
            fga_ray.run(file, place, encounters=ENCOUNTERS, address=cluster.address)
        kept = [name for name in os.listdir(place / "blocks") if name.endswith(".parquet")]
        assert kept and all(os.path.getsize(place / "blocks" / name) > 0 for name in kept)
        subprocess.run(["mount", "-o", "remount,size=64m", str(place)], check=True)
        flown = fga_ray.run(file, place, encounters=ENCOUNTERS, address=cluster.address)
        assert flown.sha256 == whole.sha256
    finally:
        subprocess.run(["umount", "-l", str(place)], check=False)


def test_a_place_that_cannot_be_written_is_an_error_before_anything_is_flown(file, tmp_path):
    with pytest.raises(OSError):
        fga_ray.run(file, "/proc/fga", encounters=300, address="nowhere")
    folder = tmp_path / "closed"
    folder.mkdir()
    folder.chmod(stat.S_IRUSR | stat.S_IXUSR)
    if os.geteuid() != 0:
        with pytest.raises(OSError):
            fga_ray.run(file, folder, encounters=300, address="nowhere")


def test_what_no_cluster_is_needed_for_is_said_before_one_is_looked_for(file, tmp_path):
    with pytest.raises(ValueError, match="in_flight is 0, expected at least 1"):
        fga_ray.run(file, tmp_path / "out", address="nowhere", in_flight=0)
    with pytest.raises(ValueError, match="in_flight is -1, expected at least 1"):
        fga_ray.dry_run(5, address="nowhere", in_flight=-1)


def test_a_cluster_that_does_not_start_is_a_clear_error(monkeypatch):
    def init(**_):
        raise Exception("The current node timed out during startup.")  # noqa: TRY002

    class Ray:
        is_initialized = staticmethod(lambda: False)

    Ray.init = staticmethod(init)
    with pytest.raises(OSError, match="the Ray cluster local does not answer: The current node timed out"):
        fga_ray._connected(Ray, "local")


def test_a_place_of_another_campaign_is_refused(file, tmp_path):
    fga.Campaign(file, encounters=300).open(tmp_path / "out")
    with pytest.raises(ValueError, match="another configuration"):
        fga_ray.run(file, tmp_path / "out", encounters=301, address="nowhere")


def test_a_block_of_another_content_is_named(file, tmp_path):
    campaign = fga.Campaign(file, encounters=300)
    campaign.open(tmp_path / "out")
    for digit in "ab":
        (tmp_path / "out" / "blocks" / f"block-00000000-{digit * 32}.parquet").write_bytes(b"")
    with pytest.raises(ValueError, match="no block of this campaign"):
        fga_ray.run(file, tmp_path / "out", encounters=300, address="nowhere")


def test_the_command_says_what_is_wrong_in_a_sentence(tmp_path):
    told = subprocess.run(
        [sys.executable, "-m", "fga.campaign", str(tmp_path / "none.toml")], capture_output=True, text=True
    )
    assert told.returncode == 1 and told.stderr.startswith("fga: ") and "Traceback" not in told.stderr


def test_an_object_store_holds_the_same_bytes(file, tmp_path):
    """A local S3 server."""
    server = needed("moto.server")
    needed("s3fs")
    import fsspec

    s3 = server.ThreadedMotoServer(port=0, verbose=False)
    s3.start()
    try:
        host, port = s3.get_host_and_port()
        keys = {"AWS_ACCESS_KEY_ID": "a", "AWS_SECRET_ACCESS_KEY": "b", "AWS_DEFAULT_REGION": "us-east-1"}
        os.environ.update(keys, AWS_ENDPOINT_URL=f"http://{host}:{port}")
        fs = fsspec.filesystem("s3")
        fs.mkdir("bucket")
        whole = fga.campaign(file, tmp_path / "whole", encounters=600)
        url = "s3://bucket/spread"
        campaign = fga.Campaign(file, encounters=600)
        store = store_of(url)
        store.open(campaign)
        for block in range(campaign.blocks):
            fga_ray.fly_block(fga_ray.pickled(campaign), url, block)
        assert len(store.names()) == campaign.blocks
        told = fga_ray.run(file, url, encounters=600, address="nowhere")
        assert told.sha256 == whole.sha256
        assert hashlib.sha256(fs.cat_file("bucket/spread/results.parquet")).hexdigest() == whole.sha256
        assert fga_ray.run(file, url, encounters=600, address="nowhere").sha256 == whole.sha256
        with pytest.raises(ValueError, match="another configuration"):
            fga_ray.run(file, url, encounters=601, address="nowhere")
    finally:
        s3.stop()
        time.sleep(0.1)
