"""A small network in the form that the C generator writes, and what it gives."""

from __future__ import annotations

import numpy as np

SAMPLES = 157
HEADER = """#ifndef UWB_PREDICT_H
#define UWB_PREDICT_H
#define UWB_PREDICT_SAMPLES 157
#define UWB_PREDICT_ARENA_BYTES 1256
int uwb_predict(const float cir[UWB_PREDICT_SAMPLES], float *error_m);
#endif
"""
SOURCE = """#include <string.h>
#include "uwb_predict.h"
#define LAYER static __attribute__((noinline))
static float arena[314];
static const float taps[5] = {0.125f, -0.25f, 0.5f, 0.25f, 0.0625f};
LAYER void uwb_layer_00_move(const float *cir) { memcpy(arena, cir, 157 * sizeof(float)); }
LAYER void uwb_layer_01_conv(void) {
  for (int i = 0; i < 153; i++) {
    float sum = 0.0f;
    for (int k = 0; k < 5; k++) sum += taps[k] * arena[i + k];
    arena[157 + i] = sum;
  }
}
LAYER float uwb_layer_02_reduce(void) {
  float sum = 0.0f;
  for (int i = 0; i < 153; i++) sum += arena[157 + i];
  return sum / 128.0f;
}
int uwb_predict(const float cir[UWB_PREDICT_SAMPLES], float *error_m) {
  uwb_layer_00_move(cir);
  uwb_layer_01_conv();
  *error_m = uwb_layer_02_reduce();
  return 0;
}
"""
FILES = {"uwb_predict.c": SOURCE, "uwb_predict.h": HEADER}


def cirs(rows: int) -> np.ndarray:
    return np.random.default_rng(5).integers(0, 4096, (rows, SAMPLES)).astype(np.float32)


def expected_m(rows: np.ndarray) -> np.ndarray:
    """Exact in float32: the inputs are small integers, the taps powers of two."""
    taps = np.array([0.125, -0.25, 0.5, 0.25, 0.0625])
    sums = [np.convolve(row.astype(np.float64), taps[::-1], "valid").sum() for row in rows]
    return (np.array(sums) / 128).astype(np.float32)
