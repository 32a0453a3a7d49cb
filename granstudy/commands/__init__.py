"""The command `granstudy`: studies from a terminal."""
