from __future__ import annotations

import pytest
from mock_rig import Rig


@pytest.fixture
def rig() -> Rig:
    return Rig()
