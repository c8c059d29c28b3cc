"""Training engines: plain, many at once, and fused."""
