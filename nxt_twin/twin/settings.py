"""The twin's noise, and the limits from which it reports."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True)
class MotorNoise:
    """The noise of a motor whose model holds.

    Attributes:
        torque_nm: standard deviation of the torque that no model has (friction is never quite smooth).
        torque_time_s: how long that torque lasts.
        sought_torque_nm: standard deviation of the torque that the tracking filter looks for.
        reading_deg: of a reading, beside its whole degrees.
        quantum_deg: a count of the encoder.
    """

    torque_nm: float = 4e-3
    torque_time_s: float = 0.15
    sought_torque_nm: float = 2e-2
    reading_deg: float = 0.1
    quantum_deg: float = 1.0


@final
@dataclass(frozen=True)
class Pace:
    """When, between a request and its reply, the brick does what was asked.

    The firmware (LEGO, 1.29) runs in passes of 1 ms. It answers with the count of the pass before, and hands
    commands to the motor bridges in every second pass.

    Attributes:
        share: of the round trip that has passed when the brick takes the request up.
        share_std: its standard deviation.
        count_age_s: how old a count is by then.
        command_lag_s: how long, on average, a command takes from then on to reach the motor.
    """

    share: float = 0.5
    share_std: float = 0.15
    count_age_s: float = 1e-3
    command_lag_s: float = 0.5e-3


BATTERY_AGE_S = 0.167
"""How old the battery's voltage may be when the brick tells it: the firmware measures it so seldom."""

AT_ARRIVAL = Pace(share=1.0, share_std=0.0, count_age_s=0.0, command_lag_s=0.0)
"""Of a recording: what stands in a row is as of its stamp."""

PACES = {"usb": Pace(), "mock": Pace(), "bt": Pace(0.3, 0.1), "serial": Pace(0.3, 0.1), "tcp": Pace(0.4, 0.2)}
"""By a URL's scheme. Over Bluetooth the radio switches directions after the reading was taken."""


def pace_of(url: str) -> Pace:
    """That of the link a URL names; of one that is not known, as of USB."""
    return PACES.get(url.partition(":")[0], Pace())


FALSE_ALARMS_PER_HOUR = 0.25
"""What is stated: at most so many divergences an hour and motor are called where the model holds. Counted, on motors
of another simulator, by `python -m benchmarks.twin_alarms`."""


@final
@dataclass(frozen=True)
class Watch:
    """When the monitor speaks up; docs/live.md says how the thresholds were set, and what they cost.

    Attributes:
        alarm_nats: evidence for a missing torque at which a divergence is called.
        doubt: probability of the model, beside the effects that are weighed, below which it is doubted.
        doubt_s: how long it has to be so.
        most_nats: what one reading can add to it.
        calm_s: how long a motor has to move without new evidence until all is said to be well again.
        gate: the largest normalised squared innovation of a reading that is believed.
        rejected_most: readings in a row that are disbelieved before the filter doubts itself instead.
        stray_most: readings, within `stray_s`, that no motion explains, at which a divergence is called.
        stray_s: how long such a reading counts.
        stall_s: how long a driven motor has to stand still until it is said to be blocked.
        stall_power_pct: from which power on.
        low_battery_v: below which the battery is too low.
    """

    alarm_nats: float = 10.0
    doubt: float = 0.1
    doubt_s: float = 0.25
    most_nats: float = 4.0
    calm_s: float = 10.0
    gate: float = 25.0
    rejected_most: int = 4
    stray_most: int = 8
    stray_s: float = 10.0
    stall_s: float = 0.5
    stall_power_pct: float = 25.0
    low_battery_v: float = 6.5
