"""The hyperbolic structure of a surface of genus 2: its group, a domain in the disk, texture coordinates, a picture."""

import numpy as np

import ricci

mesh = ricci.generate("eight", faces=2000)
layout = ricci.layout(mesh, quality=True, copies=500)
print(f"{layout.status}, {layout.geometry}; relator is the identity to {layout.relator_error:.1e}")
for generator in layout.generators:
    trace = abs(np.trace(generator.matrix))
    print(f"  {generator.name}: word {generator.word}, length {2 * np.arccosh(trace / 2):.6f}, matrix in SL(2, R)")
print(f"{layout.flipped_pieces} of {len(layout.piece_face)} pieces are turned over")
print(f"all points lie in the disk: {bool(np.all(np.hypot(*layout.conformal.T) < 1))}")
print(f"angles within 5 %: {100 * layout.quality.attributes['angles_within_5_percent']:.1f} % of corners")

layout.save_uv("eight_uv.obj", model="poincare", checker=16)
layout.export("eight_tessellation.svg", picture="tessellation", model="poincare")
ricci.save("eight_layout.h5", layout)
