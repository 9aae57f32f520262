"""The gains of a prediction-error run against a Kalman filter written out here."""

import math
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from physics_samples import commanded, nxt
from scipy.linalg import expm, solve_discrete_are

from nxt_twin.physics.observer import Noise, carried, corrected, free, free_run_std, observer, slips
from nxt_twin.physics.simulate import Job
from nxt_twin.physics.smooth import half_window_s
from nxt_twin.physics.start import at_rest, restarts

NOISE = Noise(reading_std=5e-3, disturbance_std=5.0, disturbance_time_s=0.4, damping_per_s=2.0)


def with_readings(values, *, every_s=0.01, **changes):
    run = commanded([(0.0, 0.0)], seconds=(len(values) - 1) * every_s, every_s=every_s)
    return replace(run, measured=np.array(values, dtype=float), **changes)


def discrete(noise, dt):
    """Exact transition and process noise of angle, speed and an Ornstein-Uhlenbeck acceleration (Van Loan 1978)."""
    leak = 1.0 / noise.disturbance_time_s
    rates = np.array([[0.0, 1.0, 0.0], [0.0, -noise.damping_per_s, 1.0], [0.0, 0.0, -leak]])
    density = np.diag([0.0, 0.0, 2.0 * leak * noise.disturbance_std**2])
    block = expm(np.block([[-rates, density], [np.zeros((3, 3)), rates.T]]) * dt)
    transition = block[3:, 3:].T
    return transition, transition @ block[:3, 3:]


def kalman_gains(signals, noise, read=0):
    slope_std = 2.0 * noise.reading_std / half_window_s(signals)
    covariance = np.diag([noise.reading_std, slope_std, noise.disturbance_std]) ** 2
    watch = np.eye(3)[read]
    gains, stds = [np.zeros(3)], [noise.reading_std]
    for dt, reading in zip(np.diff(signals.time_s), signals.measured[1:], strict=True):
        transition, process = discrete(noise, dt)
        covariance = transition @ covariance @ transition.T + process
        variance = watch @ covariance @ watch + noise.reading_std**2
        gain = covariance @ watch / variance if math.isfinite(reading) else np.zeros(3)
        keep = np.eye(3) - np.outer(gain, watch)
        covariance = keep @ covariance @ keep.T + noise.reading_std**2 * np.outer(gain, gain)
        gains.append(gain)
        stds.append(math.sqrt(variance))
    return np.array(gains), np.array(stds)


@pytest.mark.parametrize("is_speed", [False, True])
def test_the_gains_are_a_kalman_filter_s(is_speed):
    rng = np.random.default_rng(2)
    signals = with_readings(np.where(rng.random(120) < 0.2, np.nan, 0.0), is_speed=is_speed)
    signals.measured[0] = 0.0
    found = observer(signals, NOISE)
    gains, stds = kalman_gains(signals, NOISE, read=int(is_speed))
    observed = slice(int(is_speed), None)  # speeds say nothing of where it stands
    off = np.abs(found.gains - gains) / np.abs(gains).max(axis=0)
    assert off[:, observed].max() < 0.03
    np.testing.assert_allclose(found.innovation_std, stds, rtol=0.02)


def test_the_gains_settle_at_those_of_the_riccati_equation():
    signals = with_readings(np.zeros(400))
    transition, process = discrete(NOISE, 0.01)
    watch = np.array([[1.0, 0.0, 0.0]])
    settled = solve_discrete_are(transition.T, watch.T, process, np.array([[NOISE.reading_std**2]]))
    expected = settled[:, 0] / (settled[0, 0] + NOISE.reading_std**2)
    np.testing.assert_allclose(observer(signals, NOISE).gains[-1], expected, rtol=0.03)


def test_a_row_without_a_reading_corrects_nothing_and_the_doubt_grows():
    readings = np.zeros(100)
    readings[40:60] = np.nan
    found = observer(with_readings(readings), NOISE)
    assert np.all(found.gains[40:60] == 0.0)
    assert np.all(np.diff(found.innovation_std[40:61]) > 0.0)
    assert found.innovation_std[70] < found.innovation_std[60]


def test_counts_lost_at_random_open_the_angle_by_what_was_turned():
    turned = with_readings(np.repeat([0.0, 2.0], 40))
    slipping = replace(NOISE, slip=1e-3)
    prompt, loose = (observer(turned, noise) for noise in (NOISE, slipping))
    np.testing.assert_array_equal(prompt.innovation_std[:40], loose.innovation_std[:40])
    assert loose.innovation_std[40] ** 2 - prompt.innovation_std[40] ** 2 == pytest.approx(2e-3)
    assert loose.gains[40, 0] > prompt.gains[40, 0]
    np.testing.assert_array_equal(slips(replace(turned, is_speed=True), slipping), 0.0)
    assert slips(with_readings([0.0, np.nan, 3.0]), slipping).sum() == pytest.approx(3e-3)


def test_worse_readings_are_followed_less():
    signals = with_readings(np.zeros(100))
    rough = Noise(5e-2, NOISE.disturbance_std, NOISE.disturbance_time_s, NOISE.damping_per_s)
    assert np.all(observer(signals, rough).gains[-1] < observer(signals, NOISE).gains[-1])


def test_a_free_run_s_doubt_grows_from_each_restart():
    signals = with_readings(np.zeros(200))
    start = restarts(signals, 0.5)
    std = free_run_std(signals, NOISE, start)
    anew = np.flatnonzero(start.at)
    np.testing.assert_array_equal(anew, [0, 50, 100, 150])
    assert np.all(np.diff(std)[np.setdiff1d(np.arange(199), anew - 1)] > 0.0)
    np.testing.assert_allclose(std[49], std[99], rtol=1e-6)
    assert free(signals, 0.1).gains.any() == np.False_


def test_innovations_of_a_plant_that_is_right_are_as_large_as_foretold(motor_simulator):
    rng = np.random.default_rng(4)
    run = commanded([(0.0, 0.6), (1.0, -0.6), (2.0, 0.3)], seconds=3.0)
    clean = motor_simulator.trace(nxt(), Job(run, free(run, 0.0), at_rest(run)))["predicted"]
    noisy = clean + rng.normal(0.0, 5e-3, clean.size)
    signals = replace(run, measured=noisy)
    noise = Noise(5e-3, 0.05, 0.15, 26.0)
    gains = observer(signals, noise)
    predicted = motor_simulator.trace(nxt(), Job(signals, gains, at_rest(signals), 0.15))["predicted"]
    ratio = ((noisy - predicted) / gains.innovation_std)[20:]
    assert np.mean(ratio**2) == pytest.approx(1.0, abs=0.2)


def test_a_correction_finds_a_torque_that_the_plant_does_not_know(motor_simulator):
    pushed = nxt(effects={"constant_load": {"load_torque_nm": 0.06}})
    run = commanded([(0.0, 0.5)], seconds=3.0)
    angle = motor_simulator.trace(pushed, Job(run, free(run, 0.0), at_rest(run)))["predicted"]
    signals = replace(run, measured=angle)
    gains = observer(signals, Noise(1e-3, 50.0, 5.0, 26.0))
    trace = motor_simulator.trace(nxt(), Job(signals, gains, at_rest(signals), 5.0))
    assert trace["disturbance"][-1] * 1.2e-3 == pytest.approx(0.06, rel=0.05)
    assert abs(trace["predicted"][-1] - angle[-1]) < 1e-3


TRIANGLE = np.triu_indices(3)


def whole(triangle):
    """The symmetric matrix whose upper triangle this is, row by row."""
    matrix = np.zeros((3, 3))
    matrix[TRIANGLE] = triangle
    return matrix + np.triu(matrix, 1).T


@pytest.mark.parametrize(("seed", "damping"), [(0, 4.0), (1, 4.0), (2, 0.5), (3, 0.0)])
def test_a_covariance_is_carried_and_corrected_as_with_matrices(seed, damping):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(3, 3))
    before, dt, leak, torque_var = root @ root.T, 0.03, 2.5, 7.0
    hold, forget = math.exp(-damping * dt), math.exp(-leak * dt)
    gain, fresh = (1.0 - hold) / damping if damping else dt, torque_var * (1.0 - forget**2)
    transition = np.array([[1.0, gain, 0.5 * dt**2], [0.0, hold, gain], [0.0, 0.0, forget]])
    process = whole([0.0, 0.0, 0.0, fresh * dt**2 / 3.0, 0.5 * fresh * dt, fresh])
    after = transition @ before @ transition.T + process
    found = carried(tuple(before[TRIANGLE]), dt, damping, leak, torque_var)
    np.testing.assert_allclose(whole(found), after, rtol=1e-12)
    for reads_speed in (False, True):
        watch = np.eye(3)[int(reads_speed)]
        variance = watch @ after @ watch + 0.2
        gains = after @ watch / variance
        left, told_gains, told_variance = corrected(tuple(after[TRIANGLE]), reads_speed, 0.2)
        np.testing.assert_allclose(told_gains, gains, rtol=1e-12)
        assert told_variance == pytest.approx(variance)
        np.testing.assert_allclose(whole(left), after - np.outer(gains, watch @ after), rtol=1e-9, atol=1e-12)


def test_noise_has_no_systematic_error_unless_told_and_never_changes():
    assert NOISE.drift == 1.0
    with pytest.raises(FrozenInstanceError):
        NOISE.drift = 2.0
    with pytest.raises(FrozenInstanceError):
        free(with_readings(np.zeros(3)), 0.1).gains = None


@pytest.mark.parametrize("damping_per_s", [0.0, 2.0, 200.0])
def test_a_speed_that_is_open_opens_the_angle_by_the_way_to_rest(damping_per_s):
    open_speed = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0)
    way = -math.expm1(-0.02 * damping_per_s) / damping_per_s if damping_per_s else 0.02
    angle, *_ = carried(open_speed, 0.02, damping_per_s, 1.0, 0.0)
    assert angle == pytest.approx(way**2, rel=1e-9)
