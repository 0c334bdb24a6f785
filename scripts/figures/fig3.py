# SPDX-License-Identifier: BSD-3-Clause
"""Fig. 3: the pitch over time, and the area of interest that bounds it."""
import matplotlib.pyplot as plt
import numpy as np

import formats
import style
from steady import TOLERANCE, steady_from
from trials import Trial

SPEEDS_MPS = [0.5, 1.0, 1.5]
SCAN_S = 0.01332
WINDOW_S = 2.4
STATIONARY_FROM_S = 4.0

# In a corridor long enough for the fastest of these robots to hold its speed.
STATIONARY = Trial("fig3-stationary", "corridor:1", 1, 8, "--without", "navigator", "--no-slam6d")
DRIVES = [Trial(f"fig3-{speed}", "corridor:1", 1, 30, "--set", f"navigator.drive.max_forward_mps={speed}", "--no-slam6d")
          for speed in SPEEDS_MPS]
TRIALS = [STATIONARY, *DRIVES]


class Nod:
    """The nod of one run, within a window of constant speed."""

    def __init__(self, trial, speed_mps):
        pitch, command = formats.read_table(trial.table("PITCH_STATE")), formats.read_table(trial.table("PITCH_COMMAND"))
        truth = formats.read_table(trial.table("TRUTH"))
        start_s = steady_from(truth["time_s"], truth["forward_mps"], speed_mps, WINDOW_S) if speed_mps else STATIONARY_FROM_S
        start_us = truth["utime_us"][0] + 1e6 * start_s
        inside = [self.window(table, start_us) for table in (pitch, command, truth)]
        self.pitch, self.command, self.truth = inside
        self.speed_mps = self.truth["forward_mps"].mean()
        self.sweep_s = self.sweep_time()

    def window(self, table, start_us):
        time_s = 1e-6 * (table["utime_us"] - start_us)
        inside = (time_s >= 0) & (time_s <= WINDOW_S)
        return {**{name: column[inside] for name, column in table.items()}, "time_s": time_s[inside]}

    def sweep_time(self):
        """The mean time from one reversal to the next."""
        reversals = np.flatnonzero(np.diff(self.pitch["sweep_count"]) > 0)
        return np.diff(self.pitch["time_s"][reversals]).mean()

    def span_deg(self):
        return np.degrees(self.pitch["pitch_rad"].min()), np.degrees(self.pitch["pitch_rad"].max())

    def scans(self):
        return self.sweep_s / SCAN_S

    def step_deg(self):
        """The mean change of the pitch from scan to scan, which the paper calls pitch rate."""
        low, high = self.span_deg()
        return (high - low) / self.scans()


def draw(nods):
    figure, axes = plt.subplots(1, len(nods), figsize=(7.4, 2.4), sharey=True, constrained_layout=True)
    for axis, nod in zip(axes, nods):
        time_s = nod.command["time_s"]
        low, high = np.degrees(nod.command["pitch_min_rad"]), np.degrees(nod.command["pitch_max_rad"])
        axis.fill_between(time_s, low, high, color="#DDE8F0", linewidth=0, label="area of interest")
        axis.plot(time_s, low, time_s, high, color=style.SLAM, linewidth=0.6, linestyle="--")
        axis.plot(nod.pitch["time_s"], np.degrees(nod.pitch["pitch_rad"]), color=style.TRUTH, label="pitch, measured")
        axis.axhline(0, color=style.GREY, linewidth=0.4)
        axis.set_title("stationary" if nod.speed_mps < 0.01 else f"{nod.speed_mps:.1f} m/s")
        axis.set_xlabel("time (s)")
        axis.set_xlim(0, WINDOW_S)
    axes[0].set_ylabel(r"$\theta_\mathrm{pitch}$ (degrees, positive up)")
    axes[-1].legend(loc="upper right")
    style.save(figure, "fig3.png")


def make():
    nods = [Nod(trial, speed) for trial, speed in zip(TRIALS, [0.0, *SPEEDS_MPS])]
    draw(nods)
    rows = "\n".join(f"| {'stationary' if n.speed_mps < 0.01 else f'{n.speed_mps:.2f} m/s'} | {n.span_deg()[0]:.0f}° to {n.span_deg()[1]:.0f}° "
                     f"| {n.sweep_s:.2f} s | {n.scans():.0f} | {n.step_deg():.2f}° |" for n in nods)
    slowest, fastest = nods[0], nods[-1]
    lowest, highest = fastest.span_deg()
    return {
        "title": "the nod",
        "alt": "Pitch angle over time at four speeds, with the bounds of the area of interest",
        "paper": "The scanner nods up and down between the bounds of the area of interest (AOI). A PI controller adapts the bounds and the pitch "
                 "rate to the robot's speed: the AOI covers the whole 120° when the robot is stationary, and only the virtual corridor when it "
                 "drives fast. A point cloud consists of 15 to 500 scans.",
        "measured": f"The measured pitch at constant speed (within {100 * TOLERANCE:.0f} % for {WINDOW_S} s), in a corridor of 100 m:\n\n"
                    "| speed | pitch | sweep duration | scans in a sweep | pitch from scan to scan |\n|---|---|---|---|---|\n" + rows + "\n\n"
                    f"At {fastest.speed_mps:.1f} m/s a sweep takes 1/{slowest.sweep_s / fastest.sweep_s:.1f} of the time that it takes when the robot is "
                    "stationary. When the robot is stationary, the servo is the limit: a sweep over the 120° takes a second. A sweep of the paper's "
                    "fine scans (480 scans, 0.25° apart) takes six.",
        # At this speed the sweep is planned over the virtual corridor, a line beyond it, and 3 degrees of floor: from -21.5 to 7.5 degrees.
        "holds": [(f"sweep duration at {SPEEDS_MPS[-1]} m/s", f"{fastest.sweep_s:.2f} s", f"≤ half of {slowest.sweep_s:.2f} s",
                   fastest.sweep_s <= 0.5 * slowest.sweep_s),
                  (f"pitch at {SPEEDS_MPS[-1]} m/s", f"{lowest:.0f}° to {highest:.0f}°", "within -24° to 10°", lowest >= -24 and highest <= 10)],
    }
