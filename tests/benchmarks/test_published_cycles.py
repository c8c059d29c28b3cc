"""The Cortex-M4 table against cycles that others measured on a board: assembly, and soft floats.

AES-128 of jnk0le/cortexm-AES (commit 0359498c), hand-written, so that no compiler stands between
the figures: `doc/aes/CM3_CM4_details.md` gives 626 cycles a block on an STM32F4 without wait
states. ChaCha's permutation of joostrijneveld/chacha-arm-cortex-m (commit 4ef22dc3), written by a
generator: its README gives cycles on an STM32L100 (Cortex-M3, whose manual prices these
instructions the same) and on an STM32F407 (Cortex-M4, but at 168 MHz, where flash makes the core
wait, and called once, cold): the first are judged, the second shown.

Embench-IoT 0.5 measured its programs on an STM32F407 at 16 MHz, where flash needs no wait states
(embench-iot-results, details/cortexm4-armv7m-gcc-9.2-o2.mediawiki and -os, of 2020-04-24: soft
floats, milliseconds at 1 MHz, which are thousands of cycles). Three of them spend their time in
libgcc's assembly for floats and doubles, the same for every compiler: inverting matrices in float,
statistics and planets in double. Their sources: embench-iot, commits c1fc0e0d (minver), dc123673
(st) and 01860eae (nbody).

No source is kept here: CORTEXM_AES, CHACHA_CORTEX_M and EMBENCH_IOT name clones.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from bench.measure.counting import count_image, load_core
from bench.measure.counting.compile import HERE, Image

KERNELS = {  # function, file in the clone, published cycles of encrypt<128>
    "CM3_1T_AES_encrypt": ("aes/target/CM3_1T/CM3_1T_AES_encrypt.S", 626),
}
PLAIN = bytes.fromhex("00112233445566778899aabbccddeeff")  # FIPS 197, appendix C.1
CIPHER = bytes.fromhex("69c4e0d86a7b0430d8cdb78070b4c55a")
CALLS = 11
SOURCE = """#include <stdint.h>
#include <string.h>
#include "uwb_predict.h"
void KERNEL(const uint8_t *keys, const uint8_t *in, uint8_t *out, uint32_t rounds);
__attribute__((aligned(4))) static const uint8_t keys[176] = {%s};
__attribute__((aligned(4))) static const uint8_t in[16] = {%s}, wanted[16] = {%s};
__attribute__((aligned(4))) static uint8_t out[16];
const uint32_t AES_Te2[256] = {%s};
int uwb_predict(const float *cir, float *error_m)
{
    (void)cir;
    *error_m = 0.0f;
    for (int i = 0; i < CALLS; i++) KERNEL(keys, in, out, 10);
    int wrong = 0;
    for (int i = 0; i < 16; i++) wrong |= out[i] ^ wanted[i];
    return wrong;
}
"""
CHACHA = {8: (390, 414), 12: (542, 572), 20: (846, 888)}  # rounds: cycles on the M3 and the M4
CHACHA_SOURCE = """#include <stdint.h>
#include "uwb_predict.h"
void KERNEL(uint32_t *out, const uint32_t *in);
static const uint32_t in[16] = {%s}, wanted[16] = {%s};
static uint32_t out[16];
int uwb_predict(const float *cir, float *error_m)
{
    (void)cir;
    *error_m = 0.0f;
    for (int i = 0; i < CALLS; i++) KERNEL(out, in);
    uint32_t wrong = 0;
    for (int i = 0; i < 16; i++) wrong |= out[i] ^ wanted[i];
    return wrong != 0;
}
"""
EMBENCH = {  # file in the clone, published thousands of cycles by -O2 and by -Os
    "minver": ("src/minver/libminver.c", {"-O2": 3998, "-Os": 4360}),
    "st": ("src/st/libst.c", {"-O2": 4080, "-Os": 4111}),
    "nbody": ("src/nbody/nbody.c", {"-O2": 2808, "-Os": 2810}),
}
EMBENCH_SOURCE = """#include "uwb_predict.h"
void initialise_benchmark(void);
int benchmark(void);
int verify_benchmark(int result);
int uwb_predict(const float *cir, float *error_m)
{
    (void)cir;
    *error_m = 0.0f;
    initialise_benchmark();
    return verify_benchmark(benchmark()) ? 0 : 1;
}
"""
HEADER = """#define UWB_PREDICT_SAMPLES 1
int uwb_predict(const float *cir, float *error_m);
"""


def _double(value: int) -> int:
    return (value << 1) ^ (0x11B if value & 0x80 else 0)


def _sbox() -> list[int]:
    """Return the substitution of FIPS 197, by its definition."""
    box, p, q = [0x63] * 256, 1, 1
    while True:
        p ^= _double(p)
        for shift in (1, 2, 4):
            q ^= q << shift
        q &= 0xFF
        q ^= 0x09 if q & 0x80 else 0
        turned = q
        for shift in range(1, 5):
            turned ^= ((q << shift) | (q >> (8 - shift))) & 0xFF
        box[p] = turned ^ 0x63
        if p == 1:
            return box


def _round_keys(box: list[int]) -> bytes:
    words, factor = [bytes(range(4 * n, 4 * n + 4)) for n in range(4)], 1
    for n in range(4, 44):
        last = words[-1]
        if n % 4 == 0:
            last = bytes([box[last[1]] ^ factor, box[last[2]], box[last[3]], box[last[0]]])
            factor = _double(factor)
        words.append(bytes(a ^ b for a, b in zip(words[n - 4], last, strict=True)))
    return b"".join(words)


def _text() -> str:
    box = _sbox()
    twice = [_double(s) for s in box]
    table = [s | (d ^ s) << 8 | d << 16 | s << 24 for s, d in zip(box, twice, strict=True)]
    parts = [_round_keys(box), PLAIN, CIPHER, table]
    return SOURCE % tuple(",".join(str(value) for value in part) for part in parts)


def _quarter_round(state: list[int], *places: int) -> None:
    a, b, c, d = places
    for left, right, turned, by in ((a, b, d, 16), (c, d, b, 12), (a, b, d, 8), (c, d, b, 7)):
        state[left] = (state[left] + state[right]) & 0xFFFFFFFF
        mixed = state[turned] ^ state[left]
        state[turned] = (mixed << by | mixed >> (32 - by)) & 0xFFFFFFFF


def _chacha_text(rounds: int) -> str:
    """Return the C that calls a permutation and compares it with RFC 8439's double rounds."""
    given = [int.from_bytes(bytes(range(4 * n, 4 * n + 4)), "little") for n in range(16)]
    state = list(given)
    for _ in range(rounds // 2):
        for n in range(4):
            _quarter_round(state, n, 4 + n, 8 + n, 12 + n)
        for n in range(4):
            _quarter_round(state, n, 4 + (n + 1) % 4, 8 + (n + 2) % 4, 12 + (n + 3) % 4)
    return CHACHA_SOURCE % tuple(",".join(f"{v}u" for v in values) for values in (given, state))


def _block_cycles(caller: str, name: str, source: Path, folder: Path) -> float:
    """Return typical cycles of one call within a loop."""
    once, often = (_cycles(caller, name, source, calls, folder) for calls in (1, CALLS))
    return (often - once) / (CALLS - 1)


def _cycles(caller: str, name: str, source: Path, calls: int, folder: Path) -> float:
    """Return typical cycles of so many blocks; the answer is checked."""
    flags = (*load_core("cortex-m4f").gcc, "-O2", f"-DCALLS={calls}", f"-DKERNEL={name}")
    return _counted(caller, source, (*flags, "-nostdlib"), folder)


def _counted(caller: str, source: Path, flags: Sequence[str], folder: Path) -> float:
    """Return typical cycles of a caller with a source beside it; the answer is checked."""
    core = load_core("cortex-m4f")
    for file, text in (("uwb_predict.c", caller), ("uwb_predict.h", HEADER)):
        (folder / file).write_text(text)
    shutil.copy(HERE / "mailbox.c", folder)
    kernel = shutil.copy(source, folder / f"kernel{source.suffix}")
    link = ["-Wl,-e,uwb_count_call", "-Wl,-u,uwb_count_stop", "-T", str(HERE / "image.ld")]
    files = ["mailbox.c", "uwb_predict.c", Path(kernel).name]
    command = [core.gcc_command, "-w", "-nostartfiles", *link, *files, *flags, "-o", "image.elf"]
    subprocess.run(command, cwd=folder, check=True)
    count = count_image(Image(folder / "image.elf", "gcc"), core, np.zeros((1, 1), np.float32))
    assert count.statuses.tolist() == [0]
    return count.cycles.typical


def _clone(variable: str, file: str) -> Path:
    """Return a file of a clone; the test is skipped where it or the compiler is not there."""
    clone = os.environ.get(variable)
    if clone is None or not (Path(clone) / file).is_file():
        pytest.skip(f"{variable} names no clone with {file}")
    if shutil.which("arm-none-eabi-gcc") is None:
        pytest.skip("arm-none-eabi-gcc (Debian: gcc-arm-none-eabi) is not installed")
    return Path(clone) / file


def _judge(name: str, block: float, published: int) -> None:
    told = f"{block:.1f} cycles by the table, {published} measured, {block / published:.3f}"
    print(f"\n{name}: {told}")
    assert 0.95 <= block / published <= 1.05


@pytest.mark.parametrize("name", KERNELS)
def test_a_published_count_is_met_within_5_percent(name: str, tmp_path: Path) -> None:
    file, published = KERNELS[name]
    source = _clone("CORTEXM_AES", file)
    _judge(name, _block_cycles(_text(), name, source, tmp_path), published)


@pytest.mark.parametrize("rounds", CHACHA)
def test_chachas_permutations_are_met_within_5_percent(rounds: int, tmp_path: Path) -> None:
    generator = _clone("CHACHA_CORTEX_M", "common/chacha_gen.py")
    words = [sys.executable, str(generator), str(rounds)]
    written = subprocess.run(words, check=True, capture_output=True, text=True).stdout
    source, name = tmp_path / "chacha.S", f"chacha{rounds}_perm_asm"
    source.write_text(written)
    block, (on_m3, on_m4) = (
        _block_cycles(_chacha_text(rounds), name, source, tmp_path),
        CHACHA[rounds],
    )
    print(f"\n{name}: {on_m4} on the Cortex-M4 with wait states, {block / on_m4:.3f}", end="")
    _judge(name, block, on_m3)


@pytest.mark.parametrize("level", ["-O2", "-Os"])
@pytest.mark.parametrize("name", EMBENCH)
def test_soft_floats_are_met_within_5_percent(name: str, level: str, tmp_path: Path) -> None:
    file, published = EMBENCH[name]
    source = _clone("EMBENCH_IOT", file)
    support = source.parents[2] / "support"
    part = ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=soft", "-DCPU_MHZ=1", f"-I{support}")
    flags = (level, *part, "-ffunction-sections", "-Wl,--gc-sections", "-lm")
    told = _counted(EMBENCH_SOURCE, source, flags, tmp_path)
    _judge(f"{name} {level}", told, 1000 * published[level])
