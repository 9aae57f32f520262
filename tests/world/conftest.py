"""These need PyBullet, which there is for Python 3.11 alone; `make test` has it."""

from __future__ import annotations

import pytest

pytest.importorskip("pybullet", reason="pip install 'nxt-twin[world]', on Python 3.11")
