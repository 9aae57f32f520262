"""Estimates, findings, notes and sentences: the answer in words and in JSON."""
