"""Laws are data: the allow-list, units, and what is done with rows that give no number."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from bench.cli.main import group, main
from bench.errors import BenchError
from bench.physics import Base, Simulator, from_toml, to_toml
from bench.physics.effects.ranging.law import Law
from bench.physics.formula.units import column_unit, over, times, unit

ROWS = pd.DataFrame(
    {
        "true_range_m": [2.0, 4.0, 8.0, 5.0],
        "time_s": [0.0, 10.0, 20.0, 30.0],
        "temperature_c": [20.0, 25.0, np.nan, 30.0],
        "rx": ["a1", "a2", "a2", "a3"],
        "link": ["l1", "l2", "l3", "l4"],
        "obstacles": [["wall"], [], ["wall", "door"], []],
        "azimuth_deg": [0.0, 90.0, 180.0, 270.0],
    }
)


def shift(expression: str, *constants: str) -> np.ndarray:
    """Return what a law adds to the ranges of ROWS, in metres."""
    base = Base(noise_per_symbol=0.01)
    bare, lawful = (
        Simulator(base, effects).simulate(ROWS).frame["range_m"].to_numpy()
        for effects in ((), (Law(expression, constants),))
    )
    return lawful - bare


@pytest.mark.parametrize(
    ("expression", "constants", "expected"),
    [
        ("a * true_range_m", ["a = 0.01 m/m"], [0.02, 0.04, 0.08, 0.05]),
        ("a * true_range_m", ["a = 1 %"], [0.02, 0.04, 0.08, 0.05]),
        ("a * (time_s > t0)", ["a = 20 cm", "t0 = 15 s"], [0, 0, 0.2, 0.2]),
        ('a * (rx == "a2")', ["a = 0.3 m"], [0, 0.3, 0.3, 0]),
        ('a * (obstacles == "wall")', ["a = 0.1 m"], [0.1, 0, 0.1, 0]),
        ("a * (temperature_c - t)", ["a = 0.1 m/degC", "t = 20 degC"], [0, 0.5, 0, 1.0]),
        ("a * sin(azimuth_deg)", ["a = 1 m"], [0, 1, 0, -1]),
        ("a / true_range_m ** 2", ["a = 4 m*m*m"], [1, 0.25, 0.0625, 0.16]),
        ("a * exp(-time_s / tau)", ["a = 1 m", "tau = 10000 ms"], np.exp([0, -1, -2, -3])),
        ("a * (true_range_m / x0) ** p", ["a = 1 m", "x0 = 2 m", "p = 0.5 1"],
         [1, 2**0.5, 2, 2.5**0.5]),
        ("sqrt(true_range_m ** 2 + a ** 2) - true_range_m", ["a = 3 m"],
         np.hypot([2, 4, 8, 5], 3) - [2, 4, 8, 5]),
    ],
)  # fmt: skip
def test_a_law_gives_metres(expression: str, constants: list[str], expected: list[float]) -> None:
    assert shift(expression, *constants) == pytest.approx(np.asarray(expected), abs=1e-6)


def test_rounding_acts_on_what_was_measured() -> None:
    simulated = Simulator(Base(), (Law("q * floor(range_m / q) - range_m", ("q = 0.25 m",)),))
    steps = simulated.simulate(ROWS).frame["range_m"].to_numpy() / 0.25
    assert np.abs(steps - np.rint(steps)).max() < 1e-9


HOSTILE = [
    ("__import__('os').system('id')", "not allowed"),
    ("().__class__", "not allowed"),
    ("true_range_m.__class__", "not allowed"),
    ("eval('1')", "unknown function 'eval'"),
    ("expp(time_s / t)", "did you mean 'exp'"),
    ("[true_range_m][0]", "not allowed"),
    ("lambda: 1", "not allowed"),
    ("true_range_m if 1 else 2", "not allowed"),
    ("f'{true_range_m}'", "not allowed"),
    ("'a' * 9", "no number"),
    ("True * true_range_m", "no number"),
    ("1j * true_range_m", "not allowed"),
    ("true_range_m ** true_range_m", "expected a number or a constant of no unit"),
    ("true_range_m ** 9 ** 9", "expected a number"),
    ("true_range_m ** 99", "expected within 8"),
    ("9" * 400 + " * true_range_m", "too large"),
    ("true_range_m // 2", "not allowed"),
    ("1 < true_range_m < 2", "not allowed"),
    ("exp(true_range_m)", "expected no unit"),
    ("true_range_m + time_s", "units do not fit: m \\+ s"),
    ("time_s", "is in s, not m"),
    ("3", "no unit, not m"),
    ("minimum(true_range_m)", "1 arguments, expected 2"),
    ("sin(x=1)", "not allowed"),
    ("-" * 60 + "true_range_m", "deeper than 24"),
    ("(" * 300 + "true_range_m" + ")" * 300, "expression"),
    ("true_range_m" + " + true_range_m" * 200, "characters, expected at most"),
    ("", "SyntaxError"),
    ("true_range_m;", "SyntaxError"),
    ("x\n=3", "SyntaxError"),
]


@pytest.mark.parametrize(("expression", "message"), HOSTILE)
def test_what_is_not_in_the_allow_list_is_one_clear_line(expression: str, message: str) -> None:
    text = to_toml(Simulator(Base(), (Law(),)))
    text = text.replace("0 * true_range_m", "X").replace(
        '"X"', "'''" + expression + "'''" if "\n" not in expression else '"x\\n=3"'
    )
    with pytest.raises(BenchError, match=message) as caught:
        from_toml(text, "SIM.toml")
    assert str(caught.value).startswith("SIM.toml: effect 'law': ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("constant", "message"),
    [
        ("a = 1 metre", "unknown unit"),
        ("a = one m", "expected NAME = NUMBER UNIT"),
        ("a = inf m", "expected NAME"),
        ("a.b = 1 m", "expected NAME"),
        ("1 m", "expected NAME"),
    ],
)
def test_bad_constants(constant: str, message: str) -> None:
    with pytest.raises(BenchError, match=message):
        Law("a * 1", (constant,))
    with pytest.raises(BenchError, match="list of texts"):
        Law("true_range_m", (3,))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("expression", "constants", "message"),
    [
        ("a / (temperature_c - t)", ["a = 1 m*degC", "t = 25 degC"], "divides by zero on 1 row"),
        ("a * (true_range_m / b - c) ** -1", ["a = 1 m", "b = 2 m", "c = 1 1"], "divides by zero"),
        ("a * log(time_s / t)", ["a = 1 m", "t = 1 s"], r"has no value on 1 row\(s\) in 'log"),
        ("a * sqrt((time_s - t) / t)", ["a = 1 m", "t = 5 s"], "has no value on 1 row"),
        ("a * exp(time_s / t)", ["a = 1 m", "t = 1 us"], "has no value"),
        ("a * humidity", ["a = 1 m"], "unknown column or constant 'humidity'"),
        ('a * (tx == "x")', ["a = 1 m"], "unknown column of names 'tx'"),
    ],
)
def test_rows_that_give_no_number(expression: str, constants: list[str], message: str) -> None:
    with pytest.raises(BenchError, match=message):
        shift(expression, *constants)


def test_bench_simulate_runs_a_law_and_refuses_a_bad_one(tmp_path, monkeypatch, capsys) -> None:
    law = Law('a * true_range_m * (rx == "a2")', ("a = 0.5 m/m",))
    (tmp_path / "sim.toml").write_text(to_toml(Simulator(Base(), (law,))))
    ROWS.drop(columns=["obstacles"]).to_parquet(tmp_path / "rows.parquet")
    asked = ["--geometry", str(tmp_path / "rows.parquet"), "-o", str(tmp_path / "out.parquet")]
    done = CliRunner().invoke(group, ["simulate", str(tmp_path / "sim.toml"), *asked])
    assert done.exit_code == 0, done.output
    error = pd.read_parquet(tmp_path / "out.parquet")["error_m"].to_numpy()
    assert error == pytest.approx([0, 2, 4, 0], abs=0.2)
    zero = Law("a / time_s", ("a = 1 m*s",))
    (tmp_path / "sim.toml").write_text(to_toml(Simulator(Base(), (zero,))))
    monkeypatch.setattr(sys, "argv", ["bench", "simulate", str(tmp_path / "sim.toml"), *asked])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    said = capsys.readouterr().err.strip()
    assert "effect 'law': divides by zero on 1 row(s): time_s is 0" in said
    assert "Traceback" not in said
    assert "\n" not in said


def test_units_of_columns_and_their_quotients() -> None:
    assert column_unit("radial_speed_m_per_s") == "m/s"
    assert column_unit("true_range_m") == "m"
    assert column_unit("humidity") == "1"
    for top, below in (("m", "m/s"), ("m", "degC"), ("m", "1"), ("m/s", "m")):
        assert unit(over(top, below)).kind == unit(top).kind / unit(below).kind
    assert unit(times("m", "m", "1")).kind == unit("m").kind ** 2
    assert unit("s**-1").kind == 1 / unit("s").kind


def test_it_is_shown_with_its_numbers_and_units() -> None:
    shown = Law("a * true_range_m + b", ("a = 0.00412345 m/m", "b = 0.1 m")).formula.shown
    assert "(0.004123 m/m)" in shown
    assert "true_range_m" in shown
    assert Law("a / true_range_m ** 2", ("a = 1 m*m*m",)).formula.shown.endswith("true_range_m^2")


def test_only_laws_need_sympy() -> None:
    code = (
        "import sys, bench.discrepancy.method, bench.physics.effects.ranging.law as law; "
        "before = 'sympy' in sys.modules; law.Law(); print(before, 'sympy' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "True"]


def test_the_size_of_a_unit_needs_no_symbols() -> None:
    code = "import sys; from bench.physics.formula.units import factor_of; "
    code += "print(factor_of('deg') * factor_of('1/ms'), 'sympy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    size, loaded = done.stdout.split()
    assert float(size) == unit("deg").factor * unit("1/ms").factor
    assert loaded == "False"
