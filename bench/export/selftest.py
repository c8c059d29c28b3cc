"""A self-test that runs anywhere: ten recorded rows and what they must give."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backends.c.text import block, floats, table

ROWS = 10


def chosen_rows(predicted_m: NDArray[np.float32]) -> NDArray[np.intp]:
    """Return positions of ten rows, from the least prediction to the largest."""
    order = np.argsort(predicted_m, kind="stable")
    places = np.linspace(0, len(order) - 1, min(ROWS, len(order))).astype(int)
    chosen: NDArray[np.intp] = order[places]
    return chosen


def selftest(cirs: NDArray[np.float32], expected_m: NDArray[np.float32], limit_m: float) -> str:
    """Return the C of a program that predicts these rows and says how far it is off.

    It prints one line a row, with the cycles of that call on a Cortex-M3 or later, and returns
    how many rows are off by more than `limit_m`.
    """
    limit_um = round(limit_m * 1e6)
    lines = [
        "/* Ten recorded rows and what ONNX Runtime predicts for them. Needs printf. */",
        '#include "uwb_predict.h"',
        "#include <stdio.h>",
        "",
        *_cycle_counter(),
        "",
        f"#define ROWS {len(cirs)}",
        f"#define LIMIT_UM {limit_um}",
        "",
        table("rows", "float", floats(cirs)),
        table("expected_m", "float", floats(expected_m)),
        "",
        *_main(),
    ]
    return "\n".join(lines) + "\n"


def _cycle_counter() -> list[str]:
    """Return how cycles are counted: a register of Cortex-M3 and later, else not at all."""
    return [
        "#if defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'M' && __ARM_ARCH >= 7",
        "#define DEMCR (*(volatile unsigned long *)0xE000EDFCul)",
        "#define DWT_CTRL (*(volatile unsigned long *)0xE0001000ul)",
        "#define DWT_CYCCNT (*(volatile unsigned long *)0xE0001004ul)",
        "/* CoreSight software lock (ARMv7-M ARM, DWT_LAR): some Cortex-M7 parts come up locked,",
        "   and count nothing until this key is written; without a lock it is ignored. */",
        "#define DWT_LAR (*(volatile unsigned long *)0xE0001FB0ul)",
        *block(
            "static void start_counter(void)",
            [
                "DEMCR |= 1ul << 24;",
                "DWT_LAR = 0xC5ACCE55ul;",
                "DWT_CYCCNT = 0;",
                "DWT_CTRL |= 1ul;",
            ],
        ),
        "#define CYCLES() DWT_CYCCNT",
        "#else",
        "static void start_counter(void) { }",
        "#define CYCLES() 0ul",
        "#endif",
    ]


def _main() -> list[str]:
    body = [
        "int failed = 0;",
        "start_counter();",
        *block(
            "for (int i = 0; i < ROWS; i++)",
            [
                "float error_m = 0.0f;",
                "const unsigned long before = CYCLES();",
                "const int refused = uwb_predict_row(rows + i * UWB_PREDICT_ROW_VALUES, &error_m);",
                "const unsigned long cycles = (CYCLES() - before) & 0xfffffffful;",
                "const long got_um = (long)(error_m * 1e6f);",
                "const long want_um = (long)(expected_m[i] * 1e6f);",
                "const long off_um = got_um > want_um ? got_um - want_um : want_um - got_um;",
                "failed += refused || off_um > LIMIT_UM;",
                *_print(),
            ],
        ),
        r'printf("%d of %d rows failed\n", failed, ROWS);',
        "return failed;",
    ]
    return block("int main(void)", body)


def _print() -> list[str]:
    return [
        "if (cycles) {",
        r'    printf("row %d: %lu cycles, %ld um, expected %ld um\n", i, cycles, got_um, want_um);',
        "} else {",
        r'    printf("row %d: %ld um, expected %ld um\n", i, got_um, want_um);',
        "}",
    ]
