"""What the stage hides in waveforms: the effects of a library in other forms, and what none has.

numpy and pandas alone. Complex samples are changed, and what a chip reports of them follows by
this family's own receiver, which looks for the steepest rise. An echo is a copy of the first pulse
as it was received, so that samples of any simulator can be changed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 24, 208  # of the impulse responses that effects are put into
QUIET = 17  # samples before any signal
SAMPLE_M = 1.0016 * 0.299792458
DETECT = 11.0  # times the root mean square of the noise
WAVE_M = 0.0461  # 6.5 GHz
RIGS = ((0.05, 0.1, 0.9), (0.95, 0.15, 0.8), (0.9, 0.95, 0.85), (0.1, 0.9, 0.95), (0.5, 0.5, 0.98))
"""Where receivers hang, in shares of the room."""
SCENERY = {"plywood": (0.06, 3.0), "plasterboard": (0.1, 4.5)}  # m, dB
LAWS = {
    "smeared-pulse": Law(),
    "drooping-gain": Law(),
    "missing-gain-step": Law(),
    "miscounted-start": Law(),
    "rigs-exchanged": Law(("swap",), devices=("rig1", "rig3")),
}
"""What nobody's library has."""


@dataclass
class Take:
    """Samples of n rows and what is reported beside them.

    `cir` [n, WIDE_SAMPLES] complex counts, `floor` [n] mean |noise|^2, `hiss` [n] noise as
    reported, `symbols` [n] accumulated, `late_m`, `louder_db` and `miscounted` (samples) what
    reports gain [n] without the samples, `before` what was `seen` at first, per symbol. `own`
    seeds what a case keeps, `rng` the rest.
    """

    frame: pd.DataFrame
    cir: Complexes
    floor: Floats
    hiss: Floats
    symbols: Floats
    late_m: Floats
    louder_db: Floats
    miscounted: Floats
    before: tuple[Floats, Floats, Floats]
    own: int
    rng: np.random.Generator

    @classmethod
    def of(cls, table: pd.DataFrame, own: int, rng: np.random.Generator) -> Take:
        """Return the take of a table with `cir_i`, `cir_q` and columns of the exchange format."""
        real, imaginary = (np.stack(list(table[name])) for name in ("cir_i", "cir_q"))
        cir = (real + 1j * imaginary).astype(np.complex128)
        floor = np.full(len(table), np.mean(np.abs(cir[:, :QUIET]) ** 2))
        hiss, symbols = (table[n].to_numpy(np.float64) for n in ("noise_std", "preamble_count"))
        (a, b, c), before = np.zeros((3, len(table))), per_symbol(cir, floor, symbols)
        return cls(table, cir, floor, hiss, symbols, a, b, c, before, own, rng)

    def __getitem__(self, name: str) -> Floats:
        return self.frame[name].to_numpy(np.float64)

    def __len__(self) -> int:
        return len(self.frame)

    def ends(self, name: str) -> Floats:
        """Return positions, or the size of the room, [n, 3] in metres."""
        return self.frame[[f"{name}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64).copy()

    @property
    def moved(self) -> tuple[Floats, Floats, Floats]:
        """How far first path (samples), level and early level (dB) are from the first ones [n]."""
        now = per_symbol(self.cir, self.floor, self.symbols)
        level, early = (10 * np.log10(now[n] / self.before[n]) + self.louder_db for n in (1, 2))
        return now[0] - self.before[0], level, early

    @property
    def level(self) -> Floats:
        """Level [n] in dBm as it would be reported by now."""
        return np.asarray(self["rx_power_dbm"] + self.moved[1])

    @property
    def grid(self) -> Floats:
        """Samples after the first path [n, WIDE_SAMPLES]."""
        return np.asarray(np.arange(WIDE_SAMPLES) - seen(self.cir, self.floor)[0][:, None])

    def pulse(self) -> Complexes:
        """Return the first pulse alone [n, WIDE_SAMPLES]."""
        return np.where(np.abs(self.grid - 1) < 4.2, self.cir, 0)

    def noise(self, power: Floats) -> Complexes:
        """Return noise of mean |n|^2 = `power` [n]."""
        turned = np.exp(2j * np.pi * self.rng.random(self.cir.shape))
        strong = self.rng.exponential(1.0, self.cir.shape) * power[:, None]
        return np.asarray(np.sqrt(strong) * turned)

    def weaken(self, loss_db: Floats) -> None:
        """Weaken the signal, not the noise, by a loss [n] >= 0 in dB."""
        left = 10 ** (-loss_db / 20)
        self.cir = self.cir * left[:, None] + self.noise(self.floor * (1 - left**2))

    def replace(self, loss_db: Floats, longer_m: Floats) -> None:
        """Weaken the first pulse alone by a loss [n] in dB, and let it come later by metres [n]."""
        pulse = self.pulse()
        again = later(pulse, longer_m / SAMPLE_M) * 10 ** (-loss_db[:, None] / 20)
        hole = np.where(pulse != 0, self.noise(self.floor), 0)
        touched = ((loss_db > 0) | (longer_m > 0))[:, None]
        self.cir = np.where(touched, self.cir - pulse + again + hole, self.cir)

    def behind(self, *kinds: str) -> NDArray[np.bool_]:
        """Return where one of some kinds of obstacle stands in the direct path [n]."""
        return np.array([bool(set(row) & set(kinds)) for row in self.frame["obstacles"]])


def later(cir: Complexes, samples: Floats) -> Complexes:
    """Return samples [n, K] later by any number of samples [n], nothing wrapped around."""
    size = 2 * cir.shape[1]
    turn = np.exp(-2j * np.pi * np.fft.fftfreq(size) * samples[:, None])
    return np.asarray(np.fft.ifft(np.fft.fft(cir, size) * turn)[:, : cir.shape[1]])


def seen(cir: Complexes, floor: Floats) -> tuple[Floats, Floats, Floats]:
    """Return what a receiver makes of samples [n, K]: first path, energy and early energy [n].

    The first path is the steepest rise after the first sample that stands out of the noise.
    """
    size, rows = np.abs(cir), np.arange(len(cir))
    out = size > DETECT * np.sqrt(floor)[:, None]
    begin = np.where(out.any(axis=1), out.argmax(axis=1), size.argmax(axis=1))
    rise, grid = np.diff(size, axis=1), np.arange(size.shape[1] - 2)
    crest = (rise[:, :-1] >= rise[:, 1:]) & (rise[:, :-1] > 0) & (grid >= begin[:, None] - 2)
    at = np.clip(np.where(crest.any(axis=1), crest.argmax(axis=1), begin), 1, len(grid) - 4)
    left, mid, right = (rise[rows, at + step] for step in (-1, 0, 1))
    bend = np.minimum(left - 2 * mid + right, -1e-9)
    first = at + 0.5 + np.clip((left - right) / (2 * bend), -0.5, 0.5)
    energy = (size**2).sum(axis=1)
    energy = np.maximum(energy - size.shape[1] * floor, 0.05 * energy)
    early = sum(size[rows, at + step] ** 2 for step in (1, 2, 3))
    return np.round(first * 64) / 64, energy, np.asarray(early)


def per_symbol(cir: Complexes, floor: Floats, symbols: Floats) -> tuple[Floats, Floats, Floats]:
    """Return what is `seen`, both energies per symbol squared."""
    first, energy, early = seen(cir, floor)
    return first, energy / symbols**2, early / symbols**2


Effect = Callable[[Take, float], None]
LAST = ("level-control", "power-bias", "missing-gain-step", "quantisation")
"""What acts on what has become of the signal, in this order."""


def _noise(take: Take, strength: float) -> None:
    more = 10 ** (0.22 * strength)
    take.cir = take.cir + take.noise(take.floor * (more - 1))
    take.floor, take.hiss = take.floor * more, take.hiss * np.sqrt(more)


def _ringing(take: Take, strength: float) -> None:
    """Ring on three times, each time weaker and turned, five and a half samples apart."""
    pulse, ring = take.pulse(), 0.2 * strength * np.exp(2.2j)
    for again in (1, 2, 3):
        take.cir = take.cir + ring**again * later(pulse, np.full(len(take), 5.5 * again))


def _echoes(take: Take, strength: float) -> None:
    """Echo from all six faces of the room, more where the line grazes them (Schlick)."""
    pulse, far = take.pulse(), take["true_range_m"]
    for axis in range(3):
        for wall in (0.0, take.ends("room")[:, axis]):
            image = take.ends("tx")
            image[:, axis] = 2 * wall - image[:, axis]
            gap = image - take.ends("rx")
            way = np.linalg.norm(gap, axis=1)
            low = min(0.16 * strength, 0.7)
            part = low + (1 - low) * (1 - np.abs(gap[:, axis]) / way) ** 5
            turn = np.exp(2j * np.pi * take.rng.random(len(take)))
            size = (part * turn * far / way)[:, None]
            take.cir = take.cir + size * later(pulse, (way - far) / SAMPLE_M)


def _reverberation(take: Take, strength: float) -> None:
    """Add a tail that falls as a power of the delay, smooth over neighbouring samples."""
    after = np.maximum(take.grid - 1.5, 0)
    top = np.abs(take.pulse()).max(axis=1)
    shape = 0.06 * strength * (after > 0) / (1 + after / 14) ** 1.6
    rough = take.noise(np.ones(len(take)))
    smooth = (rough[:, :-2] + 1.4 * rough[:, 1:-1] + rough[:, 2:]) / 2
    take.cir = take.cir + np.pad(smooth, ((0, 0), (1, 1))) * shape * top[:, None]


def _stage_light(take: Take, strength: float) -> None:
    """Hum of a dimmer: a tone whose frequency sweeps, in most rows."""
    size = 2.4 * strength * np.sqrt(take.floor) * take.rng.uniform(0.3, 1.2, len(take))
    when, start = np.arange(WIDE_SAMPLES), take.rng.random(len(take))[:, None]
    tone = size[:, None] * np.exp(2j * np.pi * (0.11 * when + 1e-4 * when**2 + start))
    alone = take.noise(take.floor)
    take.cir = take.cir + tone
    take.hiss = take.hiss * np.abs(alone + tone).std(axis=1) / np.abs(alone).std(axis=1)
    take.floor = take.floor + size**2


def _root_loss(take: Take, strength: float) -> None:
    take.weaken(2.4 * strength * np.maximum(np.sqrt(take["true_range_m"]) - 1, 0))


def _bodies(take: Take, strength: float) -> None:
    """Weaken and delay the straight path of a quarter of the links: somebody stands there."""
    codes, links = pd.factorize(take.frame["link"])
    struck = (take.rng.random(len(links)) < 0.28)[codes]
    loss_db = (7 + 9 * strength * take.rng.beta(2, 2, len(links)))[codes]
    longer = take.rng.gamma(4, 0.04 * strength, len(links))[codes]
    take.replace(np.where(struck, loss_db, 0), np.where(struck, longer, 0))


def _held_level(take: Take, strength: float) -> None:
    """Stop accumulating early where it is loud, and report less of what is loud."""
    over = np.maximum(take.level + 80, 0) / 10
    share = np.exp(-0.6 * strength * over)
    take.cir = take.cir * share[:, None] + take.noise(take.floor * (share - share**2))
    take.floor, take.hiss = take.floor * share, take.hiss * np.sqrt(share)
    take.symbols = np.maximum(np.round(take.symbols * share), 1)
    take.louder_db = take.louder_db - 2 * strength * over**2 / (1 + over)


def _mid_riser(take: Take, strength: float) -> None:
    """Let no sample be zero: both parts lie half a step beside the grid of zero."""
    step = 0.85 * strength * np.sqrt(take.floor)[:, None]
    alone = take.noise(take.floor)
    take.cir, coarse = (_stepped(one, step) for one in (take.cir, alone))
    take.hiss = take.hiss * np.abs(coarse).std(axis=1) / np.abs(alone).std(axis=1)


def _stepped(cir: Complexes, step: Floats) -> Complexes:
    real, imaginary = (step * (np.floor(part / step) + 0.5) for part in (cir.real, cir.imag))
    return np.asarray(real + 1j * imaginary)


def _bent(take: Take, strength: float) -> None:
    """Bend the line over the iron curtain: 6 dB where it touches, more where it is higher."""
    codes, links = pd.factorize(take.frame["link"])
    above = (0.3 * strength * take.rng.uniform(0.5, 1.5, len(links)))[codes]
    loss_db = 20 * np.log10(2 + 4.4 * above * np.sqrt(8 / (WAVE_M * take["true_range_m"])))
    longer = 2 * above**2 / np.maximum(take["true_range_m"], 1)
    iron = take.behind("metal")
    take.replace(np.where(iron, loss_db, 0), np.where(iron, longer, 0))


def _scenery(take: Take, strength: float) -> None:
    """Slow the first pulse down in flats of scenery."""
    longer, loss_db = np.zeros(len(take)), np.zeros(len(take))
    for kind, (thick_m, lost_db) in SCENERY.items():
        longer += strength * thick_m * take.behind(kind)
        loss_db += np.sqrt(strength) * lost_db * take.behind(kind)
    take.replace(loss_db, longer)


def _cables(take: Take, strength: float) -> None:
    """Let every rig's cable be too long by another share of the longest."""
    longest = np.random.default_rng([take.own, 1]).beta(2, 1.5, len(RIGS))
    number = take.frame["rx"].str[3:].astype(int).to_numpy()
    take.late_m = take.late_m + 0.2 * strength * longest[number]


def _level_bias(take: Take, strength: float) -> None:
    over = (take.level + 75) / 4
    take.late_m = take.late_m - 0.11 * strength * over / (1 + np.abs(over))


def _shimmer(take: Take, strength: float) -> None:
    """Fade along the delay, by a gain in dB that wanders from knot to knot."""
    knots = np.arange(0, WIDE_SAMPLES + 6, 6)
    gain_db = 2.2 * strength * take.rng.normal(size=(len(take), len(knots)))
    wander = [np.interp(np.arange(WIDE_SAMPLES), knots, row) for row in gain_db]
    strong = np.abs(take.cir) ** 2
    strong = strong / (strong + 25 * take.floor[:, None])  # noise does not fade
    take.cir = take.cir * 10 ** (np.stack(wander) * strong / 20)


def _smeared(take: Take, strength: float) -> None:
    """Narrow the band: every sample takes part of its neighbours, noise and all."""
    part = 0.22 * strength
    wide = np.pad(take.cir, ((0, 0), (1, 1)))
    take.cir = (take.cir + part * (wide[:, :-2] + wide[:, 2:])) / (1 + 2 * part)
    less = (1 + 2 * part**2) / (1 + 2 * part) ** 2
    take.floor, take.hiss = take.floor * less, take.hiss * np.sqrt(less)


def _droop(take: Take, strength: float) -> None:
    """Let the gain fall along the accumulator, of signal and noise alike."""
    gain = np.exp(-strength * np.arange(WIDE_SAMPLES) / 110)
    take.cir, mean = take.cir * gain, float(np.mean(gain[:QUIET]))
    take.floor, take.hiss = take.floor * mean**2, take.hiss * mean


def _gain_step(take: Take, strength: float) -> None:
    """Report too little above a level where the amplifier switches, and nothing else."""
    take.louder_db = take.louder_db - 5 * strength * (take.level > -75)


def _miscounted(take: Take, strength: float) -> None:
    """Let one performer's firmware count the start of the samples late, the range excepted."""
    take.miscounted = take.miscounted + strength * (take.frame["tx"] == "mime1").to_numpy()


def _exchanged(take: Take, _: float) -> None:
    """Hang rigs 1 and 3 at each other's place; the gain control keeps the samples' size."""
    real, room = take.ends("rx"), take.ends("room")
    for name, other in (("rig1", 3), ("rig3", 1)):
        mine = (take.frame["rx"] == name).to_numpy()
        real[mine] = (room * np.array(RIGS[other]))[mine]
    gone, planned = np.linalg.norm(take.ends("tx") - real, axis=1), take["true_range_m"]
    take.late_m = take.late_m + gone - planned
    take.louder_db = take.louder_db - 20 * np.log10(gone / planned)


EFFECTS: dict[str, Effect] = {
    "noise-floor": _noise,
    "pulse-ringing": _ringing,
    "specular-reflections": _echoes,
    "diffuse-tail": _reverberation,
    "narrowband-interference": _stage_light,
    "path-loss": _root_loss,
    "obstructed-path": _bodies,
    "level-control": _held_level,
    "quantisation": _mid_riser,
    "diffraction": _bent,
    "material-delay": _scenery,
    "antenna-delay": _cables,
    "power-bias": _level_bias,
    "small-scale-fading": _shimmer,
    "smeared-pulse": _smeared,
    "drooping-gain": _droop,
    "missing-gain-step": _gain_step,
    "miscounted-start": _miscounted,
    "rigs-exchanged": _exchanged,
}
