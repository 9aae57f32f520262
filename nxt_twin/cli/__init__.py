"""The command line: one command a file."""

from nxt_twin.cli.app import main

__all__ = ["main"]
