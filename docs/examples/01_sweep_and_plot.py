"""Sweeps a mesh and draws, at every vertex, the area distortion of the flat metric whose only cone lies there."""
import matplotlib.pyplot as plt
import ricci
mesh = ricci.generate("eight", faces=1500)
result = ricci.sweep(mesh)
axes = plt.figure().add_subplot(projection="3d", box_aspect=(2, 1, 0.5), title=f"best: vertex {result.best.vertex}")
surface = axes.plot_trisurf(*mesh.points.T, triangles=mesh.triangles, cmap="viridis")
surface.set_array(result.at_vertices()[mesh.triangles].mean(axis=1))
plt.colorbar(surface, label="area distortion")
plt.savefig("distortion.png")
