"""``python -m slipmargin`` is the ``slipmargin`` command."""

from slipmargin_cli import run

if __name__ == "__main__":
    run()
