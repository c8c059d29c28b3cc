"""REMnet trained in compiled kernels; numba is loaded only when something is trained."""

from zoo.training.fused_remnet.fit import train, train_many, why_not

__all__ = ["train", "train_many", "why_not"]
