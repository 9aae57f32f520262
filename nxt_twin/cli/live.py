"""`nxt-twin live`: brick and twin side by side."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nxt_twin.cli.compiling import tell_of_compiling
from nxt_twin.cli.output import JsonOption
from nxt_twin.cli.showing import Showing, ViewChoice

if TYPE_CHECKING:
    from nxt_twin.api.robots import WatchedRobot
    from nxt_twin.physics.robot.drive import DifferentialDrive
    from nxt_twin.recording.columns import Port
    from nxt_twin.recording.program import MotorProgram
    from nxt_twin.twin.legs import LegsDriver

_AS_SHIPPED = "1:touch,2:sound,3:light,4:ultrasonic"
_BUILT_IN = "excitation"
_PLANT = "nxt_motor"

PlantOption = Annotated[
    str | None, typer.Option(help="Model of the motors: a name or a YAML file; without: nxt_motor.")
]
SinceOption = Annotated[
    str | None,
    typer.Option(metavar="PLANT", help="The model of then: at the end, say what differs on each motor."),
]
RobotOption = Annotated[
    str | None,
    typer.Option(
        metavar="PLANT",
        help="A differential_drive: watch its ghost in mock:?world=FILE; without: the robot that the world's is like.",
    ),
]

ReportOption = Annotated[
    Path | None, typer.Option(help="Folder for HTML reports: the session, and each diagnosis of --adopt.")
]


def live(
    url: Annotated[str | None, typer.Argument(help="As for connect; without: the first brick found.")] = None,
    plant: PlantOption = None,
    since: SinceOption = None,
    ports: Annotated[str, typer.Option(help="Ports of the motors to watch.")] = "abc",
    sensors: Annotated[str, typer.Option(help="Such as 1:touch,4:ultrasonic; or none.")] = _AS_SHIPPED,
    program: Annotated[
        str, typer.Option(help="A motor program: file or name; none: only watch.")
    ] = _BUILT_IN,
    seconds: Annotated[
        float, typer.Option(min=0.0, help="Length of the session; 0: until Ctrl-C. The program repeats.")
    ] = 30.0,
    adopt: Annotated[bool, typer.Option("--adopt", help="Diagnose a divergence, adopt the model.")] = False,
    robot: RobotOption = None,
    out: Annotated[Path | None, typer.Option(help="Record the session: .csv or .parquet.")] = None,
    model_out: Annotated[Path | None, typer.Option(help="Write the adopted plant as YAML.")] = None,
    view: Annotated[ViewChoice, typer.Option(help="Dashboard: a window, in the browser, or none.")] = "none",
    save: Annotated[Path | None, typer.Option(help="Keep the dashboard's data: .rrd.")] = None,
    report: ReportOption = None,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask before motors turn.")] = False,
    json: JsonOption = None,
) -> None:
    """Watch a brick beside its model: readings, predictions, and the moment at which they diverge.

    By default the motors run a program of steps, ramps and rests, so put the robot on blocks. Ctrl-C ends the session,
    and the motors coast. The last line and the JSON give the verdict. Exit status 0 after any verdict; 1 if the brick
    cannot be reached or answers no poll; 2 for wrong use.
    """
    # The help of this command needs none of these, and they take a second.
    from nxt_twin.brick.clock import SystemClock
    from nxt_twin.cli.holding import LIVE_SCHEMA, hold
    from nxt_twin.cli.since import one_model, plants_since
    from nxt_twin.cli.wanted import chosen_url, get_leave, wanted_ports, wanted_sensors
    from nxt_twin.twin.live import LiveOptions
    from nxt_twin.twin.settings import pace_of

    wanted, clock = wanted_ports(ports), SystemClock()
    commanded = _program(program, wanted)
    slots = wanted_sensors(sensors)
    found = chosen_url(url, clock)
    drive, legs = _watched(robot, found, wanted, built_in=program == _BUILT_IN)
    if commanded is not None:
        get_leave(found, commanded.ports, yes=yes)
    tell_of_compiling()
    options = LiveOptions(
        plants=plants_since(one_model(since, plant) or _PLANT, wanted),
        sensors=slots,
        program=commanded,
        driver=legs,
        adopt=adopt,
        experiment=program == _BUILT_IN and legs is None,
        out=out,
        pace=pace_of(found),
    )
    showing = Showing(
        title=found, schema=LIVE_SCHEMA, view=view, save=save, report=report, model_out=model_out, since=since,
        json=json, world=drive is not None,
    )  # fmt: skip
    hold(found, options, seconds or None, showing, robot=_beside(drive, silent=json == "-"))


def _robot(name: str | None, url: str) -> DifferentialDrive | None:
    """The model of the robot in the world behind the URL, if there is one to be watched beside its ghost."""
    if not url.startswith("mock:?") or "world=" not in url:
        if name is not None:
            raise typer.BadParameter(
                "only a robot in mock:?world=FILE has a pose that can be seen", param_hint="--robot"
            )
        return None
    from nxt_twin.api.robots import usual_robot
    from nxt_twin.physics.robot.drive import drive_from_config
    from nxt_twin.recording.configs import load_plant_config

    name = name or usual_robot(url)
    return None if name is None else drive_from_config(load_plant_config(name))


def _watched(
    name: str | None, url: str, ports: tuple[Port, ...], *, built_in: bool
) -> tuple[DifferentialDrive | None, LegsDriver | None]:
    """The robot to be watched, and what drives it in the built-in program's place if both wheels may turn."""
    from nxt_twin.twin.legs import LegsDriver

    drive = _robot(name, url)
    if drive is None or not built_in or not {drive.left, drive.right} <= set(ports):
        return drive, None
    return drive, LegsDriver(drive.left, drive.right)


def _beside(drive: DifferentialDrive | None, *, silent: bool) -> WatchedRobot | None:
    if drive is None:
        return None
    from nxt_twin.api.robots import WatchedRobot
    from nxt_twin.cli.watching import Printer

    return WatchedRobot(drive, (lambda _: None) if silent else Printer().event)


def _program(name: str, ports: tuple[Port, ...]) -> MotorProgram | None:
    from nxt_twin.cli.wanted import NOTHING
    from nxt_twin.recording.programs import load_program
    from nxt_twin.twin.driver import excitation

    if name == NOTHING:
        return None
    loaded = excitation(ports) if name == _BUILT_IN else load_program(name)
    missing = [port for port in loaded.ports if port not in ports]
    if missing:
        raise typer.BadParameter(
            f"the program drives {', '.join(missing)}; add {'it' if len(missing) == 1 else 'them'} to --ports"
        )
    return loaded
