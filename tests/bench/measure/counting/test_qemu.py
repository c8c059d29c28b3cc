"""QEMU, a second emulator with code of its own, must give the same answers and counts."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
import toy

from bench.measure.counting import build_image, compile, count_image

HERE = Path(__file__).parent
CALLS, ROWS = 30, 2
INSTRUCTIONS_A_TICK = 40  # one instruction a nanosecond, SysTick at 25 MHz


@pytest.fixture
def qemu():
    for program in ("qemu-system-arm", "arm-none-eabi-gcc"):
        if shutil.which(program) is None:
            package = {"qemu-system-arm": "qemu-system-arm"}.get(program, "gcc-arm-none-eabi")
            pytest.skip(f"{program} (Debian: {package}) is not installed")


def _run(folder: Path, files: dict[str, str], core, rows: np.ndarray) -> list[tuple[float, float]]:
    """Return the answer and the instructions of a call for every row."""
    for name, text in files.items():
        (folder / name).write_text(text)
    for path in (compile.HERE / "mailbox.c", HERE / "qemu.c"):
        shutil.copy(path, folder)
    values = ",".join("{" + ",".join(f"{float(x)!r}f" for x in row) + "}" for row in rows)
    (folder / "rows.c").write_text(
        f'#include "uwb_predict.h"\nconst float qemu_rows[{len(rows)}][UWB_PREDICT_SAMPLES] = '
        f"{{{values}}};\n"
    )
    command = ["arm-none-eabi-gcc", *core.gcc, *compile.COMMON, f"-DROWS={len(rows)}"]
    command += [f"-DCALLS={CALLS}", "-nostartfiles", "-Wl,--gc-sections,-e,reset", "-T"]
    command += [str(HERE / "qemu.ld"), "mailbox.c", "qemu.c", "rows.c", "uwb_predict.c"]
    subprocess.run([*command, "-o", "qemu.elf"], cwd=folder, check=True)
    machine = ["qemu-system-arm", "-M", "mps2-an386", "-nographic", "-icount", "shift=0"]
    machine += ["-semihosting-config", "enable=on,target=native", "-monitor", "none"]
    done = subprocess.run(
        [*machine, "-serial", "none", "-kernel", "qemu.elf"],
        cwd=folder, capture_output=True, timeout=60, check=True,
    )  # fmt: skip
    words = [int(word, 16) for word in (done.stdout + done.stderr).split()]
    answers = np.array(words[::2], np.uint32).view(np.float32)
    calls = [ticks * INSTRUCTIONS_A_TICK / CALLS + 1 for ticks in words[1::2]]  # + its return
    return list(zip(answers.tolist(), calls, strict=True))


def test_qemu_gives_the_same_answers_and_instructions(qemu, tools, tmp_path):
    rows = toy.cirs(ROWS)
    ours = count_image(build_image(toy.FILES, tools, "gcc"), tools, rows)
    theirs = _run(tmp_path, toy.FILES, tools, rows)
    assert [answer for answer, _ in theirs] == ours.outputs_m.tolist()
    # A tick is 40 instructions over 30 calls; the counts agree to less than that.
    for _, instructions in theirs:
        assert instructions == pytest.approx(ours.instructions, rel=1e-4, abs=2)
