"""A long loft with scatterers that stand where they stand: channel impulse responses.

numpy and pandas alone. Other forms than in any library or other family: a pulse of hyperbolic
secants, single scatterers in place of a room's second reflections, an early-late detector, effects
with other laws of strength.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Law, Tables

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LOFT_M = (12.0, 5.0, 3.0)
SAMPLE_NS, SAMPLES, BEFORE = 1.0016, 140, 14
SAMPLE_M = SAMPLE_NS * 0.299792458
LINKS, MOST_ROWS = 110, 2
NOISE, GAIN, SCATTER_M = 38.0, 16000.0, 0.018
DETECT = 8.5  # times the usual noise
SCREEN_DB = 11.0  # that a screen weakens the straight path by, in both tables
CAUSES: dict[str, str] = {}
RARELY = ()
LAWS = {
    "second-transmitter": Law(),
    "clipped-peaks": Law(),
    "anchor-elsewhere": Law(("position",), 0.5, "m", devices=("n1",)),
    "ghost-before": Law(),
}
"""What nobody's library has."""
KNOWN = (
    "noise-floor",
    "pulse-ringing",
    "specular-reflections",
    "diffuse-tail",
    "narrowband-interference",
    "path-loss",
    "obstructed-path",
    "late-detection",
    "level-control",
    "quantisation",
    "diffraction",
    "material-delay",
    "antenna-delay",
    "power-bias",
)


@dataclass
class Loft:
    """Rows to receive: `own` seeds the scatterers, `rng` what both tables draw, `more` the rest."""

    frame: pd.DataFrame
    own: int
    rng: np.random.Generator
    more: np.random.Generator
    hidden: dict[str, float] = field(default_factory=dict)

    def __getitem__(self, name: str) -> float:
        return self.hidden.get(name, 0.0)

    def ends(self, end: str) -> Floats:
        """Return the positions of one end [n, 3] in metres."""
        return self.frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64)

    @property
    def screened(self) -> NDArray[np.bool_]:
        """Where a metal screen stands in the straight line [n]."""
        return np.array([len(row) > 0 for row in self.frame["obstacles"]])


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case."""
    hidden = dict.fromkeys(drawn.hidden, drawn.strength)
    rng = np.random.default_rng([seed, 31])
    rows = _placed(rng, 1.0 if drawn.same_mix else 0.75)
    recorded, clean = (_received(_loft(rows, seed, 32, what)) for what in (hidden, {}))
    if not drawn.paired:
        rows = _placed(rng, 1.0)
        rows = rows.assign(link="other " + rows["link"])
    simulated, truth = (
        pd.concat(
            [_received(_loft(rows, seed, first + n, what)) for n in range(drawn.ratio)],
            ignore_index=True,
        )
        for first, what in ((300, {}), (400, hidden))
    )
    gone = [] if drawn.listed else ["obstacles"]
    recorded, clean, simulated, truth = (
        table.drop(columns=gone) for table in (recorded, clean, simulated, truth)
    )
    return Tables(recorded, clean, simulated, truth)


def _loft(rows: pd.DataFrame, seed: int, part: int, hidden: dict[str, float]) -> Loft:
    """Return rows to receive: the same part, the same random numbers."""
    rng, more = (np.random.default_rng([seed, part, stream]) for stream in (0, 1))
    return Loft(rows, seed, rng, more, hidden)


def _placed(rng: np.random.Generator, reach: float) -> pd.DataFrame:
    """Return positions on the floor of the loft, in the first `reach` of its length."""
    again = rng.integers(1, MOST_ROWS + 1, LINKS)
    size = np.array(LOFT_M) * np.array([reach, 1, 1])
    ends = rng.uniform(0.3, size - 0.3, (2, LINKS, 3))
    screened = rng.random(LINKS) < 0.25
    rows = np.repeat(np.arange(LINKS), again)
    frame = pd.DataFrame({"link": [f"k{row}" for row in rows]})
    for axis, name in enumerate("xyz"):
        frame[f"tx_{name}_m"], frame[f"rx_{name}_m"] = ends[0, rows, axis], ends[1, rows, axis]
        frame[f"room_{name}_m"] = LOFT_M[axis]
    far = np.linalg.norm(ends[0] - ends[1], axis=1)[rows]
    walls = [["metal"] if screened[row] else [] for row in rows]
    frame["true_range_m"], frame["tx"] = far, [f"m{row % 2}" for row in rows]
    frame["rx"] = [f"n{row % 4}" for row in rows]
    return frame.assign(obstacles=pd.Series(walls, dtype=object))


def _received(loft: Loft) -> pd.DataFrame:
    """Return the table a receiver would write: samples, first path, levels, range."""
    frame, rng = loft.frame, loft.rng
    far = frame["true_range_m"].to_numpy(np.float64)
    longer, gain = _ways(loft)
    start = BEFORE + rng.random(len(frame))
    signal = _pulses(start[:, None] + longer / SAMPLE_M, gain) + _haze(loft, start)
    signal, symbols = _controlled(loft, signal)
    noise = rng.normal(0, NOISE * 10 ** (0.15 * loft["noise-floor"]), (2, *signal.shape))
    heard = np.abs(signal + noise[0] + 1j * noise[1] + _foreign(loft, signal.shape))
    if loft["clipped-peaks"]:
        heard = np.minimum(heard, np.quantile(heard.max(axis=1), 0.6) / (1 + loft["clipped-peaks"]))
    if grain := 45 * loft["quantisation"]:
        heard = grain * np.round(heard / grain)
    first, peak = _edge(heard, loft["late-detection"])
    energy = (heard**2).sum(axis=1) - 2 * SAMPLES * NOISE**2
    level = 10 * np.log10(np.maximum(energy, 1e5)) - 160
    early = 20 * np.log10(heard[np.arange(len(heard)), peak]) - 158
    error = (first - start) * SAMPLE_M + rng.normal(0, SCATTER_M, len(far)) + _shift(loft, level)
    made = frame.assign(range_m=far + error, error_m=error, rx_power_dbm=level)
    made = made.assign(first_path_power_dbm=early, preamble_count=symbols, first_path_index=first)
    quiet = heard[:, : BEFORE - 5].std(axis=1) + 0.5
    return made.assign(
        noise_std=quiet, sample_period_ns=SAMPLE_NS, cir=list(heard.astype(np.float32))
    )


def _ways(loft: Loft) -> tuple[Floats, Complexes]:
    """Return excess length in metres and gain [n, ways]: straight, floor, walls, scatterers."""
    tx, rx = loft.ends("tx"), loft.ends("rx")
    far = np.linalg.norm(tx - rx, axis=1)
    longer, gain = [np.zeros(len(far))], [np.ones(len(far), complex) / far]
    gain[0] *= np.where(loft.screened, 10 ** (-SCREEN_DB / 20), 1.0)
    for axis, place in ((2, 0.0), (1, 0.0), (1, LOFT_M[1]), (0, 0.0)):
        image = tx.copy()
        image[:, axis] = 2 * place - image[:, axis]
        way = np.linalg.norm(image - rx, axis=1)
        strong = 0.3 * (1 + 1.4 * loft["specular-reflections"])
        longer.append(way - far)
        gain.append(strong / way * np.exp(2j * np.pi * loft.rng.random(len(far))))
    for point in np.random.default_rng([loft.own, 5]).uniform(0.2, np.array(LOFT_M) - 0.2, (5, 3)):
        there, back = np.linalg.norm(tx - point, axis=1), np.linalg.norm(rx - point, axis=1)
        longer.append(there + back - far)
        gain.append(0.12 / (there * back + 0.5) * np.exp(2j * np.pi * loft.rng.random(len(far))))
    _change(loft, far, longer, gain)
    return np.stack(longer, axis=1), np.asarray(GAIN * np.stack(gain, axis=1), np.complex128)


def _change(loft: Loft, far: Floats, longer: list[Floats], gain: list[Complexes]) -> None:
    """Change the ways by what is hidden."""
    lost_db = 5 * loft["path-loss"] * np.log10(far / 2 + 0.5)
    for way in range(len(gain)):
        gain[way] = gain[way] * 10 ** (-lost_db / 20)
    if strength := loft["obstructed-path"]:
        codes, links = pd.factorize(loft.frame["link"])
        struck = (loft.more.random(len(links)) < 0.35)[codes]
        loss_db = loft.more.triangular(6, 12, 14 + 8 * strength, len(links))[codes]
        gain[0] = gain[0] * np.where(struck, 10 ** (-loss_db / 20), 1)
        longer[0] = longer[0] + np.where(struck, 0.2 * strength, 0)
    if strength := loft["material-delay"]:
        longer[0] = longer[0] + np.where(loft.screened, 0.12 * strength, 0)
    if strength := loft["diffraction"]:
        gain[0] = gain[0] * np.where(loft.screened, 10 ** (-(6 + 8 * strength) / 20), 1)
        for around in (0.08, 0.14):
            longer.append(np.full(len(far), around))
            bent = np.where(loft.screened, 0.12 / far, 0)
            gain.append(bent * np.exp(-2j * np.pi * around / 0.075))
    if strength := loft["pulse-ringing"]:
        longer += [longer[0] + 4.7 * SAMPLE_M, longer[0] + 9.4 * SAMPLE_M]
        gain += [0.28 * strength * np.exp(2j) * gain[0], 0.08 * strength * gain[0]]
    if strength := loft["ghost-before"]:
        longer.append(longer[0] - 3.4 * SAMPLE_M)
        gain.append(0.12 * strength * gain[0])


def _pulses(at: Floats, gain: Complexes) -> Complexes:
    """Return the sum of hyperbolic-secant pulses, 2.4 samples wide at half height [n, SAMPLES]."""
    total = np.zeros((len(at), SAMPLES), complex)
    for place, strength in zip(at.T, gain.T, strict=True):
        lag = np.clip((np.arange(SAMPLES) - place[:, None]) / 0.91, -30, 30)
        total += strength[:, None] / np.cosh(lag)
    return total


def _haze(loft: Loft, start: Floats) -> Complexes:
    """Return diffuse energy of random phase: two slopes; hidden: more of the slower one."""
    lag = np.arange(SAMPLES) - start[:, None] - 3
    slow = 0.25 + 0.8 * loft["diffuse-tail"]
    shape = np.exp(-np.maximum(lag, 0) / 9) + slow * np.exp(-np.maximum(lag, 0) / 42)
    size = 0.02 * GAIN * shape * (lag > 0)
    parts = loft.rng.normal(size=(2, *size.shape))
    smooth = [np.apply_along_axis(np.convolve, 1, one, [0.5, 0.7, 0.5], "same") for one in parts]
    return np.asarray(size * (smooth[0] + 1j * smooth[1]))


def _controlled(loft: Loft, signal: Complexes) -> tuple[Complexes, Floats]:
    """Return signal and symbols accumulated."""
    top = np.abs(signal).max(axis=1)
    symbols = np.full(len(top), 990.0)
    if not (strength := min(loft["level-control"], 1.6)):
        return signal, symbols
    over = np.maximum(20 * np.log10(top / np.quantile(top, 0.35)), 0)
    share = 1 / (1 + 0.05 * strength * over) ** 2
    return signal * share[:, None], np.round(symbols * share)


def _foreign(loft: Loft, shape: tuple[int, ...]) -> Complexes:
    """Return what others transmit."""
    grid, phase = np.arange(shape[1]), 2 * np.pi * loft.more.random((shape[0], 1))
    loud = 0.5 + loft.more.rayleigh(0.6, (shape[0], 1))
    tone = 150 * loft["narrowband-interference"] * loud * np.exp(1j * (1.3 * grid + phase))
    at = loft.more.uniform(30, 120, (shape[0], 1))
    pulse = 1 / np.cosh(np.clip((grid - at) / 1.1, -30, 30))
    return np.asarray(tone + 1800 * loft["second-transmitter"] * pulse * np.exp(1j * phase))


def _edge(heard: Floats, late: float) -> tuple[Floats, NDArray[np.intp]]:
    """Return the first path [n] in samples and the sample of its peak.

    The first sample over a threshold, climbed to its peak, refined by a parabola; `late` raises
    the threshold to a share of the highest sample.
    """
    rows, last = np.arange(len(heard)), heard.shape[1] - 2
    raised = (0.35 * min(late, 2.0) + 0.15 * (late > 0)) * heard.max(axis=1)
    over = heard[:, 3:] > np.maximum(DETECT * NOISE, raised)[:, None]
    peak = np.where(over.any(axis=1), over.argmax(axis=1) + 3, heard.argmax(axis=1))
    for _ in range(4):
        after = np.minimum(peak + 1, last)
        peak = np.where(heard[rows, after] > heard[rows, peak], after, peak)
    peak = np.clip(peak, 1, last)
    left, mid, right = (heard[rows, peak + step] for step in (-1, 0, 1))
    bend = np.minimum(left - 2 * mid + right, -1e-6)
    return np.asarray(peak + np.clip(0.5 * (left - right) / bend, -0.7, 0.7)), peak


def _shift(loft: Loft, level: Floats) -> Floats:
    """Return what hidden effects of the range alone add, in metres."""
    delays = np.random.default_rng([loft.own, 6]).uniform(0.3, 1.7, 6)
    number = loft.frame["rx"].str[1:].astype(int).to_numpy()
    total = 0.11 * loft["antenna-delay"] * delays[number]
    total = total - 0.09 * loft["power-bias"] * np.tanh((level - np.median(level)) / 4)
    mine = (loft.frame["rx"] == "n1").to_numpy()[:, None]
    real = loft.ends("rx") + mine * np.array([0.4, 0.3, 0.0]) * loft["anchor-elsewhere"]
    gone, planned = (np.linalg.norm(loft.ends("tx") - to, axis=1) for to in (real, loft.ends("rx")))
    return np.asarray(total + gone - planned)
