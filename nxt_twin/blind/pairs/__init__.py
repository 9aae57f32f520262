"""Recordings before and after somebody touched a motor, with sealed answers: what `changed` is scored on."""
