"""The renderer over NumPy: exact gradients, equal bits in all threads, no growth, and clear errors."""

from __future__ import annotations

import multiprocessing
import os
import resource
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from drawings import HEIGHT, WIDTH, areas, capsules, double, strokes

import strokefit

BACKGROUND = (0.2, 0.5, 0.9)


def picture(seed: int = 9, channels: int = 3) -> np.ndarray:
    return np.random.default_rng(seed).random((HEIGHT, WIDTH, channels)).astype(np.float32)


def numbers(gradients: strokefit.Gradients) -> np.ndarray:
    return np.concatenate([by.ravel() for by in gradients if by is not None])


def shares_within(own: strokefit.Gradients, exact: strokefit.Gradients, relative: float) -> list[bool]:
    """Which derivatives are so near. One that nearly cancels counts as a thousandth of the others of its kind."""
    near: list[bool] = []
    for x, y in zip(own, exact):
        if x is not None:
            size = np.maximum(np.abs(y), 1e-3 * np.sqrt(np.mean(y**2)))
            near += (np.abs(x - y) <= relative * size).ravel().tolist()
    return near


@pytest.mark.parametrize("coverage", ["smoothstep", "raw"])
@pytest.mark.parametrize("draw, least", [(strokes, 0.999), (areas, 0.996)])
def test_gradients_are_those_of_the_reference(draw, least: float, coverage: str) -> None:
    renderer = strokefit.Renderer(WIDTH, HEIGHT, coverage=coverage)
    reference = strokefit.Reference(WIDTH, HEIGHT, coverage=coverage)
    near = []
    for marks in map(draw, range(8)):
        canvas = renderer.render(marks, BACKGROUND)
        assert np.abs(canvas - reference.render(double(marks), BACKGROUND)).max() < 2e-5
        d_canvas = canvas - picture()
        near += shares_within(renderer.backward(d_canvas), reference.backward(d_canvas.astype(float)), 1e-3)
    # Where two segments are nearly as near to a pixel, single precision may take the other one.
    assert np.mean(near) >= least


def test_a_tail_is_cut_where_no_8_bit_level_sees_it() -> None:
    marks = strokes(0, 1)
    for coverage in ("sigmoid", "tanh", "atan:4"):
        renderer = strokefit.Renderer(WIDTH, HEIGHT, coverage=coverage)
        reference = strokefit.Reference(WIDTH, HEIGHT, coverage=coverage)
        assert np.abs(renderer.render(marks) - reference.render(double(marks))).max() < 1 / 512


@pytest.mark.parametrize("background", [None, "picture"])
@pytest.mark.parametrize("draw", [strokes, areas])
def test_other_backgrounds_have_exact_gradients_too(draw, background: object) -> None:
    behind = picture(3) if background else None
    marks = draw(4)
    renderer, reference = strokefit.Renderer(WIDTH, HEIGHT), strokefit.Reference(WIDTH, HEIGHT)
    canvas = renderer.render(marks, behind)
    exact = reference.render(double(marks), None if behind is None else behind.astype(float))
    assert canvas.shape == (HEIGHT, WIDTH, 4 if behind is None else 3)
    assert np.abs(canvas - exact).max() < 2e-5
    d_canvas = canvas - picture(5, canvas.shape[2])
    own, other = renderer.backward(d_canvas), reference.backward(d_canvas.astype(float))
    assert np.mean(shares_within(own, other, 1e-3)) >= 0.99
    assert (own.background is None) == (behind is None)


def test_a_transparent_picture_on_a_colour_is_that_on_the_colour() -> None:
    marks = strokes(1)
    renderer = strokefit.Renderer(WIDTH, HEIGHT)
    canvas = renderer.render(marks, None)
    over = canvas[:, :, :3] + (1 - canvas[:, :, 3:]) * np.float32(BACKGROUND)
    assert np.abs(over - renderer.render(marks, BACKGROUND)).max() < 1e-5


@pytest.mark.parametrize("background", ["colour", "picture", None])
@pytest.mark.parametrize("draw", [strokes, areas])
def test_the_reference_is_central_differences(draw, background: object) -> None:
    marks = double(draw(2, 8, 24, 16))
    random = np.random.default_rng(0)
    behind = {"colour": random.random(3), "picture": random.random((16, 24, 3)), None: None}[background]
    reference = strokefit.Reference(24, 16)
    d_canvas = random.normal(size=reference.render(marks, behind).shape)
    own = reference.backward(d_canvas)
    arrays = {"points": marks.points, "colors": marks.colors, "opacities": marks.opacities}
    if draw is strokes:
        arrays["widths"] = marks.widths
    if behind is not None:
        arrays["background"] = behind
    for name, array in arrays.items():
        flat = array.reshape(-1)
        for k in random.permutation(flat.size)[:20]:
            ends = []
            for step in (-1e-6, 1e-6):
                flat[k] += step
                ends.append((reference.render(marks, behind) * d_canvas).sum())
                flat[k] -= step
            slope = (ends[1] - ends[0]) / 2e-6
            assert getattr(own, name).flat[k] == pytest.approx(slope, rel=1e-4, abs=1e-4), (name, k)


@pytest.mark.parametrize("draw", [strokes, areas])
def test_worth_is_what_leaving_a_mark_out_costs(draw) -> None:
    marks, target = draw(6, 24), picture(7)
    renderer = strokefit.Renderer(WIDTH, HEIGHT)
    error = renderer.render(marks, BACKGROUND) - target
    worth = renderer.worth(error)
    for i in range(24):
        hidden = marks._replace(opacities=np.where(np.arange(24) == i, 0, marks.opacities).astype(np.float32))
        without = renderer.render(hidden, BACKGROUND) - target
        change = (without.astype(float) ** 2).sum() - (error.astype(float) ** 2).sum()
        assert worth[i] == pytest.approx(change, rel=1e-2, abs=2e-2)
    exact = strokefit.Reference(WIDTH, HEIGHT)
    exact.render(double(marks), BACKGROUND)
    assert np.allclose(worth, exact.worth(error.astype(float)), rtol=1e-3, atol=1e-3)


def descent(seed: int, threads: int) -> bytes:
    marks, renderer = strokes(seed), strokefit.Renderer(WIDTH, HEIGHT, threads=threads)
    target = picture()
    for _ in range(20):
        gradients = renderer.backward(renderer.render(marks, BACKGROUND) - target)
        marks.points[:] -= 0.01 * gradients.points
    return marks.points.tobytes() + numbers(gradients).tobytes()


def test_ten_renderers_in_ten_threads_give_the_bits_of_one() -> None:
    with ThreadPoolExecutor(10) as pool:
        side_by_side = list(pool.map(lambda k: descent(3, 1 + k % 3), range(10)))
    assert set(side_by_side) == {descent(3, 1)}


def test_one_renderer_in_many_threads_takes_one_after_the_other() -> None:
    renderer, drawings = strokefit.Renderer(WIDTH, HEIGHT), [strokes(seed) for seed in range(8)]
    expected = [renderer.render(marks).tobytes() for marks in drawings]
    with ThreadPoolExecutor(8) as pool:
        assert [canvas.tobytes() for canvas in pool.map(renderer.render, drawings)] == expected


def test_other_threads_run_meanwhile() -> None:
    marks, renderer = capsules(0, 20_000, 2000, 2000), strokefit.Renderer(2000, 2000, threads=1)
    ticks, done = 0, threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not done.wait(0.001):
            ticks += 1

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    try:
        for _ in range(5):
            renderer.render(marks)
    finally:
        done.set()
        thread.join()
    assert ticks > (time.monotonic() - start) / 0.01


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells the memory like this")
def test_memory_does_not_grow() -> None:
    marks, renderer = strokes(0, 4, 16, 16), strokefit.Renderer(16, 16)
    target = np.zeros((16, 16, 3), np.float32)

    def run(calls: int) -> int:
        for _ in range(calls):
            renderer.backward(renderer.render(marks) - target)
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    before = run(200)
    assert run(10_000) - before <= 512  # KiB


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system does not fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_forked_process_renders() -> None:
    renderer, marks = strokefit.Renderer(WIDTH, HEIGHT), strokes(0)
    expected = renderer.render(marks).tobytes()
    _forked.update(renderer=renderer, marks=marks)
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert pool.apply_async(_render_forked).get(timeout=60) == expected


_forked: dict[str, object] = {}


def _render_forked() -> bytes:
    return _forked["renderer"].render(_forked["marks"]).tobytes()


def test_what_is_changed_after_a_render_does_not_count() -> None:
    marks, renderer = strokes(0), strokefit.Renderer(WIDTH, HEIGHT)
    d_canvas, behind = picture(), picture(1)
    renderer.render(marks, behind)
    expected = numbers(renderer.backward(d_canvas))
    marks.points[:] += 1
    behind[:] = 0
    assert np.array_equal(numbers(renderer.backward(d_canvas)), expected)


def test_strided_arrays_are_read() -> None:
    marks, renderer = strokes(0), strokefit.Renderer(WIDTH, HEIGHT)
    wide = np.zeros((len(marks.points), 4), np.float32)
    wide[:, ::2] = marks.points
    strided = marks._replace(points=wide[:, ::2], colors=np.asfortranarray(marks.colors))
    assert np.array_equal(renderer.render(strided), renderer.render(marks))
    d_canvas = picture()
    expected = numbers(renderer.backward(d_canvas))
    turned = np.ascontiguousarray(d_canvas.transpose(1, 0, 2)).transpose(1, 0, 2)
    assert np.array_equal(numbers(renderer.backward(turned)), expected)


def test_a_drawing_may_be_empty_or_beside_the_picture() -> None:
    renderer, none = strokefit.Renderer(WIDTH, HEIGHT), strokes(0, 1)
    none = none._replace(**{name: getattr(none, name)[:0] for name in ("points", "widths", "colors", "opacities")})
    none = none._replace(starts=np.zeros(1, np.int64), on_path=None, closed=None, filled=None, rings=None)
    assert np.array_equal(renderer.render(none, BACKGROUND), np.broadcast_to(np.float32(BACKGROUND), (HEIGHT, WIDTH, 3)))
    gradients = renderer.backward(np.ones((HEIGHT, WIDTH, 3), np.float32))
    assert gradients.points.shape == (0, 2) and gradients.background == pytest.approx([HEIGHT * WIDTH] * 3)
    away = strokes(0)
    away = away._replace(points=away.points + 1000)
    renderer.render(away, BACKGROUND)
    assert not renderer.backward(np.ones((HEIGHT, WIDTH, 3), np.float32)).points.any()


def test_paths_hold_cubic_curves_and_arcs() -> None:
    bow = strokefit.Marks(
        points=np.array([[8, 40], [8, 8], [40, 8], [40, 40], [56, 56], [72, 40]], np.float32),
        starts=np.array([0, 6]),
        widths=np.array([4], np.float32),
        colors=np.array([[1, 0, 0]], np.float32),
        opacities=np.array([1], np.float32),
        kinds=np.array([0, 2, 2, 0, 3, 0], np.uint8),
    )
    scene = strokefit.Scene(WIDTH, HEIGHT, bow, background=(1, 1, 1))
    assert 'd="M8 40C8 8 40 8 40 40a16 16 0 0 0 32 0"' in scene.to_svg()
    image = strokefit.Renderer(WIDTH, HEIGHT).render(bow, (1, 1, 1))
    file = strokefit.render(scene, background="#ffffff") / 255
    assert np.abs(image - file).mean() < 0.005
    exact = strokefit.Reference(WIDTH, HEIGHT).render(double(bow), (1, 1, 1))
    assert np.allclose(image, exact, atol=1e-4)
    read = strokefit.Scene.read(scene.to_svg())
    assert read.marks.kinds.tolist() == bow.kinds.tolist() and read.marks.on_path.tolist() == (bow.kinds == 0).tolist()
    assert read.to_svg() == scene.to_svg()
    stroke = strokefit.Stroke(bow.points, bow.kinds == 0, False, 4.0, (1.0, 0.0, 0.0), 1.0, bow.kinds)
    assert stroke.flattened(0.01)[:, 1].max() == pytest.approx(56, abs=0.02)
    assert read.refine(strokefit.render(scene, background="#ffffff"), strokes=2, preset="draft").svg


MARKS = strokes(0, 8)
SHAPES = areas(0, 6)


@pytest.mark.parametrize(
    "change, error, message",
    [
        ({"points": MARKS.points.astype(float)}, TypeError, r"points is of float64: give float32, as by points.astype\(np.float32\)"),
        ({"points": MARKS.points.tolist()}, TypeError, "points is a list: give a NumPy array"),
        ({"points": MARKS.points[:, :1]}, ValueError, r"points has shape \(30, 1\): give \(30, 2\)"),
        ({"points": MARKS.points * np.float32(np.nan)}, ValueError, "points holds NaN"),
        ({"widths": MARKS.widths[:-1]}, ValueError, r"starts has shape \(9,\): give \(8,\)"),
        ({"widths": MARKS.widths + np.float32(np.inf)}, ValueError, "widths holds inf"),
        ({"colors": MARKS.colors[:, :2]}, ValueError, r"colors has shape \(8, 2\): give \(8, 3\)"),
        ({"opacities": MARKS.opacities + 1}, ValueError, r"opacities\[0\] is 1\.\d+: give 0 to 1, and clamp"),
        ({"starts": MARKS.starts.astype(np.int32)}, TypeError, "starts is of int32: give int64"),
        ({"starts": MARKS.starts + 1}, ValueError, "starts goes from 1 to 31: it has to go from 0 to 30"),
        ({"starts": np.sort(MARKS.starts % 5)}, ValueError, "starts goes from"),
        ({"starts": MARKS.starts[[0, 1, 1, 3, 4, 5, 6, 7, 8]]}, ValueError, r"starts\[1\] is 1 and starts\[2\] is 1: every mark needs a point"),
        ({"on_path": ~MARKS.on_path}, ValueError, "mark 0: an open path has to start and end with points on it"),
        ({"kinds": MARKS.on_path}, TypeError, "kinds is of bool: give uint8"),
        ({"kinds": np.full(30, 4, np.uint8)}, ValueError, "kinds: 4 is no kind of point: give 0 on the path"),
        ({"kinds": (~MARKS.on_path).astype(np.uint8) ^ (np.arange(30) == 1)}, ValueError, r"on_path\[1\] and kinds\[1\] differ"),
        ({"kinds": 2 * (~MARKS.on_path).astype(np.uint8) + (np.arange(30) == 4)}, ValueError, "mark 2: between two points .* are"),
        ({"closed": MARKS.closed.astype(np.uint8)}, TypeError, "closed is of uint8: give bool"),
        ({"rings": np.array([2])}, ValueError, r"rings\[0\] is 2: give, .* mark 1 has the points 1 to 2 and is a stroke"),
        ({"rings": np.array([99])}, ValueError, r"rings\[0\] is 99: there are not as many points"),
    ],
)
def test_wrong_marks_are_refused(change: dict[str, object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        strokefit.Renderer(WIDTH, HEIGHT).render(MARKS._replace(**change))


@pytest.mark.parametrize("rings", [[10, 18], [34, 18], [18, 18]])
def test_wrong_rings_are_refused(rings: list[int]) -> None:
    with pytest.raises(ValueError, match=r"rings\[\d\] is \d+: give, in rising order"):
        strokefit.Renderer(WIDTH, HEIGHT).render(SHAPES._replace(rings=np.array(rings)))


def test_wrong_calls_are_refused() -> None:
    renderer = strokefit.Renderer(WIDTH, HEIGHT)
    d_canvas = picture()
    with pytest.raises(RuntimeError, match="there is no picture yet: call render first"):
        renderer.backward(d_canvas)
    renderer.render(MARKS)
    with pytest.raises(ValueError, match=r"d_canvas has shape \(64, 96, 2\): give \(64, 96, 3\)"):
        renderer.backward(d_canvas[:, :, :2])
    with pytest.raises(TypeError, match="d_canvas is of float64"):
        renderer.backward(d_canvas.astype(float))
    d_canvas[63, 95, 2] = np.nan
    for refused in (renderer.backward, renderer.worth):
        with pytest.raises(ValueError, match="NaN or infinity: give finite numbers"):
            refused(d_canvas)
    for background in ((0.5, 0.5), np.zeros((3, 3, 3), np.float32), (np.nan, 0, 0)):
        with pytest.raises(ValueError, match="background h"):
            renderer.render(MARKS, background)
    renderer.render(MARKS, None)
    with pytest.raises(ValueError, match="without a background has no worth"):
        renderer.worth(picture())


@pytest.mark.parametrize(
    "options, message",
    [
        ({"width": 0}, "width=0: give 1 px or more"),
        ({"softness": 0}, "softness=0: give px above 0"),
        ({"softness": float("nan")}, "softness=NaN: give px above 0"),
        ({"coverage": "soft"}, "no coverage function is called `soft`"),
    ],
)
def test_wrong_renderers_are_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        strokefit.Renderer(**{"width": 8, "height": 8, **options})


def test_softness_can_anneal() -> None:
    renderer = strokefit.Renderer(WIDTH, HEIGHT, softness=4)
    soft = renderer.render(MARKS)
    renderer.softness = 1.2
    assert np.array_equal(renderer.render(MARKS), strokefit.Renderer(WIDTH, HEIGHT).render(MARKS))
    assert not np.array_equal(soft, renderer.render(MARKS))
    assert repr(renderer) == "<Renderer 96×64 px, smoothstep, 1.2 px soft>"
