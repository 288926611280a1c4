"""A sweep that is interrupted and goes on where it was: what is finished is on disk every few seconds."""

import ricci

mesh = ricci.generate("eight", faces=3000)


def impatient(progress: ricci.SweepProgress) -> None:
    if progress.solves_done >= 100:
        raise TimeoutError(f"stopped after {progress.solves_done} solves")


# Ctrl-C does the same.
try:
    ricci.sweep(mesh, vertices="sample:400", output="resumed.h5", progress=impatient)
except TimeoutError as stopped:
    print(stopped)

first: list[int] = []
result = ricci.sweep(
    mesh,
    vertices="sample:400",
    output="resumed.h5",
    resume=True,
    progress=lambda progress: first.append(progress.solves_known),
)
print(f"{first[-1]} vertices were left to be solved")
print(result)
