"""What every model of the zoo promises, each checked on each."""

from __future__ import annotations

import io
import pickle
from collections.abc import Callable

import numpy as np
import onnxruntime
import pytest
import torch
from numpy.typing import NDArray
from sklearn.base import clone

import zoo
from zoo import CNN1D, FeatureMLP, FeatureSVM, MitigationModel, NoMitigation, REMnet

Rows = tuple[NDArray[np.float32], NDArray[np.float32]]
FAST: dict[str, Callable[[], MitigationModel]] = {
    "none": NoMitigation,
    "remnet": lambda: REMnet(epochs=1),
    "cnn1d": lambda: CNN1D(epochs=1, batch_size=32),
    "svm": FeatureSVM,
    "mlp": lambda: FeatureMLP(epochs=1),
}
WIDTH = 160  # wider than any model wants, so cropping is always at work


@pytest.fixture(scope="module")
def rows() -> Rows:
    """Made-up pulses whose spread goes with the error: something to learn, not a simulation."""
    generator = np.random.default_rng(3)
    errors = generator.normal(0.1, 0.15, 300)
    decay = np.exp(-np.clip(np.arange(WIDTH) - 5, 0, None) / (15 + 40 * errors[:, None] ** 2))
    level = np.where(np.arange(WIDTH) < 5, 0, 8000) * decay
    cirs = generator.rayleigh(80, (300, WIDTH)) + level * generator.uniform(0.5, 1, (300, WIDTH))
    return cirs.astype(np.float32), errors.astype(np.float32)


@pytest.fixture(scope="module", params=FAST)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def fitted(name: str, rows: Rows) -> MitigationModel:
    return FAST[name]().fit(*rows)


def test_predictions_are_float32_metres_one_per_row(fitted: MitigationModel, rows: Rows) -> None:
    predicted = fitted.predict(rows[0])
    assert predicted.dtype == np.float32
    assert predicted.shape == (300,)
    assert np.isfinite(predicted).all()


def test_the_module_predicts_what_the_model_predicts(fitted: MitigationModel, rows: Rows) -> None:
    module = fitted.to_module()
    assert not module.training
    with torch.no_grad():
        errors = module(torch.from_numpy(rows[0]))
    assert errors.dtype == torch.float32
    np.testing.assert_allclose(errors.numpy(), fitted.predict(rows[0]), atol=1e-6)


def test_changing_the_module_leaves_the_model_alone(fitted: MitigationModel, rows: Rows) -> None:
    before = fitted.predict(rows[0])
    module = fitted.to_module().train()
    with torch.no_grad():
        for parameter in module.parameters():
            parameter.add_(1.0)
    np.testing.assert_array_equal(fitted.predict(rows[0]), before)


def test_rows_with_no_signal_at_all_give_a_finite_error(fitted: MitigationModel) -> None:
    assert np.isfinite(fitted.predict(np.zeros((2, WIDTH)))).all()


def test_same_seed_same_fit_and_global_random_state_is_left(name: str, rows: Rows) -> None:
    model = FAST[name]()
    state = torch.get_rng_state()
    first = model.fit(*rows).predict(rows[0])
    np.random.random()  # a fit must not depend on it
    assert torch.equal(torch.get_rng_state(), state)
    torch.rand(3)
    np.testing.assert_array_equal(clone(model).fit(*rows).predict(rows[0]), first)


@pytest.mark.parametrize("name", ["remnet", "cnn1d", "mlp"])
def test_another_seed_gives_another_network(name: str, rows: Rows) -> None:
    first, second = (
        FAST[name]().set_params(random_state=seed).fit(*rows).predict(rows[0]) for seed in (0, 1)
    )
    assert not np.allclose(first, second)


def test_a_pickle_predicts_the_same(fitted: MitigationModel, rows: Rows) -> None:
    copy = pickle.loads(pickle.dumps(fitted))
    np.testing.assert_array_equal(copy.predict(rows[0]), fitted.predict(rows[0]))


def test_a_fit_travels_as_plain_arrays(name: str, fitted: MitigationModel, rows: Rows) -> None:
    stored = io.BytesIO()
    np.savez(stored, **fitted.fitted_state())
    stored.seek(0)
    copy = FAST[name]()
    with np.load(stored, allow_pickle=False) as state:
        assert copy.restore_state(dict(state))
    np.testing.assert_array_equal(copy.predict(rows[0]), fitted.predict(rows[0]))


def test_arrays_of_another_model_are_not_taken(name: str, fitted: MitigationModel) -> None:
    state = fitted.fitted_state()
    assert not FAST[name]().restore_state({**state, "more": np.zeros(3)})
    assert not FAST[name]().restore_state({})


@pytest.mark.parametrize("kind", ["svm", "cnn1d"])  # tests/backends export every model
def test_one_onnx_graph_agrees_with_torch_at_any_batch(kind: str, rows: Rows) -> None:
    fitted = FAST[kind]().fit(*rows)
    session = onnxruntime.InferenceSession(exported(fitted.to_module()))
    with torch.no_grad():
        expected = fitted.to_module()(torch.from_numpy(rows[0])).numpy()
    for batch in (1, 4, 300):
        (errors,) = session.run(None, {"cir": rows[0][:batch]})
        np.testing.assert_allclose(errors, expected[:batch], atol=1e-5)


def exported(module: torch.nn.Module) -> bytes:
    program = torch.onnx.export(
        module,
        (torch.rand(2, WIDTH),),
        input_names=["cir"],
        dynamic_shapes=({0: torch.export.Dim("batch")},),
        verbose=False,
    )
    assert program is not None
    return bytes(program.model_proto.SerializeToString())


@pytest.mark.parametrize(
    ("model", "needed"),
    [(REMnet(), 128), (CNN1D(), 157), (FeatureSVM(), 157), (FeatureMLP(), 157)],
)
def test_narrow_rows_are_refused_naming_both_widths(model: MitigationModel, needed: int) -> None:
    with pytest.raises(ValueError, match=f"at least {needed} samples, got {needed - 1}"):
        model.fit(np.ones((10, needed - 1)), np.ones(10))


@pytest.mark.parametrize(
    ("model", "used"),
    [
        (REMnet(epochs=1), slice(0, 128)),
        (CNN1D(epochs=1), slice(5, 157)),
        (FeatureSVM(), slice(0, 157)),
        (FeatureMLP(epochs=1), slice(0, 157)),
    ],
)
def test_wider_rows_are_cropped(model: MitigationModel, used: slice, rows: Rows) -> None:
    predicted = model.fit(*rows).predict(rows[0])
    outside = np.full_like(rows[0], 9e4)
    outside[:, used] = rows[0][:, used]
    np.testing.assert_array_equal(model.predict(outside), predicted)


def test_rows_of_another_width_than_fitted_are_refused(fitted: MitigationModel) -> None:
    with pytest.raises(ValueError, match=f"{WIDTH} features as input"):
        fitted.predict(np.ones((2, WIDTH + 1)))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_rows_that_are_not_finite_are_refused(fitted: MitigationModel, bad: float) -> None:
    rows = np.ones((2, WIDTH))
    rows[1, 7] = bad
    with pytest.raises(ValueError, match="X contains"):
        fitted.predict(rows)


def test_remnet_scaled_by_each_rows_own_maximum_does_not_see_the_level(rows: Rows) -> None:
    peak, level = (REMnet(epochs=1, scaling=kind).fit(*rows) for kind in ("peak", "global"))
    louder = 2 * rows[0]  # a power of two: nothing is rounded
    np.testing.assert_array_equal(peak.predict(louder), peak.predict(rows[0]))
    assert not np.allclose(level.predict(louder), level.predict(rows[0]))


def test_an_unknown_scaling_is_refused(rows: Rows) -> None:
    with pytest.raises(ValueError, match="'global' or 'peak', got 'loud'"):
        REMnet(scaling="loud").fit(*rows)


def test_a_model_says_whether_it_is_a_floor() -> None:
    assert {name for name, make in FAST.items() if make().floor} == {"none"}


def test_a_network_keeps_its_training_log(rows: Rows) -> None:
    log = REMnet(epochs=2).fit(*rows).training_log_
    assert (log.engine, log.epochs, log.rows) == ("fused", 2, 300)
    assert log.seconds > 0
    log = FeatureMLP(epochs=1).fit(*rows).training_log_
    assert (log.engine, log.epochs, log.steps) == ("eager", 1, 3)


def test_progress_reaches_the_end(rows: Rows) -> None:
    seen: list[float] = []
    FeatureMLP(epochs=3).fit(*rows, progress=seen.append)
    assert seen == pytest.approx([1 / 3, 2 / 3, 1])


def test_recipes_are_the_published_ones() -> None:
    recipes = {name: make().set_params().training_recipe() for name, make in FAST.items()}
    assert recipes["none"] is None
    assert recipes["svm"] is None
    remnet, cnn = REMnet().training_recipe(), CNN1D(learning_rate=1e-4, epochs=40).training_recipe()
    assert (remnet.loss, remnet.learning_rate, remnet.batch_size, remnet.epochs) == (
        *("mae", 3e-4),
        *(32, 30),
    )
    assert (cnn.loss, cnn.learning_rate, cnn.batch_size) == ("mse", 1e-4, 200)
    assert (cnn.epochs, cnn.stopping) == (40, None)
    assert CNN1D().training_recipe().stopping is not None


def test_names_come_from_the_package() -> None:
    assert {getattr(zoo, name).__name__ for name in zoo.__all__} == set(zoo.__all__)
    with pytest.raises(AttributeError, match="no attribute 'Nothing'"):
        _ = zoo.Nothing
