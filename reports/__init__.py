"""Result files -> Markdown and figures. Knows result files, never models."""
