"""What a fit depends on, when an earlier one is reused, and what is not believed."""

from __future__ import annotations

import os
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from recordings_factory import make_recordings

from bench.plugins import Plugin
from bench.recordings.splits import Split
from bench.runner.fits import fit_fold, is_kept, new_model, place_of, state_of
from bench.runner.kept_arrays import write_arrays
from bench.runner.material import Material, load_material
from zoo.none import NoMitigation

ASKED: list[tuple[str, object]] = []


class Mean(NoMitigation):
    """Predicts the mean training error; notes what it was asked to do."""

    def __init__(self, random_state: int = 0, restores: bool = True) -> None:
        self.random_state, self.restores = random_state, restores

    def fit(self, X, y, progress=None, groups=None):
        ASKED.append(("fit", (X, y, groups)))
        self.mean_m = float(np.mean(y))
        if progress:
            progress(1.0)
        return super().fit(X, y)

    def fitted_state(self):
        return {"mean_m": np.array([self.mean_m, self.random_state])}

    def restore_state(self, state):
        ASKED.append(("restore", sorted(state)))
        if not self.restores:
            return False
        self.mean_m = float(state["mean_m"][0])
        return True


class Stateless(Mean):
    """Keeps no state."""

    def fit(self, X, y, progress=None):
        return super().fit(X, y, progress)

    def fitted_state(self):
        return None


class Forgetful(Mean):
    """Cannot be restored."""

    def restore_state(self, state):
        return False


class Teacher(Mean):
    """Says the mean."""

    def predict(self, X):
        return np.full(len(X), self.mean_m, np.float32)


class Taught(Mean):
    """Is taught by a `Teacher`, and notes what it is told."""

    def teacher(self):
        return Teacher(self.random_state)

    def fit(self, X, y, progress=None, groups=None, said_m=None):
        ASKED.append(("told", said_m))
        return super().fit(X, y, progress, groups)


def plugin(kind: str = "Mean", name: str = "mean") -> Plugin:
    return Plugin("models", name, f"{__name__}:{kind}", "tests")


@pytest.fixture
def material() -> Material:
    ASKED.clear()
    return load_material(make_recordings(rows=96), "link-kfold:2")


def fits() -> int:
    return sum(what == "fit" for what, _ in ASKED)


def test_a_model_has_the_seed_where_it_takes_one() -> None:
    assert new_model(plugin(), 7).random_state == 7
    assert new_model(Plugin("models", "none", "zoo.none:NoMitigation", "tests"), 7) is not None


def test_a_fit_sees_its_folds_training_rows_and_links_and_nothing_else(material: Material) -> None:
    told: list[float] = []
    fit_fold(plugin(), material, 1, 0, told.append)
    train = material.split.folds[1].train
    [(_, (X, y, groups))] = ASKED
    np.testing.assert_array_equal(X, material.cirs[train])
    np.testing.assert_array_equal(y, material.errors_m[train])
    np.testing.assert_array_equal(groups, material.links[train])
    assert told == [1.0]


def _pretrained(material: Material) -> Material:
    """Return the material with half of the first fold's rows to be trained on before the others."""
    fold = material.split.folds[0]
    parted = replace(fold, train=fold.train[::2], pretrain=fold.train[1::2])
    return replace(material, split=Split("parted", (parted,)))


def test_a_fit_with_rows_before_goes_on_with_its_own(material: Material, monkeypatch) -> None:
    noted = []
    monkeypatch.setattr("bench.runner.fits.train_further", lambda *given: noted.append(given))
    parted = _pretrained(material)
    model, fold = fit_fold(plugin(), parted, 0, 0), parted.split.folds[0]
    [(_, (X, y, groups))] = ASKED
    np.testing.assert_array_equal(X, material.cirs[fold.pretrain])
    np.testing.assert_array_equal(y, material.errors_m[fold.pretrain])
    np.testing.assert_array_equal(groups, material.links[fold.pretrain])
    [(further, more, errors_m)] = noted
    assert further is model
    np.testing.assert_array_equal(more, material.cirs[fold.train])
    np.testing.assert_array_equal(errors_m, material.errors_m[fold.train])


def test_how_a_fit_goes_on_is_part_of_its_place_only_where_it_does(material, monkeypatch) -> None:
    parted = _pretrained(material)
    before = [place_of(plugin(), some, 0, 0)[0] for some in (material, parted)]
    assert len(set(before)) == 2
    monkeypatch.setattr("bench.runner.fits.STEPS", 12345)
    after = [place_of(plugin(), some, 0, 0)[0] for some in (material, parted)]
    assert after[0] == before[0]
    assert after[1] != before[1]


def test_links_are_given_only_to_models_that_take_them(material: Material) -> None:
    fit_fold(plugin("Stateless"), material, 0, 0)
    assert ASKED[0][1][2] is None


def test_the_same_fit_is_not_made_twice_and_is_the_same(material: Material) -> None:
    first = fit_fold(plugin(), material, 0, 0)
    second = fit_fold(plugin(), material, 0, 0)
    assert fits() == 1
    assert second.mean_m == first.mean_m
    assert ASKED[-1] == ("restore", ["mean_m"])  # what is ours in the file is not the model's
    assert second.training_log_.engine is None


def test_a_teacher_is_fitted_once_for_all_and_its_word_is_passed_on(material, monkeypatch) -> None:
    teacher = plugin("Teacher", "teacher")
    monkeypatch.setattr("bench.runner.fits.named", lambda group, kind: teacher)
    fit_fold(plugin("Taught", "taught"), material, 0, 3)
    assert fits() == 2  # the teacher's and its own
    [said_m] = [what for asked, what in ASKED if asked == "told"]
    train = material.split.folds[0].train
    np.testing.assert_array_equal(said_m, np.full(len(train), material.errors_m[train].mean()))
    fit_fold(teacher, material, 0, 3)  # the board's own run of what teaches
    assert fits() == 2
    fit_fold(plugin("Taught", "another"), material, 0, 3)
    assert fits() == 3


def test_a_teacher_that_is_no_plugin_is_left_to_the_model(material: Material) -> None:
    fit_fold(plugin("Taught"), material, 0, 0)
    assert ("told", None) in ASKED


def test_two_that_want_the_same_fit_at_once_make_one(material: Material, monkeypatch) -> None:
    begun = []

    def slowly(model, *given):
        begun.append(model)
        time.sleep(0.2)
        model.fit(material.cirs, material.errors_m)

    monkeypatch.setattr("bench.runner.fits.fit_on", slowly)
    with ThreadPoolExecutor(2) as pool:
        both = list(pool.map(lambda _: fit_fold(plugin(), material, 0, 0), range(2)))
    assert len(begun) == 1
    assert both[0].mean_m == both[1].mean_m


@pytest.mark.parametrize("kind", ["Stateless", "Forgetful"])
def test_a_model_without_state_or_that_cannot_take_it_is_fitted_again(material, kind) -> None:
    fit_fold(plugin(kind), material, 0, 0)
    fit_fold(plugin(kind), material, 0, 0)
    assert fits() == 2


def _other_rows(material: Material) -> Material:
    fold = material.split.folds[0]
    shorter = replace(fold, train=fold.train[:-1])
    return replace(material, split=Split("cut", (shorter, *material.split.folds[1:])))


@pytest.mark.parametrize(
    "change",
    [
        lambda m: (plugin(), m, 1, 0),
        lambda m: (plugin(), m, 0, 1),
        lambda m: (plugin("Forgetful"), m, 0, 0),
        lambda m: (plugin(name="other"), m, 0, 0),
        lambda m: (plugin(), replace(m, fingerprint="0" * 16), 0, 0),
        lambda m: (plugin(), _other_rows(m), 0, 0),
    ],
    ids=["fold", "seed", "class", "name", "data", "rows"],
)
def test_whatever_decides_a_fit_gives_it_another_place(material: Material, change) -> None:
    path, _ = place_of(plugin(), material, 0, 0)
    assert place_of(*change(material))[0] != path
    assert place_of(plugin(), material, 0, 0)[0] == path


def test_packages_parameters_and_what_a_model_declares_stand_in_the_key(
    material: Material, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, key = place_of(plugin(), material, 0, 3)
    assert key["parameters"] == {"random_state": "3", "restores": "True"}
    assert {"numpy", "torch"} <= set(key["versions"])
    monkeypatch.setattr(Mean, "cache_key", lambda self: "file of today", raising=False)
    assert place_of(plugin(), material, 0, 3)[1]["declared"] == "file of today"


def _kept(material: Material) -> tuple[Path, dict]:
    fit_fold(plugin(), material, 0, 0)
    path, key = place_of(plugin(), material, 0, 0)
    assert is_kept(path, key)
    return path, key


def test_a_fit_under_another_key_is_not_believed(material: Material) -> None:
    path, key = _kept(material)
    assert not is_kept(path, {**key, "seed": 1})


@pytest.mark.parametrize("spoil", ["cut", "empty", "absent", "edited", "unsealed", "pickled"])
def test_a_damaged_or_edited_fit_is_made_again(material: Material, spoil: str) -> None:
    path, key = _kept(material)
    with np.load(path) as archive:
        arrays = dict(archive)
    match spoil:
        case "cut":
            path.write_bytes(path.read_bytes()[:-40])
        case "empty":
            path.write_bytes(b"")
        case "absent":
            path.unlink()
        case "edited":
            np.savez(path, **{**arrays, "mean_m": np.array([9.0, 0.0])})
        case "unsealed":
            np.savez(path, mean_m=np.array([9.0, 0.0]))
        case "pickled":
            np.savez(path, mean_m=np.array([object()]), allow_pickle=True)
    assert not is_kept(path, key)
    assert fit_fold(plugin(), material, 0, 0).mean_m != 9.0
    assert fits() == 2


class Trap:
    """Makes a folder where it is unpickled."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self):
        return os.mkdir, (str(self.path),)


def test_no_pickle_in_a_fit_is_ever_run(material: Material, tmp_path: Path) -> None:
    path, key = _kept(material)
    np.savez(path, mean_m=np.array([Trap(tmp_path / "sprung")], object), allow_pickle=True)
    assert not is_kept(path, key)
    assert not (tmp_path / "sprung").exists()


@pytest.mark.parametrize(
    "other",
    [np.array([[9.0, 0.0]]), np.array([9.0, 0.0], np.float32), np.array([0.0, 9.0])],
    ids=["shape", "type", "order"],
)
def test_the_seal_covers_shape_type_and_values(material: Material, other) -> None:
    path, key = _kept(material)
    state = state_of(fit_fold(plugin(), material, 0, 0))
    write_arrays(path, key, {**state, "mean_m": np.array([9.0, 0.0])})
    assert is_kept(path, key)
    with np.load(path) as archive:
        arrays = dict(archive)
    np.savez(path, **{**arrays, "mean_m": other})
    assert not is_kept(path, key)
