"""How long a run takes, told before it is run: roughly, for whoever decides whether to wait for it."""

from robomill.simulation.setup import SimulationSetup

# s on a desktop of 2024, measured.
A_RUN, A_SAMPLE, A_NEIGHBOUR, A_STEP, A_COUPLED_STEP = 0.03, 20e-6, 1e-7, 150e-6, 3e-3


def run_seconds(setup: SimulationSetup) -> float:
    """About how many seconds a run takes: its points, the neighbours within a tool's width that each of them is
    measured against, and the steps that are marched."""
    path = setup.toolpath
    count = len(path) + float(path.s[-1]) / setup.step
    beside = min(count, setup.cutter.diameter / setup.step)
    marched = A_COUPLED_STEP if setup.coupling else A_STEP if setup.engagement else 0.0
    return A_RUN + count * (A_SAMPLE + A_NEIGHBOUR * beside + marched)
