from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import result_files as files
from markdown_it import MarkdownIt

from reports import make_boards
from reports.leaderboard import leaderboard
from reports.markdown import to_markdown

HEADER = "| Model | Backend |"


def markdown(folder: Path, *records: Any, picture: str | None = None) -> str:
    results = files.read(folder, *records)
    return to_markdown(leaderboard(make_boards(results), results.unreadable, picture))


def rows(text: str, table: int = 0) -> dict[str, dict[str, str]]:
    """Parse one table: {'model backend': {header: cell}}."""
    block = [part for part in text.split("\n\n") if part.startswith(HEADER)][table]
    split = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in block.split("\n")]
    header = split[0]
    return {f"{row[0]} {row[1]}": dict(zip(header, row, strict=True)) for row in split[2:]}


def test_every_column_of_a_row(tmp_path: Path) -> None:
    run = files.run(
        "remnet",
        "int8",
        nlos=files.score(mae_m=files.Interval(0.07, 0.066, 0.0745), r2=files.Interval(0.41)),
        integer_kernels="14/14",
    )
    row = rows(markdown(tmp_path, run, files.timing(run, 123.4)))["remnet int8"]
    assert row == {
        "Model": "remnet",
        "Backend": "int8",
        "NLoS MAE (m)": "0.0700<br>[0.0660, 0.0745]",
        "NLoS R²": "0.410",
        "NLoS σ (m)": "0.0980<br>[0.0920, 0.1040]",
        "LoS MAE (m)": "0.0400<br>[0.0360, 0.0440]",
        "LoS R²": "0.333<br>[0.303, 0.363]",
        "Seeds": "1",
        "Latency, batch 1 (µs)": "123<br>[121, 126]",
        "Latency, batch 4 (µs)": "308<br>[302, 315]",
        "Throughput (rows/s)": "12,966",
        "Peak memory (MB)": "80.0",
        "File (kB)": "30.0",
        "Weights (kB)": "24.6",
        "Parameters": "6,151",
        "MACs": "1,234,567",
        "Integer kernels": "14/14",
    }


def test_what_is_not_known_is_a_dash_and_what_is_not_finite_says_so(tmp_path: Path) -> None:
    run = files.run(
        nlos=files.score(r2=files.Interval(float("nan"))), los=None, size=None, estimates=[]
    )
    text = markdown(tmp_path, run)
    row = rows(text)["remnet fp32"]
    assert row["NLoS R²"] == "n/a"
    for header in ("LoS MAE (m)", "Latency, batch 1 (µs)", "File (kB)", "Integer kernels"):
        assert row[header] == "–"
    assert "Energy" not in text


def test_the_best_of_each_column_is_bold(tmp_path: Path) -> None:
    good = files.run("good", nlos=files.score(0.05))
    fast = files.run("fast", nlos=files.score(0.09), size=files.Size(10, 8, 2, 4))
    table = rows(markdown(tmp_path, good, fast, files.timing(good, 50), files.timing(fast, 5)))
    bold = {name: {h for h, cell in row.items() if "**" in cell} for name, row in table.items()}
    assert bold["good fp32"] == {"NLoS MAE (m)", "NLoS R²", "NLoS σ (m)"}
    assert bold["fast fp32"] == {
        "Latency, batch 1 (µs)",
        "Latency, batch 4 (µs)",
        "Throughput (rows/s)",
        "File (kB)",
        "Weights (kB)",
        "Parameters",
        "MACs",
    }


def test_figures_that_read_alike_are_both_best(tmp_path: Path) -> None:
    table = rows(
        markdown(
            tmp_path,
            files.run("a", nlos=files.score(0.070001)),
            files.run("b", nlos=files.score(0.070002)),
            files.run("c", nlos=files.score(0.08)),
        )
    )
    best = [name for name, row in table.items() if row["NLoS MAE (m)"].startswith("**")]
    assert best == ["a fp32", "b fp32"]


def test_the_floor_can_win_accuracy_but_not_cost(tmp_path: Path) -> None:
    floor = files.run("none", nlos=files.score(0.05), size=files.Size(1, 0, 0, 0))
    other = files.run("svm", nlos=files.score(0.09))
    more = files.run("mlp", nlos=files.score(0.10), size=files.Size(40_000, 30_000, 9000, 9))
    timings = [files.timing(floor, 1), files.timing(other, 9), files.timing(more, 10)]
    table = rows(markdown(tmp_path, floor, other, more, *timings))
    assert table["none (floor) fp32"]["NLoS MAE (m)"].startswith("**0.0500**")
    assert table["none (floor) fp32"]["Latency, batch 1 (µs)"].startswith("1.00<br>")
    assert table["svm fp32"]["Latency, batch 1 (µs)"].startswith("**9.00**")
    assert table["svm fp32"]["File (kB)"] == "**30.0**"


def test_an_unstable_timing_is_marked_and_cannot_win(tmp_path: Path) -> None:
    runs = [files.run(model) for model in "abc"]
    shaky = files.timing(runs[0], latency=[files.latency(1, 5.0, unstable=True)])
    table = rows(
        markdown(tmp_path, *runs, shaky, *(files.timing(r, 9 + i) for i, r in enumerate(runs[1:])))
    )
    assert table["a fp32"]["Latency, batch 1 (µs)"] == "5.00<br>[4.90, 5.10] unstable"
    assert table["b fp32"]["Latency, batch 1 (µs)"].startswith("**9.00**")
    assert table["a fp32"]["Throughput (rows/s)"] == "16,000<br>unstable"


def test_a_timing_with_other_weights_carries_a_dagger(tmp_path: Path) -> None:
    run = files.run()
    borrowed = files.timing(run, 50, artifact_sha256="another")
    table = rows(markdown(tmp_path, run, borrowed))
    assert table["remnet fp32"]["Latency, batch 1 (µs)"].startswith("50.0 †")


def test_seeds_are_counted_and_their_spread_shown(tmp_path: Path) -> None:
    runs = [files.run(seed=i, nlos=files.score(0.07 + 0.001 * i)) for i in range(3)]
    row = rows(markdown(tmp_path, *runs))["remnet fp32"]
    assert row["Seeds"] == "3"
    assert row["NLoS MAE (m)"] == "0.0710<br>[0.0670, 0.0750] ±0.0025"


def test_simulated_data_says_so_in_every_heading(tmp_path: Path) -> None:
    text = markdown(tmp_path, files.run(data="rooms"))
    about = [line for line in text.splitlines() if line.startswith("#") and "rooms" in line]
    assert len(about) == 3
    assert all("SIMULATED" in line for line in about)
    assert "data: rooms, SIMULATED, fingerprint" in text
    assert "SIMULATED" not in markdown(tmp_path / "real", files.run(data="apartment"))


def test_estimates_are_marked_and_impossible_ones_have_their_reason(tmp_path: Path) -> None:
    text = markdown(
        tmp_path,
        files.run("a", "fp32"),
        files.run("b", "fp32"),
        files.run("a", "int8", estimates=[]),
    )
    latency, energy = rows(text, 1), rows(text, 2)
    assert latency["a fp32"]["cortex-a53 (est.)"] == "900<br>500 to 1,500"
    assert energy["a fp32"]["cortex-a53 (est.)"] == "1.50<br>0.800 to 2.90"
    assert energy["a int8"]["cortex-a53 (est.)"] == "–"
    assert "- edge-tpu: runs int8 only (every model on fp32)" in text


def test_a_reason_for_some_models_names_the_pairs(tmp_path: Path) -> None:
    text = markdown(tmp_path, files.run("a"), files.run("b", estimates=[]))
    assert "- edge-tpu: runs int8 only (a/fp32)" in text


def test_a_device_that_can_run_nothing_has_no_column_but_a_reason(tmp_path: Path) -> None:
    never = files.Estimate("edge-tpu", None, None, "runs int8 only")
    text = markdown(tmp_path, files.run(estimates=[never]))
    assert "(est.):" not in text.split("## How to read it")[0]
    assert "- edge-tpu: runs int8 only (every model on fp32)" in text


def test_measured_energy_stands_beside_the_estimates(tmp_path: Path) -> None:
    run = files.run()
    measured = files.timing(run, energy_mj=files.Interval(2.0, 1.9, 2.1))
    cell = rows(markdown(tmp_path, run, measured), 2)["remnet fp32"]["this machine (measured)"]
    assert cell == "2.00<br>1.90 to 2.10"


def test_skipped_and_missing_pairs_are_listed(tmp_path: Path) -> None:
    text = markdown(
        tmp_path,
        files.run("svm", "fp32"),
        files.skipped("svm", "qat", "not trained by gradient descent"),
        files.run("mlp", "qat"),
    )
    assert "Skipped:\n\n- svm/qat: not trained by gradient descent" in text
    assert "No result yet:\n\n- mlp/fp32" in text


def test_a_board_of_skips_alone_has_no_table(tmp_path: Path) -> None:
    text = markdown(tmp_path, files.skipped("svm", "qat", "no gradient"))
    assert "No run of this board has finished." in text
    assert HEADER not in text
    assert "- svm/qat: no gradient" in text
    assert "machine: no timings" in text


def test_what_the_figures_rest_on(tmp_path: Path) -> None:
    run = files.run(note="every row scored as NLoS: no labels")
    other = files.run(
        "mlp", versions={"torch": "3"}, code_hash="beef", nlos=files.score(raw_mae=0.13)
    )
    stale = files.run("mlp", versions={"torch": "1"}, created_utc="2020-01-01")
    staler = files.run("mlp", versions={"torch": "0"}, created_utc="2019-01-01")
    foreign = files.run("mlp", data_fingerprint="old", created_utc="2020-01-01")
    machine = {"cpu": "Chip", "cores": 2, "flags": ["avx2"], "ram": {"gb": 8}, "dump": "x" * 500}
    text = markdown(
        tmp_path, run, other, stale, staler, foreign, files.timing(run, machine=machine)
    )
    for line in (
        "- remnet/fp32: every row scored as NLoS: no labels",
        "- data: rooms, SIMULATED, fingerprint 0123456789abcdef",
        "- NLoS test rows: 8,000 on 160 links; before mitigation MAE 0.1200 to 0.1300 m, "
        "σ 0.1560 to 0.1690 m",
        "- LoS test rows: 8,000 on 160 links; before mitigation MAE 0.0600 m, σ 0.0780 m",
        "- machine: Chip (cores 2; flags avx2; ram gb 8)",
        "- versions: numpy 2.4.6, onnxruntime 1.31.1, torch 2.13.0",
        "- versions: torch 3",
        "- WARNING: rows made with 2 different sets of versions",
        "- code that made the rows: beef, c0de",
        "- left out, on older data of the same name: 1 record",
        "- left out, replaced by newer code, versions or runs: 2 records",
        "- newest record: 2026-03-01T10:00:00+00:00",
    ):
        assert line in text.splitlines()


def test_machines_whose_timings_are_not_shown_are_named(tmp_path: Path) -> None:
    run = files.run()
    old = files.timing(run, machine={"cpu": "Old chip"}, created_utc="2020-01-01")
    text = markdown(tmp_path, run, old, files.timing(run))
    assert (
        "- machine: Example CPU 3000, id 0123abcd (cores 2; instruction sets avx2, fma; "
        "python 3.11.9; system Linux x86_64)"
    ) in text
    assert "- timings of other machines, not shown (choose with --machine): Old chip" in text


def test_an_estimate_without_a_range_shows_its_value_alone(tmp_path: Path) -> None:
    bare = files.Estimate("npu", files.Interval(12.0), files.Interval(3.0))
    text = markdown(tmp_path, files.run(estimates=[bare]))
    assert rows(text, 1)["remnet fp32"]["npu (est.)"] == "12.0"


def test_unreadable_files_are_counted_and_the_first_listed(tmp_path: Path) -> None:
    files.write(tmp_path, files.run())
    for i in range(25):
        (tmp_path / "runs" / f"bad{i:02}.json").write_text("{")
    text = markdown(tmp_path)
    assert "## Files left out: 25" in text
    assert "- runs/bad00.json: not JSON" in text
    assert "- and 5 more" in text


HOSTILE = "x|y <script>alert(1)</script> **b** [l](http://e) `c`\n# h"


def test_hostile_names_stay_text_in_one_cell(tmp_path: Path) -> None:
    run = files.run(HOSTILE, data=HOSTILE, split="_a_", note=HOSTILE)
    html = MarkdownIt("commonmark").enable("table").render(markdown(tmp_path, run))
    assert "<script" not in html
    assert "<a " not in html
    assert html.count("<h1>") == 1
    assert "<code>" not in html
    shown = "x|y &lt;script&gt;alert(1)&lt;/script&gt; **b** [l](http://e) `c` # h"
    assert f"<td>{shown}</td>" in html.replace(' style="text-align:right"', "")
    assert "split _a_" in html


def test_the_markdown_is_a_table_with_one_cell_per_column(tmp_path: Path) -> None:
    text = markdown(files.full_folder(tmp_path), picture="some dir/plot.svg")
    html = MarkdownIt("commonmark").enable("table").render(text)
    assert html.count("<table>") == 6
    assert '<img src="some%20dir/plot.svg"' in html
    for body in html.split("<table>")[1:]:
        lines = body.split("</table>")[0].split("<tr>")[1:]
        widths = {line.count("<td") + line.count("<th") - line.count("<thead") for line in lines}
        assert len(widths) == 1


def test_the_same_files_give_the_same_bytes(tmp_path: Path) -> None:
    files.full_folder(tmp_path)
    assert markdown(tmp_path) == markdown(tmp_path)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.0012345, "0.00123"),
        (0.00012345, "1.23e-04"),
        (1.0, "1.00"),
        (99.96, "100.0"),
        (-12345.6, "-12,346"),
    ],
)
def test_three_significant_digits(value: float, text: str) -> None:
    from reports.numbers import significant

    assert significant(value) == text


def test_lengths_of_many_metres_need_no_tenths_of_millimetres() -> None:
    from reports.numbers import count, metres, significant

    assert metres(1234.5678) == "1,234.57"
    assert {metres(float("inf")), count(float("nan")), significant(float("nan"))} == {"n/a"}
