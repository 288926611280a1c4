"""Reads what the command line wrote, like `ricci sweep eight.off -o sweep.h5`, and writes it again."""

import sys

import numpy as np

import ricci

path = sys.argv[1] if len(sys.argv) > 1 else "sweep.h5"
run = ricci.read(path)
print(f"{path}, made by ricci {run.info['software_version']}: {len(run)} items, {len(run.failures)} failures")
for item in run:
    print(f"{item.name} of {item.source}: {item.mesh}")
    if item.sweep is not None and item.sweep.best is not None:
        quartiles = np.nanquantile(item.sweep.area_distortion, [0, 0.25, 0.5, 0.75, 1])
        print("  quartiles of the area distortion", np.array2string(quartiles, precision=4))
        print(f"  best cone: vertex {item.sweep.best.vertex}")
for failure in run.failures:
    print(f"failed: {failure.item} ({failure.stage}): {failure.status}: {failure.message}")

run.save("copy.h5")
print("sound" if ricci.verify("copy.h5", recompute=True).sound else "NOT sound")
