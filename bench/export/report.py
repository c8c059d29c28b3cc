"""REPORT.md: what was exported, how well it agrees, what it takes, how it is called."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.export.agreement import Agreement, at_most
from bench.export.chosen import Chosen
from bench.results import Interval
from bench.text import named
from zoo.inputs import COLUMNS

if TYPE_CHECKING:
    from bench.runner.counting import Counted

CIR = "cir"
FROM = {
    "rx_power_dbm": "dBm: 10 log10(CIR_PWR 2^17 / RXPACC^2) - A",
    "first_path_power_dbm": "dBm: 10 log10((FP_AMPL1^2 + FP_AMPL2^2 + FP_AMPL3^2) / RXPACC^2) - A; "
    "A = 121.74 at 64 MHz PRF, 113.77 at 16 MHz",
    "noise_std": "counts: STD_NOISE",
    "preamble_count": "symbols: RXPACC",
    "peak_ampl": "counts: LDE_PPAMPL",
    "fp_ampl1": "counts",
    "fp_ampl2": "counts",
    "fp_ampl3": "counts",
    "range_m": "as measured",
}
"""Unit and origin of what is read beside the CIR (DW1000 User Manual 2.18, section 4.7)."""
NOT_CHECKED = "not checked: no C compiler on this machine"


@dataclass(frozen=True)
class Figures:
    """What is known of the C: `constant_bytes` of tables; agreement None where not compiled.

    `samples` of the first input; `inputs` in order: the macro of each one's size by its name.
    `counted` is what it takes on parts, emulated; `kept` are rows of counts made before of this C.
    """

    integer: bool
    agreement: Agreement | None
    constant_bytes: int
    arena_bytes: int
    samples: int
    inputs: Mapping[str, str]
    counted: Sequence[Counted] = ()
    kept: Sequence[str] = ()


def report(chosen: Chosen, figures: Figures | None) -> str:
    """Return the report; without figures it is of an ONNX file."""
    return "\n".join([*_origin(chosen), *(_c_parts(figures) if figures else _onnx_parts())])


def _origin(chosen: Chosen) -> list[str]:
    origin = named(f"{chosen.origin[0].upper()}{chosen.origin[1:]}")
    return [
        f"# {chosen.model} on {chosen.backend}",
        "",
        f"{origin}: the first fold of `{chosen.split}`, seed {chosen.seed}. The prediction "
        "is the range error (measured - true) in metres: subtract it from the range.",
        "",
    ]


def _onnx_parts() -> list[str]:
    return [
        "`model.onnx` takes `cir` float32 [n, width] and gives `error_m` float32 [n]; features and "
        "normalisation are inside.",
        "",
    ]


def _c_parts(figures: Figures) -> Iterable[str]:
    return [
        "| figure | value | how obtained |",
        "| --- | --- | --- |",
        *_agreement(figures),
        f"| flash for constants | {figures.constant_bytes} bytes | counted in the source |",
        f"| RAM for activations | {figures.arena_bytes} bytes, static | counted in the source |",
        *_counted(figures),
        "",
        *_calling(figures),
        *_inputs(),
    ]


def _counted(figures: Figures) -> list[str]:
    """Return rows for each part; without parts, how to get them."""
    lines = []
    for one in figures.counted:
        figure = one.figure
        how = f"counted: emulated {one.count.core}, {one.count.compiler}"
        lines.append(f"| {figure.device}: cycles of a call | {_cycles(figure.cycles)} | {how} |")
        lines.append(f"| {figure.device}: latency | {_ms(figure.latency_us)} | {how} |")
        lines.append(f"| {figure.device}: size | {figure.fits} | {how} |")
    pointer = "| code size, cycles | not counted: `--device` names parts to count them for | – |"
    return [*lines, *figures.kept] or [pointer]


def _cycles(cycles: Interval) -> str:
    low, high = cycles.low or cycles.value, cycles.high or cycles.value
    return f"{cycles.value:.0f} [{low:.0f}, {high:.0f}], the part's wait states included"


def _ms(latency_us: Interval) -> str:
    low, high = latency_us.low or latency_us.value, latency_us.high or latency_us.value
    return f"{latency_us.value / 1e3:.2f} ms [{low / 1e3:.2f}, {high / 1e3:.2f}]"


def _agreement(figures: Figures) -> list[str]:
    found = figures.agreement
    if found is None:
        return [f"| agreement with ONNX Runtime | {NOT_CHECKED} | – |"]
    how = f"measured on {found.rows} held-out rows, this machine"
    lines = [
        f"| difference from ONNX Runtime, 99 % of rows | {at_most(found.usual_m)} | {how} |",
        f"| the largest | {at_most(found.largest_m)} | {how} |",
    ]
    if figures.integer:
        lines.append(f"| rows equal to it bit by bit | {100 * found.equal:.2f} % | {how} |")
    return lines


def _calling(figures: Figures) -> list[str]:
    cir = _reading_the_cir(figures.samples) if CIR in figures.inputs else []
    first_path = ["/* cir[5] is the sample of the detected first path */"] if cir else []
    sizes = [f"{name}[{size}]" for name, size in figures.inputs.items()]
    return [
        "## Calling it from DW1000 firmware (DWM1001 and others)",
        "",
        *cir,
        *(f"- {line}" for line in map(_values_of, figures.inputs) if line),
        "",
        "Correct the range:",
        "",
        "```c",
        f"float {', '.join(sizes)}, error_m;",
        *first_path,
        f"if (uwb_predict({', '.join(figures.inputs)}, &error_m) == 0) {{",
        "    range_m -= error_m;",
        "}",
        "```",
        "",
    ]


def _values_of(name: str) -> str | None:
    """Return what stands in an input beside the CIR, value by value."""
    if name not in COLUMNS:
        return None
    values = ", ".join(f"{one} ({FROM[one]})" if one in FROM else one for one in COLUMNS[name])
    return f"`{name}`, in this order: {values}. NaN for what is not known."


def _reading_the_cir(samples: int) -> list[str]:
    return [
        "1. After a good frame read the first path index FP_INDEX from RX_TIME (register 0x15, "
        "offset 0x05, 16 bits: ten whole, six fractional).",
        "2. Read the accumulator ACC_MEM (register 0x25) from sample floor(FP_INDEX) - 5 on: "
        f"{samples} samples of four bytes, real then imaginary, each signed 16 bits, little "
        "endian. A read begins with one dummy byte, and the accumulator's clock has to be on "
        "(PMSC_CTRL0: FACE and AMCE), as `dwt_readaccdata` does.",
        "3. Take the magnitude of each as a float: sqrt(re^2 + im^2), in counts as they are. "
        "Scaling and features are inside `uwb_predict`.",
    ]


def _inputs() -> list[str]:
    return [
        "## What it gives for odd inputs",
        "",
        "A sample that is NaN, infinite or beyond +-1e9 counts: 1 is returned, the error is 0 m. "
        "Sums that overflow: 2, and 0 m. All zeros are an input like others. Not reentrant: the "
        "arena is static.",
        "",
        "Check it on the target with `uwb_selftest.c`; the `Makefile` runs it here.",
        "",
    ]
