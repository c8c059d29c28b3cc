"""What the cowshed hides in waveforms: effects in forms of its own, oddities of its radios.

numpy alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.case import Law
from bench.challenge.families.cowshed_barn import LAWS as RANGE_LAWS
from bench.challenge.families.cowshed_barn import RAFTERS_M, SHED_M
from bench.challenge.families.cowshed_effects import EFFECTS, roof_ways, slat_ray
from bench.challenge.families.cowshed_scope import METRES, PLACE, Scope, murmur

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OF_RANGES = (
    "time-lag", "exchange-motion", "antenna-delay", "clock-offset", "temperature-drift",
    "antenna-pattern", "power-bias", "timestamp-jitter", "path-loss", "range-scale",
    "material-delay", "diffraction", "level-control",
)  # fmt: skip
"""Effects that are those of the cowshed's tables of ranges."""
ODD = ("sampler-trembles", "slopes-limited", "mirror-image-leaks")
LAWS = {
    name: law for name, law in RANGE_LAWS.items() if law.forms and name != "varas-from-one-rafter"
} | dict.fromkeys(ODD, Law())
"""What nobody's library has."""
GABLES = 5.24  # permittivity of concrete
STEEL, CURTAIN = 0.62, 0.3  # of what meets the roof and a long wall, returned


def _shed(scope: Scope, strength: float) -> None:
    """Hear both sides of the roof, curtains of the long walls, and gables as Fresnel has it."""
    herd = scope.herd()
    first, far = scope.coming() * scope.early(), herd.far
    ways, _ = roof_ways(herd)
    returned = [STEEL, STEEL]
    heard = [(way, np.full(len(far), part)) for way, part in zip(ways, returned, strict=True)]
    for axis in (0, 1):
        for wall in (0.0, SHED_M[axis]):
            heard.append(_off_wall(herd.collars()[:, axis] - wall, herd.aerials()[:, axis] - wall,
                                   far, axis))  # fmt: skip
    for way, part in heard:
        spread = herd.per_link(lambda n: scope.rng.beta(4.0, 2.0, n))  # what hangs and leans there
        share = np.minimum(1.15 * strength**0.5 * part * spread * far / way, 0.85)
        scope.repeat(share * scope.turned(), np.maximum(way - far, 1.0) / METRES, first)


def _off_wall(one: Floats, other: Floats, far: Floats, axis: int) -> tuple[Floats, Floats]:
    """Return how long a way by a wall is in m, and the part it returns, [n] each."""
    way = np.sqrt(far**2 + 4 * one * other)
    if axis == 0:
        return way, np.full(len(far), CURTAIN)
    met = np.abs(one + other) / way
    root = np.sqrt(GABLES - 1 + met**2)
    return way, (root - met) / (root + met)


def _slats(scope: Scope, strength: float) -> None:
    longer, share = slat_ray(scope.herd(), strength)
    scope.repeat(share, longer / METRES, scope.coming())


def _behind_bales(scope: Scope, strength: float) -> None:
    """Lose, behind bales, what comes straight: over them comes a fan, ever farther apart."""
    herd, coming = scope.herd(), scope.coming()
    bales = herd.per_link(lambda n: 1.0 * (scope.rng.random(n) < 0.21))
    scope.hush(1 - 0.984 * bales[:, None] * scope.on() * scope.early())
    late = (0.5 + 0.5 * strength) * herd.per_link(lambda n: 2.1 + scope.rng.gamma(3.0, 0.4, n))
    for number in range(1, 7):
        size = bales * 0.38 * number**-0.4 * scope.rng.uniform(0.75, 1.25, len(bales))
        scope.repeat(size * scope.turned(), late, coming)
        late = late + number**0.5 * herd.per_link(lambda n: scope.rng.wald(1.5, 6.0, n))


def _hoyt(scope: Scope, strength: float) -> None:
    """Fade by Hoyt's sizes beside what is steady: one component of chance is half the other."""
    rows, knots = len(scope.table), len(PLACE) // 5 + 3
    loose = scope.rng.standard_normal((2, rows, knots)) * np.sqrt([[[0.8]], [[0.2]]])
    place = (PLACE + 5 * scope.rng.random((rows, 1))) / 5
    at = np.floor(place).astype(np.intp)
    angle = 0.5 * np.pi * (place - at)  # keeps the power of what is between knots
    part = min(0.2 * strength, 0.75)
    here, there = (np.take_along_axis(loose, (at + k)[None].repeat(2, 0), axis=2) for k in (0, 1))
    real, imaginary = here * np.cos(angle) + there * np.sin(angle)
    size = np.abs(np.sqrt(1 - part) + np.sqrt(part) * (real + 1j * imaginary))
    scope.hush(1 + scope.on() * (size / np.sqrt(np.mean(size**2)) - 1))


def _log_normal(scope: Scope, strength: float) -> None:
    """Scatter from rail to rail: factors of delay multiply, so power is a log-normal of it."""
    past = np.maximum(scope.past - 3.0, 1e-3)
    power = 0.021 * strength * np.exp(-0.5 * np.square(np.log(past / 15.0) / 0.8))
    rough = np.sqrt(power / 2) * murmur(scope.rng, len(past))
    scope.trace = scope.trace + scope.height()[:, None] * rough


def _below_cut_off(scope: Scope, strength: float) -> None:
    """Ring in the tube that holds an antenna: what is near its cut-off comes later and later."""
    pitch = scope.lasting(1).uniform(0.9, 1.5)
    lags = np.arange(4, 48)
    wave = np.cos(pitch * np.sqrt(np.square(lags) - 9.0)) / np.sqrt(lags) * np.exp(-lags / 16.0)
    coming, rung = scope.coming(), scope.trace.copy()
    for lag, part in zip(lags.tolist(), (0.62 * min(strength, 2.5) * wave).tolist(), strict=True):
        rung[:, lag:] += part * coming[:, :-lag]
    scope.trace = rung


def _milk_pump(scope: Scope, strength: float) -> None:
    scope.noise_up(np.asarray(EFFECTS["noise-floor"](scope.herd(), strength).noise_db))


def _gate_reader(scope: Scope, strength: float) -> None:
    """Hear a harmonic of a gate's reader: a carrier and four lines beside it, at near rafters."""
    gate, pitch = scope.lasting(2).uniform(6, 38), scope.lasting(3).uniform(-0.2, 0.2)
    near = np.exp(-np.abs(RAFTERS_M[:, 1] - gate) / 16.0)
    size = 1.9 * strength * near[scope.herd().rafter]
    tone = np.zeros(scope.trace.shape, np.complex128)
    for line, part in zip((-0.26, -0.13, 0.0, 0.13, 0.26), (0.25, 0.5, 0.75, 0.5, 0.25),
                          strict=True):  # fmt: skip
        tone += part * np.exp(2j * np.pi * (pitch + line) * PLACE) * scope.turned()[:, None]
    scope.trace = scope.trace + (size * scope.sigma)[:, None] * tone
    scope.louder = scope.louder * _beside(size)
    scope.sigma = scope.sigma * np.sqrt(1 + 0.594 * size**2)


def _beside(size: Floats) -> Floats:
    """Return how many times more sizes scatter beside such lines [n]: by trial."""
    rng = np.random.default_rng(967)
    noise = rng.standard_normal((24000, 2)) @ np.array([1, 1j])
    lines = np.exp(2j * np.pi * rng.random((24000, 5))) @ np.array([0.25, 0.5, 0.75, 0.5, 0.25])
    tried = np.linspace(0, 5, 26)
    spread = np.array([np.abs(noise + one * lines).std() for one in tried])
    return np.asarray(np.interp(size, tried, spread / spread[0]))


def _trembles(scope: Scope, strength: float) -> None:
    """Take late samples a part of a sample too soon or too late, each by its own chance."""
    off = scope.rng.normal(0, 0.4 * strength, scope.trace.shape) * scope.after(11.0)
    off = np.clip(off, -1, 1)
    beside = np.clip(np.arange(len(PLACE)) + np.sign(off).astype(np.intp), 0, len(PLACE) - 1)
    taken = np.take_along_axis(scope.trace, beside, axis=1)
    scope.trace = (1 - np.abs(off)) * scope.trace + np.abs(off) * taken


def _slopes(scope: Scope, strength: float) -> None:
    """Code late sizes by their steps, which are too short: what rises or falls fast is cut."""
    size, gate = np.abs(scope.trace), scope.after(11.0) > 0.5
    usual = np.sqrt(np.sum(size**2 * gate, axis=1) / np.maximum(np.sum(gate, axis=1), 1))
    most, coded = 0.24 * usual / strength**0.5, size.copy()
    for k in range(1, len(PLACE)):
        cut = np.clip(size[:, k], coded[:, k - 1] - most, coded[:, k - 1] + most)
        coded[:, k] = np.where(gate[:, k], cut, size[:, k])
    scope.trace = scope.trace * coded / np.maximum(size, 1e-9)


def _mirror(scope: Scope, strength: float) -> None:
    """Let the mirror image of the band leak into late samples, as a mixer out of balance does."""
    turn = np.exp(2j * np.pi * scope.lasting(4).uniform(0.15, 0.35) * PLACE)
    part = min(0.35 * strength, 0.85) * scope.after(10.0)
    scope.trace = scope.trace + part * np.conj(scope.trace) * turn * scope.turned()[:, None]


def _companded(scope: Scope, strength: float) -> None:
    """Keep components in steps that grow with them, as a law of telephones has it (G.711)."""
    usual = float(np.median(scope.sigma))
    step = 1.7 * strength * usual
    kept = [_by_mu(x, step, usual) for x in (scope.trace.real, scope.trace.imag)]
    scope.trace = kept[0] + 1j * kept[1]
    noise = np.random.default_rng(968).standard_normal((2, 14000))
    tried = np.geomspace(0.6, 1.6, 21) * usual
    spread = [np.hypot(*_by_mu(noise * one, step, usual)).std() / one for one in tried]
    by = np.interp(scope.sigma, tried, np.array(spread) / np.hypot(*noise).std())
    scope.louder = scope.louder * np.maximum(by, 0.05)


def _by_mu(values: Floats, step: float, usual: float) -> Floats:
    """Return values in whole steps near zero, and longer ones far from it."""
    scale = 40.0 * usual
    code = np.rint(np.log1p(np.abs(values) / scale) * scale / step) * step
    return np.asarray(np.sign(values) * scale * np.expm1(code / scale))


def _dull(scope: Scope, strength: float) -> None:
    """Ask more of a first pulse, and wait for more of its energy."""
    scope.dull = 0.95 * strength


ON_THE_WAY: dict[str, Callable[[Scope, float], None]] = {
    "specular-reflections": _shed,
    "ground-bounce": _slats,
    "obstructed-path": _behind_bales,
    "small-scale-fading": _hoyt,
    "diffuse-tail": _log_normal,
}
IN_THE_RADIO: dict[str, Callable[[Scope, float], None]] = {
    "pulse-ringing": _below_cut_off,
    "noise-floor": _milk_pump,
    "narrowband-interference": _gate_reader,
    "sampler-trembles": _trembles,
    "slopes-limited": _slopes,
    "mirror-image-leaks": _mirror,
    "quantisation": _companded,
    "late-detection": _dull,
}
WAVES = ON_THE_WAY | IN_THE_RADIO


def suffer(scope: Scope, names: tuple[str, ...], strength: float) -> None:
    """Let waveforms suffer effects: those on the way, those of rows, those of the radio."""
    for name in (one for one in ON_THE_WAY if one in names):
        ON_THE_WAY[name](scope, strength)
    for name in (one for one in names if one not in WAVES):
        scope.befall(EFFECTS[name](scope.herd(), strength))
    for name in (one for one in IN_THE_RADIO if one in names):
        IN_THE_RADIO[name](scope, strength)
