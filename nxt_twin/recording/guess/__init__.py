"""Guess what the columns of a stranger's table are, and say why."""
