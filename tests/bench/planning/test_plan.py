"""Which measurement next: scatter, what is left open, predictions, choice, and the command."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.stats import multivariate_normal

import bench
from bench.cli.main import main
from bench.discrepancy.report.evidence import Evidence, read_evidence, write_evidence
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.clock_offset import ClockOffset
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.physics.toml_file import to_toml
from bench.planning.alternatives import Past, posterior
from bench.planning.choose import probability
from bench.planning.measurements import measurements, reference_row
from bench.planning.outlook import Outlook, Prediction
from bench.planning.plan import Answer, answer
from bench.planning.questions import Question, Seen, read_questions
from bench.planning.scatter import Scatter, components, log_likelihood
from bench.planning.settings import ASSURED_NATS, SURE, SURE_NATS
from bench.planning.strays import of_one_device, stray_links
from bench.planning.trends import trends
from bench.planning.world import World

DELAY, CLOCK = AntennaDelay(delay_ns=0.7), ClockOffset(offset_ppm=0.7)


def evidence(shift_m: float = 0.105, seed: int = 0) -> Evidence:
    """Return rows of one reply time, at which a constant may be a delay or a clock's offset."""
    rng = np.random.default_rng(seed)
    link = np.repeat(np.arange(24), 5)
    frame = pd.DataFrame({"link": [f"l{i}" for i in link], "reply_time_s": 1e-3})
    frame["true_range_m"] = rng.uniform(3, 15, 24)[link]
    level = -58.8 - 20 * np.log10(frame["true_range_m"].to_numpy())
    error = shift_m + rng.normal(0, 0.03, 120) + rng.normal(0, 0.01, 24)[link]
    recorded = np.stack([error, level + rng.normal(0, 0.5, 120)], 1)
    simulated = np.stack([np.zeros(120), level], 1)
    whole = frame.assign(error_m=error, range_m=error + frame["true_range_m"])
    return Evidence(whole, ("error_m", "rx_power_dbm"), recorded, simulated)


@pytest.fixture(scope="module")
def planned() -> Answer:
    """Return the plan for two explanations that only the reply time tells apart."""
    question = Question("delay or clock", (DELAY, CLOCK), ())
    return answer(question, evidence(), Simulator(Base()), None, 0)


def folder_with(tmp_path: Path, verdicts: list[dict], **inputs: object) -> Path:
    report = {"headline": "said", "verdicts": verdicts, "tried": []}
    (tmp_path / "diagnosis.json").write_text(json.dumps(report))
    content = {"simulator_toml": to_toml(Simulator(Base())), **inputs}
    (tmp_path / "inputs.json").write_text(json.dumps(content))
    write_evidence(evidence(), tmp_path)
    return tmp_path


def ambiguous() -> dict:
    options = [{"effect": e.name, "values": vars(e)} for e in (DELAY, CLOCK)]
    return {"verdict": "ambiguous", "names": ["antenna-delay", "clock-offset"], "options": options}


def test_scatter_is_taken_apart_and_its_likelihood_is_the_normal_one():
    rng = np.random.default_rng(1)
    links = np.repeat(np.arange(400), 5)
    values = rng.normal(0, 2, (2000, 2)) + rng.normal(0, 3, (400, 2))[links]
    found = components(values, links)
    np.testing.assert_allclose(np.diag(found.within), 4, rtol=0.1)
    np.testing.assert_allclose(np.diag(found.between), 9, rtol=0.2)
    few, code = values[:15], links[:15]
    same = code[:, None] == code
    whole = np.kron(np.eye(15), found.within) + np.kron(same, found.between)
    exact = multivariate_normal(np.zeros(30), whole)
    other = Scatter(found.within * 2, found.between)
    twice = np.kron(np.eye(15), other.within) + np.kron(same, other.between)
    wanted = exact.logpdf(few.ravel()) - multivariate_normal(np.zeros(30), twice).logpdf(
        few.ravel()
    )
    got = log_likelihood(few, code, found) - log_likelihood(few, code, other)
    assert got == pytest.approx(wanted)


def test_expected_nats_are_those_of_normals_where_nothing_is_open():
    one, other = (Prediction(np.full((1, 1, 1), mean), np.full((1, 1, 1), 4.0)) for mean in (0, 3))
    found = Outlook(("a", "b"), (one, other)).nats(np.array([2]))
    np.testing.assert_allclose(found, [[0, 2.25], [2.25, 0]])
    wide = Prediction(np.linspace(-9, 9, 200)[:, None, None], np.full((1, 1, 1), 4.0))
    assert Outlook(("a", "b"), (one, wide)).nats(np.array([2]))[0, 1] < 2  # it can follow


def test_walkers_find_a_narrow_normal():
    rngs = [np.random.default_rng(seed) for seed in range(20)]
    draws = [
        posterior(lambda x: float(-((x[0] - 0.6) ** 2) / 2 / 0.02**2), r.random((24, 1)), 40, r)
        for r in rngs
    ]
    assert np.mean(draws) == pytest.approx(0.6, abs=0.01)
    assert np.std(draws) == pytest.approx(0.02, rel=0.3)


def test_a_plan_varies_what_the_two_explanations_differ_in(planned: Answer):
    assert planned.names == ("antenna-delay", "clock-offset")
    assert {m.knob for m, _ in planned.planned()} == {"reply time"}
    assert planned.worth[0].least_nats > 1
    assert planned.sure
    assert planned.probability >= SURE
    assert all(w.links is None or w.links >= 12 for w in planned.worth)
    knobs = {planned.offered[w.place].knob for w in planned.worth}
    assert "heading" not in knobs  # nothing reacts to it
    assert "distance" not in knobs


@pytest.mark.parametrize("truth", [DELAY, CLOCK])
def test_what_is_reached_is_what_was_expected(planned: Answer, truth: object):
    """Simulated links of the plan, many times: the mean log ratio is the expected one."""
    assert planned.outlook is not None
    rng, right = np.random.default_rng(0), [DELAY, CLOCK].index(truth)
    counts, mine = np.array(planned.links), planned.outlook.predictions[right]
    used = np.maximum(counts, 1)[:, None, None]
    root = np.linalg.cholesky(mine.scatter / used)
    reached = []
    for _ in range(400):
        noise = np.einsum("cpq,cq->cp", root, rng.normal(size=root.shape[:2]))
        values = mine.means[rng.integers(len(mine.means))] + noise
        reached.append(planned.outlook.reached(counts, values, right, 1 - right))
    expected = planned.outlook.nats(counts)[right, 1 - right]
    assert np.mean(reached) == pytest.approx(expected, rel=0.15)


def test_planned_rows_can_be_simulated(planned: Answer):
    rows = planned.geometry()
    assert len(rows) == planned.rows * sum(planned.links)
    assert rows["link"].nunique() == sum(planned.links)
    made = Simulator(Base()).observe(scene(rows), cir=False)
    assert np.isfinite(made.range_m).all()


def test_every_measurement_offered_can_be_simulated():
    frame = evidence().frame.assign(
        temperature_c=20.0, time_s=7.0, azimuth_deg=3.0, radial_speed_m_per_s=0.1, tx="a", rx="b",
        obstacles=[["brick"]] * 120, obstacle_thickness_m=[[0.1]] * 120, los=0.0,
        tx_x_m=1.0, tx_y_m=2.0, tx_z_m=1.0, rx_x_m=5.0, rx_y_m=2.0, rx_z_m=1.0,
    )  # fmt: skip
    offered, typical = measurements(frame, Base()), reference_row(frame)
    rows = pd.concat([m.rows(typical, 2, f"p{i}") for i, m in enumerate(offered)])
    assert {m.knob for m in offered} >= {"walls", "speed", "height", "devices", "warm-up"}
    far = rows[rows["true_range_m"] == 7.0]
    assert (far["tx_x_m"] - far["rx_x_m"]).abs().iloc[0] == pytest.approx(7.0)
    made = Simulator(Base()).observe(scene(rows.reset_index(drop=True)), cir=False)
    assert np.isfinite(made.rx_power_dbm).all()


def test_less_power_in_a_row_is_simulated():
    frame = pd.DataFrame({"true_range_m": [5.0, 5.0, 5.0], "tx_power_dbm": [-14.3, -20.3, np.nan]})
    level = Simulator(Base()).observe(scene(frame), cir=False).rx_power_dbm
    np.testing.assert_allclose(level - level[0], [0, -6, 0], atol=1e-4)


def test_the_scale_of_nats():
    assert probability(SURE_NATS) == pytest.approx(SURE, abs=0.002)
    assert probability(0) == 0
    assert probability(SURE_NATS / ASSURED_NATS) < 0.5


def test_evidence_comes_back_as_written(tmp_path: Path):
    write_evidence(evidence(), tmp_path)
    again = read_evidence(tmp_path)
    assert again.names == evidence().names
    np.testing.assert_array_equal(again.recorded, evidence().recorded)
    pd.testing.assert_frame_equal(again.frame, evidence().frame, check_dtype=False)


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys):
    monkeypatch.setattr("bench.planning.alternatives.SWEEPS", 4)
    folder, table = folder_with(tmp_path, [ambiguous()]), tmp_path / "plan.csv"
    line = ["bench", "plan", "--diagnosis", str(folder), "-o", str(table), "--links", "14"]
    monkeypatch.setattr("sys.argv", [*line, "--json"])
    with pytest.raises(SystemExit) as ended:
        main()
    said = json.loads(capsys.readouterr().out)
    assert ended.value.code == 0
    assert sum(one["links"] for one in said["questions"][0]["plan"]) == 14
    rows = pd.read_csv(table)
    assert len(rows) == 14
    assert (rows["rows"] == 5).all()
    assert rows["reply_time_s"].notna().all()


def test_nothing_open_is_said_and_no_failure(tmp_path: Path, monkeypatch, capsys):
    folder = folder_with(tmp_path, [{"verdict": "no mismatch", "names": []}])
    monkeypatch.setattr("sys.argv", ["bench", "plan", "--diagnosis", str(folder)])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 0
    assert "no measurement is needed" in capsys.readouterr().out


def test_an_unknown_cause_is_asked_what_it_follows(tmp_path: Path):
    unknown = {"verdict": "unknown", "names": []}
    rng, found = np.random.default_rng(0), evidence()
    warm = rng.uniform(10, 30, 24)[found.links]
    frame = found.frame.assign(temperature_c=warm + 0.01 * found.frame["true_range_m"])
    recorded = found.recorded + np.stack([0.001 * warm, 0 * warm], 1)
    folder = folder_with(tmp_path, [unknown])
    write_evidence(Evidence(frame, found.names, recorded, found.simulated), folder)
    report = json.loads((folder / "diagnosis.json").read_text())
    constant = {"name": "a", "value": 0.2, "low": 0.1, "high": 0.3, "unit": "m"}
    step = constant | {"name": "t", "value": 9.0, "low": 9.0, "high": 9.0}
    report["law"] = {"expression": "a * (true_range_m > t)", "constants": [constant, step]}
    (folder / "diagnosis.json").write_text(json.dumps(report))
    one = bench.plan(folder).answers[0]
    assert one.names[0] == "law: a * (true_range_m > t)"
    assert one.question == "what no known effect explains"
    follows = {f"the error follows {what}" for what in ("distance", "temperature")}
    assert set(one.names[1:]) <= {*follows, "the error is the same everywhere"}
    assert "distance" in {m.knob for m, _ in one.planned()}
    report["setup_fault"] = {"words": "a fault of the set-up: a2 hangs elsewhere"}
    (folder / "diagnosis.json").write_text(json.dumps(report))
    assert "a2 hangs elsewhere" in bench.plan(folder).answers[0].note


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"diagnosis.json": None}, "no diagnosis there"),
        ({"diagnosis.json": "{}"}, "not a diagnosis that can be planned from"),
        ({"diagnosis.json": "["}, "not JSON"),
        ({"inputs.json": '{"simulator_toml": "x"}'}, "not TOML"),
        ({"evidence.parquet": None}, "not there"),
        ({"evidence.parquet": "no"}, "evidence.parquet"),
    ],
)
def test_bad_folders_are_one_line(tmp_path: Path, change: dict[str, str | None], message: str):
    folder = folder_with(tmp_path, [ambiguous()])
    for name, text in change.items():
        (folder / name).unlink()
        if text is not None:
            (folder / name).write_text(text)
    with pytest.raises(BenchError, match=message) as told:
        bench.plan(folder)
    assert "\n" not in str(told.value)


def test_effects_of_a_folder_are_checked(tmp_path: Path):
    wrong = ambiguous()
    wrong["options"][0]["values"] = {"delay_ns": 1e9}
    with pytest.raises(BenchError, match="outside its physical bounds"):
        bench.plan(folder_with(tmp_path, [wrong]))
    with pytest.raises(BenchError, match="--links 0"):
        bench.plan(tmp_path, links=0)


def test_each_planned_line_says_what_every_explanation_predicts(planned: Answer):
    measurement, _ = planned.planned()[0]
    why = planned.why(measurement)
    assert why.startswith("recorded - simulated range: ")
    assert "m if antenna-delay" in why
    assert "m if clock-offset; a link's mean scatters by" in why
    assert float(why.split("range: ")[1].split(" m if")[0]) == pytest.approx(0.105, abs=0.02)


def test_few_links_far_off_are_to_be_looked_at_first():
    found = evidence(0.0)
    far = found.recorded + np.where(found.links < 2, 0.6, 0.0)[:, None] * [1, 0]
    past = Past(World(Simulator(Base()), found.names, False), found)
    assert stray_links(past, ()) == ""
    struck = Past(past.world, Evidence(found.frame, found.names, far, found.simulated))
    assert "2 of 24 links" in stray_links(struck, ())
    assert "l0 (+0.6" in stray_links(struck, ())


def test_an_error_that_follows_nothing_is_an_explanation_too():
    past = Past(World(Simulator(Base()), evidence().names, False), evidence())
    found = {one.name: one for one in trends(past, (), 0)}
    (effect,) = found["the error is the same everywhere"].draws[0]
    assert np.ptp(effect.shifts_m) == 0
    assert effect.shifts_m[0] == pytest.approx(0.105, abs=0.02)


def test_what_shows_in_waveforms_alone_gets_no_plan_over_ranges():
    profile = "profile_db[3.5..6.5ns]"
    seen = Seen(profile, "as a trend over rx_y_m", profile, "rx_y_m")
    question = Question("what no known effect explains", (), (), seen=(seen,))
    made = answer(question, evidence(), Simulator(Base()), None, 0)
    assert not made.planned()
    assert made.note.startswith("it shows in profile_db[3.5..6.5ns] as a trend over rx_y_m, not")


def test_what_is_all_of_one_device_is_told_by_exchanging_it():
    names = ("rx_power_dbm", "energy_db", "max_amplitude_db")
    seen = tuple(Seen(name, "where tx=t3", name, "tx=t3") for name in names)
    question = Question("what no known effect explains", (), (), seen=seen)
    made = answer(question, evidence(), Simulator(Base()), None, 0)
    assert made.note.startswith("all of it shows where tx=t3: let another device take the place")
    assert not of_one_device((*seen[:2], Seen("rx_power_dbm", "in all rows", "rx_power_dbm")))
    assert not of_one_device(seen[:2])
    assert not of_one_device(tuple(replace(one, covariate="rx_z_m") for one in seen))


def test_what_a_diagnosis_says_tells_apart_is_repeated_where_no_setting_does(tmp_path: Path):
    folder = folder_with(tmp_path, [{**ambiguous(), "separate": "record while no tag sends"}])
    (asked,) = read_questions(folder).questions
    assert asked.separate == "record while no tag sends"
    alike = replace(asked, options=(DELAY, AntennaDelay(delay_ns=0.71)))
    made = answer(alike, evidence(), Simulator(Base()), None, 0)
    assert not made.planned()
    assert made.note.endswith("they predict the same; what may: record while no tag sends")
