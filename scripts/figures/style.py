# SPDX-License-Identifier: BSD-3-Clause
"""The common style of all figures."""
import pathlib

import matplotlib
import numpy as np
from PIL import Image

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of where to draw)

PICTURES = pathlib.Path(__file__).resolve().parent.parent.parent / "docs" / "pictures" / "paper"

# Okabe and Ito's colours, which colour-blind people can distinguish.
TRUTH, SLAM, ODOMETRY, NODDING, FIXED, GREY = "#000000", "#0072B2", "#E69F00", "#009E73", "#D55E00", "#777777"
HEIGHT_MAP = "viridis"

plt.rcParams.update({
    "font.family": "DejaVu Sans", "font.size": 8, "axes.titlesize": 8, "axes.titleweight": "bold", "axes.labelsize": 8,
    "axes.linewidth": 0.6, "axes.spines.top": False, "axes.spines.right": False, "xtick.labelsize": 7, "ytick.labelsize": 7,
    "xtick.major.width": 0.6, "ytick.major.width": 0.6, "legend.fontsize": 7, "legend.frameon": False, "lines.linewidth": 1.1,
    "figure.dpi": 150, "savefig.dpi": 150, "figure.facecolor": "white",
})


def save(figure, name, colours=256):
    """Writes the image with a palette of a few colours, which keeps it small. The same figure gives the same bytes."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    figure.canvas.draw()
    image = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB").quantize(colours, dither=Image.Dither.NONE)
    image.save(PICTURES / name, optimize=True)
    plt.close(figure)
    size_kb = (PICTURES / name).stat().st_size / 1000
    if size_kb > 300:
        raise RuntimeError(f"{name}: {size_kb:.0f} kB is too large to be committed")


def as_plan(axes, scale_m=1.0):
    """Shows a view from above: with equal scales, without axes, and with a scale bar below it."""
    axes.set_aspect("equal")
    axes.axis("off")
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    strip = max(0.07 * (top - bottom), 0.03 * (right - left))
    axes.set_ylim(bottom - strip, top)
    x, y = left + 0.02 * (right - left), bottom - 0.55 * strip
    axes.plot([x, x + scale_m], [y, y], color="black", linewidth=2.5, solid_capstyle="butt")
    axes.text(x + scale_m + 0.01 * (right - left), y, f"{scale_m:g} m", ha="left", va="center", fontsize=7)
