"""Rows of several blocks inside a module: taken apart, levels in decibels, features, range."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from zoo.base import Floats
from zoo.inputs import LEVELS, Input
from zoo.modules.features import FEATURES, NOISE_SAMPLES, MaranoFeatures
from zoo.modules.preparation import Crop, apply_in_blocks
from zoo.modules.scaling import GlobalScale

LEVEL_FIGURES = (
    "rx_power_dbm",
    "first_path_power_dbm",
    "rx_less_first_path_db",
    "preamble_count",
    "noise_std_db",
    *(f"{name}_db" for name in LEVELS[4:]),
)
_SMALLEST = 1e-3  # counts per symbol: what a logarithm is taken of at least
_FAINTEST = 1e-2  # of a row's peak, -40 dB: below it a sample is noise


class BlockModule(nn.Module):
    """A module of named inputs, called with one tensor per input or one of all their columns.

    `inputs` are what the exported graph takes. Subclasses write `compute`.
    """

    def __init__(self, inputs: Sequence[Input]) -> None:
        super().__init__()
        self.inputs = tuple(inputs)

    def forward(
        self, a: Tensor, b: Tensor | None = None, c: Tensor | None = None, d: Tensor | None = None
    ) -> Tensor | tuple[Tensor, Tensor]:
        """Return what `compute` does; arguments are named so that the export keeps them apart."""
        blocks = [block for block in (a, b, c, d) if block is not None]
        if len(blocks) == 1 and len(self.inputs) > 1:
            blocks = list(torch.split(a, [one.width for one in self.inputs], 1))
        named = {one.name: block for one, block in zip(self.inputs, blocks, strict=True)}
        return self.compute(named)

    def compute(self, blocks: dict[str, Tensor]) -> Tensor | tuple[Tensor, Tensor]:
        """Return the result for blocks [n, width] by name."""
        raise NotImplementedError


class LevelFigures(nn.Module):
    """Levels [n, 8] -> figures [n, 9]; NaN where unknown.

    Receive and first-path power (dBm), their difference (dB), accumulated symbols, and noise and
    amplitudes per symbol in dB: counts grow with the symbols summed, the channel does not.
    """

    def forward(self, x: Tensor) -> Tensor:
        """Return the figures in the order of LEVEL_FIGURES."""
        symbols = torch.where(x[:, 3:4] > 1, x[:, 3:4], torch.ones_like(x[:, 3:4]))
        counts = torch.cat([x[:, 2:3], x[:, 4:]], 1) / symbols
        held = torch.where(counts < _SMALLEST, torch.full_like(counts, _SMALLEST), counts)
        decibels = 20 * torch.log10(held)
        return torch.cat([x[:, :2], x[:, :1] - x[:, 1:2], x[:, 3:4], decibels], 1)


class PulseShape(nn.Module):
    """CIRs [n, width] -> the `samples` after the first four in dB below the row's peak.

    Before the fifth there is noise alone; levels say what the peak is.
    """

    def __init__(self, width: int, samples: int) -> None:
        super().__init__()
        self.samples = max(0, min(samples, width - NOISE_SAMPLES))

    def forward(self, x: Tensor) -> Tensor:
        """Return decibels [n, samples], -40 at least."""
        kept = x[:, NOISE_SAMPLES : NOISE_SAMPLES + self.samples].abs()
        relative = kept / x.abs().amax(1, keepdim=True).clamp_min(1e-9)
        held = torch.where(relative < _FAINTEST, torch.full_like(relative, _FAINTEST), relative)
        return 20 * torch.log10(held)


class Columns(BlockModule):
    """Blocks -> one table [n, columns]: level figures, range, settings, features, CIR bins.

    Each only where the block is there; `features`, `cir_samples` as they are and
    `shape_samples` in decibels (0: none) of the CIR.
    """

    def __init__(
        self,
        inputs: Sequence[Input],
        *,
        features: bool = True,
        cir_samples: int = 0,
        shape_samples: int = 0,
    ) -> None:
        super().__init__(inputs)
        widths = {one.name: one.width for one in inputs}
        cir = widths.get("cir", 0)
        self.cir_samples = min(cir_samples, cir)
        self.shape = PulseShape(cir, shape_samples)
        self.figures = LevelFigures()
        self.features = MaranoFeatures(cir) if features and cir > NOISE_SAMPLES else None
        self.width = (
            len(LEVEL_FIGURES) * ("levels" in widths)
            + widths.get("range", 0)
            + widths.get("settings", 0)
            + len(FEATURES) * (self.features is not None)
            + self.cir_samples
            + self.shape.samples
        )

    def compute(self, blocks: dict[str, Tensor]) -> Tensor:
        """Return the table."""
        parts = [self.figures(blocks["levels"])] if "levels" in blocks else []
        parts += [blocks[name] for name in ("range", "settings") if name in blocks]
        if self.features is not None:
            parts.append(self.features(blocks["cir"]))
        if self.cir_samples:
            parts.append(blocks["cir"][:, : self.cir_samples])
        if self.shape.samples:
            parts.append(self.shape(blocks["cir"]))
        return torch.cat(parts, 1) if len(parts) > 1 else parts[0]


class StandardiseKnown(nn.Module):
    """Standardise columns [n, c] by their known training values; unknown ones become the mean, 0.

    Held within five standard deviations: a level far from any seen in training should not carry
    a network far from what it has learnt.
    """

    mean: Tensor
    std: Tensor

    def __init__(self, columns: int) -> None:
        super().__init__()
        self.register_buffer("mean", torch.zeros(columns))
        self.register_buffer("std", torch.ones(columns))

    def fit(self, values: Tensor) -> None:
        """Take mean and standard deviation of what is known in training rows [n, c]."""
        values = values.double()
        known = ~values.isnan()
        count = known.sum(0).clamp_min(1)
        mean = torch.where(known, values, 0.0).sum(0) / count
        std = (torch.where(known, values - mean, 0.0).square().sum(0) / count).sqrt()
        self.mean.copy_(mean)
        self.std.copy_(torch.where(std <= 1e-6 * mean.abs() + 1e-12, 1.0, std))

    def forward(self, x: Tensor) -> Tensor:
        """Return standardised rows without NaN."""
        z = (x - self.mean) / self.std
        z = torch.where(torch.isnan(z), torch.zeros_like(z), z)
        return z.clamp(-5.0, 5.0)


class Table(BlockModule):
    """`Columns`, standardised: what networks and kernels on a few figures take."""

    def __init__(self, columns: Columns) -> None:
        super().__init__(columns.inputs)
        self.columns, self.scaling = columns, StandardiseKnown(columns.width)

    def compute(self, blocks: dict[str, Tensor]) -> Tensor:
        """Return standardised figures [n, columns]."""
        scaled: Tensor = self.scaling(self.columns.compute(blocks))
        return scaled

    def fit(self, rows: Floats) -> Floats:
        """Fit the scaling on rows [n, width] and return the prepared rows."""
        values = apply_in_blocks(self.columns, rows)
        self.scaling.fit(values)
        return apply_in_blocks(self.scaling, values.numpy()).numpy()


class BlockError(BlockModule):
    """A fitted model of several inputs as one module: preparation, then network.

    A network that gives [n, 2] (error, logarithm of its standard deviation) makes the module give
    two results: errors [n] and standard deviations [n], both in metres.
    """

    def __init__(self, preparation: BlockModule, network: nn.Module, spread: bool = False) -> None:
        super().__init__(preparation.inputs)
        self.preparation, self.network, self.spread = preparation, network, spread

    def compute(self, blocks: dict[str, Tensor]) -> Tensor | tuple[Tensor, Tensor]:
        """Return the errors [n] in metres, with their standard deviations where there are such."""
        result: Tensor = self.network(self.preparation.compute(blocks))
        if not self.spread:
            return result
        return result[:, 0], torch.exp(result[:, 1])


class Side(BlockModule):
    """CIR bins scaled by one number, and beside them standardised level figures and range.

    `shape_samples` of the CIR in dB too. [n, bins + side]. Raises ValueError where the CIR has
    fewer than `cir_samples` bins.
    """

    def __init__(self, inputs: Sequence[Input], cir_samples: int, shape_samples: int = 0) -> None:
        super().__init__(inputs)
        widths = {one.name: one.width for one in inputs}
        self.crop = Crop(widths.get("cir", 0), 0, cir_samples)
        self.scale = GlobalScale()
        self.columns = Columns(inputs, features=False, shape_samples=shape_samples)
        self.scaling = StandardiseKnown(self.columns.width)
        self.bins, self.side = cir_samples, self.columns.width

    def compute(self, blocks: dict[str, Tensor]) -> Tensor:
        """Return bins and side figures [n, bins + side]."""
        side = self.scaling(self.columns.compute(blocks))
        return torch.cat([self.scale(self.crop(blocks["cir"])), side], 1)

    def fit(self, rows: Floats) -> Floats:
        """Fit both scalings on rows [n, width] and return the prepared rows."""
        cir = next(one.width for one in self.inputs if one.name == "cir")
        self.scale.fit(apply_in_blocks(self.crop, rows[:, :cir]))
        self.scaling.fit(apply_in_blocks(self.columns, rows))
        return apply_in_blocks(self, rows).numpy()
