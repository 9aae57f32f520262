"""Simulators that all tests of the physics share: a kernel is compiled or loaded once."""

import pytest

from nxt_twin.physics.layout import layout
from nxt_twin.physics.simulate import Simulator


@pytest.fixture(scope="session")
def motor_simulator():
    with Simulator(layout("dc_motor", "motor"), workers=1) as simulator:
        yield simulator


@pytest.fixture(scope="session")
def rotary_simulator():
    with Simulator(layout("rigid_body", "rotary"), workers=1) as simulator:
        yield simulator


@pytest.fixture(scope="session")
def linear_simulator():
    with Simulator(layout("rigid_body", "linear"), workers=1) as simulator:
        yield simulator


@pytest.fixture(scope="session")
def servo_simulator():
    with Simulator(layout("servo", "motor"), workers=1) as simulator:
        yield simulator
