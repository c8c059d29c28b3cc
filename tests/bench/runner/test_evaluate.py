"""Building, predicting and scoring over folds, with a backend that notes what it is given."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from recordings_factory import make_recordings

from bench.errors import BenchError
from bench.measure.metrics import score
from bench.runner.evaluate import Evaluation, evaluate, score_rows
from bench.runner.material import Material, load_material
from zoo.none import NoMitigation


@dataclass
class Made:
    """An artifact that predicts the fold's number plus a tenth of the row's highest sample."""

    path: Path
    offset_m: float
    opener: str = "somewhere:open"

    def predict(self, cirs):
        return (self.offset_m + cirs.max(axis=1) * 1e-6).astype(np.float32)


class Noting:
    """A backend that notes what it is given."""

    opener = "somewhere:open"

    def __init__(self) -> None:
        self.given = []

    def build(self, model, data, path, progress):
        self.given.append((model, data, path, progress))
        return Made(path, float(len(self.given)))


@pytest.fixture
def material() -> Material:
    return load_material(make_recordings(rows=96), "link-kfold:3")


@pytest.fixture
def done(material: Material) -> tuple[Noting, Evaluation]:
    backend = Noting()
    models = [NoMitigation() for _ in range(3)]
    return backend, evaluate(models, backend, material, 5, [Path("a"), Path("b"), Path("c")], print)


def test_every_fold_builds_from_its_training_rows(material: Material, done) -> None:
    backend, found = done
    assert [path for _, _, path, _ in backend.given] == [Path("a"), Path("b"), Path("c")]
    assert found.artifact.path == Path("a")
    for (_, data, _, progress), fold in zip(backend.given, material.split.folds, strict=True):
        np.testing.assert_array_equal(data.cirs, material.cirs[fold.train])
        np.testing.assert_array_equal(data.errors_m, material.errors_m[fold.train])
        assert data.seed == 5
        assert progress is print


def test_every_row_is_predicted_once_by_the_fold_that_did_not_train_on_it(material, done) -> None:
    _, found = done
    assert sorted(found.rows) == list(range(96))
    for row, predicted, los in zip(found.rows, found.predicted_m, found.los, strict=True):
        [number] = [k for k, fold in enumerate(material.split.folds) if row not in fold.train]
        assert predicted == pytest.approx(number + 1 + material.cirs[row].max() * 1e-6)
        assert los == material.recordings.frame["los"].iloc[row]


def test_scores_are_those_of_the_rows_of_one_kind(material: Material, done) -> None:
    _, found = done
    for los in (False, True):
        rows = np.array([row for row, is_los in zip(found.rows, found.los, strict=True)
                         if is_los == los])  # fmt: skip
        predicted = found.predicted_m[found.los == los]
        expected = score(material.errors_m[rows], predicted, material.links[rows], 4)
        assert score_rows(found, material, los, 4) == expected
        assert score_rows(found, material, los, 5) != expected


def test_no_rows_of_a_kind_no_score(material: Material, done) -> None:
    _, found = done
    none = replace(found, los=np.zeros(96, bool))
    assert score_rows(none, material, True, 0) is None
    assert score_rows(none, material, False, 0).rows == 96


@pytest.mark.parametrize("declares", ["elsewhere:open", None])
def test_a_file_with_an_opener_that_the_backend_does_not_declare_is_refused(
    material: Material, declares
) -> None:
    backend = Noting()
    backend.opener = declares
    with pytest.raises(BenchError, match="expected the same"):
        evaluate([NoMitigation()] * 3, backend, material, 0, [Path("a")] * 3)


def test_fewer_models_than_folds_are_a_mistake_of_ours(material: Material) -> None:
    with pytest.raises(ValueError, match="zip"):
        evaluate([NoMitigation()], Noting(), material, 0, [Path("a")] * 3)


class Unsure(NoMitigation):
    """A model that gives a deviation."""

    gives_std = True


def test_deviations_are_those_of_the_rows_in_their_order(material: Material, monkeypatch) -> None:
    monkeypatch.setattr(
        Made, "deviations", lambda self, cirs: cirs.max(axis=1) + self.offset_m, raising=False
    )
    found = evaluate([Unsure()] * 3, Noting(), material, 0, [Path("a")] * 3)
    trained = [set(fold.train) for fold in material.split.folds]
    folds = [next(k for k in range(3) if row not in trained[k]) for row in found.rows]
    expected = material.cirs[found.rows].max(axis=1) + np.array(folds) + 1
    np.testing.assert_allclose(found.std_m, expected)
    assert evaluate([NoMitigation()] * 3, Noting(), material, 0, [Path("a")] * 3).std_m is None


@pytest.mark.parametrize("declines", [True, False])
def test_what_a_backend_cannot_do_is_declined_or_one_line(material: Material, declines) -> None:
    from backends.base import CannotTakeError
    from bench.runner.evaluate import DeclinedError

    class Unable(Noting):
        def build(self, model, data, path, progress):
            raise CannotTakeError("no") if declines else ValueError("cannot export")

    with pytest.raises(
        DeclinedError if declines else BenchError, match="no" if declines else "exp"
    ):
        evaluate([NoMitigation()] * 3, Unable(), material, 0, [Path("a")] * 3)


def test_an_artifact_without_an_answer_fails_its_run_alone(material: Material, monkeypatch) -> None:
    def refuse(self, cirs):
        raise ValueError("a row is not finite")

    monkeypatch.setattr(Made, "predict", refuse)
    with pytest.raises(BenchError, match=r"gives no answer: a row is not finite") as caught:
        evaluate([NoMitigation()] * 3, Noting(), material, 0, [Path("a")] * 3)
    assert type(caught.value) is BenchError  # a WriteError would end all runs
