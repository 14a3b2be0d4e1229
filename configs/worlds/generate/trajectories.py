# SPDX-License-Identifier: Apache-2.0
"""Trajectories, all closed loops: surveys on an arc around a target with the sonar's fan held on it, and for a head that turns
step by step rests and slow moves between them.

Poses are of the vehicle body (x forward, y left, z up) in the world frame (x east, y north, z up).
"""

import math


def quaternion(roll, pitch, yaw):
    """(x, y, z, w) of Rz(yaw) Ry(pitch) Rx(roll)."""
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return (sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy)


def arc_survey(target, start_deg, sweep_deg, radius_m, closer_m, height_m, lower_m, period_s, rate_hz=10):
    """Rows (t, x, y, z, qx, qy, qz, qw). Starts and ends at rest at bearing `start_deg` from the target.

    Half-way round it stands at start_deg + sweep_deg, `closer_m` nearer and `lower_m` lower than at the start.
    """
    rows = []
    for k in range(int(period_s * rate_hz) + 1):
        t = k / rate_hz
        phase = 2.0 * math.pi * t / period_s
        out = 0.5 * (1.0 - math.cos(phase))
        bearing = math.radians(start_deg + sweep_deg * out)
        radius = radius_m - closer_m * out
        x = target[0] + radius * math.cos(bearing)
        y = target[1] + radius * math.sin(bearing)
        z = target[2] + height_m - lower_m * out + 0.10 * math.sin(3.0 * phase)
        yaw = bearing + math.pi + math.radians(6.0) * math.sin(2.0 * phase)
        roll = math.radians(1.5) * math.sin(7.0 * phase)
        pitch = math.radians(1.0) * math.sin(5.0 * phase)
        rows.append((t, x, y, z, *quaternion(roll, pitch, yaw)))
    return rows


def out_and_back(start, end, rest_s, move_s, rate_hz=10):
    """Rows (t, x, y, z, qx, qy, qz, qw), heading east: rest at `start`, ease over to `end`, rest there, ease back."""
    rows = []
    for k in range(2 * int((rest_s + move_s) * rate_hz) + 1):
        t = k / rate_hz
        away = min(max(t - rest_s, 0.0) / move_s, 1.0) - max(t - 2.0 * rest_s - move_s, 0.0) / move_s
        share = 0.5 * (1.0 - math.cos(math.pi * away))
        rows.append((t, *(a + (b - a) * share for a, b in zip(start, end)), *quaternion(0.0, 0.0, 0.0)))
    return rows


def turn_and_back(position, turn_deg, rest_s, turn_s, rate_hz=50):
    """Rows as above: heading east at rest, a turn to port at a constant rate, rest, the same turn back."""
    rows = []
    for k in range(2 * int((rest_s + turn_s) * rate_hz) + 1):
        t = k / rate_hz
        share = min(max(t - rest_s, 0.0) / turn_s, 1.0) - max(t - 2.0 * rest_s - turn_s, 0.0) / turn_s
        rows.append((t, *position, *quaternion(0.0, 0.0, math.radians(turn_deg * share))))
    return rows


def csv_text(rows, time_digits=1):
    lines = ["t,x,y,z,qx,qy,qz,qw"]
    lines += [f"{r[0]:.{time_digits}f}," + ",".join(f"{v:.3f}" for v in r[1:4]) + "," + ",".join(f"{v:.6f}" for v in r[4:]) for r in rows]
    return "\n".join(lines) + "\n"


def trajectories():
    """{path below configs/trajectories: bytes}."""
    dock = arc_survey(target=(0.0, 0.2, -30.0), start_deg=-100.0, sweep_deg=115.0, radius_m=12.3, closer_m=0.8, height_m=4.4,
                      lower_m=0.4, period_s=80.0)
    valve = arc_survey(target=(0.0, 0.0, -42.2), start_deg=-70.0, sweep_deg=-100.0, radius_m=13.5, closer_m=1.0, height_m=4.5,
                       lower_m=0.3, period_s=80.0)
    manifold = arc_survey(target=(0.0, 0.0, -25.16), start_deg=-90.0, sweep_deg=70.0, radius_m=11.9, closer_m=0.8, height_m=5.5,
                          lower_m=0.4, period_s=80.0)
    tank = out_and_back(start=(-1.0, -0.5, -4.0), end=(2.0, 1.5, -4.0), rest_s=20.0, move_s=20.0)
    grid = turn_and_back(position=(0.0, 0.0, -8.0), turn_deg=20.0, rest_s=10.0, turn_s=10.0)
    oil_and_gas = out_and_back(start=(0.0, 0.0, -24.5), end=(7.0, 0.0, -24.5), rest_s=20.0, move_s=20.0)
    demo = [row for row in dock if row[0] <= 10.0]
    files = {"demo": csv_text(demo), "docking_demo": csv_text(dock), "ssiv_demo": csv_text(valve), "manifold_demo": csv_text(manifold),
             "tank": csv_text(tank), "grid": csv_text(grid, time_digits=2), "oil_and_gas": csv_text(oil_and_gas)}
    return {f"{name}.csv": text.encode("ascii") for name, text in files.items()}
