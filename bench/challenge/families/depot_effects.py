"""What the depot hides in ranges and levels: a library's effects in other forms, laws and faults.

numpy and pandas alone; shared by the depot's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
SITE_M = (62.0, 36.0, 9.5)
GATES_M = (
    (2, 2, 6.5), (20, 1, 7.5), (41, 2, 6.0), (60, 4, 7.8), (61, 20, 5.5), (58, 34, 7.0),
    (38, 35, 8.0), (19, 34, 5.8), (1, 19, 7.2),
)  # fmt: skip
FORKS = 4
GOODS = {"plywood": (0.06, 2.0), "chipboard": (0.1, 4.0), "glass": (0.14, 3.0)}  # m late, dB
UNSEEN = ("speed_x", "speed_y", "gain_x", "gain_y")  # m/s, m/s^2
PER_PPM_S = 299.792458 / 2  # metres
WAVE_M = 0.0751
LAWS = {
    "frosted-over": Law(("logarithm", "saturation", "power")),
    "stacked-high": Law(("power", "parabola", "linear")),
    "fork-raised": Law(("step",), 0.12, "m"),
    "rewound-counter": Law(),
    "surveyed-by-shift": Law(),
    "gate-bumped": Law(("position",), 0.583, "m", devices=("gate2",)),
    "gates-relabelled": Law(("swap",), devices=("gate3", "gate4")),
    "metres-as-yards": Law(("unit",), 0.9144, "1", grows=False, devices=("gate7",)),
}
"""What nobody's library has."""


@dataclass
class Sheet:
    """Rows to change, and what they gain [n]: `late_m`, dB of all and of the straight path.

    `kept` seeds what all tables of a case share, `rng` the rest; `few`: causes are to be rare.
    """

    table: pd.DataFrame
    kept: int
    rng: np.random.Generator
    few: bool = False
    gained: dict[str, Floats] = field(default_factory=dict)

    def column(self, name: str) -> Floats:
        """Return a column [n]."""
        return self.table[name].to_numpy(np.float64)

    def gain(self, name: str, value: Floats) -> None:
        """Let rows gain something: metres or dB are added."""
        self.gained[name] = self.gained.get(name, np.zeros(len(self.table))) + value

    def same(self, stream: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.kept, stream, 99])

    def which(self, end: str) -> NDArray[np.intp]:
        """Return the number of the fork or the gate of each row."""
        return self.table[end].str.slice(4).to_numpy(np.intp)

    def gates(self) -> Floats:
        """Return where the gates of the rows are [n, 3]."""
        return np.array(GATES_M, np.float64)[self.which("rx")]

    def forks(self, later_s: Floats | float = 0.0) -> Floats:
        """Return where the forks of the rows are at a later time [n, 3]."""
        here = self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64).copy()
        for axis, (speed, more) in enumerate((UNSEEN[::2], UNSEEN[1::2])):
            here[:, axis] += self.column(speed) * later_s + self.column(more) * later_s**2 / 2
        return here

    def each_link(self, values: Callable[[int], Floats]) -> Floats:
        """Return values drawn once for each link [n]."""
        number, names = pd.factorize(self.table["link"])
        return values(len(names))[number]

    def has(self, kinds: Mapping[str, object] | tuple[str, ...]) -> NDArray[np.bool_]:
        """Return which rows have something of these kinds in the straight path [n]."""
        return np.array([any(kind in kinds for kind in row) for row in self.table["obstacles"]])


def _distance(left: Floats, right: Floats) -> Floats:
    return np.asarray(np.sqrt(((left - right) ** 2).sum(axis=1)))


def _behind(sheet: Sheet, strength: float) -> None:
    """Compare with a truth that is older than the range."""
    sheet.gain("late_m", _distance(sheet.forks(0.09 * strength), sheet.gates()) - _far(sheet))


def _far(sheet: Sheet) -> Floats:
    return sheet.column("true_range_m")


def _driving(sheet: Sheet, strength: float) -> None:
    """Drive on while the answer is prepared and sent."""
    there = _distance(sheet.forks(sheet.column("reply_time_s") + 4e-4), sheet.gates())
    sheet.gain("late_m", (there - _far(sheet)) * min(strength / 2, 1.0))


def _connectors(sheet: Sheet, strength: float) -> None:
    rng = sheet.same(1)
    gate, fork = rng.laplace(0.03, 0.03, len(GATES_M)), rng.exponential(0.04, FORKS)
    sheet.gain("late_m", strength * (gate[sheet.which("rx")] + fork[sheet.which("tx")]))


def _ageing(sheet: Sheet, strength: float) -> None:
    """Crystals that differ, and go on to differ with the logarithm of time."""
    rng = sheet.same(2)
    apart = rng.uniform(-0.02, 0.02, FORKS)[sheet.which("tx")]
    apart -= rng.uniform(-0.02, 0.02, len(GATES_M))[sheet.which("rx")]
    aged = 1 + 0.12 * np.log1p(sheet.column("time_s") / 600)
    sheet.gain("late_m", PER_PPM_S * strength * apart * aged * sheet.column("reply_time_s"))


def _doubling(sheet: Sheet, strength: float) -> None:
    """Double the delay with every 14 degrees."""
    sheet.gain("late_m", 0.05 * strength * (2 ** ((sheet.column("temperature_c") - 5) / 14) - 1))


def _mast_sector(sheet: Sheet, strength: float) -> None:
    """Be late in a sector of directions with soft edges, where the mast of the truck stands."""
    turn = np.radians(sheet.column("azimuth_deg")) - sheet.same(3).uniform(0, 2 * np.pi)
    inside = 1 / (1 + np.exp((0.45 - np.cos(turn)) / 0.1))
    sheet.gain("late_m", 0.14 * strength * (inside - 0.3))
    sheet.gain("all_db", -2.0 * min(strength, 1.5) * inside)


def _two_ramps(sheet: Sheet, strength: float) -> None:
    level = sheet.column("rx_power_dbm")
    low, high = np.clip((-86 - level) / 5, 0, 1), np.clip((level + 83) / 8, 0, 1)
    sheet.gain("late_m", strength * (0.055 * low - 0.105 * high + 0.02))


def _hyperbolic(sheet: Sheet, strength: float) -> None:
    """Scatter like the hyperbolic secant."""
    chance = sheet.rng.uniform(1e-6, 1 - 1e-6, len(sheet.table))
    sheet.gain("late_m", 0.05 * strength * 2 / np.pi * np.log(np.tan(np.pi / 2 * chance)))


def _absorbed(sheet: Sheet, strength: float) -> None:
    sheet.gain("all_db", -0.16 * strength * _far(sheet))


def _too_short(sheet: Sheet, strength: float) -> None:
    sheet.gain("late_m", -0.0032 * strength * sheet.column("range_m"))


def _decimal(sheet: Sheet, strength: float) -> None:
    step, range_m = 0.2 * strength, sheet.column("range_m")
    sheet.gain("late_m", step * np.rint(range_m / step) - range_m)


def _goods(sheet: Sheet, strength: float) -> None:
    """Goods are packed more or less densely: delay and loss go together from link to link."""
    each = [[GOODS[one] for one in row if one in GOODS] for row in sheet.table["obstacles"]]
    late, lost = np.array([np.sum([*some, (0.0, 0.0)], axis=0) for some in each]).T
    dense = sheet.each_link(lambda n: sheet.rng.lognormal(0, 0.18, n))
    sheet.gain("late_m", strength * dense * late)
    sheet.gain("straight_db", -min(strength, 1.5) * dense * lost)


def _by_the_roof(sheet: Sheet, strength: float) -> None:
    """Hear only what comes by the roof, which is sloped: its height differs from link to link."""
    share = 0.07 if sheet.few else 0.14
    lost = sheet.each_link(lambda n: (sheet.rng.random(n) < share).astype(np.float64))
    roof = SITE_M[2] + sheet.each_link(lambda n: sheet.rng.uniform(-1.0, 3.0, n))
    over = (roof - sheet.column("tx_z_m")) * (roof - sheet.column("rx_z_m"))
    around = np.sqrt(_far(sheet) ** 2 + 4 * over * (0.5 + 0.5 * strength))
    sheet.gain("late_m", lost * (around - _far(sheet)))
    sheet.gain("all_db", -6.0 * lost)


def concrete_floor(sheet: Sheet, strength: float) -> tuple[Floats, Floats]:
    """Return how much longer the way by the floor is in m, and its real amplitude, both [n]."""
    up, far = sheet.column("tx_z_m") * sheet.column("rx_z_m"), _far(sheet)
    longer = np.sqrt(far**2 + 4 * up) - far
    grazing = (sheet.column("tx_z_m") + sheet.column("rx_z_m")) / (far + longer)
    rough = np.exp(-((4 * np.pi * 0.005 * grazing / WAVE_M) ** 2) / 2)
    return longer, min(0.6 * strength, 0.9) * rough * np.exp(-1.1 * grazing)


def _floor(sheet: Sheet, strength: float) -> None:
    """Where the sum of two pulses passes half its height, and the power of the sum."""
    longer, size = concrete_floor(sheet, strength)
    turned = -size * np.exp(-2j * np.pi * longer / WAVE_M)
    metres = np.linspace(-1.0, 1.6, 261)
    pulses = [np.exp(-(((metres - at[:, None]) / 0.42) ** 2)) for at in (0 * longer, longer)]
    both = np.abs(pulses[0] + turned[:, None] * pulses[1])
    passed, alone = (
        metres[np.argmax(one >= one.max(axis=1, keepdims=True) / 2, axis=1)]
        for one in (both, pulses[0])
    )
    sheet.gain("late_m", passed - alone)
    sheet.gain("all_db", 10 * np.log10((both**2).sum(axis=1) / (pulses[0] ** 2).sum(axis=1)))


def edge_loss_db(parameter: Floats) -> Floats:
    """Return the loss over one edge by its Fresnel parameter >= 0: the integral, summed up."""
    fine = np.linspace(0, 8, 8001)
    waves = np.exp(0.5j * np.pi * fine**2)
    integral = np.cumsum((waves + np.roll(waves, 1)) / 2) * (fine[1] - fine[0])
    size = np.abs((1 + 1j) / 2 - (integral - integral[0])) / np.sqrt(2)
    return np.asarray(np.interp(np.minimum(parameter, 7), fine, -20 * np.log10(size)))


def _racks(sheet: Sheet, strength: float) -> None:
    """Over the two edges of an iron rack, one after the other."""
    iron, far = sheet.has(("metal",)) * 1.0, _far(sheet)
    high = strength**0.5 * sheet.each_link(lambda n: sheet.rng.uniform(0.2, 0.75, n))
    near = far * sheet.each_link(lambda n: sheet.rng.uniform(0.15, 0.4, n))
    wide = np.minimum(2.5, far / 4)
    rest = far - near - wide
    first = high * np.sqrt(2 / WAVE_M * (1 / near + 1 / wide)) / 2
    second = high * np.sqrt(2 / WAVE_M * (1 / wide + 1 / rest)) / 2
    lost = edge_loss_db(first) + edge_loss_db(second)
    sheet.gain("late_m", iron * (np.hypot(near, high) + wide + np.hypot(rest, high) - far))
    sheet.gain("straight_db", -iron * min(strength, 1.0) ** 0.5 * np.minimum(lost, 24))


def _gain_steps(sheet: Sheet, strength: float) -> None:
    """Switch back in steps of 4 dB above a level: fewer symbols, and levels that stay behind."""
    steps = np.clip(np.ceil((sheet.column("rx_power_dbm") + 84) / 4), 0, 6)
    sheet.gain("symbols_db", -1.1 * strength * steps)
    sheet.gain("all_db", -0.55 * min(strength, 2.0) * steps)


def _warm_noise(sheet: Sheet, strength: float) -> None:
    """More noise, the more so where it is warm; what is weak scatters more."""
    louder = strength * (1.7 + 0.02 * sheet.column("temperature_c"))
    weak = 10 ** ((-90 - sheet.column("rx_power_dbm")) / 20) * np.sqrt(10 ** (louder / 10) - 1)
    sheet.gain("noise_db", louder)
    sheet.gain("late_m", 0.025 * weak * sheet.rng.normal(size=len(weak)))


def _frost(sheet: Sheet, strength: float) -> None:
    sheet.gain("late_m", 0.08 * strength * np.log1p(sheet.column("since_defrost_h") / 3))


def _stack(sheet: Sheet, strength: float) -> None:
    sheet.gain("late_m", 0.008 * strength * sheet.column("stack_m") ** 1.7)


def _raised(sheet: Sheet, strength: float) -> None:
    sheet.gain("late_m", np.where(sheet.column("fork_height_m") > 2.6, 0.12 * strength, 0.0))


def _rewound(sheet: Sheet, strength: float) -> None:
    """Begin to count again above so many metres, on some links."""
    most = 46.0 - 5 * strength
    old = sheet.each_link(lambda n: (sheet.rng.random(n) < 0.5).astype(np.float64))
    sheet.gain("late_m", -most * old * (sheet.column("range_m") > most))


def _by_shift(sheet: Sheet, strength: float) -> None:
    """Every run was surveyed anew: its ranges are all too long or too short alike."""
    runs = sheet.table["link"].str.extract(r"(\d+)\.")[0].to_numpy(np.intp)
    off = sheet.same(5).choice([-1.0, 1.0], 64) * sheet.same(6).uniform(0.03, 0.13, 64)
    sheet.gain("late_m", strength * off[runs])


def _elsewhere(sheet: Sheet, gates: Floats) -> None:
    """Let gates really be at other positions [n, 3]."""
    really = _distance(sheet.forks(), gates)
    sheet.gain("late_m", really - _far(sheet))
    sheet.gain("all_db", 20 * np.log10(_far(sheet) / really))


def _bumped(sheet: Sheet, strength: float) -> None:
    moved = np.outer(sheet.which("rx") == 2, [0.32, 0.48, -0.0917])
    _elsewhere(sheet, sheet.gates() + strength * moved)


def _relabelled(sheet: Sheet, _: float) -> None:
    other = np.arange(len(GATES_M))
    other[[3, 4]] = 4, 3
    _elsewhere(sheet, np.array(GATES_M, np.float64)[other[sheet.which("rx")]])


def _yards(sheet: Sheet, _: float) -> None:
    sheet.gain("late_m", (0.9144 - 1) * (sheet.which("rx") == 7) * sheet.column("range_m"))


EFFECTS: dict[str, Callable[[Sheet, float], None]] = {
    "time-lag": _behind,
    "exchange-motion": _driving,
    "antenna-delay": _connectors,
    "clock-offset": _ageing,
    "temperature-drift": _doubling,
    "antenna-pattern": _mast_sector,
    "power-bias": _two_ramps,
    "timestamp-jitter": _hyperbolic,
    "path-loss": _absorbed,
    "range-scale": _too_short,
    "range-rounding": _decimal,
    "material-delay": _goods,
    "blocked-path": _by_the_roof,
    "ground-bounce": _floor,
    "diffraction": _racks,
    "level-control": _gain_steps,
    "noise-floor": _warm_noise,
    "frosted-over": _frost,
    "stacked-high": _stack,
    "fork-raised": _raised,
    "rewound-counter": _rewound,
    "surveyed-by-shift": _by_shift,
    "gate-bumped": _bumped,
    "gates-relabelled": _relabelled,
    "metres-as-yards": _yards,
}
