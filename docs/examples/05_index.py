"""An index of shapes: which are alike?"""

from pathlib import Path

import ricci

folder = Path("shapes")
folder.mkdir(exist_ok=True)
for faces in (1500, 2500):
    ricci.generate("eight", faces=faces).save(folder / f"eight{faces}.off")
    ricci.generate("torus", faces=faces, major=2.5).save(folder / f"torus{faces}.off")
ricci.generate("bolza", faces=2000).save(folder / "bolza.len")

index = ricci.Index.build("shapes.h5", folder)
print(index, index.types)

query = ricci.generate("eight", faces=4000)
for neighbour in index.query(query, k=3):
    print(f"{neighbour.distance:10.6f}  {neighbour.file}")

distances = index.distances("g2b0", clusters=2)
for name, cluster in zip(distances.names, distances.cluster):
    print(f"cluster {cluster}: {name}")
