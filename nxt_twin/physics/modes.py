"""The modes of a motor: driven through a bridge, let go, or driven by a source of its own."""

from __future__ import annotations

MODE_DRIVE = 0
MODE_FLOAT = 1
MODE_COAST = 2
MODE_BRAKE = 3
MODE_VOLTAGE = 4
MODE_CURRENT = 5
