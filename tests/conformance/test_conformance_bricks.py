"""Every check on every brick."""

from __future__ import annotations

import pytest
from conformance_checks import CHECKS, OpenBrick


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
def test_conformance(check, open_brick: OpenBrick):
    check(open_brick)
