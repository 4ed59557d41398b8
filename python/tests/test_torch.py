"""The renderer in PyTorch: exact gradients, batches, the article's own numbers, and what is refused."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
from conftest import ROOT
from drawings import HEIGHT, WIDTH, areas, capsules, double, strokes

import strokefit

torch = pytest.importorskip("torch", reason="PyTorch is not installed")
render = pytest.importorskip("strokefit.torch").render


def tensors(marks: strokefit.Marks, **others: object) -> tuple[list[Any], dict[str, Any]]:
    """The numbers of marks, which ask for gradients, and what else `render` takes."""
    numbers = [marks.points, marks.widths, marks.colors, marks.opacities]
    kinds = {name: getattr(marks, name) for name in ("starts", "on_path", "closed", "filled", "rings", "kinds")}
    named = {name: None if array is None else torch.from_numpy(array) for name, array in kinds.items()}
    return [torch.tensor(array, requires_grad=True) for array in numbers], {**named, **others}


def small(dtype: Any = torch.float64, count: int = 5) -> list[Any]:
    """Strokes of three points on a picture of 20×16 px."""
    random = torch.Generator().manual_seed(1)
    draw = lambda *shape: torch.rand(*shape, generator=random, dtype=dtype)
    made = [20 * draw(count, 3, 2), 1 + 4 * draw(count), draw(count, 3), 0.1 + 0.8 * draw(count)]
    return [tensor.requires_grad_() for tensor in made]


SIZE = {"width": 20, "height": 16}


@pytest.mark.parametrize("draw", [strokes, areas])
def test_it_is_the_renderer_of_numpy(draw: Callable[[int], strokefit.Marks]) -> None:
    marks = draw(0)
    behind = torch.tensor([0.2, 0.5, 0.9], requires_grad=True)
    numbers, named = tensors(marks, background=behind)
    image = render(*numbers, width=WIDTH, height=HEIGHT, **named)
    renderer = strokefit.Renderer(WIDTH, HEIGHT)
    assert np.array_equal(image.detach().numpy(), renderer.render(marks, (0.2, 0.5, 0.9)))
    (image**2).sum().backward()
    gradients = renderer.backward(2 * image.detach().numpy())
    for tensor, expected in zip([*numbers, behind], gradients):
        assert np.array_equal(tensor.grad.numpy(), expected)


@pytest.mark.parametrize("background", ["colour", "picture", None])
def test_gradcheck_against_the_reference(background: object) -> None:
    random = torch.Generator().manual_seed(2)
    shape = {"colour": (3,), "picture": (16, 20, 3)}.get(background)
    behind = [] if shape is None else [torch.rand(shape, generator=random, dtype=torch.float64, requires_grad=True)]
    on_path = torch.ones(5, 3, dtype=torch.bool)
    on_path[::2, 1] = False

    def drawn(points: Any, widths: Any, colors: Any, opacities: Any, *behind: Any) -> Any:
        ground = behind[0] if behind else None
        return render(points, widths, colors, opacities, background=ground, on_path=on_path, **SIZE)

    assert torch.autograd.gradcheck(drawn, (*small(), *behind), eps=1e-6, atol=1e-5)


def test_gradcheck_of_areas_and_offsets() -> None:
    numbers, named = tensors(double(areas(1, 4, 20, 16)))
    assert torch.autograd.gradcheck(lambda *numbers: render(*numbers, **named, **SIZE), numbers, eps=1e-6, atol=1e-5)


def test_gradcheck_of_cubic_curves_and_arcs() -> None:
    random = torch.Generator().manual_seed(4)
    draw = lambda *shape: torch.rand(*shape, generator=random, dtype=torch.float64)
    made = [20 * draw(2, 6, 2), 1 + 4 * draw(2), draw(2, 3), 0.1 + 0.8 * draw(2)]
    numbers = [tensor.requires_grad_() for tensor in made]
    kinds = torch.tensor([[0, 2, 2, 0, 3, 0], [0, 3, 0, 1, 1, 0]], dtype=torch.uint8)
    assert torch.autograd.gradcheck(lambda *numbers: render(*numbers, kinds=kinds, **SIZE), numbers, eps=1e-6, atol=1e-5)


@pytest.mark.parametrize("asked", range(1, 32))
def test_any_subset_may_ask_for_gradients(asked: int) -> None:
    marked = [*small(torch.float32), torch.rand(3).requires_grad_()]
    render(*marked[:4], background=marked[4], **SIZE).sum().backward()
    some = [tensor.detach().clone().requires_grad_(bool(asked >> i & 1)) for i, tensor in enumerate(marked)]
    render(*some[:4], background=some[4], **SIZE).sum().backward()
    for tensor, whole in zip(some, marked):
        assert (tensor.grad is None) != tensor.requires_grad
        assert tensor.grad is None or torch.equal(tensor.grad, whole.grad)


def test_a_batch_is_its_drawings_one_by_one() -> None:
    points, widths, colors, opacities = small(torch.float32)
    many = (points + torch.arange(6.0).reshape(2, 3, 1, 1, 1)).detach().requires_grad_()
    behind = torch.rand(3, 3, requires_grad=True)
    images = render(many, widths, colors, opacities, background=behind, **SIZE)
    assert images.shape == (2, 3, 16, 20, 3)
    (images**2).sum().backward()
    batched = [tensor.grad.clone() for tensor in (many, widths, colors, opacities, behind)]
    for tensor in (many, widths, colors, opacities, behind):
        tensor.grad = None
    for i in range(2):
        for k in range(3):
            one = render(many[i, k], widths, colors, opacities, background=behind[k], **SIZE)
            assert torch.equal(one, images[i, k])
            (one**2).sum().backward()
    for got, tensor in zip(batched, (many, widths, colors, opacities, behind)):
        assert torch.allclose(got, tensor.grad, rtol=1e-5, atol=1e-5)


def test_a_picture_may_be_behind_a_picture() -> None:
    back, front = small(torch.float32), small(torch.float32, 3)
    ground = render(*back, **SIZE)
    both = [torch.cat([a, b]) for a, b in zip(back, front)]
    over = render(*front, background=ground, **SIZE)
    assert torch.allclose(over, render(*both, **SIZE), atol=1e-6)
    gradients = torch.autograd.grad((over**2).sum(), back)
    for got, expected in zip(gradients, torch.autograd.grad((render(*both, **SIZE) ** 2).sum(), back)):
        assert torch.allclose(got, expected, rtol=1e-4, atol=1e-4)


def test_second_derivatives_are_refused_by_name() -> None:
    points, *others = small()
    loss = (render(points, *others, **SIZE) ** 2).sum()
    (slope,) = torch.autograd.grad(loss, points, create_graph=True)
    with pytest.raises(RuntimeError, match="strokefit.torch.render has no second derivatives"):
        slope.sum().backward()


def test_what_was_changed_in_place_is_refused() -> None:
    points, *others = small()
    moved = points * 1
    loss = render(moved, *others, **SIZE).sum()
    moved += 1
    with pytest.raises(RuntimeError, match="modified by an inplace operation"):
        loss.backward()


def test_a_graph_may_be_kept_and_threads_may_share_it() -> None:
    marked = small(torch.float32)
    loss = (render(*marked, **SIZE) ** 2).sum()
    first = torch.autograd.grad(loss, marked, retain_graph=True)

    def again(_: int) -> bool:
        own = torch.autograd.grad((render(*marked, **SIZE) ** 2).sum(), marked)
        return all(torch.equal(a, b) for a, b in zip(own, first))

    with ThreadPoolExecutor(10) as pool:
        assert all(pool.map(again, range(30)))
    assert all(torch.equal(a, b) for a, b in zip(torch.autograd.grad(loss, marked), first))


@pytest.mark.skipif(not hasattr(torch, "compile"), reason="PyTorch 1 has no compiler")
@pytest.mark.filterwarnings("ignore")
def test_a_compiled_function_leaves_its_graph_for_it() -> None:
    marked = small(torch.float32)

    def loss(points: Any, *others: Any) -> Any:
        return (render(1.5 * points, *others, **SIZE) * 2).sum()

    compiled = torch.compile(loss, backend="aot_eager")
    own, plain = compiled(*marked), loss(*marked)
    assert torch.allclose(own, plain)
    for got, expected in zip(torch.autograd.grad(own, marked), torch.autograd.grad(plain, marked)):
        assert torch.allclose(got, expected)


class Elsewhere:
    """As much of a tensor on another device as is used to copy it."""

    device = torch.device("cuda", 0)

    def detach(self) -> Elsewhere:
        return self

    def cpu(self) -> Any:
        return torch.ones(3)


def test_copies_from_another_device_are_said_once(monkeypatch: pytest.MonkeyPatch) -> None:
    module = pytest.importorskip("strokefit.torch")
    monkeypatch.setattr(module, "_told_of_devices", False)
    with pytest.warns(UserWarning, match="strokefit renders on the CPU: tensors on cuda:0 are copied"):
        module._array(Elsewhere())
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert module._array(Elsewhere()).tolist() == [1, 1, 1]


@pytest.mark.skipif(not torch.cuda.is_available(), reason="there is no CUDA device")
def test_tensors_on_a_gpu_come_back_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pytest.importorskip("strokefit.torch"), "_told_of_devices", False)
    marked = small(torch.float32)
    there = [tensor.detach().cuda().requires_grad_() for tensor in marked]
    with pytest.warns(UserWarning, match="strokefit renders on the CPU: tensors on cuda:0 are copied"):
        image = render(*there, **SIZE)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        (image**2).sum().backward()
        assert render(*there, **SIZE).device.type == "cuda"
    (render(*marked, **SIZE) ** 2).sum().backward()
    for tensor, other in zip(there, marked):
        assert torch.allclose(tensor.grad.cpu(), other.grad, rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize(
    "change, error, message",
    [
        ({"points": [[1.0, 2.0]]}, TypeError, "points is a list: give a tensor"),
        ({"points": torch.zeros(5, 3, 2, dtype=torch.float16)}, TypeError, "points is of torch.float16: give float32"),
        ({"widths": torch.ones(5, dtype=torch.float64)}, TypeError, "widths is of torch.float64 and points of torch.float32"),
        ({"points": torch.zeros(5, 2)}, ValueError, r"points has shape \(5, 2\): give n × k × 2, or m × 2 and starts"),
        ({"widths": torch.ones(4)}, ValueError, r"starts has shape \(6,\): give \(5,\)"),
        ({"colors": torch.ones(5)}, ValueError, r"colors has shape \(5,\): give 2 dimensions"),
        ({"opacities": 1.5 * torch.ones(5)}, ValueError, r"opacities\[0\] is 1.5: give 0 to 1"),
        ({"widths": torch.ones(2, 5), "colors": torch.ones(3, 5, 3)}, ValueError, "do not fit together"),
        ({"widths": torch.ones(0, 5)}, ValueError, r"the batch \(0,\) is empty"),
        ({"epsilon": 1e-4}, ValueError, "epsilon=0.0001: it is for float64 alone"),
        ({"background": torch.zeros(2)}, ValueError, r"background has shape \(2,\)"),
        ({"coverage": "soft"}, ValueError, "no coverage function"),
    ],
)
def test_wrong_tensors_are_refused(change: dict[str, Any], error: type[Exception], message: str) -> None:
    named = dict(zip(("points", "widths", "colors", "opacities"), small(torch.float32)))
    with pytest.raises(error, match=message):
        render(**{**named, **SIZE, **change})


GOLDEN = json.loads((ROOT / "tests/data/golden_gradients.json").read_text())["cases"]
COVERAGES = {"smoothstep": "smoothstep", "tanh": "tanh", "sigmoid": "sigmoid", "atan": "atan", "atanx4": "atan:4"}
cases = pytest.mark.parametrize("case", GOLDEN, ids=lambda case: case["name"])


class Article:
    """A scene of the article's program. Its coordinates are [row, column], with pixels at integers."""

    def __init__(self, case: dict[str, Any], norm: str) -> None:
        self.case, self.coverage = case, COVERAGES[norm]
        self.params = {name: torch.tensor(case[name], dtype=torch.float64).requires_grad_() for name in ("a", "b", "r", "c", "bg")}
        self.target = torch.tensor(case["target"], dtype=torch.float64)

    def image(self) -> Any:
        a, b, r, c, background = self.params.values()
        return render(
            torch.stack([a, b], -2).flip(-1) + 0.5,
            2 * r,
            c,
            torch.ones_like(r),
            background=background,
            width=self.case["cols"],
            height=self.case["rows"],
            softness=1.0,
            coverage=self.coverage,
            epsilon=self.case["eps"],
        )

    def clamp(self) -> None:
        rows, cols = self.case["rows"], self.case["cols"]
        with torch.no_grad():
            for name in ("a", "b"):
                self.params[name][:, 0].clamp_(0, rows)
                self.params[name][:, 1].clamp_(0, cols)
            for name, most in (("c", 1), ("bg", 1), ("r", 16)):
                self.params[name].clamp_(0, most)


@cases
@pytest.mark.parametrize("norm", COVERAGES)
def test_pictures_losses_and_gradients_are_those_of_the_article(case: dict[str, Any], norm: str) -> None:
    article = Article(case, norm)
    image, golden = article.image(), case["norms"][norm]
    assert np.abs(image.detach().numpy() - np.array(golden["image"])).max() < 1e-9
    error = image - article.target
    for name, loss in (("l1", error.abs().mean()), ("l2", (error**2).mean())):
        assert loss.item() == pytest.approx(golden[name]["loss"], abs=1e-9)
        gradients = torch.autograd.grad(loss, list(article.params.values()), retain_graph=True)
        for got, param in zip(gradients, article.params):
            assert np.abs(got.numpy() - np.array(golden[name]["grad"][param])).max() < 1e-9


@cases
@pytest.mark.parametrize("norm", COVERAGES)
def test_twenty_steps_are_those_of_the_article(case: dict[str, Any], norm: str) -> None:
    article, golden = Article(case, norm), case["norms"][norm]["adam20"]
    adam = torch.optim.Adam(article.params.values(), lr=0.1, betas=(0.99, 0.999), eps=1e-8)
    for expected in golden["losses"]:
        loss = (article.image() - article.target).abs().mean()
        assert loss.item() == pytest.approx(expected, abs=1e-9)
        adam.zero_grad()
        loss.backward()
        adam.step()
        article.clamp()
    for name, param in article.params.items():
        assert np.abs(param.detach().numpy() - np.array(golden["final"][name])).max() < 1e-7


def test_the_large_demo_goes_down_in_single_precision() -> None:
    marks = capsules(0, 500, 110, 44)
    numbers, named = tensors(marks, background=(0.5, 0.5, 0.5))
    random = np.random.default_rng(1)
    target = torch.from_numpy(np.kron(random.random((11, 22, 3)), np.ones((4, 5, 1))).astype(np.float32))
    adam = torch.optim.Adam(numbers[:3], lr=0.1, betas=(0.99, 0.999))
    losses = []
    for _ in range(100):
        loss = (render(*numbers, width=110, height=44, softness=1.0, **named) - target).abs().mean()
        adam.zero_grad()
        loss.backward()
        adam.step()
        with torch.no_grad():
            numbers[1].clamp_(0, 32)
            numbers[2].clamp_(0, 1)
        losses.append(loss.item())
    assert losses[-1] < 0.7 * losses[0]
