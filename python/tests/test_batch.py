"""A batch draws every input once, whatever happens meanwhile: on one machine."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("pyarrow")

from crowd import FLAGS, OPTIONS, batch, children, drawings, ended, noted, pictures, report, rows, until

import strokefit

on_linux = pytest.mark.skipif(sys.platform != "linux", reason="processes are found in /proc")


@pytest.fixture
def crowd(tmp_path: Path) -> Path:
    """30 pictures, one without content, one that is text, one that is cut off."""
    folder = tmp_path / "in"
    paths = pictures(folder, 30)
    (folder / "0/empty.png").write_bytes(b"")
    (folder / "text.jpg").write_text("hello")
    (folder / "0/short.PNG").write_bytes(Path(paths[3]).read_bytes()[:200])
    (folder / "readme.txt").write_text("not among them")
    (folder / "0/._0.png").write_bytes(b"not among them, either")
    return folder


def test_every_input_has_its_row(crowd: Path, tmp_path: Path) -> None:
    summary = strokefit.batch(crowd, tmp_path / "out", **OPTIONS)
    assert (summary.drawn, summary.failed, summary.before, summary.repeated) == (30, 3, 0, 0)
    assert len(summary.cpu_s_percentiles) == 6 and 15 < summary.psnr_db_percentiles[2] < 60
    found = rows(tmp_path / "out")
    assert len(found) == 33
    for i in range(0, 30, 7):
        path = str(crowd / f"0/{i}.png")
        assert found[path]["svg"] == strokefit.fit(path, threads=1, **OPTIONS).svg
        assert report(found[path])["input"]["path"] == path and report(found[path])["cpu_s"] > 0
    assert found[str(crowd / "0/empty.png")]["error"].startswith("ValueError: the picture: the file is empty")
    for path in ("text.jpg", "0/short.PNG"):
        row = found[str(crowd / path)]
        assert row["svg"] is None and row["report"] is None and "the picture" in row["error"]


def test_files_are_in_the_tree_of_the_pictures(crowd: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    summary = strokefit.batch(crowd, out, files=True, **OPTIONS)
    assert (summary.drawn, summary.failed) == (30, 3)
    svgs = sorted(path.relative_to(out) for path in out.rglob("*.svg"))
    assert len(svgs) == 30 and Path("0/17.svg") in svgs
    assert (out / "0/17.svg").read_text() == strokefit.fit(crowd / "0/17.png", **OPTIONS).svg
    assert strokefit.batch(crowd, out, files=True, **OPTIONS).before == 33


@pytest.mark.parametrize("workers", [1, 4])
def test_workers_change_nothing(workers: int, crowd: Path, tmp_path: Path) -> None:
    strokefit.batch(crowd, tmp_path / "two", workers=2, **OPTIONS)
    strokefit.batch(crowd, tmp_path / "other", workers=workers, **OPTIONS)
    assert drawings(tmp_path / "two") == drawings(tmp_path / "other")


def test_what_is_done_is_not_done_again(crowd: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    strokefit.batch(crowd, out, limit=10, **OPTIONS)
    before = {path: path.stat().st_mtime_ns for path in out.glob("*.parquet")}
    summary = strokefit.batch(crowd, out, **OPTIONS)
    assert (summary.drawn + summary.failed, summary.before) == (23, 10)
    assert {path: path.stat().st_mtime_ns for path in before} == before
    assert len(rows(out)) == 33
    assert strokefit.batch(crowd, out, **OPTIONS).before == 33
    assert sorted(path.name for path in (out / "_strokefit").iterdir()) == ["batch.json", "lock"]


def test_errors_are_drawn_anew_only_on_demand(crowd: Path, tmp_path: Path) -> None:
    for files in (False, True):
        out = tmp_path / f"out-{files}"
        assert strokefit.batch(crowd, out, files=files, **OPTIONS).failed == 3
        (crowd / "text.jpg").write_bytes((crowd / "0/1.png").read_bytes())
        assert strokefit.batch(crowd, out, files=files, **OPTIONS).before == 33
        summary = strokefit.batch(crowd, out, files=files, retry=True, **OPTIONS)
        assert (summary.drawn, summary.failed, summary.before) == (1, 2, 30)
        (crowd / "text.jpg").write_text("hello")
    assert len(rows(tmp_path / "out-False")) == 33


def test_other_options_are_refused_by_name(crowd: Path, tmp_path: Path) -> None:
    strokefit.batch(crowd, tmp_path / "out", limit=1, **OPTIONS)
    with pytest.raises(ValueError, match=r"strokes=12 there, 13 now"):
        strokefit.batch(crowd, tmp_path / "out", **{**OPTIONS, "strokes": 13})
    with pytest.raises(ValueError, match=r"files=False there, True now"):
        strokefit.batch(crowd, tmp_path / "out", files=True, **OPTIONS)
    kept = tmp_path / "out/_strokefit/batch.json"
    kept.write_text(json.dumps({**json.loads(kept.read_text()), "strokefit": "0.0.1"}))
    with pytest.raises(ValueError, match=r"strokefit='0.0.1' there"):
        strokefit.batch(crowd, tmp_path / "out", **OPTIONS)


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"strokes": 0}, ValueError, "strokes is 0: give a whole number"),
        ({"speed": 3}, TypeError, "'speed' is no option"),
        ({"threads": 2}, TypeError, "'threads' is no option"),
        ({"engine": "spark"}, ValueError, "give local or ray"),
        ({"address": "auto"}, ValueError, "engine='ray'"),
        ({"workers": 0}, ValueError, "workers=0"),
        ({"limit": 0}, ValueError, "limit=0"),
        ({"sample": 1.5}, ValueError, "sample=1.5"),
    ],
)
def test_wrong_options_write_nothing(options: dict[str, object], error: type, words: str, crowd: Path, tmp_path: Path) -> None:
    with pytest.raises(error, match=words):
        strokefit.batch(crowd, tmp_path / "out", **options)
    with pytest.raises(FileNotFoundError, match="no-such: no such file"):
        strokefit.batch([crowd, tmp_path / "no-such"], tmp_path / "out")
    assert not (tmp_path / "out").exists()


@on_linux
def test_a_killed_batch_goes_on(tmp_path: Path) -> None:
    pictures(tmp_path / "in", 200)
    out = tmp_path / "out"
    process = batch(tmp_path / "in", "-o", out, *FLAGS)
    until(lambda: noted(out) >= 60)
    process.kill()
    ended(process)
    kept = noted(out)
    assert kept < 200
    status, words = ended(batch(tmp_path / "in", "-o", out, *FLAGS))
    assert status == 0 and f"{200 - kept} drawn, 0 failed" in words and f"{kept} were done before" in words
    assert len(rows(out)) == 200


@on_linux
def test_killed_workers_lose_nothing(tmp_path: Path) -> None:
    pictures(tmp_path / "in", 200)
    out = tmp_path / "out"
    process = batch(tmp_path / "in", "-o", out, "--workers", 2, *FLAGS)
    for enough in (40, 80):
        until(lambda: noted(out) >= enough)
        for worker in children(process.pid):
            os.kill(worker, signal.SIGKILL)
    status, words = ended(process)
    assert status == 0 and "200 drawn, 0 failed" in words
    assert len(rows(out)) == 200


def test_a_picture_that_ends_its_process_is_a_row(crowd: Path, bomb: dict[str, str], tmp_path: Path) -> None:
    (crowd / "0/bomb.png").write_bytes((crowd / "0/1.png").read_bytes())
    status, words = ended(batch(crowd, "-o", tmp_path / "out", "--workers", 2, *FLAGS, **bomb))
    assert status == 1 and "30 drawn, 4 failed" in words
    assert f"error: {crowd / 'text.jpg'}: ValueError: the picture" in words
    assert "its process ended 3 times" in str(rows(tmp_path / "out")[str(crowd / "0/bomb.png")]["error"])


def test_a_worker_that_does_not_start_ends_the_batch(crowd: Path, tmp_path: Path) -> None:
    (tmp_path / "sitecustomize.py").write_text("import sys\nif sys.argv[0] == '-c': sys.exit('no memory')")
    status, words = ended(batch(crowd, "-o", tmp_path / "out", *FLAGS, PYTHONPATH=str(tmp_path)))
    assert status == 1 and "a worker of the batch does not start" in words
    assert not list((tmp_path / "out").glob("*.parquet"))


@on_linux
def test_a_full_disk_ends_the_batch_and_loses_nothing(tmp_path: Path) -> None:
    import resource

    pictures(tmp_path / "in", 40)
    out = tmp_path / "out"
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, limits[1]))
    try:
        process = batch(tmp_path / "in", "-o", out, *FLAGS)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    status, words = ended(process)
    assert status == 1 and "error: " in words and "goes on" in words
    kept = noted(out)
    assert 0 < kept < 40
    summary = strokefit.batch(tmp_path / "in", out, **OPTIONS)
    assert (summary.before, summary.drawn) == (kept, 40 - kept)
    assert len(rows(out)) == 40


@on_linux
def test_two_batches_do_not_write_to_one_folder(tmp_path: Path) -> None:
    pictures(tmp_path / "in", 200)
    out = tmp_path / "out"
    racers = [batch(tmp_path / "in", "-o", out, "--workers", 1, *FLAGS) for _ in range(2)]
    (first, said), (second, words) = sorted((ended(racer) for racer in racers), key=lambda end: end[0])
    assert first == 0 and "200 drawn" in said
    assert second == 1 and "is being written to by process" in words
    assert len(rows(out)) == 200


@on_linux
def test_ctrl_c_leaves_no_process_and_the_rest_for_later(tmp_path: Path) -> None:
    pictures(tmp_path / "in", 200)
    out = tmp_path / "out"
    process = batch(tmp_path / "in", "-o", out, *FLAGS)
    until(lambda: noted(out) >= 20)
    workers = children(process.pid)
    process.send_signal(signal.SIGINT)
    status, words = ended(process, timeout_s=10)
    assert status == 130 and words == "Stopped. The same command goes on.\n"
    assert workers and not any(Path(f"/proc/{worker}").exists() for worker in workers)
    kept = noted(out)
    summary = strokefit.batch(tmp_path / "in", out, **OPTIONS)
    assert (summary.before, summary.drawn, len(rows(out))) == (kept, 200 - kept, 200)


def test_progress_ends_a_batch_that_it_raises_in(crowd: Path, tmp_path: Path) -> None:
    seen: list[strokefit.Progress] = []

    def progress(now: strokefit.Progress) -> None:
        seen.append(now)
        if len(seen) == 12:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        strokefit.batch(crowd, tmp_path / "out", progress=progress, **OPTIONS)
    summary = strokefit.batch(crowd, tmp_path / "out", progress=seen.append, **OPTIONS)
    assert summary.before == 12 and len(seen) == 33
    assert seen[-1].done == 33 and seen[-1].total == 33 and seen[-1].left_s == 0
    assert str(seen[-1]).startswith("33 of 33 done")


def test_an_estimate_writes_nothing(crowd: Path, tmp_path: Path) -> None:
    estimate = strokefit.estimate_batch(crowd, tmp_path / "out", **OPTIONS)
    assert (estimate.inputs, estimate.missing, estimate.sampled) == (33, 33, 20)
    assert estimate.cpu_s > estimate.error_s > 0 and estimate.svg_bytes > 1000
    assert not (tmp_path / "out").exists()
    strokefit.batch(crowd, tmp_path / "out", limit=30, **OPTIONS)
    assert strokefit.estimate_batch(crowd, tmp_path / "out", **OPTIONS)[:3] == (33, 3, 3)


def test_a_share_is_the_same_every_time(crowd: Path, tmp_path: Path) -> None:
    half = strokefit.batch(crowd, tmp_path / "out", sample=0.5, **OPTIONS)
    assert 5 < half.drawn + half.failed < 28
    again = strokefit.batch(crowd, tmp_path / "out", sample=0.5, **OPTIONS)
    assert (again.drawn, again.before) == (0, half.drawn + half.failed)


def test_the_module_is_the_function(crowd: Path, tmp_path: Path) -> None:
    code = "import sys, strokefit.batch; print(strokefit.batch(*sys.argv[1:], limit=2, strokes=2).drawn)"
    command = [sys.executable, "-c", code, crowd, tmp_path / "out"]
    assert subprocess.check_output(command, text=True) == "2\n"
