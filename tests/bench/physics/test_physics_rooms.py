"""The embedded data against the structure and figures of the paper (Angarano et al. 2021)."""

import numpy as np
import pandas as pd
import pytest

from bench.physics.room_geometry import room_geometry
from bench.physics.room_plan import places, things
from bench.physics.rooms import IdealRooms, Rooms
from bench.physics.rooms_data import IdealRoomsSource, RoomsSource
from bench.recordings.open import open_recordings
from bench.recordings.table import Recordings

ROOMS = ("big", "medium", "small")


@pytest.fixture(scope="module")
def rooms() -> Recordings:
    return Rooms().generate()


def errors(rooms: Recordings, environment: str | None, los: bool) -> np.ndarray:
    frame = rooms.frame
    within = frame["environment"].isin(ROOMS if environment is None else (environment,))
    return rooms.errors_m()[within & (frame["los"] == los)]


def test_structure_is_the_papers(rooms: Recordings) -> None:
    frame = rooms.frame
    assert len(frame) == 55_000
    blocked = frame[~frame["los"]].groupby("environment").size()
    assert blocked[list(ROOMS)].tolist() == [18_422, 13_210, 17_601]
    assert (frame["los"] & frame["environment"].isin(ROOMS)).sum() == 4_691
    assert set(frame["environment"]) == {*ROOMS, "outdoor", "through-the-wall"}
    sizes = frame.groupby("environment")[["room_x_m", "room_y_m"]].first()
    assert sizes.loc["big"].tolist() == [10.0, 5.0]
    assert sizes.loc["medium"].tolist() == [5.0, 5.0]
    assert sizes.loc["small"].tolist() == [5.0, 3.5]
    kinds = {kind for cell in frame["obstacles"] for kind in cell}
    assert kinds == {thing.kind for thing in things()}
    assert len(kinds) == 10


def test_it_is_labelled_simulated(rooms: Recordings) -> None:
    assert rooms.simulated
    assert rooms.label == "rooms (SIMULATED)"
    assert "[[effects]]" in (rooms.simulator or "")


def test_cir_has_157_samples_five_of_them_before_the_first_path(rooms: Recordings) -> None:
    cir, index = np.stack(rooms.frame["cir"]), rooms.frame["first_path_index"].to_numpy()
    assert cir.shape == (55_000, 157)
    assert cir.dtype == np.float32
    assert np.mean((index >= 5) & (index < 6)) > 0.999
    assert np.all((index >= 0) & (index < 157))
    peaks = np.median(cir.max(axis=1))
    assert 5_000 < peaks < 10_000  # 128 symbols; miluv: 5 300 to 6 100


def test_links_are_short_walks_that_share_nothing(rooms: Recordings) -> None:
    links = rooms.frame.groupby("link")
    assert links.size().max() <= 40
    assert links.size().median() >= 20
    assert (links["environment"].nunique() == 1).all()
    assert (links["los"].nunique() == 1).all()
    moved = links["true_range_m"].agg(np.ptp)
    assert 0.05 < moved.median() < 1.0
    assert moved.max() < 1.5


def test_geometry_is_consistent(rooms: Recordings) -> None:
    frame = rooms.frame
    ends = [frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy() for end in ("tx", "rx")]
    distance = np.linalg.norm(ends[0] - ends[1], axis=1)
    np.testing.assert_allclose(distance, frame["true_range_m"])
    np.testing.assert_allclose(frame["range_m"] - frame["true_range_m"], frame["error_m"])
    inside = frame["environment"].isin(ROOMS).to_numpy()
    for axis, column in enumerate(("room_x_m", "room_y_m", "room_z_m")):
        for end in ends:
            assert (end[inside, axis] > 0).all()
            assert (end[inside, axis] < frame[column].to_numpy()[inside]).all()
    assert (frame.loc[frame["los"], "obstacles"].map(len) == 0).all()
    assert (frame.loc[~frame["los"], "obstacles"].map(len) > 0).all()


def test_before_mitigation_it_is_near_the_papers_medium_room(rooms: Recordings) -> None:
    medium = errors(rooms, "medium", los=False)
    assert abs(np.abs(medium).mean() / 0.1242 - 1) < 0.25
    assert abs(medium.std() / 0.1642 - 1) < 0.25
    assert abs(medium.mean() / 0.1244 - 1) < 0.25
    assert abs(np.abs(errors(rooms, None, los=True)).mean() / 0.0594 - 1) < 0.25


@pytest.mark.parametrize(
    ("room", "mean_m", "sigma_m"), [("small", 0.0881, 0.1508), ("big", 0.1057, 0.1851)]
)
def test_the_other_rooms_are_near_the_papers_too(
    rooms: Recordings, room: str, mean_m: float, sigma_m: float
) -> None:
    found = errors(rooms, room, los=False)
    assert abs(found.mean() / mean_m - 1) < 0.35
    assert abs(found.std() / sigma_m - 1) < 0.35


def test_errors_come_from_physics(rooms: Recordings) -> None:
    frame = rooms.frame[rooms.frame["environment"].isin(ROOMS)]
    alone = frame[frame["obstacles"].map(len) <= 1]
    kind = alone["obstacles"].map(lambda cell: cell[0] if len(cell) else "none")
    mean, median = (getattr(alone["error_m"].groupby(kind), of)() for of in ("mean", "median"))
    assert mean["metal plate"] > mean["cardboard box"] > mean["polystyrene plate"] > mean["none"]
    assert abs(median["polystyrene plate"] - median["none"]) < 0.05  # foam is air, nearly
    foot = alone["rx_power_dbm"] - alone["first_path_power_dbm"]
    assert foot.groupby(kind).mean()["metal plate"] > foot.groupby(kind).mean()["none"] + 1


def left(rooms: Recordings, samples: int) -> np.ndarray:
    """Return what trees leave of the medium room's NLoS errors, trained on the other rooms."""
    from sklearn.ensemble import HistGradientBoostingRegressor

    frame, error = rooms.frame, rooms.errors_m()
    blocked = (~frame["los"]).to_numpy()
    train = np.flatnonzero(blocked & frame["environment"].isin(("big", "small")))[::6]
    test = np.flatnonzero(blocked & (frame["environment"] == "medium").to_numpy())[::3]
    cir = np.log(np.stack(frame["cir"])[:, :samples] + 50.0)
    rest = np.sqrt(np.mean(np.exp(2 * cir[:, 8:]), axis=1, keepdims=True)) if samples > 8 else 0
    cir = np.column_stack([cir[:, :8], rest + np.zeros((len(cir), 1))])
    model = HistGradientBoostingRegressor(loss="absolute_error", max_iter=40, random_state=0)
    return error[test] - model.fit(cir[train], error[train]).predict(cir[test])


def test_cir_tells_of_the_error_on_links_never_seen(rooms: Recordings) -> None:
    before = errors(rooms, "medium", los=False)[::3]
    few, many = left(rooms, 8), left(rooms, 32)
    assert 0.25 < 1 - np.abs(many).mean() / np.abs(before).mean() < 0.6
    assert 0.35 < 1 - many.var() / before.var() < 0.7  # the paper's REMnet: 0.56
    assert np.abs(many).mean() < 0.96 * np.abs(few).mean()  # the paper's sweep falls with K


def test_level_goes_with_the_error_as_recorded(rooms: Recordings) -> None:
    """Recorded links without sight (apartment): rank correlation -0.65, spread 4 dB."""
    found = _level_over_links(rooms.frame)
    assert -0.75 < found[0] < -0.5
    assert 2.0 < found[1] < 5.0


def test_the_rooms_before_stay_to_be_had(rooms: Recordings) -> None:
    before = IdealRooms().generate(8000)
    assert before.label == "rooms-ideal (SIMULATED)"
    assert IdealRooms().key() != Rooms().key()
    correlation, spread_db = _level_over_links(before.frame)
    assert abs(correlation) < 0.4
    assert spread_db < 1.0


def _level_over_links(frame: pd.DataFrame) -> tuple[float, float]:
    """Return rank correlation of level and error over NLoS links, and the level's spread in dB.

    The level is what a straight line over log distance leaves of the receive level.
    """
    inside = frame[frame["environment"].isin(ROOMS) & ~frame["los"]]
    far, level = np.log10(inside["true_range_m"]), inside["rx_power_dbm"]
    rest = level - np.polyval(np.polyfit(far, level, 1), far)
    links = pd.DataFrame({"rest": rest, "error": inside["error_m"], "link": inside["link"]})
    means = links.groupby("link").mean()
    return means["rest"].corr(means["error"], "spearman"), means["rest"].std()


def test_fewer_rows_keep_the_mixture_and_the_seed_decides() -> None:
    small = room_geometry(np.random.default_rng(0), 3000)
    assert len(small) == 3000
    share = small["environment"].value_counts(normalize=True)
    assert abs(share["medium"] - (13_210 + 1_564) / 55_000) < 0.002
    pd.testing.assert_frame_equal(small, room_geometry(np.random.default_rng(0), 3000))
    other = room_geometry(np.random.default_rng(1), 3000)
    assert not np.allclose(other["true_range_m"], small["true_range_m"])
    assert len(room_geometry(np.random.default_rng(0), 1)) == 1
    assert sum(p.nlos_rows + p.los_rows for p in places()) == 55_000


def test_the_source_keeps_what_it_made_and_heals(monkeypatch, tmp_path) -> None:
    monkeypatch.setenv("BENCH_CACHE", str(tmp_path))
    monkeypatch.setattr(Rooms, "generate", _counted := _Counted(Rooms.generate))
    first, source = open_recordings("rooms")
    again, _ = open_recordings("rooms")
    assert _counted.calls == 1
    assert source is not None
    assert source.simulated
    assert source.available() is None
    assert first.fingerprint == again.fingerprint
    (kept,) = (tmp_path / "simulated").iterdir()
    kept.write_bytes(kept.read_bytes()[:1000])
    healed, _ = open_recordings("rooms")
    assert _counted.calls == 2
    assert healed.fingerprint == first.fingerprint


def test_the_source_works_without_a_writable_cache(monkeypatch, tmp_path) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("BENCH_CACHE", str(tmp_path / "file"))
    monkeypatch.setattr(Rooms, "generate", _Counted(Rooms.generate))
    made, _ = open_recordings("rooms")
    assert len(made) == 400


class _Counted:
    """Generates 400 rows instead of all, and counts how often."""

    def __init__(self, generate) -> None:
        self.generate = generate
        self.calls = 0

    def __get__(self, instance, owner):
        def call():
            self.calls += 1
            return self.generate(instance, 400)

        return call


@pytest.mark.parametrize(("source", "made"), [(RoomsSource, Rooms), (IdealRoomsSource, IdealRooms)])
def test_where_rows_are_kept_is_known_without_making_the_simulator(
    source, made, monkeypatch
) -> None:
    place = source().kept()
    assert place.name == f"{source.name}-{made().key()}.parquet"
    monkeypatch.setattr(source, "_rooms", None)
    assert source().kept() == place
