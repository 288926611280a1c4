"""One metric with two cones of curvature -2 pi on a surface of genus 2, watched step by step, kept in a file."""

import numpy as np

import ricci

mesh = ricci.generate("eight", faces=3000)
print(mesh)


def watch(step: ricci.FlowProgress) -> None:
    print(f"  step {step.iteration}: residual {step.residual_max:.1e}")


result = ricci.flow(mesh, cones={0: -2 * np.pi, 99: "-2pi"}, progress=watch)
print(f"{result.status}: {result.newton_iterations} steps, {result.flips} flips")

# Curvature is 0 but at the cones, and adds up to 2 pi chi.
flat = np.delete(result.curvature, [0, 99])
print(f"largest curvature elsewhere {np.abs(flat).max():.1e}")
print(f"total curvature / pi = {result.curvature.sum() / np.pi:.9f}, chi = {mesh.euler_characteristic}")

# Edges scale by exp((u_i + u_j) / 2).
u = result.conformal_factor
print(f"lengths change by factors of {np.exp(u.min()):.3g} to {np.exp(u.max()):.3g}")
result.save("cones.h5")  # for `ricci verify cones.h5 --recompute`, or ricci.read
