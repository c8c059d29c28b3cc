"""Published forms of recordings, read into the exchange format."""
