"""Training with rounding: rounded where the 8-bit graph rounds, better for it, and repeatable."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from backends.base import Floats, TrainingData
from backends.export import exported
from backends.fake_quant import FakeActivation, FakeWeight, fake_quantised
from backends.int8 import write_artifact
from backends.integer_form import to_integer_form
from backends.qat import EPOCHS, QatBackend, passes, train_quantised
from backends.quantise import Range, quantise
from zoo import REMnetLevels
from zoo.base import TrainingRecipe

RECIPE = TrainingRecipe("mae", 2e-3, 32, 20)


@pytest.mark.parametrize("model", ["remnet", "cnn1d", "mlp"])
def test_fake_quantisation_computes_what_the_8_bit_graph_computes(
    model: str, fitted, training: TrainingData, test_rows: tuple[Floats, Floats], tmp_path: Path
) -> None:
    """The rounding itself moves predictions by far more than the two differ."""
    form = exported(fitted(model).to_module(), 157, to_integer_form)
    rows = training.cirs[:512]
    integer = write_artifact(form.graph, rows, tmp_path / "int8.onnx", "").predict(test_rows[0])
    fake = fake_quantised(form.module(), quantise(form.graph, rows).ranges)
    with torch.no_grad():
        simulated = fake(torch.from_numpy(test_rows[0])).numpy()
        exact = form.module()(torch.from_numpy(test_rows[0])).numpy()
    assert np.abs(integer - exact).mean() > 3 * np.abs(integer - simulated).mean()
    assert np.abs(integer - simulated).mean() < 5e-4


@pytest.mark.parametrize("model", ["remnet", "cnn1d", "mlp"])
def test_error_is_no_worse_than_int8(model: str, built, test_rows: tuple[Floats, Floats]) -> None:
    cirs, errors = test_rows
    mae = {
        name: np.abs(built(model, name).predict(cirs) - errors).mean()
        for name in ("fp32", "int8", "qat")
    }
    assert mae["qat"] < mae["fp32"] + 0.002
    assert mae["qat"] < mae["int8"] + 0.001


def test_qat_differs_from_int8_in_values_alone(built) -> None:
    plain, trained = built("remnet", "int8"), built("remnet", "qat")
    assert trained.coverage == plain.coverage
    assert trained.precision == "int8"
    assert trained.opener == plain.opener
    assert abs(trained.path.stat().st_size - plain.path.stat().st_size) < 200
    assert f"trained {EPOCHS} epochs further" in trained.note


def test_what_is_not_trained_by_gradient_descent_is_skipped(
    fitted, training: TrainingData, tmp_path: Path
) -> None:
    backend = QatBackend()
    assert backend.supports(fitted("svm")) == "FeatureSVM is not trained by gradient descent"
    assert backend.supports(fitted("none")) == "NoMitigation has no weights"
    assert backend.supports(fitted("remnet")) is None
    with pytest.raises(ValueError, match="not trained by gradient descent"):
        backend.build(fitted("svm"), training, tmp_path / "svm.onnx")


def test_same_seed_same_weights_and_ranges(fitted, training: TrainingData) -> None:
    form = exported(fitted("mlp").to_module(), 157, to_integer_form)
    few = TrainingData(training.cirs[:300], training.errors_m[:300], seed=1)
    runs = [train_quantised(form, RECIPE, data) for data in (few, few, replace(few, seed=2))]
    assert runs[0].ranges == runs[1].ranges != runs[2].ranges
    files = [run.graph.SerializeToString() for run in runs]
    assert files[0] == files[1] != files[2]


def test_training_leaves_the_model_and_the_random_state_alone(
    fitted, training: TrainingData
) -> None:
    module = fitted("mlp").to_module()
    before = {name: value.clone() for name, value in module.state_dict().items()}
    state = torch.get_rng_state()
    form = exported(module, 157, to_integer_form)
    learnt = train_quantised(
        form, RECIPE, replace(training, cirs=training.cirs[:64], errors_m=training.errors_m[:64])
    )
    assert torch.equal(torch.get_rng_state(), state)
    assert all(torch.equal(value, before[name]) for name, value in module.state_dict().items())
    assert learnt.graph.SerializeToString() != form.graph.SerializeToString()
    again = exported(module, 157, to_integer_form)
    assert again.graph.SerializeToString() == form.graph.SerializeToString()


def test_progress_reaches_one(fitted, training: TrainingData) -> None:
    heard: list[float] = []
    form = exported(fitted("mlp").to_module(), 157, to_integer_form)
    train_quantised(form, RECIPE, training, heard.append)
    assert heard == sorted(heard)
    assert heard[-1] == 1.0


def test_rounding_is_torch_s_own_and_its_gradient_stops_outside() -> None:
    fake = FakeActivation(Range(0.1, 10))
    x = torch.linspace(-3, 30, 500, requires_grad=True)
    rounded = fake(x)
    expected = torch.fake_quantize_per_tensor_affine(x, 0.1, 10, 0, 255)
    assert torch.allclose(rounded, expected, atol=1e-6)
    rounded.sum().backward()
    inside = (x > -1.05) & (x < 24.55)
    assert torch.equal(x.grad, inside.float())


def test_a_range_learns_to_cover_what_it_cuts_off() -> None:
    """d(rounded)/d(scale) is 255 steps where values are cut off: the range must grow."""
    fake = FakeActivation(Range(0.01, 0))
    optimiser = torch.optim.Adam(fake.parameters(), lr=0.002)
    x = torch.linspace(0, 5, 1000)
    for _ in range(300):
        optimiser.zero_grad()
        ((fake(x) - x) ** 2).mean().backward()
        optimiser.step()
    assert 255 * fake.learnt().scale == pytest.approx(5, rel=0.1)


def test_weights_round_per_output_channel() -> None:
    weight = torch.tensor([[[1.0, -0.5]], [[0.01, 0.0]], [[0.0, 0.0]]])
    rounded = FakeWeight()(weight)
    steps = torch.tensor([1 / 127, 0.01 / 127, 1.0]).reshape(3, 1, 1)
    assert torch.allclose(rounded, torch.round(weight / steps) * steps)


def test_an_unknown_value_is_refused(fitted) -> None:
    module = exported(fitted("mlp").to_module(), 157, to_integer_form).module()
    with pytest.raises(ValueError, match="'nowhere'"):
        fake_quantised(module, {"nowhere": Range(1.0, 0)})


def test_two_backends_with_the_same_weights_train_them_once(
    fitted, training: TrainingData, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seeds = []

    def counted(form, recipe, data, progress=None):
        seeds.append(data.seed)
        return train_quantised(form, recipe, data, progress)

    monkeypatch.setattr("backends.qat.train_quantised", counted)
    few = TrainingData(training.cirs[:300], training.errors_m[:300], seed=11)
    made = [
        QatBackend().build(fitted("mlp"), data, tmp_path / f"{number}.onnx").path.read_bytes()
        for number, data in enumerate((few, few, replace(few, seed=12)))
    ]
    assert seeds == [11, 12]
    assert made[0] == made[1] != made[2]


def test_many_rows_get_fewer_passes() -> None:
    assert [passes(rows, 64) for rows in (1, 256 * 75, 256 * 76, 36_000, 10**6)] == [4, 4, 3, 2, 1]
    assert passes(10_000, 10_000) == 4


def test_maps_beside_other_figures_are_trained_too() -> None:
    """Their flattened maps are no view where channels lie innermost."""
    rng = np.random.default_rng(0)
    rows = np.concatenate([rng.rayleigh(100, (120, 157)), rng.normal(-85, 4, (120, 9))], 1)
    errors_m = rng.normal(0.1, 0.1, 120).astype(np.float32)
    data = TrainingData(rows.astype(np.float32), errors_m, 0)
    model = REMnetLevels(most_steps=1).fit(data.cirs, errors_m)
    form = exported(model.to_module(), rows.shape[1], to_integer_form)
    learnt = train_quantised(form, replace(RECIPE, epochs=1), data)
    assert any(one.name == "network.dense.weight" for one in learnt.graph.graph.initializer)
