"""Four diagnoses of a small simulated motor, as the engine could have made them."""

import math
from dataclasses import replace
from functools import cache

import numpy as np

from nxt_twin.api.files import load_plant
from nxt_twin.diagnose.changed.answer import Change, Changes
from nxt_twin.diagnose.diagnosis import (
    Alternative,
    Confusion,
    Diagnosis,
    DrivenPath,
    Estimate,
    Fit,
    FoundEffect,
    HeldOutRun,
    Leftover,
    Mismatch,
    Moved,
    NextExperiment,
    RegimeFinding,
    Spell,
    Tolerance,
)

PERIOD_S = 0.01


def duty(seed, samples):
    rng = np.random.default_rng(seed)
    lengths = rng.integers(30, 90, size=samples // 30 + 1)
    return np.repeat(rng.integers(-6, 7, size=lengths.size) * 12.0, lengths)[:samples]


def motor_deg(power_pct, *, friction=11.0, stiction=0.0, gravity=0.0, bump=0.0):
    """Angle of a DC motor in degrees: first-order lag, Coulomb friction and what is asked for on top."""
    angle, speed, out = 0.0, 0.0, []
    fine = 5
    step_s = PERIOD_S / fine
    for power in power_pct.tolist():
        out.append(angle)
        for _ in range(fine):
            drive = (
                36.0 * 0.078 * power
                - 18.0 * speed
                - gravity * math.sin(angle)
                - bump * math.sin(3 * angle) * speed
            )
            limit = friction + stiction * math.exp(-((speed / 1.2) ** 2))
            free = speed + step_s * drive
            speed = math.copysign(max(0.0, abs(free) - step_s * limit), free)
            angle += step_s * speed
    return np.degrees(out)


def held_out(name, seed, *, truth, improved, samples=1500, stale=False):
    rng = np.random.default_rng(seed + 1000)
    power = duty(seed, samples)
    measured = np.round(motor_deg(power, **truth) + rng.normal(0, 0.3, samples))
    lost = np.zeros(samples)
    if stale:
        lost = (rng.random(samples) < 0.04).astype(float)
        measured = np.where(lost > 0, measured - rng.normal(0, 60, samples), measured)
    baseline = motor_deg(power)
    better = motor_deg(power, **improved) if improved else baseline
    kept = lost < 0.5
    return HeldOutRun(
        recording=name,
        time_s=np.arange(samples) * PERIOD_S,
        command=power,
        command_label="power (%)",
        measured=measured,
        baseline=baseline,
        improved=better,
        stale=lost,
        baseline_rmse=float(np.sqrt(np.mean((baseline - measured)[kept] ** 2))),
        improved_rmse=float(np.sqrt(np.mean((better - measured)[kept] ** 2))),
    )


def leftover(shape_before, shape_after, samples=6000):
    rng = np.random.default_rng(7)
    time_s = np.arange(samples) * PERIOD_S
    speed = 7 * np.sin(0.9 * time_s) + 4 * np.sin(2.3 * time_s)
    position = np.degrees(np.cumsum(speed) * PERIOD_S)
    noise = rng.normal(0, 0.0016, (2, samples))
    return Leftover(
        unit="N·m",
        speed_unit="rad/s",
        position_unit="deg",
        time_s=time_s % 20.0,
        speed=speed,
        position=position,
        before=shape_before(speed, position) + noise[0],
        after=shape_after(speed, position) + noise[1],
    )


def overall(runs, floor=0.42):
    def together(values):
        return float(np.sqrt(np.mean(np.square(values))))

    return Fit(
        "free-run RMSE, held-out",
        "deg",
        together([run.baseline_rmse for run in runs]),
        together([run.improved_rmse for run in runs]),
        floor,
    )


STICTION = FoundEffect(
    id="stiction",
    name="Stribeck stiction",
    equation="|τ| = Tc + (Ts - Tc)·exp(-(ω/ωs)²), Ts at rest",
    params={
        "breakaway_torque_nm": Estimate(0.0312, 0.0021, "N·m"),
        "stribeck_speed_rad_s": Estimate(1.18, 0.09, "rad/s"),
    },
    probability=0.9997,
    confusable_with=(
        Confusion(
            "presliding", "both act in the first degrees after a reversal; these runs rarely rest there"
        ),
    ),
)

GRAVITY = FoundEffect(
    id="gravity_load",
    name="gravity load of an unbalanced arm",
    equation="τ = -τg·sin(θ + φ)",
    params={"gravity_torque_nm": Estimate(0.0171, 0.0006, "N·m"), "phase_deg": Estimate(-3.2, 2.4, "deg")},
    probability=0.93,
    confusable_with=(),
)

REFIT = {
    "viscous_friction_nm_s_per_rad": Moved(0.00192, 0.0021, 0.00004, "N·m·s/rad"),
    "coulomb_friction_nm": Moved(0.00845, 0.0132, 0.0004, "N·m"),
    "inertia_kg_m2": Moved(0.0012, 0.00119, 0.00002, "kg·m²"),
}

REGIMES = (
    RegimeFinding("low_speed", 14.2, 1e-30),
    RegimeFinding("reversal", 8.8, 2.1e-9),
    RegimeFinding("angle_periodic", 6.1, 3e-5),
    RegimeFinding("high_speed", 0.7, 0.48),
)

ANCHOR = "Physical units rest on one anchor: the torque constant 0.4908 N·m/A was taken from the plant file."


@cache
def explained(runs=5, samples=1500, name="arm-on-port-a"):
    truth = {"stiction": 14.0, "gravity": 13.0}
    found = {"stiction": 13.4, "gravity": 13.2}
    held = tuple(
        held_out(f"run_{seed:02d}.csv", seed, truth=truth, improved=found, samples=samples)
        for seed in range(1, runs + 1)
    )
    end_s = samples * PERIOD_S
    when = tuple(
        Spell(run.recording, share * end_s, (share + 0.07) * end_s, strength)
        for run in held
        for share, strength in ((0.22, 12.4), (0.61, 7.9))
    )
    return Diagnosis(
        name=name,
        verdict="explained",
        sentence="The model lacks stiction and an arm that is off balance; "
        "with both it predicts new runs to within a degree or two.",
        refit=REFIT,
        mismatch=Mismatch("a_tacho_deg", when, REGIMES, "torque_balance"),
        effects=(STICTION, GRAVITY),
        alternatives=(
            Alternative("presliding + gravity_load", 0.02, 4.1),
            Alternative("stiction + cogging", 0.0004, 11.9),
        ),
        fit=overall(held),
        next_experiment=NextExperiment(
            why="Presliding and stiction differ only below 0.5 rad/s, where these runs hardly dwell.",
            input="Ramp the power from 0 to 30 % and back in 20 s, in both directions, five times.",
        ),
        notes=(ANCHOR, "run_03.csv stays at 9 deg: its battery fell below 7 V in the last seconds."),
        held_out=held,
        leftover=leftover(
            lambda speed, angle: (
                -0.018 * np.exp(-((speed / 1.4) ** 2)) * np.sign(speed) - 0.017 * np.sin(np.radians(angle))
            ),
            lambda speed, _: 0.0 * speed,
        ),
    )


@cache
def adequate():
    held = tuple(
        held_out(f"run_{seed:02d}.csv", seed, truth={}, improved=None, samples=900) for seed in range(1, 4)
    )
    return Diagnosis(
        name="bare-motor",
        verdict="adequate",
        sentence="Nothing is missing: with its friction re-fitted, the model predicts new runs to the noise.",
        refit=REFIT,
        mismatch=Mismatch("a_tacho_deg", (), (), None),
        effects=(),
        alternatives=(),
        fit=overall(held),
        next_experiment=None,
        notes=(),
        held_out=held,
        leftover=leftover(lambda speed, _: 0.0 * speed, lambda speed, _: 0.0 * speed),
    )


@cache
def unexplained(*, helped=False):
    effects = (STICTION,) if helped else ()
    truth = {"bump": 6.0}
    held = tuple(
        held_out(f"run_{seed:02d}.csv", seed, truth=truth, improved={"bump": 2.5} if effects else None)
        for seed in range(1, 4)
    )
    return Diagnosis(
        name="mystery-axle",
        verdict="unexplained",
        sentence="Something is missing that no known effect accounts for: "
        "a torque that comes three times a turn and grows with speed.",
        refit=REFIT,
        mismatch=Mismatch(
            "a_tacho_deg", (Spell("run_02.csv", 3.1, 3.9, 21.5),), REGIMES[1:], "torque_balance"
        ),
        effects=effects,
        alternatives=(
            Alternative("cogging", 0.11, 38.2),
            Alternative("angle_dependent_friction", 0.06, 41.0),
        ),
        fit=overall(held),
        next_experiment=NextExperiment(
            "Speed and angle went together here.", "Five turns at each of 20, 40, 60 %."
        ),
        notes=(ANCHOR,),
        held_out=held,
        leftover=leftover(
            lambda speed, angle: -0.004 * speed * np.sin(3 * np.radians(angle)),
            lambda speed, angle: (-0.003 if helped else -0.004) * speed * np.sin(3 * np.radians(angle)),
        ),
    )


def brief(diagnosis):
    """With one held-out run alone: a page that is drawn sooner."""
    return replace(diagnosis, held_out=diagnosis.held_out[:1])


@cache
def with_stale_samples():
    truth, found = {"stiction": 14.0, "gravity": 6.0}, {"stiction": 13.4, "gravity": 6.1}
    held = tuple(
        held_out(f"bluetooth_{seed}.csv", seed, truth=truth, improved=found, samples=700, stale=True)
        for seed in (21, 22)
    )
    return replace(
        explained(runs=1),
        name="over-bluetooth",
        sentence="The model lacks stiction; 4 % of the readings came late over the air and were left out.",
        effects=(STICTION,),
        alternatives=(),
        held_out=held,
        fit=overall(held),
        mismatch=Mismatch(
            "a_tacho_deg", (Spell("bluetooth_21.csv", 2.0, 2.6, 9.0),), REGIMES[:1], "torque_balance"
        ),
        leftover=None,
    )


@cache
def of_sensor():
    """As of an ultrasonic sensor on a rig."""
    rng = np.random.default_rng(3)
    true_mm = np.linspace(50.0, 1500.0, 400)
    measured = np.round(0.1 * true_mm + 1.5 + rng.normal(0.0, 0.4, true_mm.size))
    run = HeldOutRun(
        recording="rig_with_a_long_name_of_its_own_01.csv",
        time_s=np.arange(true_mm.size) * 0.1,
        command=true_mm,
        command_label="rig_distance_mm",
        measured=measured,
        baseline=0.1 * true_mm,
        improved=0.1 * true_mm + 1.5,
        stale=np.zeros(true_mm.size),
        baseline_rmse=1.56,
        improved_rmse=0.43,
    )
    return replace(
        explained(runs=1), name="sonar", held_out=(run,), leftover=None,
        mismatch=Mismatch("s4_ultrasonic_cm", (), (), "measurement"), fit=Fit("held-out RMSE", "cm", 1.56, 0.43, 0.4),
    )  # fmt: skip


@cache
def of_robot():
    """As of a robot that drove a square."""
    turn = np.linspace(0.0, 2.0 * np.pi, 600)
    measured = np.column_stack((np.sin(turn), np.cos(turn) - 1.0))
    path = DrivenPath(measured, 1.2 * measured, 1.1 * measured, 1.01 * measured)
    off_mm = [1e3 * np.linalg.norm(places - measured, axis=1) for places in (path.baseline, path.improved)]
    run = HeldOutRun(
        recording="held_out/square_231220200029_02.csv",
        time_s=np.arange(turn.size) * 0.1,
        command=0.1 + 0.02 * np.sin(5 * turn),
        command_label="speed of the wheels' middle (m/s)",
        measured=np.zeros(turn.size),
        baseline=off_mm[0],
        improved=off_mm[1],
        stale=np.zeros(turn.size),
        baseline_rmse=float(np.sqrt(np.mean(off_mm[0] ** 2))),
        improved_rmse=float(np.sqrt(np.mean(off_mm[1] ** 2))),
        path=path,
    )
    return replace(
        explained(runs=1), name="robot", held_out=(run,), leftover=None,
        mismatch=Mismatch("pose", (), (), None), fit=Fit("position error", "mm", 117.0, 11.7, 10.0),
    )  # fmt: skip


@cache
def changes():
    """A motor with more inertia and a spring after."""
    run = held_out("after_the_repair_of_the_arm_03.csv", 5, truth={"gravity": 9.0}, improved={"gravity": 8.8})
    inertia = Change("inertia_kg_m2", 1.2e-3, 1.92e-3, 4e-5, "kg·m²", (1.84e-3, 2.0e-3), 0.9998)
    load = Change(
        "gravity_load", None, 0.0171, 6e-4, "N·m", (0.0159, 0.0183), 0.93, params=GRAVITY.params
    )  # fmt: skip
    return Changes(
        name="after-the-repair",
        before="before",
        verdict="changed",
        sentence="The load changed: inertia 0.0012 to 0.00192 kg·m², and gravity load of an unbalanced arm came in.",
        changes=(inertia, load),
        refit=REFIT,
        effects=(GRAVITY,),
        fit=overall([run]),
        tolerance=Tolerance(0.5, "deg", 0.42),
        mismatch=Mismatch("a_tacho_deg", (), (), None),
        notes=("recordings of one side were made on another day",),
        held_out=(run,),
        plant=load_plant("nxt_motor"),
    )
