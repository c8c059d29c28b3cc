"""Effect 16: a wider pulse, and ringing of antenna and board at a fixed delay."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.physics.batch import Batch, altered
from bench.physics.effect import Effect, parameter
from bench.physics.filters import convolved, decaying, echo_taps, filtered
from bench.physics.loops import parts
from bench.physics.randomness import Draws
from bench.physics.units import Complexes, amplitude, energy, scaled, squared

MOST_BACK = 0.9  # of an amplitude, that comes back: what reflects does not amplify


@dataclass(frozen=True)
class PulseRinging(Effect):
    """Widens the pulse and lets every path ring: an echo of the whole waveform at a fixed delay.

    Recorded accumulators ring 2.5 to 3.5 samples behind every strong first path, in all links of
    a device alike. The echo's phase is `ring_phase_deg`. An antenna that resonates rings on from
    then on: the echo decays in `ring_decay_ns` to 1/e while it turns by `ring_offset_mhz`, its
    resonance off the carrier; a hundredth of a ns is one echo, of a reflection. A cable that fits
    neither of its ends reflects an echo again: `again` of its energy. Energy is kept, but
    for `on_top` of it: a level that was calibrated with the pulse alone has all of the echo on top.
    One that takes energy away, within the pulse and against it, is calibrated with it.
    """

    name = "pulse-ringing"
    number = 16
    stage = "receiver"
    stackable = True
    source = "measured on Zenodo 10.5281/zenodo.4742391"
    signature = "all paths widened alike, an echo at a delay that no geometry moves"
    needs = (("cir",),)
    without_cir = False
    with_phases = True
    dies_away = True
    at_one_delay = True
    seldom = "again"
    begins = ({"on_top": 1.0}, {"on_top": 1.0, "first_alone": 1.0})

    ring_db: float = parameter(-60, "dB", -60, 6, "echo over the path itself, in energy", null=-60)
    ring_delay_ns: float = parameter(2.9, "ns", 0.5, 40, "of the echo")
    ring_phase_deg: float = parameter(120, "deg", -360, 360, "of the echo")
    ring_decay_ns: float = parameter(0.01, "ns", 0.01, 10, "in which the echo falls to 1/e")
    ring_offset_mhz: float = parameter(0, "MHz", -300, 300, "of what decays, off the carrier")
    widening: float = parameter(1, "ratio", 1, 3, "of the pulse's width", null=1)
    on_top: float = parameter(0, "ratio", 0, 1, "of what rings on, that the pulse does not lose")
    first_alone: float = parameter(0, "ratio", 0, 1, "of the echo, that other paths do not have")
    again: float = parameter(0, "ratio", 0, 1, "of the echo's energy, that echoes on", null=0)
    as_high: float = parameter(0, "1", 0, 1, "1 where a wider pulse is no lower", fitted=False)
    pulse_fwhm: float = parameter(2.5, "samples", 1.2, 5, "the base's width, before", fitted=False)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Filter signal and noise-free waveform; noise is left as it is."""
        if batch.waveform is None:
            return batch
        before = energy(batch.waveform)
        waveform = self._rung(self._widened(batch.waveform), batch.sample_period_ns)
        kept = np.sqrt(before / np.maximum(energy(waveform), 1e-20)).astype(np.float32)
        kept = np.where(kept < 1, kept ** np.float32(1 - self.on_top), kept)
        kept *= np.float32(self.widening ** (self.as_high / 2))
        return altered(batch, waveform=scaled(waveform, kept))

    def _widened(self, waveform: Complexes) -> Complexes:
        """Convolve with the Gaussian that makes the pulse `widening` times as wide."""
        sigma = self.pulse_fwhm * np.sqrt(self.widening**2 - 1) / np.sqrt(8 * np.log(2))
        if sigma < 0.1:
            return waveform
        lags = np.arange(-int(4 * sigma) - 1, int(4 * sigma) + 2)
        taps = np.exp(-0.5 * (lags / sigma) ** 2)
        return convolved(waveform, taps / taps.sum())

    def _rung(self, waveform: Complexes, period_ns: float) -> Complexes:
        """Add the echo."""
        if self.ring_db <= -60:
            return waveform
        turn = np.exp(1j * np.radians(self.ring_phase_deg)) * amplitude(self.ring_db)
        on = decaying(self.ring_decay_ns / period_ns, self.ring_offset_mhz * 1e-3 * period_ns)
        back = np.sqrt(self.again) * turn * min(1.0, MOST_BACK / abs(turn))
        taps = echo_taps(self.ring_delay_ns / period_ns, turn * on, back)
        if self.first_alone <= 0:
            return filtered(waveform, *taps)
        heard = self._heard(waveform)
        made = waveform - heard
        made += filtered(heard, *taps)
        return made

    def _heard(self, waveform: Complexes) -> Complexes:
        """Return what of every sample [n, S] echoes: all of the strongest path."""
        made: Complexes = (parts(waveform) * np.float32(1 - self.first_alone)).view(np.complex64)
        reach = int(np.ceil(2 * self.pulse_fwhm)) - 1
        at = squared(waveform).argmax(axis=1)[:, None] + np.arange(-reach, reach + 1)
        row, column = np.nonzero((at >= 0) & (at < waveform.shape[1]))
        near = row, at[row, column]
        made[near] = waveform[near]
        return made
