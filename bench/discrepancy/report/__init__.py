"""A diagnosis as Markdown, JSON, TOML and pictures."""
