"""A batch draws every input once on a cluster, too: a head and two workers, processes of this machine."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ray = pytest.importorskip("ray")
pytest.importorskip("pyarrow")

from crowd import FLAGS, OPTIONS, batch, children, drawings, ended, noted, pictures, rows, until

import strokefit

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="Ray's processes are found in /proc")


class Cluster:
    """A head without cores, and nodes of one core each."""

    def __init__(self, log: Path, **environment: str) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.address = f"127.0.0.1:{free.getsockname()[1]}"
        self._log = log.open("ab")
        # Ray's processes give way to all others; on a busy machine that takes too long.
        ours = {"RAY_AUTH_MODE": "disabled", "RAY_USAGE_STATS_ENABLED": "0", "RAY_worker_niceness": "0"}
        self._variables = {**os.environ, **ours, **environment}
        self._nodes: list[subprocess.Popen[bytes]] = []
        port = self.address.split(":")[1]
        self._start("--head", f"--port={port}", "--num-cpus=0", "--include-dashboard=false")
        self.grow(2)

    def grow(self, cores: int) -> None:
        """Adds nodes until there are so many cores."""
        while self.cores() < cores:
            count = self.cores()
            self._start(f"--address={self.address}", "--num-cpus=1")
            until(lambda: self.cores() > count)

    def cores(self) -> int:
        code = f"import ray; ray.init('{self.address}', log_to_driver=False); print(ray.cluster_resources().get('CPU', 0))"
        run = [sys.executable, "-c", code]
        told = subprocess.run(run, env=self._variables, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
        return int(float(told.stdout or 0))

    def batch(self, *args: object) -> subprocess.Popen[str]:
        environment = {"RAY_AUTH_MODE": "disabled"}
        return batch(*args, "--engine", "ray", "--address", self.address, *FLAGS, **environment)

    def kill_node(self) -> None:
        """Kills the raylet of the node that was added last."""
        node = self._nodes.pop()
        started = {child: Path(f"/proc/{child}/cmdline").read_bytes() for child in children(node.pid)}
        os.kill(next(child for child, words in started.items() if b"/raylet\0" in words), signal.SIGKILL)
        node.wait(60)

    def stop(self) -> None:
        for node in self._nodes:
            node.terminate()
        for node in self._nodes:
            node.wait(60)
        self._log.close()

    def _start(self, *args: str) -> None:
        command = [sys.executable, "-m", "ray.scripts.scripts", "start", *args, "--block"]
        self._nodes.append(subprocess.Popen(command, env=self._variables, stdout=self._log, stderr=self._log))


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    folder = tmp_path_factory.mktemp("cluster")
    # A picture named bomb.png ends the process that draws it.
    (folder / "sitecustomize.py").write_text("""
import os
if b"default_worker.py" in open("/proc/self/cmdline", "rb").read():
    from strokefit._batch import draw

    def read(one, read=draw.read):
        if one.path.endswith("bomb.png"):
            os.abort()
        return read(one)

    draw.read = read
""")
    cluster = Cluster(folder / "log", PYTHONPATH=str(folder))
    yield cluster
    cluster.stop()


@pytest.fixture(scope="module")
def crowd(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """200 pictures, and two that are none."""
    folder = tmp_path_factory.mktemp("crowd")
    pictures(folder, 200)
    (folder / "2/empty.png").write_bytes(b"")
    (folder / "3/text.jpg").write_text("hello")
    return folder


@pytest.fixture(scope="module")
def expected(crowd: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, object]:
    """Drawings of the local engine."""
    out = tmp_path_factory.mktemp("local")
    strokefit.batch(crowd, out, **OPTIONS)
    return drawings(out)


def test_the_bytes_are_those_of_the_local_engine(
    cluster: Cluster, crowd: Path, expected: dict[str, object], tmp_path: Path
) -> None:
    status, words = ended(cluster.batch(crowd, "-o", tmp_path / "out"))
    assert status == 1 and "200 drawn, 2 failed" in words, words
    assert drawings(tmp_path / "out") == expected
    status, words = ended(cluster.batch(crowd, "-o", tmp_path / "out"), timeout_s=10)
    assert status == 0 and "0 drawn, 0 failed" in words and "202 were done before" in words


def test_a_killed_node_loses_nothing(cluster: Cluster, crowd: Path, expected: dict[str, object], tmp_path: Path) -> None:
    out = tmp_path / "out"
    process = cluster.batch(crowd, "-o", out)
    until(lambda: noted(out) >= 50)
    cluster.kill_node()
    status, words = ended(process)
    assert status == 1 and "200 drawn, 2 failed" in words, words
    assert drawings(out) == expected
    cluster.grow(2)


def test_a_killed_batch_goes_on(cluster: Cluster, crowd: Path, expected: dict[str, object], tmp_path: Path) -> None:
    out = tmp_path / "out"
    process = cluster.batch(crowd, "-o", out)
    until(lambda: noted(out) >= 50)
    process.kill()
    ended(process)
    kept = noted(out)
    assert kept < 202
    status, words = ended(cluster.batch(crowd, "-o", out))
    # The two pictures that fail may be among those that were done before.
    assert status == (0 if " 0 failed" in words else 1) and f"{kept} were done before" in words, words
    assert drawings(out) == expected


def test_two_batches_do_not_write_to_one_folder(cluster: Cluster, crowd: Path, tmp_path: Path) -> None:
    racers = [cluster.batch(crowd, "-o", tmp_path / "out") for _ in range(2)]
    refused = "is being written to by process"
    (first, said), (second, words) = sorted((ended(racer) for racer in racers), key=lambda end: refused in end[1])
    assert first == 1 and "200 drawn, 2 failed" in said
    assert second == 1 and refused in words
    assert len(rows(tmp_path / "out")) == 202


def test_a_picture_that_ends_its_process_is_a_row(cluster: Cluster, crowd: Path, tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    for name in ("a.png", "b.png", "bomb.png"):
        (tmp_path / "in" / name).write_bytes((crowd / "0/0.png").read_bytes())
    # URLs are read where the picture is drawn.
    status, words = ended(cluster.batch((tmp_path / "in").as_uri(), "-o", tmp_path / "out"))
    assert status == 1 and "2 drawn, 1 failed" in words, words
    errors = [row["error"] for row in rows(tmp_path / "out").values() if row["error"]]
    assert errors == ["it was lost 5 times, at last by WorkerCrashedError"]


def test_without_an_address_ray_is_started_here(crowd: Path, tmp_path: Path) -> None:
    command = [crowd / "0", "-o", tmp_path / "out", "--engine", "ray", "--workers", 2, "--limit", 6, *FLAGS]
    status, words = ended(batch(*command))
    assert status == 0 and "6 drawn" in words, words
