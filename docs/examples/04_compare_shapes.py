"""Shapes by their conformal structure: closed geodesics, and coordinates in Teichmueller space."""

import numpy as np

import ricci

# Tori of revolution are rectangular: their modulus is i times a function of the radii alone.
for major in (1.5, 2.0, 3.0):
    torus = ricci.generate("torus", faces=3000, major=major, minor=1.0)
    expected = 1j * max(np.sqrt(major**2 - 1), 1 / np.sqrt(major**2 - 1))
    found = ricci.teichmuller(torus).modulus
    print(f"torus {major}: modulus {found:.4f}, smooth torus {expected:.4f}")

# The same surface in two triangulations, and another surface.
coarse, fine = (ricci.generate("eight", faces=n) for n in (2000, 6000))
other = ricci.generate("bolza", faces=2000)
for mesh in (coarse, fine, other):
    spectrum = ricci.spectrum(mesh, max_length=4.0)
    shortest = ", ".join(f"{length:.4f}" for length in spectrum.lengths[:5])
    print(f"{mesh.name} with {mesh.faces} faces: {len(spectrum.lengths)} geodesics, shortest {shortest}")

a, b = (ricci.teichmuller(mesh) for mesh in (coarse, fine))
print("coordinates", ", ".join(a.names))
print(f"distance of the two triangulations {np.linalg.norm(a.coordinates - b.coordinates):.4f}")
