"""Which set of effects waveforms speak for: all statistics of a link are compared at once."""
