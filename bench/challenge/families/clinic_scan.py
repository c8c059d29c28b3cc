"""The clinic's receiver: samples that can be changed, and what is reported of them.

numpy and pandas alone. The first path is taken from the centroid of the first peak.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 24, 208  # of the impulse responses that effects are put into
QUIET = 16  # samples before any signal
SAMPLE_M = 1.0016 * 0.299792458
DETECT = 8.0  # times the root mean square of the noise
SHARE = 0.13  # of the highest sample: less is a side lobe
EDGE = 1.2  # samples from the first path to the centre of its pulse


def read(cir: Complexes, floor: Floats, share: float = SHARE) -> tuple[Floats, Floats, Floats]:
    """Return what a receiver makes of samples [n, K]: first path, energy and early energy [n].

    The first path lies before the centroid of the first peak over the noise, and over a `share`
    of the highest sample.
    """
    size, rows = np.abs(cir), np.arange(len(cir))
    least = np.maximum(DETECT * np.sqrt(floor), share * size.max(axis=1))
    out = size[:, 4:-8] > least[:, None]
    top = np.where(out.any(axis=1), out.argmax(axis=1), size[:, 4:-8].argmax(axis=1)) + 4
    for _ in range(5):
        top = np.where(size[rows, top + 1] > size[rows, top], top + 1, top)
    near = np.stack([size[rows, top + step] for step in (-1, 0, 1)], axis=1)
    weight = near - 0.8 * near.min(axis=1, keepdims=True)
    centre = top + weight @ np.array([-1.0, 0.0, 1.0]) / np.maximum(weight.sum(axis=1), 1e-9)
    energy = (size**2).sum(axis=1)
    energy = np.maximum(energy - size.shape[1] * floor, 0.05 * energy)
    return np.round((centre - EDGE) * 64) / 64, energy, np.asarray((near**2).sum(axis=1))


def delayed(cir: Complexes, samples: Floats) -> Complexes:
    """Return samples [n, K] later by any number of samples [n], nothing wrapped around."""
    length = 2 * cir.shape[1]
    turns = np.fft.fftfreq(length)[None] * samples[:, None]
    late = np.fft.ifft(np.fft.fft(cir, length) * np.exp(-2j * np.pi * turns))
    return np.asarray(late[:, : cir.shape[1]])


@dataclass
class Scan:
    """Samples of n rows and what is reported beside them.

    `cir` [n, WIDE_SAMPLES] complex counts, `floor` [n] mean |noise|^2, `hiss` [n] noise as
    reported, `symbols` [n] accumulated, `late_m` and `louder_db` what reports gain [n] without
    the samples, `share` of the highest sample that detection asks for. `own` seeds what a case
    keeps, `rng` the rest; `before` [3, n] what was `told` at first.
    """

    frame: pd.DataFrame
    cir: Complexes
    floor: Floats
    hiss: Floats
    symbols: Floats
    own: int
    rng: np.random.Generator
    late_m: Floats
    louder_db: Floats
    share: float = SHARE
    before: Floats = field(default_factory=lambda: np.zeros(0))

    @classmethod
    def of(cls, table: pd.DataFrame, own: int, rng: np.random.Generator) -> Scan:
        """Return the scan of a table with `cir_i`, `cir_q` and columns of the exchange format."""
        real, imaginary = (np.stack(list(table[name])) for name in ("cir_i", "cir_q"))
        cir = (real + 1j * imaginary).astype(np.complex128)
        floor = np.full(len(table), np.mean(np.abs(cir[:, :QUIET]) ** 2))
        hiss, symbols = (table[n].to_numpy(np.float64) for n in ("noise_std", "preamble_count"))
        late, louder = np.zeros((2, len(table)))
        scan = cls(table, cir, floor, hiss, symbols, own, rng, late, louder)
        scan.before = scan.told
        return scan

    @property
    def told(self) -> Floats:
        """First path in samples, level and early level in dB as samples say them [3, n]."""
        first, *strong = read(self.cir, self.floor, self.share)
        return np.stack([first, *(10 * np.log10(one / self.symbols**2) for one in strong)])

    def written(self) -> pd.DataFrame:
        """Return the table with changed samples, and reports moved by what they now say."""
        later, louder, early = self.told - self.before
        longer_m, table = SAMPLE_M * later + self.late_m, self.frame
        return table.assign(
            cir_i=list(self.cir.real),
            cir_q=list(self.cir.imag),
            noise_std=self.hiss,
            preamble_count=self.symbols,
            first_path_index=table["first_path_index"] + later,
            range_m=table["range_m"] + longer_m,
            error_m=table["error_m"] + longer_m,
            rx_power_dbm=table["rx_power_dbm"] + louder + self.louder_db,
            first_path_power_dbm=table["first_path_power_dbm"] + early + self.louder_db,
        )

    def __getitem__(self, name: str) -> Floats:
        return self.frame[name].to_numpy(np.float64)

    def __len__(self) -> int:
        return len(self.frame)

    def ends(self, name: str) -> Floats:
        """Return positions, or the size of the room, [n, 3] in metres."""
        return self.frame[[f"{name}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64).copy()

    @property
    def level(self) -> Floats:
        """Level [n] in dBm as it would be reported by now."""
        return np.asarray(self["rx_power_dbm"] + (self.told - self.before)[1] + self.louder_db)

    @property
    def after(self) -> Floats:
        """Samples after the centre of the first pulse [n, WIDE_SAMPLES]."""
        first = read(self.cir, self.floor, self.share)[0]
        return np.asarray(np.arange(WIDE_SAMPLES) - (first + EDGE)[:, None])

    def pulse(self) -> Complexes:
        """Return the first pulse alone, faded out at both sides [n, WIDE_SAMPLES]."""
        fade = np.clip((5 - np.abs(self.after)) / 2, 0, 1)
        return np.asarray(self.cir * np.sin(fade * np.pi / 2) ** 2)

    def hissing(self, power: Floats) -> Complexes:
        """Return noise of mean |n|^2 = `power` [n], neighbouring samples alike."""
        white = self.rng.normal(size=(2, len(self), WIDE_SAMPLES + 1))
        near = (white[..., 1:] + 0.4 * white[..., :-1]) / np.sqrt(1.16)
        return np.asarray((near[0] + 1j * near[1]) * np.sqrt(power / 2)[:, None])

    def dimmed(self, loss_db: Floats) -> None:
        """Weaken the signal, not the noise, by a loss [n] in dB; a gain leaves the noise."""
        left = 10 ** (-loss_db / 20)
        self.cir = self.cir * left[:, None]
        self.cir = self.cir + self.hissing(self.floor * np.maximum(1 - left**2, 0))

    def straight(self, loss_db: Floats, longer_m: Floats) -> None:
        """Weaken the first pulse alone by a loss [n] in dB, and let it come later by metres [n]."""
        pulse = self.pulse()
        again = delayed(pulse, longer_m / SAMPLE_M) * 10 ** (-loss_db[:, None] / 20)
        self.cir = self.cir - pulse + again

    def per_link(self, draw: Callable[[int], Floats]) -> Floats:
        """Return what is drawn once for every link, for each row [n]."""
        codes, links = pd.factorize(self.frame["link"])
        return draw(len(links))[codes]

    def node(self) -> NDArray[np.int64]:
        """Return the number of the node of each row [n]."""
        return np.asarray(self.frame["rx"].str[4:], np.int64)
