"""Raylets on this machine, which start on a busy one too."""

from __future__ import annotations

import contextlib
import os
import time

START_S = 300
"""Time that a raylet may take to start. Ray's own 30 s are too few where other programs keep the processors busy."""


@contextlib.contextmanager
def _patience():
    """Ray waits as long as START_S for a node to report itself."""
    import ray._private.services as services

    once = services.get_node

    def patient(*arguments, **named):
        until = time.monotonic() + START_S
        while True:
            try:
                return once(*arguments, **named)
            except RuntimeError:
                if time.monotonic() > until:
                    raise
                time.sleep(0.2)

    os.environ["RAY_gcs_server_port_wait_time_s"] = str(START_S)
    services.get_node = patient
    try:
        yield
    finally:
        services.get_node = once


class Raylets:
    """A head that flies nothing, and workers of one processor each."""

    def __init__(self, workers: int) -> None:
        from ray.cluster_utils import Cluster

        self.cluster = Cluster()
        self.workers = []
        try:
            with _patience():
                self.cluster.add_node(wait=False, num_cpus=0, include_dashboard=False)
            for _ in range(workers):
                self.add()
        except BaseException:
            self.stop()
            raise

    @property
    def address(self) -> str:
        return self.cluster.address

    def add(self) -> None:
        """One worker more."""
        with _patience():
            self.workers.append(self.cluster.add_node(wait=False, num_cpus=1))
            self.cluster.wait_for_nodes(timeout=START_S)

    def process_of(self, worker: int) -> int:
        """The raylet's process."""
        kinds = self.workers[worker].all_processes
        return next(info.process.pid for kind, infos in kinds.items() if kind == "raylet" for info in infos)

    def stop(self) -> None:
        import ray

        if ray.is_initialized():
            ray.shutdown()
        self.cluster.shutdown()
