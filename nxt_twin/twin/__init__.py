"""Brick and model side by side: what is measured, what was predicted, and what the difference means."""
