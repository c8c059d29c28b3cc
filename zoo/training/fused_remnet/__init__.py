"""REMnet training with fused kernels."""
