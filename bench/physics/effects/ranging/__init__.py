"""Effects on timestamps and ranges: clocks, antennas, calibration."""
