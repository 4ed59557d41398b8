"""Results: shards, journals, and what is left of a batch that was ended."""

from __future__ import annotations

import gc
import tracemalloc
from pathlib import Path

import pytest

pytest.importorskip("pyarrow")

from crowd import noted, rows

import strokefit
from strokefit._batch import local, results
from strokefit._batch.draw import Row, failed
from strokefit._batch.seen import Seen

FINGERPRINT = {"files": False, "strokes": 5}


def row(i: int) -> Row:
    report = {"cpu_s": 0.1, "fidelity": {"psnr_db": None}, "svg_bytes": 3}
    return Row(f"{i}.png", str(i), f"<svg {i}>", report, None)  # type: ignore[arg-type]


def write(folder: Path, numbers: range) -> None:
    with results.opened(str(folder), FINGERPRINT) as written:
        for i in numbers:
            written.add(row(i))
        written.finish()


def test_shards_are_of_one_size(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(results, "SHARD_ROWS", 10)
    write(tmp_path, range(25))
    write(tmp_path, range(25, 40))
    assert [path.name for path in sorted(tmp_path.glob("*.parquet"))] == [f"part-{i:06}.parquet" for i in range(5)]
    assert {path: int(str(row["svg"])[5:-1]) for path, row in rows(tmp_path).items()} == {f"{i}.png": i for i in range(40)}


@pytest.mark.parametrize("left", [b"", b'{"path":"7.png","re', b"\xff\x00"])
def test_a_line_that_was_cut_off_is_no_row(left: bytes, tmp_path: Path) -> None:
    with results.opened(str(tmp_path), FINGERPRINT) as written:
        for i in range(7):
            written.add(row(i))
    assert noted(tmp_path) == 7 and not rows(tmp_path)
    with (tmp_path / "_strokefit/part-000000.jsonl").open("ab") as journal:
        journal.write(left)
    with results.opened(str(tmp_path), FINGERPRINT) as written:
        assert len(written.done) == 7 and "6.png" in written.done and "7.png" not in written.done
        written.add(row(7))
        written.finish()
    assert len(rows(tmp_path)) == 8


def test_a_journal_whose_shard_is_there_is_dropped(tmp_path: Path) -> None:
    with results.opened(str(tmp_path), FINGERPRINT) as written:
        written.add(row(0))
    journal = tmp_path / "_strokefit/part-000000.jsonl"
    kept = journal.read_bytes()
    write(tmp_path, range(1, 2))
    journal.write_bytes(kept)
    write(tmp_path, range(2, 3))
    assert set(rows(tmp_path)) == {"0.png", "1.png", "2.png"} and not journal.exists()


def test_a_shard_that_was_not_finished_is_not_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched, pytest.raises(OSError, match="No space"):
        patched.setattr(results.os, "fsync", broken)
        write(tmp_path, range(3))
    assert not rows(tmp_path)
    write(tmp_path, range(3, 4))
    assert len(rows(tmp_path)) == 4


def test_the_lock_is_free_when_its_holder_has_ended(tmp_path: Path) -> None:
    with results.opened(str(tmp_path), FINGERPRINT):
        with pytest.raises(BlockingIOError, match=r"is being written to by process \d+ on "):
            write(tmp_path, range(1))
    write(tmp_path, range(1))


def test_seen_texts_are_those_that_were_added() -> None:
    seen, expected = Seen(), set()
    for i in range(20_000):
        text = f"photos/{i * 7919 % 12_007}.png"
        assert seen.add(text) == (text not in expected)
        expected.add(text)
    assert len(seen) == len(expected)
    assert all(text in seen for text in expected) and "photos/-1.png" not in seen


def test_memory_does_not_grow_with_the_inputs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def rows_of(inputs: object, *_: object) -> object:
        return (failed(one, "not drawn") for one in inputs)  # type: ignore[attr-defined]

    monkeypatch.setattr(local, "rows", rows_of)

    listed, held = tmp_path / "list.txt", []
    listed.write_text("".join(f"photos/{i}.png\n" for i in range(12_000)))

    def progress(now: strokefit.Progress) -> None:
        if now.failed in (3_500, 11_500):
            gc.collect()
            held.append(tracemalloc.get_traced_memory()[0])

    tracemalloc.start()
    assert strokefit.batch(listed, tmp_path / "out", progress=progress).failed == 12_000
    tracemalloc.stop()
    # Digests take some 16 to 100 bytes each; a row takes 200, and an input 300.
    assert held[1] - held[0] < 8_000 * 100
