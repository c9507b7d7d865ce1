"""The plot of a problem of contrib/evidence work-precision."""
import os
import sys

from outcome import ROOT

sys.path.insert(0, os.path.join(ROOT, "contrib", "plot"))
import plot_study  # noqa: E402
from picture import plt  # noqa: E402


def draw(problem, runs, own, path):
    """Error against processor time of whole runs, a curve a case; below the line the reference's own error."""
    shown = {}
    for run in runs:
        shown.setdefault(run["case"], []).append({**run, "cpu_time_s": run["processor_s"], "cpu_times_s": [run["processor_s"]]})
    figure, axes = plt.subplots(figsize=(9., 5.2), constrained_layout=True)
    plot_study.draw_work(axes, shown)
    if own > 0.:
        axes.axhline(own, color="black", linewidth=.8, linestyle=":", label="the reference's own error")
    axes.set(xscale="log", yscale="log", xlabel="processor time of the whole run [s]", ylabel="relative error", title=problem.title)
    axes.grid(alpha=.3, which="both")
    axes.legend(fontsize="small", loc="upper left", bbox_to_anchor=(1.01, 1.))
    figure.savefig(path, dpi=110)
    plt.close(figure)
