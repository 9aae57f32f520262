import pytest

from nxt_twin.experiment.errors import PositionerError, StoppedError
from nxt_twin.experiment.positioner.by_hand import ByHand
from nxt_twin.experiment.positioner.positioner import Limits
from nxt_twin.experiment.positioner.rail import Rail, RailSetUp
from nxt_twin.experiment.standin.hand import Hand
from nxt_twin.experiment.standin.rig import Carriage
from nxt_twin.experiment.standin.workbench import Workbench, workbench
from nxt_twin.mock.body.course import TargetCourse
from nxt_twin.mock.body.world import World

MM_PER_DEG = 0.3


def rail_on(bench: Workbench, **changes: object) -> Rail:
    return Rail(bench.brick, 1, RailSetUp(MM_PER_DEG, **changes), "distance_mm", bench.clock)  # type: ignore[arg-type]


def test_a_hand_is_asked_for_the_value_and_may_tell_another() -> None:
    hand = Hand(lambda value: None if value < 100 else value + 0.5)
    positioner = ByHand("distance_mm", hand)
    assert positioner.move_to(50.0) == 50.0
    assert positioner.move_to(138.0) == 138.5
    assert "138 mm" in hand.asked[1]


def test_a_hand_is_asked_again_until_it_says_something_sensible() -> None:
    answers = iter(["what?", "99999", "12,5"])
    assert ByHand("distance_mm", lambda _: next(answers)).move_to(12.0) == 12.5


def test_a_hand_can_end_it() -> None:
    with pytest.raises(StoppedError):
        ByHand("angle_deg", lambda _: "q").move_to(5.0)


def test_nobody_is_asked_to_go_beyond_the_limits() -> None:
    hand = Hand(lambda _: None)
    with pytest.raises(PositionerError, match="outside"):
        ByHand("force_g", hand, Limits(0.0, 100.0)).move_to(150.0)
    assert hand.asked == []


def test_a_rail_arrives_where_it_says_in_spite_of_play() -> None:
    bench = workbench()
    carriage = Carriage(bench.body, 1, MM_PER_DEG, play_deg=12.0)
    rail = rail_on(bench, play_deg=12.0, power_pct=50)
    for target in (80.0, 81.0, 40.0, 39.0, 150.0, 60.0):
        reached = rail.move_to(target)
        assert reached == pytest.approx(target, abs=2.5 * MM_PER_DEG)
        assert carriage.place_mm() == pytest.approx(reached, abs=1.5 * MM_PER_DEG)


def test_a_rail_finds_its_end_by_touch() -> None:
    bench = workbench()
    carriage = Carriage(bench.body, 1, MM_PER_DEG, play_deg=15.0, start_mm=30.0)

    class Bumper:
        def at(self, time_s: float) -> float:
            return float(time_s >= 0.0 and carriage.place_mm() <= 2.0)

    bench.body.sensors[0].pressed = Bumper()
    rail = rail_on(bench, homing="touch", home_value=2.0, play_deg=15.0)
    rail.move_to(50.0)
    assert carriage.place_mm() == pytest.approx(50.0, abs=3.0)


def test_a_rail_that_is_stuck_lets_go_and_says_so() -> None:
    stuck = {"kind": "dc_motor", "resistance_ohm": 7.6, "torque_constant_nm_per_a": 0.49,
             "back_emf_v_s_per_rad": 0.49, "coulomb_friction_nm": 2.0, "inertia_kg_m2": 1e-3}  # fmt: skip
    bench = workbench(World.model_validate({"motors": {"b": stuck}}))
    with pytest.raises(PositionerError, match="stuck"):
        rail_on(bench).move_to(50.0)
    assert bench.brick.motors.read(1).value.mode == 0


def test_a_rail_that_finds_no_end_gives_up() -> None:
    bench = workbench()
    bench.body.sensors[0].pressed = TargetCourse([(0.0, 0.0)])
    with pytest.raises(PositionerError, match="no end"):
        rail_on(bench, homing="touch")
    assert bench.brick.motors.read(1).value.mode == 0


def test_a_rail_without_a_gear_ratio_is_refused() -> None:
    bench = workbench()
    with pytest.raises(PositionerError, match="no rail"):
        Rail(bench.brick, 1, RailSetUp(0.0), "distance_mm", bench.clock)


def test_a_rail_refuses_what_is_out_of_its_limits_without_moving() -> None:
    bench = workbench()
    rail = Rail(bench.brick, 1, RailSetUp(1.0), "distance_mm", bench.clock, Limits(0.0, 100.0))
    with pytest.raises(PositionerError, match="outside"):
        rail.move_to(101.0)
    assert bench.brick.motors.tacho_deg(1).value == 0
