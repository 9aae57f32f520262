"""Tables as people have them, all of one motion of one motor, which a simulator of its own makes."""

import io
import json
import zipfile
from datetime import UTC, datetime, timedelta

import numpy as np
from scipy.io import savemat

ROWS = 600
T = 0.01 * np.arange(ROWS)
U = np.repeat([0.0, 40.0, -60.0, 80.0, -30.0, 0.0, 100.0, 20.0, -90.0, 50.0], ROWS // 10)


def _motion():
    """Angle, deg, and speed, rad/s: a motor of 8 V with a constant of 0.49 N·m/A behind 7.6 Ω."""
    angle, speed, found = 0.0, 0.0, []
    for duty in U:
        found.append((np.degrees(angle), speed))
        for _ in range(20):
            torque = 0.49 * (0.08 * duty - 0.49 * speed) / 7.6 - 2e-3 * speed - 8e-3 * np.tanh(speed / 0.05)
            speed += 5e-4 * torque / 1.2e-3
            angle += 5e-4 * speed
    return np.array(found).T


DEG, W = _motion()
RAD, COUNT, MS, V = np.radians(DEG), np.round(DEG), np.round(1000 * T), 0.08 * U
GOAL = np.repeat([60.0, -45.0, 90.0, 5.0, -80.0, 30.0, 75.0, -60.0, 10.0, 50.0], ROWS // 10)
THERE = np.zeros(ROWS)
for _row in range(1, ROWS):
    THERE[_row] = THERE[_row - 1] + 0.15 * (GOAL[_row - 1] - THERE[_row - 1])


def _cell(value):
    return value if isinstance(value, str) else f"{value:.10g}"


def _lines(head, *columns, sep=",", comma=False):
    rows = (sep.join(map(_cell, row)) for row in zip(*columns, strict=True))
    body = "\n".join(rows)
    return f"{head}\n{body.replace('.', ',') if comma else body}\n"


def _arduino():
    rows = [
        f"{1234 + int(ms)},{int(2.55 * u)},{int(count)}" for ms, u, count in zip(MS, U, COUNT, strict=True)
    ]
    rows[300:300] = ["WARNING: overcurrent?", "# heartbeat ok"]
    return "\n".join(["Motor test v1.2", "Initializing...", "OK", *rows]) + "\n"


def _excel_thousands():
    rows = (f"{t:.3f};{u:g};{deg + 2000:,.2f}" for t, u, deg in zip(T, U, DEG, strict=True))
    return "t;pwm;deg\n" + "\n".join(row.translate(str.maketrans(",.", ".,")) for row in rows) + "\n"


def _swapped(values):
    order = np.arange(ROWS)
    order[100:110], order[400:405] = order[100:110][::-1], order[400:405][::-1]
    return values[order]


def _json():
    rows = zip(T, U / 100, RAD, strict=True)
    return json.dumps(
        [{"t": t, "u": u, "theta": None if n % 5 == 2 else q} for n, (t, u, q) in enumerate(rows)]
    )


def _clock(start, ending):
    return [f"{start}{int(50 + t) // 60:02d}:{(50 + t) % 60:06.3f}{ending}" for t in T]


_SCOPE = {"time": T[:, None], "signals": {"values": np.column_stack([V, RAD]), "label": "x"}}
_SIGNALS = np.array([{"values": V[:, None]}, {"values": RAD[:, None]}], dtype=object)
_STAMPS = [(datetime(2024, 5, 1, 12, tzinfo=UTC) + timedelta(seconds=float(t))).isoformat() for t in T]
_EPISODE = (T >= 3.0).astype(int)

READ = {
    "Excel, decimal commas, a row of units": _lines(
        "Zeit;Stellgröße;Drehwinkel\ns;%;°", T, U, DEG, sep=";", comma=True
    ),
    "Excel with thousands": _excel_thousands(),
    "quoted headers": _lines('"Time (ms)","Motor Power (%)","Rotation (deg)"', MS, U, DEG),
    "ROS topic as CSV": _lines(
        "%time,field.header.seq,field.name0,field.position0,field.velocity0,cmd",
        [f"{1_600_000_000_000_000_000 + int(1e9 * t)}" for t in T],
        np.arange(ROWS),
        ["knee"] * ROWS,
        RAD,
        W,
        U / 100,
    ),
    "PlotJuggler, commands in some rows": _lines(
        "__time,/joint_states/knee/position,/motor_voltage/data",
        [f"{1.7e9 + t:.3f}" for t in T],
        RAD,
        [_cell(v) if n % 60 == 0 else "" for n, v in enumerate(V)],
    ),
    "serial log with lines of words": _arduino(),
    "serial log with labels": "".join(
        f"t:{int(ms)} pwm:{int(2.55 * u)} enc:{int(c)}\n" for ms, u, c in zip(MS, U, COUNT, strict=True)
    ),
    "LabVIEW": _lines("Writer_Version\t2\nSeparator\tTab\n\nX_Value\tVoltage\tAngle", T, V, DEG, sep="\t"),
    "header behind a mark, blanks": _lines("# t[s] u[V] theta[rad]", T, V, RAD, sep="  "),
    "pipes": _lines("", *([""] * ROWS, T, U, DEG, [""] * ROWS), sep=" | "),
    "EV3, rows numbered": _lines("Sample,Time,Motor A Power,Motor A Degrees", np.arange(ROWS), T, U, COUNT),
    "Simulink structure with time": {"logsout": _SCOPE},
    "Simulink scope": {"ScopeData": {"time": T[:, None], "signals": _SIGNALS}},
    "MAT, rows for columns": {"x": np.vstack([T, V, RAD])},
    "JSON with nulls": _json(),
    "JSON, columns within an object": json.dumps(
        {"meta": {"rate": 100}, "data": {"t": T.tolist(), "pwm": U.tolist(), "pos": RAD.tolist()}}
    ),
    "Dynamixel power, ticks that wrap": _lines(
        "ms,goal_pwm,present_position", MS, 8.85 * U, np.mod(np.round(DEG * 4096 / 360), 4096)
    ),
    "Dynamixel goal and reading that wrap": _lines(
        "t,goal_position,present_position",
        T,
        *(np.mod(np.round(each * 4096 / 360), 4096) for each in (GOAL, THERE)),
    ),
    "hobby servo's pulses": _lines("time_ms,servo_us,pot_deg", MS, 1500 + GOAL * 1000 / 180, THERE),
    "each stamp twice": _lines("ms,pwm,deg", 20 * (np.arange(ROWS) // 2), U, DEG),
    "ISO dates": _lines("when,duty,angle", _STAMPS, U / 100, DEG),
    "times of day": _lines("time,power,angle_deg", _clock("12:", ""), U, DEG),
    "times of day with PM": _lines("Timestamp,Power,Angle (deg)", _clock("5/1/2024 1:", " PM"), U, DEG),
    "date and time apart": _lines(
        "Datum;Uhrzeit;Leistung %;Winkel Grad", ["01.05.2024"] * ROWS, _clock("12:", ""), U, DEG, sep=";"
    ),
    "pandas' lengths of time": _lines(
        ",elapsed,duty,position", np.arange(ROWS), _clock("0 days 00:", ""), U / 100, RAD
    ),
    "milliseconds of 16 bits": _lines("millis16,pwm,deg", np.mod(62000 + MS, 65536), U, DEG),
    "rows out of order": _lines("time_s,pwm,deg", *map(_swapped, (T, U, DEG))),
    "gaps": _lines("time,pwm,deg", T, U, ["NaN" if n % 7 == 3 else _cell(d) for n, d in enumerate(DEG)]),
    "a last line that is cut off": _lines("t,pwm,deg", T, U, DEG) + "6.0,5",
    "two motors": _lines(
        "t,left_pwm,left_enc,right_pwm,right_enc", T, U, COUNT, U[::-1], np.round(0.5 * DEG[::-1])
    ),
    "speed alone": _lines("t,voltage,rpm", T, V, W * 60 / (2 * np.pi)),
    "a gyroscope's rate": _lines("timestamp,gyro_z_dps,motor_cmd", T, np.degrees(W), U / 100),
    "current beside power": _lines("time;pwm;current_mA;angle_rad", T, U, 10 * V, RAD, sep=";"),
    "duty of 8 bits and a direction": _lines(
        "ms,pwm,dir,ticks", MS, 2.55 * np.abs(U), (U < 0).astype(int), COUNT
    ),
    "turns": _lines("t [s],motor voltage [V],shaft [rev]", T, V, DEG / 360),
    "radians that nobody names": _lines("stamp,cmd,pos", T, U / 100, RAD),
    "French": _lines("temps (s),tension (V),angle (degrés)", T, V, DEG),
    "Spanish": _lines("tiempo_ms;potencia;ángulo_grados", MS, U, DEG, sep=";"),
    "Japanese": _lines("時刻[s],電圧[V],角度[deg]", T, V, DEG),
    "tabs and microseconds": _lines("t_us\tduty\tposition_deg", 1e6 * T, U / 100, DEG, sep="\t"),
    "runs one after the other": _lines("ms,pwm,deg", np.where(_EPISODE, MS - 3000, MS), U, DEG),
    "episodes": _lines("run,t,u_V,theta", _EPISODE, np.where(_EPISODE, T - 3.0, T), V, RAD),
}
"""Tables by what is odd in them: text, or the variables of a MAT file."""

_BOOK = io.BytesIO()
with zipfile.ZipFile(_BOOK, "w") as _archive:
    _archive.writestr("xl/workbook.xml", "<x/>")

REFUSED = {
    "a spreadsheet": (_BOOK.getvalue(), "export the sheet as CSV"),
    "two columns of one name": (_lines("time,motor,motor", T, U, DEG), "`table: {header: false, skip: 1}`"),
    "a stamp that is missing": (
        _lines("t,pwm,deg", ["" if n == 99 else _cell(t) for n, t in enumerate(T)], U, DEG),
        "row 101, column t: has no time stamp",
    ),
    "the goal of a speed loop": (_lines("t,target_speed_dps,speed_dps", T, U, W), "write `input: {column"),
    "no time": (_lines("pwm,deg", U, DEG), "write `time: {period_s"),
    "no command": (_lines("t,deg", T, DEG), "write `input: {column"),
}
"""Tables by what is wrong with them, and a part of the line that refuses each."""


def write(path, content):
    """A table as a file."""
    if isinstance(content, dict):
        savemat(path, content, appendmat=False)
    else:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path
