# SPDX-License-Identifier: BSD-3-Clause
"""Where in a drive a speed is held, for what the figures show at constant speed."""
TOLERANCE = 0.03  # of the speed
SETTLED_S = 0.3  # from when the speed is reached until the window begins


def steady_from(times_s, speeds_mps, speed_mps, window_s):
    """The beginning of the first window in which the robot holds this speed; raises RuntimeError if there is none."""
    needed_s, reached_s = SETTLED_S + window_s, None
    for time_s, now_mps in zip(times_s, speeds_mps):
        if abs(now_mps - speed_mps) > TOLERANCE * speed_mps:
            reached_s = None
        elif reached_s is None:
            reached_s = time_s
        elif time_s - reached_s >= needed_s:
            return reached_s + SETTLED_S
    raise RuntimeError(f"the robot never holds {speed_mps} m/s, to {100 * TOLERANCE:.0f} %, for {needed_s:.1f} s")
