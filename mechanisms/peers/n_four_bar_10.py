"""As n_four_bar.py: the number of four-bars follows from the coordinates."""

from pathlib import Path

exec(Path(__file__).with_name("n_four_bar.py").read_text(encoding="utf-8"))
