"""Networks and kernels that came later: sizes, layers written out again, distributions."""

from __future__ import annotations

import io

import numpy as np
import pytest
import torch
from blocks import CIR, made_up_blocks
from scipy.stats import norm
from sklearn.base import clone
from torch import nn

from zoo import (
    NPN,
    BaggedMLP,
    Bregar2023,
    ECANet,
    GaussianProcess,
    REMnetLevels,
    SmallCNN,
    SmallLevels,
)
from zoo.bregar2023 import Bregar2023Network
from zoo.gp import GaussianProcessNetwork
from zoo.modules.bagged import BaggedNetwork, Members
from zoo.modules.blocks import Columns, Table
from zoo.modules.folding import fold
from zoo.npn import natural_relu, normal_loss
from zoo.training.averaging import RunningMean
from zoo.training.bagged import Bagging, link_bags
from zoo.training.blended import best_share
from zoo.training.further import FEWEST_LINKS, train_further

X, Y, LINKS = made_up_blocks(400, seed=1)
CIR_ONLY = slice(0, CIR)
MODELS = {
    "remnet-levels": (REMnetLevels(most_steps=100), slice(None)),
    "npn": (NPN(most_steps=200), slice(None)),
    "gp": (GaussianProcess(points=60), slice(None)),
    "bregar2023": (Bregar2023(most_steps=300, batch_size=32), CIR_ONLY),
    "ecanet": (ECANet(most_steps=60), CIR_ONLY),
    "bagged-mlp": (BaggedMLP(steps=200), slice(None)),
    "small-cnn": (SmallCNN(distilled=False, epochs=12), CIR_ONLY),
    "small-levels": (SmallLevels(samples=32, distilled=False, epochs=8, steps=100), slice(None)),
}


@pytest.fixture(scope="module", params=MODELS)
def fitted(request: pytest.FixtureRequest):
    model, columns = MODELS[request.param]
    return clone(model).fit(X[:, columns], Y, groups=LINKS), columns


@pytest.mark.parametrize(
    ("model", "width", "parameters"),
    [
        (Bregar2023(), 157, 13_927),
        (ECANet(), 157, 7_383),
        (REMnetLevels(), 166, 4_004),
        (NPN(), 166, 3_266),
        (BaggedMLP(), 166, 6_121),
        (SmallCNN(), 157, 1_297),
        (SmallLevels(), 166, 2_250),
    ],
)
def test_trainable_parameters(model, width: int, parameters: int) -> None:
    module = model.untrained(width)
    assert sum(p.numel() for p in module.parameters() if p.requires_grad) == parameters


def test_remnet_levels_is_no_larger_than_remnet() -> None:
    module = REMnetLevels().untrained(166)
    assert sum(p.numel() for p in module.parameters()) <= 6151


def test_bregar2023_has_the_published_layers() -> None:
    network, shapes = Bregar2023Network(0.5).eval(), []
    for layer in network.modules():
        if isinstance(layer, nn.Conv1d | nn.Linear):
            layer.register_forward_hook(lambda _, __, out: shapes.append(tuple(out.shape[1:])))
    network(torch.zeros(1, 152))
    assert shapes == [(10, 151), (10, 76), (10, 38), (20, 16), (20, 8), (128,), (1,)]


def test_folding_leaves_no_normalisation_and_the_same_sums() -> None:
    for name in ("bregar2023", "ecanet"):
        model, columns = MODELS[name]
        done = clone(model).fit(X[:, columns], Y, groups=LINKS)
        module = done.to_module()
        kinds = {type(layer) for layer in module.modules()}
        assert nn.BatchNorm1d not in kinds
        with torch.no_grad():
            folded = module(torch.from_numpy(X[:50, columns])).numpy()
        np.testing.assert_allclose(folded, done.predict(X[:50, columns]), atol=2e-5)


def test_folding_takes_only_what_follows_a_convolution() -> None:
    layers = nn.Sequential(nn.BatchNorm1d(1), nn.Conv1d(1, 2, 1), nn.ReLU(), nn.BatchNorm1d(2))
    fold(layers.eval())
    assert [type(layer) for layer in layers] == [
        *(nn.BatchNorm1d, nn.Conv1d, nn.ReLU),
        nn.BatchNorm1d,
    ]


def test_natural_relu_has_the_moments_of_a_cut_normal() -> None:
    draws = np.random.default_rng(0).normal(size=200_000)
    for mean, std in ((0.5, 1.0), (-1.0, 0.5), (2.0, 0.3)):
        cut = np.maximum(mean + std * draws, 0)
        got = natural_relu(torch.tensor([mean]), torch.tensor([std**2]))
        assert float(got[0]) == pytest.approx(cut.mean(), abs=0.02)  # a logistic for the integral
        assert float(got[1]) == pytest.approx(cut.var(), abs=0.05)


def test_normal_loss_is_the_likelihood_up_to_a_constant() -> None:
    mean, std = torch.tensor([0.1, 0.3]), torch.tensor([0.2, 0.05])
    errors = torch.tensor([0.2, 0.25])
    expected = -norm.logpdf(errors, mean, std).mean() - 0.5 * np.log(2 * np.pi)
    pair = torch.stack([mean, torch.log(std)], 1)
    assert float(normal_loss(pair, errors)) == pytest.approx(expected, rel=1e-5)
    assert float(normal_loss((mean, std), errors)) == pytest.approx(expected, rel=1e-5)


def test_the_process_on_its_own_points_is_the_textbooks() -> None:
    """With every row a point, the sparse process is the full one."""
    model = GaussianProcess(points=40)
    rows, errors = X[:30], Y[:30]
    done = clone(model).fit(rows, errors)
    table = Table(Columns(model._layout(166)))
    x = table.fit(rows).astype(float) / model.length
    tested = X[30:45]
    with torch.no_grad():
        z = table(torch.from_numpy(tested)).numpy().astype(float) / model.length

    def kernel(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        distance = ((a[:, None] - b[None]) ** 2).sum(2)
        return model.signal_m**2 * np.exp(-distance / 2)

    inner = kernel(x, x) + model.noise_m**2 * np.eye(30)
    offset = np.median(errors)
    mean = offset + kernel(z, x) @ np.linalg.solve(inner, errors - offset)
    explained = (kernel(z, x) * np.linalg.solve(inner, kernel(x, z)).T).sum(1)
    std = np.sqrt(model.signal_m**2 - explained + model.noise_m**2)
    found = done.predict(tested, return_std=True)
    np.testing.assert_allclose(found[0], mean, atol=2e-3)
    np.testing.assert_allclose(found[1], std, rtol=2e-2)
    assert isinstance(done.module_.network, GaussianProcessNetwork)


def test_it_learns_and_its_fit_travels(fitted) -> None:
    model, columns = fitted
    rows, errors, _ = made_up_blocks(300, seed=2)
    predicted = model.predict(rows[:, columns])
    assert predicted.dtype == np.float32
    assert np.isfinite(predicted).all()
    assert np.corrcoef(errors, predicted)[0, 1] > 0.6
    stored = io.BytesIO()
    np.savez(stored, **model.fitted_state())
    stored.seek(0)
    copy = clone(model)
    with np.load(stored, allow_pickle=False) as state:
        assert copy.restore_state(dict(state))
    np.testing.assert_array_equal(copy.predict(rows[:, columns]), predicted)
    assert not clone(model).restore_state({})


def test_deviations_are_positive_and_of_the_errors_size() -> None:
    for name in ("npn", "gp"):
        model, _ = MODELS[name]
        done = clone(model).fit(X, Y, groups=LINKS)
        errors, std = done.predict(X, return_std=True)
        assert (std > 0).all()
        inside = np.abs(Y - errors) < 2 * std
        assert inside.mean() > 0.8


def test_without_levels_or_cir_what_is_left_is_used() -> None:
    for columns in (slice(CIR, None), CIR_ONLY):
        rows = np.full_like(X, np.nan)
        rows[:, columns] = X[:, columns]
        kept = rows if columns == CIR_ONLY else rows[:, CIR:]
        done = clone(MODELS["gp"][0]).fit(kept, Y)
        assert np.abs(done.predict(kept) - Y).mean() < 0.7 * np.abs(Y - np.median(Y)).mean()
    with pytest.raises(ValueError, match="at least 64 samples, got 0"):
        REMnetLevels().fit(X[:, CIR:], Y)


def test_bagged_is_the_weighted_mean_of_its_members() -> None:
    reads = Bagging((0.1, 0.2, 0.3), 1, apart=1).reads(4, 1)
    assert reads.tolist() == [[1, 1, 1, 0], [1, 1, 1, 1], [1, 1, 1, 0]]
    members = Members(reads, 3, torch.tensor([0.1, 0.2, 0.3]), seed=0)
    with torch.no_grad():
        members.outer.normal_(generator=torch.Generator().manual_seed(1))
    network, shares = BaggedNetwork(4, 3, 3), torch.tensor([0.5, 0.2, 0.3])
    network.take(members, shares)
    rows = torch.from_numpy(np.random.default_rng(0).normal(size=(7, 4)).astype(np.float32))
    with torch.no_grad():
        apart = members(rows.expand(3, -1, -1))
        assert torch.allclose(network(rows), shares @ apart, atol=1e-6)


def test_pairs_of_members_see_every_link_once() -> None:
    bags = link_bags(9, 6, seed=0)
    assert bags.shape == (6, 9)
    assert (bags[0::2] ^ bags[1::2]).all()
    assert set(bags.sum(1)) == {4, 5}
    assert link_bags(1, 2, seed=0).all()


def further(links: int, gain: float) -> float:
    """Train a flat line further on links whose errors are `gain` times a column with noise."""
    rng = np.random.default_rng(3)
    inputs = rng.normal(size=(1600, 1)).astype(np.float32)
    errors = (gain * (inputs[:, 0] + rng.normal(0, 0.5, 1600))).astype(np.float32)
    network = nn.Sequential(nn.Linear(1, 1), nn.Flatten(0))
    for value in network.state_dict().values():
        value.zero_()
    recipe = BaggedMLP().training_recipe()
    train_further(
        network, *map(torch.from_numpy, (inputs, errors)), recipe, np.arange(1600) % links
    )
    return float(network.state_dict()["0.weight"])


def test_an_average_is_trained_further_only_where_many_links_gain() -> None:
    assert further(FEWEST_LINKS - 1, gain=1.0) == 0
    assert further(FEWEST_LINKS, gain=0.0) == 0
    assert further(FEWEST_LINKS, gain=1.0) > 0.3


def test_the_mean_of_weights_is_worn_for_a_while() -> None:
    layer = nn.Linear(1, 1)
    mean = RunningMean(layer)
    for value in range(1, 4):
        layer.weight.data.fill_(value)
        mean.take()
    with mean.worn():
        assert 2.0 < layer.weight.item() < 3.0
    assert layer.weight.item() == 3.0


def test_a_blends_share_is_what_suits_links_not_rows() -> None:
    links = np.array([0, 0, 0, 0, 0, 0, 1, 2])
    first = np.array([1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0])
    assert best_share(np.stack([first, 1 - first]), links) == 1.0
    assert best_share(np.stack([1 - first, first]), links) == 0.0
    assert best_share(np.stack([np.full(8, 0.2), np.full(8, -0.6)]), links) == 0.75


def test_a_blend_is_its_parts_by_their_shares() -> None:
    from zoo.modules.blended import BlendedNetwork
    from zoo.modules.small import Shape

    network = BlendedNetwork(Shape(16, 4, 3, 2, 1), 5, 4, 3, seed=0).eval()
    x = torch.randn(20, 21, generator=torch.Generator().manual_seed(0))
    with torch.no_grad():
        trunk, few = network.trunk(x[:, :16]), network.perceptrons(x[:, 16:])
        network.blend(0.3)
        np.testing.assert_allclose(network(x), 0.3 * trunk + 0.7 * few, atol=1e-6)


def test_a_blend_is_trained_on_links_of_one_row_each() -> None:
    model = SmallLevels(samples=32, distilled=False, epochs=1, steps=50).fit(X, Y)
    assert np.abs(Y - model.predict(X)).mean() < np.abs(Y).mean()


@pytest.mark.parametrize(("kind", "columns"), [(SmallCNN, CIR_ONLY), (SmallLevels, slice(None))])
def test_a_teachers_word_that_is_known_saves_its_training(kind, columns, monkeypatch) -> None:
    settings = {"samples": 32, "epochs": 8} | ({"steps": 5} if kind is SmallLevels else {})
    teacher = kind(**settings).teacher().set_params(cir_samples=None, epochs=1)
    monkeypatch.setattr(kind, "teacher", lambda self: clone(teacher) if self.distilled else None)
    rows = X[:, columns]
    said_m = clone(teacher).fit(X[:, CIR_ONLY], Y).predict(X[:, CIR_ONLY])
    own, given, none = (
        kind(**settings, **more).fit(rows, Y, groups=LINKS, **told).predict(rows)
        for more, told in (({}, {}), ({}, {"said_m": said_m}), ({"distilled": False}, {}))
    )
    np.testing.assert_array_equal(own, given)
    assert not np.array_equal(own, none) or kind is SmallLevels  # which may leave its CNN no share
