"""Many networks of one architecture trained with one set of tensor calls."""

from zoo.training.stacked.fit import train_stacked, why_not

__all__ = ["train_stacked", "why_not"]
