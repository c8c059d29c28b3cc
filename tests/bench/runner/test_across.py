"""Training on some data sets and testing on another; learning curves; pretraining."""

from __future__ import annotations

from pathlib import Path

import constant_graphs
import numpy as np
import pandas as pd
import pytest

import bench
from bench.errors import BenchError
from bench.recordings import Recordings, write_recordings
from bench.recordings.combine import combine, shared_rows
from bench.recordings.draws import Roles
from bench.runner.across import Across, ready
from bench.runner.curve import over_draws
from bench.runner.keys import run_key
from bench.runner.observer import Observer
from bench.runner.plan import make_plan

ROWS = 12


def table(seed: int, links: int = 10, offset_m: float = 0.0, source: str = "t") -> Recordings:
    """Return noise CIRs whose first-path amplitude falls with the error, and levels."""
    rng = np.random.default_rng(seed)
    n = ROWS * links
    error_m = rng.gamma(2.0, 0.06, n)
    cirs = np.abs(rng.normal(0, 60, (n, 157)))
    pulse = np.exp(-(((np.arange(157) - 6) / 1.6) ** 2))
    cirs += 12000 * np.exp(-4 * error_m)[:, None] * pulse
    true_m = rng.uniform(1, 8, n)
    frame = pd.DataFrame(
        {
            "range_m": true_m + error_m + offset_m,
            "true_range_m": true_m,
            "cir": list(cirs.astype(np.float32)),
            "first_path_index": np.full(n, 5.2),
            "first_path_power_dbm": -80 - 20 * error_m,
            "rx_power_dbm": rng.normal(-80, 1, n),
            "los": np.repeat(np.arange(links) % 3 == 0, ROWS),
            "link": np.repeat([f"l{i}" for i in range(links)], ROWS),
        }
    )
    return Recordings(frame, source=source)


@pytest.fixture(autouse=True)
def _untimed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bench.runner.api.time_artifacts", lambda *_, **__: ([], []))
    monkeypatch.setattr("backends.export.export_module", constant_graphs.export_module)


A, B, C = (table(seed, source=name) for seed, name in enumerate(("a", "b", "c")))
ASK = {"model": "constant", "backend": "fp32", "device": "host"}


# The table and its split --------------------------------------------------------------------------


def test_only_columns_that_all_have_are_kept() -> None:
    bare = Recordings(B.frame.drop(columns="rx_power_dbm"), source="b")
    bare.frame["first_path_power_dbm"] = np.nan
    both = combine({"a": A, "b": bare}, "a")
    assert not {"rx_power_dbm", "first_path_power_dbm"} & set(both.frame)
    assert both.frame["link"].iloc[[0, -1]].tolist() == ["a: l0", "b: l9"]
    assert len(both) == len(A) + len(B)
    assert both.errors_m() == pytest.approx(np.concatenate([A.errors_m(), B.errors_m()]))


def test_rows_trained_on_are_those_named_and_rows_tested_on_the_others() -> None:
    both = combine({"a": A, "b": B}, "b")
    (fold,) = Roles("b", ("a",)).split(both).folds
    assert set(both.frame["data_set"].iloc[fold.train]) == {"a"}
    tested = np.concatenate([fold.test_nlos, fold.test_los])
    assert sorted(tested) == list(range(len(A), len(A) + len(B)))
    assert both.frame["los"].iloc[fold.test_los].all()


def test_draws_are_nested_and_never_share_a_link() -> None:
    both = combine({"a": A, "b": B}, "b")
    link = both.frame["link"].to_numpy()

    def sides(links: int, **roles: tuple[str, ...]) -> list[tuple[set[str], set[str]]]:
        folds = Roles("b", links=links, draws=4, **roles).split(both).folds
        both_kinds = [np.concatenate([f.test_nlos, f.test_los]) for f in folds]
        return [(set(link[f.train]), set(link[t])) for f, t in zip(folds, both_kinds, strict=True)]

    few, more, along = sides(2), sides(5), sides(2, train=("a",))
    for (train, test), (larger, same), (with_a, again) in zip(few, more, along, strict=True):
        assert (len(train), len(larger), len(test)) == (2, 5, 3)
        assert train < larger
        assert test == same == again
        assert not larger & test
        assert with_a == train | {f"a: l{i}" for i in range(10)}
    assert len({frozenset(test) for _, test in few}) > 1


@pytest.mark.parametrize(
    ("roles", "name"),
    [
        (Roles("c", ("a", "b")), "trained-on:a + b"),
        (Roles("c", ("a",), links=4, draws=5), "trained-on:a + 4 links of c, 5 draws"),
        (Roles("c", (), ("s (SIMULATED)",), 1, 2),
         "trained-on:1 link of c after s (SIMULATED), 2 draws"),
    ],
)  # fmt: skip
def test_the_name_of_the_split_says_what_was_trained_on(roles: Roles, name: str) -> None:
    assert roles.name == name


def test_the_same_measurements_are_found_again() -> None:
    renamed = Recordings(A.frame.assign(link="x", range_m=0.0), source="x")
    assert shared_rows(renamed, A) == 1.0
    assert shared_rows(B, A) == 0.0
    part = Recordings(A.frame.iloc[: len(A) // 2], source="x")
    assert shared_rows(part, A) == 0.5


# Runs ---------------------------------------------------------------------------------------------


def test_train_here_test_there(tmp_path: Path) -> None:
    shifted = table(7, offset_m=0.5, source="shifted")
    done = bench.run(**ASK, train=[A, shifted], test=B, out=tmp_path)
    (run,) = done.runs
    assert (run.key.data, run.key.split) == ("b", "trained-on:a + shifted")
    middle = np.median(np.concatenate([A.errors_m(), shifted.errors_m()]))
    left = np.abs(B.errors_m() - middle)[~B.frame["los"].to_numpy()]
    assert run.nlos is not None
    assert run.nlos.mae_m.value == pytest.approx(left.mean(), rel=1e-4)
    assert run.nlos.rows + run.los.rows == len(B)


def test_what_was_trained_on_is_part_of_the_key() -> None:
    plan = make_plan("constant", "fp32", "host", 1)

    def digest(*train: Recordings, **more: object) -> str:
        _, (material,) = ready(Across(B, train, **more), None, plan, Observer())
        return run_key(plan.models[0], plan.backends[0], material, 0).digest()

    moved = table(0, offset_m=0.1, source="a")
    others = [digest(C), digest(A, C), digest(moved), digest(A, links=(2,))]
    others += [digest(A, links=(3,)), digest(A, links=(2,), draws=3)]
    assert digest(A) == digest(A)
    assert len({digest(A), *others}) == 7


def test_a_learning_curve_has_a_point_per_number_of_links(tmp_path: Path) -> None:
    done = bench.run(**ASK, data=A, links="1,6", draws=3, out=tmp_path)
    few, many = done.curve
    assert (few.links, many.links, many.draws) == (1, 6, 3)
    assert few.raw_nlos_mae_m == many.raw_nlos_mae_m
    assert many.nlos_mae_m is not None
    by_draw = []
    for fold in Roles("a", links=6, draws=3).split(combine({"a": A}, "a")).folds:
        errors = A.errors_m().astype(np.float32)
        left = np.abs(errors[fold.test_nlos] - np.median(errors[fold.train]))
        by_draw.append(left.mean())
    assert many.nlos_mae_m.value == pytest.approx(np.mean(by_draw), rel=1e-4)
    assert many.nlos_mae_m.low < many.nlos_mae_m.value < many.nlos_mae_m.high


def test_intervals_over_draws_hold_the_mean_as_often_as_they_say() -> None:
    rng = np.random.default_rng(0)
    means = np.exp(rng.normal(-2.0, 0.3, (2000, 5)))
    true = np.exp(-2.0)  # the interval is of the logarithms
    held = [one.low <= true <= one.high for one in map(over_draws, means)]
    assert np.mean(held) == pytest.approx(0.95, abs=0.015)
    assert over_draws(np.array([0.2])).low is None
    assert over_draws(np.array([0.2, 0.3])).low is None


def test_fine_tuning_goes_on_from_the_pretrained_weights(tmp_path: Path) -> None:
    far = table(5, links=12, offset_m=-1.0, source="far")
    ask = {"model": "mlp", "backend": "fp32", "device": "host", "draws": 1, "out": tmp_path}
    # Errors there are a metre shorter: what was learnt here alone is wrong by that.
    tuned = bench.run(**ask, pretrain=A, finetune=f"{_put(tmp_path, far)}:4")
    from_a = bench.run(**ask, train=A, test=far)
    left = [one.runs[0].nlos.mae_m.value for one in (tuned, from_a)]
    assert tuned.runs[0].key.split == "trained-on:4 links of " + _put(tmp_path, far) + (
        " after a, 1 draw"
    )
    assert left[0] < 0.5 * left[1]


def _put(folder: Path, recordings: Recordings) -> str:
    path = folder / f"{recordings.source}.parquet"
    if not path.exists():
        write_recordings(recordings, path)
    return str(path)


def test_a_simulator_is_trained_on_and_marked(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("bench.physics.room_plan.ROW_TOTAL", 400)
    sim = tmp_path / "sim.toml"
    sim.write_text('name = "free space"\nseed = 3\n')
    (run,) = bench.run(**ASK, train=str(sim), test=A, out=tmp_path / "out").runs
    assert run.key.split == f"trained-on:{sim} (SIMULATED)"
    assert run.simulated is False


# Bad input ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"data": A, "links": 8}, "8 links to train on, but it has 10, of which 3 are tested"),
        ({"data": A, "links": "2,x"}, "--links x: expected whole numbers, such as 1,2,4"),
        ({"data": A, "links": 0}, "nothing to train on"),
        ({"data": A, "links": 2, "draws": 0}, "--draws 0: expected"),
        ({"data": A, "links": 2, "split": "link-kfold:2"}, "--split link-kfold:2: training across"),
        ({"train": A}, "--train and --test go together"),
        ({"train": A, "test": A}, "they hold the same measurements"),
        ({"pretrain": A}, "--pretrain and --finetune go together"),
        ({"pretrain": A, "finetune": "b"}, "--finetune b: expected DATA:LINKS"),
        ({"pretrain": A, "finetune": "b:2", "links": 2}, "--finetune C:k names data and links"),
        ({"train": "roms", "test": A}, "did you mean 'rooms'?"),
        ({"train": "no.toml", "test": A}, "cannot read no.toml"),
    ],
)
def test_bad_input_is_one_clear_line(tmp_path: Path, options: dict, expected: str) -> None:
    with pytest.raises(BenchError) as caught:
        bench.run(**ASK, **options, out=tmp_path / "out")
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "out").exists()


def test_a_table_without_the_inputs_a_model_needs_is_named(tmp_path: Path) -> None:
    bare = Recordings(A.frame.drop(columns="cir"), source="bare")
    target = f"{_put(tmp_path, B)}:2"
    with pytest.raises(BenchError, match=r"bare has no CIR, which .* reads \(pretrained on\)"):
        bench.run("mlp", "fp32", pretrain=bare, finetune=target, out=tmp_path)
    with pytest.raises(BenchError, match=r"bare has no CIR, which .* reads \(trained on\)"):
        bench.run("mlp", "fp32", train=[B, bare], test=C, out=tmp_path)
    both = bench.run("mlp,constant", "fp32", device="host", train=bare, test=C, out=tmp_path)
    assert [run.key.model for run in both.runs] == ["constant"]


def test_what_is_not_trained_by_gradient_descent_cannot_be_fine_tuned(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match="svm: FeatureSVM is not trained by gradient descent"):
        bench.run("svm", "fp32", pretrain=A, finetune=f"{_put(tmp_path, B)}:2", out=tmp_path)
