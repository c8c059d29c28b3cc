"""Effects on the waveform: what the receiver does to every path alike."""
