"""What lets a stopped diagnosis go on: a journal of finished steps, as plain JSON."""
