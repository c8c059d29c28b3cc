"""What the clinic hides in waveforms: the effects of a library in other forms, and what none has.

numpy alone. Complex samples are changed, and what a chip reports of them follows by the receiver
of `clinic_scan`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.clinic_scan import SAMPLE_M, WIDE_SAMPLES, Scan, delayed

WAVE_M = 0.0461  # 6.5 GHz
NODES = (
    (0.06, 0.5, 0.95),
    (0.94, 0.4, 0.97),
    (0.5, 0.06, 0.9),
    (0.3, 0.93, 0.96),
    (0.7, 0.6, 0.99),
)
"""Where nodes hang, in shares of the room."""
PARTITIONS = {"plasterboard": (0.08, 2.0), "glass": (0.05, 3.0), "brick": (0.12, 6.0)}  # m, dB
LAWS = {
    "door-ajar": Law(("step",), 0.13, "m"),
    "on-the-charger": Law(("linear", "power")),
    "thirsty-tail": Law(),
    "uneven-converters": Law(),
    "slipped-sum": Law(),
    "node-knocked": Law(("position",), 0.52, "m", devices=("node2",)),
    "nodes-crossed": Law(("swap",), devices=("node0", "node3")),
}
"""What nobody's library has."""


Effect = Callable[[Scan, float], None]
LAST = ("level-control", "power-bias", "uneven-converters", "quantisation", "late-detection")
"""What acts on what has become of the signal, in this order."""


def _noise(scan: Scan, strength: float) -> None:
    more = 10 ** (0.26 * strength)
    scan.cir = scan.cir + scan.hissing(scan.floor * (more - 1))
    scan.floor, scan.hiss = scan.floor * more, scan.hiss * np.sqrt(more)


def _resonance(scan: Scan, strength: float) -> None:
    """Ring as a damped oscillation, from three samples after the pulse on."""
    since, pulse = np.arange(WIDE_SAMPLES) - 3.0, scan.pulse()
    ring = 0.11 * strength * np.exp((0.9j - 1 / 4.5) * np.maximum(since, 0)) * (since >= 0)
    length = 2 * WIDE_SAMPLES
    rung = np.fft.ifft(np.fft.fft(pulse, length) * np.fft.fft(ring, length))
    scan.cir = scan.cir + rung[:, :WIDE_SAMPLES]


def _rough_walls(scan: Scan, strength: float) -> None:
    """Echo from walls and floor, and floor and ceiling in turn; rough ones shine when grazed."""
    pulse, far, room = scan.pulse(), scan["true_range_m"], scan.ends("room")
    planes = [[(axis, 0 * far)] for axis in range(3)]
    planes += [[(axis, room[:, axis])] for axis in range(2)]
    for turns in [*planes, [(2, 0 * far), (2, room[:, 2])]]:
        image = scan.ends("tx")
        for axis, wall in turns:
            image[:, axis] = 2 * wall - image[:, axis]
        gap = image - scan.ends("rx")
        way = np.linalg.norm(gap, axis=1)
        steep = np.abs(gap[:, turns[0][0]]) / way
        part = min(0.42 * strength, 0.85) * np.exp(-0.7 * steep**2)
        size = part ** len(turns) * far / way * np.exp(2j * np.pi * scan.rng.random(len(scan)))
        scan.cir = scan.cir + size[:, None] * delayed(pulse, (way - far) / SAMPLE_M)


def _cluttered(scan: Scan, strength: float) -> None:
    """Add taps of gamma power after the pulse, whose mean rises and falls (a soft onset)."""
    after = np.maximum(scan.after - 0.5, 0)
    mean = after / 13 * np.exp(1 - after / 13)
    power = mean * scan.rng.gamma(0.7, 1 / 0.7, mean.shape)
    turn = np.exp(2j * np.pi * scan.rng.random(mean.shape))
    taps = np.pad(np.sqrt(power) * turn, ((0, 0), (1, 1)))
    wide = 0.6 * taps[:, :-2] + taps[:, 1:-1] + 0.6 * taps[:, 2:]
    top = np.abs(scan.pulse()).max(axis=1)
    scan.cir = scan.cir + 0.045 * strength * top[:, None] * wide


def _telemetry(scan: Scan, strength: float) -> None:
    """Add a monitor's frequency-modulated carrier, on the air during three rows of five."""
    on_air = scan.rng.random(len(scan)) < 0.6
    size = 2.2 * strength * np.sqrt(scan.floor) * on_air * scan.rng.weibull(3, len(scan))
    when, start = np.arange(WIDE_SAMPLES), scan.rng.random((len(scan), 1)) * 2 * np.pi
    tone = size[:, None] * np.exp(1j * (1.9 * when + 1.5 * np.sin(when / 11 + start) + start))
    alone = scan.hissing(scan.floor)
    scan.hiss = scan.hiss * np.abs(alone + tone).std(axis=1) / np.abs(alone).std(axis=1)
    scan.cir, scan.floor = scan.cir + tone, scan.floor + size**2


def _bent_loss(scan: Scan, strength: float) -> None:
    scan.dimmed(8 * strength * np.log10(1 + (scan["true_range_m"] / 5) ** 1.6))


def _somebody(scan: Scan, strength: float) -> None:
    """Weaken the straight path of a third of the links, and bend it the longer the weaker it is."""
    struck = scan.per_link(lambda links: (scan.rng.random(links) < 0.3).astype(np.float64))
    loss_db = scan.per_link(lambda links: 8 + 5 * strength * scan.rng.rayleigh(1.0, links))
    scan.straight(struck * loss_db, struck * 0.011 * loss_db * strength)


def _enough(scan: Scan, strength: float) -> None:
    """Stop accumulating when the peak is high enough, and report less of what is loud."""
    over = scan.level + 82
    soft = 2.5 * np.log1p(np.exp(over / 2.5))
    share = (1 + (0.055 * strength * soft) ** 1.5) ** (-1 / 1.5)
    scan.cir = scan.cir * share[:, None] + scan.hissing(scan.floor * (share - share**2))
    scan.symbols = np.maximum(np.round(scan.symbols * share), 1)
    scan.floor, scan.hiss = scan.floor * share, scan.hiss * np.sqrt(share)
    scan.louder_db = scan.louder_db - 0.22 * min(strength, 2.0) * soft


def _two_gears(scan: Scan, strength: float) -> None:
    """Round to steps that are twice as coarse where the peak is high: another gear."""
    top = np.abs(scan.cir).max(axis=1)
    step = ((1 + (top > np.median(top))) * 0.8 * strength * np.sqrt(scan.floor))[:, None]
    alone = scan.hissing(scan.floor)
    rounded, quiet = (step * (np.round(one.real / step) + 1j * np.round(one.imag / step))
                      for one in (scan.cir, alone))  # fmt: skip
    left = np.abs(quiet).std(axis=1) / np.abs(alone).std(axis=1)
    scan.cir, scan.hiss = rounded, np.maximum(scan.hiss * left, 0.5)


def _cabinets(scan: Scan, strength: float) -> None:
    """Bend over both edges of a steel cabinet, 0.6 m apart."""
    steel = np.array(["metal" in row for row in scan.frame["obstacles"]], np.float64)
    high = strength * scan.per_link(lambda links: scan.rng.triangular(0.1, 0.25, 0.6, links))
    far = np.maximum(scan["true_range_m"], 1.0)
    bend = high * np.sqrt(8 / (WAVE_M * far))
    loss_db = np.minimum(2 * (6 + 9 * bend / (1 + 0.35 * bend)) - 4, 30)
    scan.straight(steel * loss_db, steel * (2 * high**2 / far + 0.02))


def _partitions(scan: Scan, strength: float) -> None:
    """Slow the first pulse down in partitions, single or double."""
    double = scan.per_link(lambda links: scan.rng.choice([0.8, 1.3], links))
    sums = [np.sum([PARTITIONS[k] for k in row if k in PARTITIONS] or [(0, 0)], axis=0)
            for row in scan.frame["obstacles"]]  # fmt: skip
    late_m, loss_db = np.array(sums, np.float64).T * double
    scan.straight(min(strength, 1.5) * loss_db, strength * late_m)


def _batches(scan: Scan, strength: float) -> None:
    """Two batches of nodes; within a batch they are alike."""
    late = np.random.default_rng([scan.own, 1]).permutation([0.03, 0.03, 0.15, 0.15, 0.16])
    scan.late_m = scan.late_m + strength * late[scan.node()]


def _level_bias(scan: Scan, strength: float) -> None:
    over = np.clip((scan.level + 77) / 9, -1, 1)
    scan.late_m = scan.late_m - 0.1 * strength * np.sin(over * np.pi / 2)


def _triangles(scan: Scan, strength: float) -> None:
    """Add a scatter of two even ones of different width."""
    wide, narrow = scan.rng.uniform(-1, 1, (2, len(scan)))
    scan.late_m = scan.late_m + strength * (0.08 * wide + 0.04 * narrow)


def _slow_clock(scan: Scan, strength: float) -> None:
    scan.late_m = scan.late_m + 0.011 * strength * (scan["range_m"] + 0.6)


def _gamma_fading(scan: Scan, strength: float) -> None:
    """Fade along the delay by a gamma-distributed power, alike within a pulse."""
    knots, shape = np.arange(0, WIDE_SAMPLES + 4, 4), 5 / strength**1.5
    power = scan.rng.gamma(shape, 1 / shape, (len(scan), len(knots)))
    gain = np.stack([np.interp(np.arange(WIDE_SAMPLES), knots, row) for row in np.sqrt(power)])
    size = np.abs(scan.cir)
    signal = np.maximum(1 - 3 * np.sqrt(scan.floor)[:, None] / np.maximum(size, 1e-9), 0)
    scan.cir = scan.cir * (1 + signal * (gain - 1))


def _deaf(scan: Scan, strength: float) -> None:
    """Ask of the first path that it is no weaker than a share of the strongest."""
    scan.share = min(0.45 + 0.25 * strength, 0.95)


def _door(scan: Scan, strength: float) -> None:
    scan.late_m = scan.late_m + 0.13 * strength * (scan["door_deg"] > 55)


def _charger(scan: Scan, strength: float) -> None:
    scan.late_m = scan.late_m + 0.002 * strength * (scan["charge_pct"] - 40)


def _thirsty(scan: Scan, strength: float) -> None:
    """Absorb: the more people are in the room, the weaker is all, and the sooner it dies away."""
    scan.dimmed(0.3 * strength * scan["people"])
    rate = 0.012 * strength * scan["people"][:, None]
    size = np.abs(scan.cir)
    signal = np.maximum(1 - 2.5 * np.sqrt(scan.floor)[:, None] / np.maximum(size, 1e-9), 0)
    kept = np.exp(-rate * np.maximum(scan.after - 3, 0))
    scan.cir = scan.cir * (1 + signal * (kept - 1))


def _uneven(scan: Scan, strength: float) -> None:
    """Let every other sample be converted with less gain, noise and all."""
    odd = 1 - 0.2 * min(strength, 3.0) * (np.arange(WIDE_SAMPLES) % 2)
    alone = scan.hissing(scan.floor)
    scan.hiss = scan.hiss * np.abs(alone * odd).std(axis=1) / np.abs(alone).std(axis=1)
    scan.cir, scan.floor = scan.cir * odd, scan.floor * np.mean(odd**2)


def _slipped(scan: Scan, strength: float) -> None:
    """Add symbols up that slipped by two samples halfway, in two rows of five."""
    slipped = 0.5 * (scan.rng.random(len(scan)) < 0.4)[:, None] * min(strength, 2.0)
    scan.cir = (1 - 0.6 * slipped) * scan.cir + 0.6 * slipped * np.roll(scan.cir, 2, axis=1)


def _really_at(scan: Scan, real: NDArray[np.float64]) -> None:
    """Let ranges and levels be those of nodes that really hang at `real` [n, 3]."""
    gone, planned = np.linalg.norm(scan.ends("tx") - real, axis=1), scan["true_range_m"]
    scan.late_m = scan.late_m + gone - planned
    scan.louder_db = scan.louder_db - 20 * np.log10(gone / planned)


def _knocked(scan: Scan, strength: float) -> None:
    aside = np.array([0.3, 0.4245, 0.0]) * strength
    _really_at(scan, scan.ends("rx") + (scan.node() == 2)[:, None] * aside)


def _crossed(scan: Scan, _: float) -> None:
    """Hang nodes 0 and 3 at each other's place; the gain control keeps the samples' size."""
    real, room, node = scan.ends("rx"), scan.ends("room"), scan.node()
    for mine, other in ((0, 3), (3, 0)):
        real[node == mine] = (room * np.array(NODES[other]))[node == mine]
    _really_at(scan, real)


EFFECTS: dict[str, Effect] = {
    "noise-floor": _noise,
    "pulse-ringing": _resonance,
    "specular-reflections": _rough_walls,
    "diffuse-tail": _cluttered,
    "narrowband-interference": _telemetry,
    "path-loss": _bent_loss,
    "obstructed-path": _somebody,
    "level-control": _enough,
    "quantisation": _two_gears,
    "diffraction": _cabinets,
    "material-delay": _partitions,
    "antenna-delay": _batches,
    "power-bias": _level_bias,
    "timestamp-jitter": _triangles,
    "range-scale": _slow_clock,
    "small-scale-fading": _gamma_fading,
    "late-detection": _deaf,
    "door-ajar": _door,
    "on-the-charger": _charger,
    "thirsty-tail": _thirsty,
    "uneven-converters": _uneven,
    "slipped-sum": _slipped,
    "node-knocked": _knocked,
    "nodes-crossed": _crossed,
}
