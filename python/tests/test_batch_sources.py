"""Where a batch finds its inputs, and how drawings are named."""

from __future__ import annotations

import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

pa = pytest.importorskip("pyarrow")

import pyarrow.parquet as pq
from crowd import OPTIONS, drawings, pictures, rows

import strokefit
from strokefit._batch import inputs


@pytest.fixture
def seven(tmp_path: Path) -> list[str]:
    return pictures(tmp_path / "in", 7)


def found(*sources: object, **columns: str) -> list[str]:
    return [one.path for one in inputs.find(map(str, sources), **columns)]


def test_globs_are_those_of_a_shell(tmp_path: Path) -> None:
    for name in ("a.png", "b.jpg", "x/a.png", "x/y/c.png", "x/y/d1.png", "x/.hidden/e.png", "x/[z].png", "X.PNG"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"")

    def below(pattern: str) -> set[str]:
        return {str(Path(path).relative_to(tmp_path)) for path in found(f"{tmp_path}/{pattern}")}

    assert below("*.png") == {"a.png"}
    assert below("*") == {"a.png", "b.jpg", "X.PNG"}
    assert below("**/*.png") == {"a.png", "x/a.png", "x/[z].png", "x/y/c.png", "x/y/d1.png"}
    assert below("x/**") == {"x/a.png", "x/[z].png", "x/y/c.png", "x/y/d1.png"}
    assert below("*/?/[a-c].png") == {"x/y/c.png"}
    assert below("*/?/[!a-c]?.png") == {"x/y/d1.png"}
    assert below("x/[[]z].png") == below("x/[z].png") == {"x/[z].png"}
    assert below("x/.hidden/*.png") == {"x/.hidden/e.png"}
    assert below("") == {"a.png", "X.PNG", "b.jpg", "x/a.png", "x/[z].png", "x/y/c.png", "x/y/d1.png"}
    with pytest.raises(FileNotFoundError, match="no file matches"):
        below("*.gif")


def test_inputs_that_are_named_twice_are_drawn_once(seven: list[str], tmp_path: Path) -> None:
    listed = tmp_path / "list.txt"
    listed.write_text("\n".join([seven[0], "", seven[3], seven[0], str(tmp_path / "gone.png"), str(tmp_path / "in")]))
    summary = strokefit.batch([tmp_path / "in", listed, seven[1]], tmp_path / "out", **OPTIONS)
    assert (summary.drawn, summary.failed, summary.repeated) == (7, 2, 4)
    errors = {path: row["error"] for path, row in rows(tmp_path / "out").items() if row["error"]}
    assert "No such file" in errors[str(tmp_path / "gone.png")] and "directory" in errors[str(tmp_path / "in")]


@pytest.mark.parametrize("struct", [False, True])
def test_pictures_may_be_in_parquet_files(struct: bool, seven: list[str], tmp_path: Path) -> None:
    contents: list[object] = [Path(path).read_bytes() for path in seven]
    contents[4] = None
    held = [content and {"bytes": content, "path": "x"} for content in contents] if struct else contents
    table = pa.table({"name": [f"n/{i}.5" for i in range(7)], "image": held})
    file = tmp_path / "some.parquet"
    pq.write_table(table, file, row_group_size=3)
    expected = {i: strokefit.fit(path, **OPTIONS).svg if i != 4 else None for i, path in enumerate(seven)}
    strokefit.batch(file, tmp_path / "out", limit=2, **OPTIONS)
    summary = strokefit.batch(file, tmp_path / "out", **OPTIONS)
    assert (summary.drawn, summary.failed, summary.before) == (4, 1, 2)
    assert drawings(tmp_path / "out") == {f"{file}#{i}": svg for i, svg in expected.items()}
    assert rows(tmp_path / "out")[f"{file}#4"]["error"] == "ValueError: the row has no picture"
    strokefit.batch(f"{tmp_path}/*.parquet", tmp_path / "named", id="name", files=True, column="image", **OPTIONS)
    assert (tmp_path / "named/n/3.5.svg").read_text() == expected[3]
    estimate = strokefit.estimate_batch(file, tmp_path / "new", **OPTIONS)
    assert (estimate.sampled, estimate.failed) == (7, 1)


def test_columns_without_pictures_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "some.parquet"
    pq.write_table(pa.table({"a": [b""], "b": [b""], "c": ["text"]}), file)
    for column, words in ((None, "give one of a, b"), ("c", "no pictures in column 'c': give one of a, b")):
        with pytest.raises(ValueError, match=words):
            strokefit.batch(file, tmp_path / "out", column=column)
    with pytest.raises(ValueError, match="no column 'd': it has a, b, c"):
        strokefit.batch(file, tmp_path / "out", column="a", id="d")
    file.write_text("no Parquet")
    with pytest.raises(ValueError, match="not a Parquet file"):
        strokefit.batch(file, tmp_path / "out")


def test_urls_are_read(seven: list[str], tmp_path: Path) -> None:
    folder = (tmp_path / "in").as_uri()
    expected = sorted(strokefit.fit(path, **OPTIONS).svg for path in seven)
    for source in (folder, f"{folder}/*/*.png", f"{folder}/**/*.png"):
        out = tmp_path / source.replace("/", "_").replace("*", "x")[-20:]
        assert strokefit.batch(source, out, **OPTIONS).drawn == 7
        assert sorted(map(str, drawings(out).values())) == expected
    assert f"{folder}/0/3.png" in found(folder)
    with pytest.raises(FileNotFoundError):
        strokefit.batch(f"{folder}/no-such", tmp_path / "new")


def test_web_pages_are_read(seven: list[str], tmp_path: Path) -> None:
    pytest.importorskip("fsspec")
    pytest.importorskip("aiohttp")

    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, *_: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(tmp_path))) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        base = f"http://127.0.0.1:{server.server_port}"
        listed = tmp_path / "list.txt"
        listed.write_text(f"{base}/in/0/2.png\n{base}/gone.png\n")
        summary = strokefit.batch(listed, tmp_path / "out", files=True, **OPTIONS)
        server.shutdown()
    assert (summary.drawn, summary.failed) == (1, 1)
    svg = tmp_path / f"out/127.0.0.1:{server.server_port}/in/0/2.svg"
    assert svg.read_text() == strokefit.fit(seven[2], **OPTIONS).svg


def test_drawings_of_one_name_are_not_laid_on_each_other(seven: list[str], tmp_path: Path) -> None:
    (tmp_path / "in/0/2.jpg").write_bytes(Path(seven[3]).read_bytes())
    out = tmp_path / "out"
    summary = strokefit.batch(tmp_path / "in", out, files=True, workers=1, **OPTIONS)
    assert (summary.drawn, summary.failed) == (7, 1)
    journal = (out / "_strokefit/part-000000.jsonl").read_text()
    assert "0/2.svg is another picture's drawing" in journal
    assert strokefit.batch(tmp_path / "in", out, files=True, **OPTIONS).before == 8


def test_names_that_no_file_can_have_are_rows(seven: list[str], tmp_path: Path) -> None:
    content = Path(seven[0]).read_bytes()
    names = ["x" * 300, "zero\0", "../../up", "/etc/y", "", "ü€"]
    file = tmp_path / "some.parquet"
    pq.write_table(pa.table({"id": names, "image": [content] * len(names)}), file)
    summary = strokefit.batch(file, tmp_path / "out", id="id", files=True, **OPTIONS)
    assert (summary.drawn, summary.failed) == (4, 2)
    written = {str(path.relative_to(tmp_path / "out")) for path in (tmp_path / "out").rglob("*.svg")}
    assert written == {"up.svg", "etc/y.svg", "picture.svg", "ü€.svg"}


def test_names_that_are_no_text_are_rows(seven: list[str], tmp_path: Path) -> None:
    odd = tmp_path / "in/0/caf\udce9.png"
    try:
        odd.write_bytes(Path(seven[1]).read_bytes())
    except (OSError, UnicodeError):
        pytest.skip("names are text here")
    strokefit.batch(tmp_path / "in", tmp_path / "out", **OPTIONS)
    assert rows(tmp_path / "out")[str(tmp_path / "in/0") + "/caf\\xe9.png"]["svg"]
