"""The deviation along the path as a picture"""

import matplotlib

matplotlib.use("Agg")  # no screen needed
import matplotlib.pyplot as plt
import numpy as np

import robomill as rm

result = rm.simulate(rm.load_setup("paper_flute"))
cut = result.path.cutting
s_mm = result.path.s[cut] * 1e3
fig, ax = plt.subplots(figsize=(7, 4), layout="constrained")
ax.plot(s_mm, result.deviation[cut] * 1e3, color="black", linewidth=2, label="size of the deviation")
for axis, name in enumerate("XYZ"):
    ax.plot(s_mm, result.delta[cut, axis] * 1e3, label=f"in {name}")
ax.axhline(result.setup.tolerance * 1e3, color="red", linestyle="--", label="tolerance of walls")
ax.set(xlabel="length cut, mm", ylabel="deviation, mm", title=result.setup.name)
ax.legend()
fig.savefig("deviation.png", dpi=150)
least = result.deviation[cut].min()
print(f"{cut.sum()} samples over {np.ptp(s_mm):.1f} mm")
print(f"deviation from {least * 1e3:.4f} to {result.max_deviation * 1e3:.4f} mm")
