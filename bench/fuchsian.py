"""Length spectra of Fuchsian groups from elements that generate them alone, sharing nothing with the C++ program.

Elements are arrays of pairs (a, b), z -> (a z + b)/(conj(b) z + conj(a)) on the unit disk, |a|^2 - |b|^2 = 1; straight
lines and half planes are those of the Klein model. The steps:

1. A Dirichlet domain from products of the generators. Half planes of some elements contain the domain; that none is
   missing is proved by the area: 2 pi |chi| (of the part in the convex core, where there are boundaries).
2. All elements up to a displacement R, as a tree: the parent of a tile lies across the side by which the geodesic from
   the tile's centre to the origin leaves it. Displacements fall along it, each tile has one parent, so nothing is missed
   and nothing comes twice, and no elements need comparing.
3. A closed geodesic of length l crosses the domain at a point within rho of the centre, so some conjugate has
   displacement <= 2 asinh(cosh(rho) sinh(l/2)) (Hodgson, Weeks 1994): R for the longest l asked for.
4. Classes are counted, not compared: the axes of all elements of length l cut from the domain pieces whose lengths add
   up to 2 l (both directions) for every primitive class, 2 l / k for the k-th power of one. That the numbers come out
   whole checks everything before.
"""

import math
import tempfile
from pathlib import Path

import h5py
import numpy as np

import running


class GroupError(RuntimeError):
    """Generators that do not generate what their Euler characteristic says, or an enumeration that does not add up."""


def multiply(g, h):
    a, b, c, d = g[..., 0], g[..., 1], h[..., 0], h[..., 1]
    return np.stack([a * c + b * np.conj(d), a * d + b * np.conj(c)], axis=-1)


def inverse(g):
    return np.stack([np.conj(g[..., 0]), -g[..., 1]], axis=-1)


def displacement(g):
    return 2 * np.arcsinh(np.abs(g[..., 1]))


def translation_length(g):
    half = np.sqrt(np.maximum(np.abs(g[..., 1]) ** 2 - g[..., 0].imag ** 2, 0.0))
    return 2 * np.arcsinh(half)


def translation(point):
    """That carries the origin to a point of the disk."""
    a = 1 / math.sqrt(1 - abs(point) ** 2)
    return np.array([a, a * point], dtype=complex)


def conjugated(g, carry):
    """The elements in coordinates in which the image of the origin under `carry` is the origin."""
    return multiply(inverse(carry), multiply(g, carry))


def shortest(g, count):
    """The `count` elements of smallest displacement, without repetitions and the identity: the image of the origin tells."""
    g = g[displacement(g) > 1e-2]
    g = g[np.argsort(displacement(g), kind="stable")]
    image = g[:, 1] / np.conj(g[:, 0])
    kept = []
    for k, z in enumerate(image):
        if len(kept) == count:
            break
        if not kept or np.min(np.abs(image[kept] - z)) > 1e-6 * (1 - abs(z)) + 1e-7:
            kept.append(k)
    return g[kept]


def reduced(generators):
    """Nielsen's moves: a generator gives way to its product with another where that is nearer to the identity."""
    g = np.array(generators)
    changed = True
    while changed:
        changed = False
        for i in range(len(g)):
            others = np.concatenate([np.delete(g, i, axis=0), inverse(np.delete(g, i, axis=0))])
            products = np.concatenate([multiply(g[i], others), multiply(others, g[i])])
            best = products[np.argmin(displacement(products))]
            if displacement(best) < displacement(g[i]) - 1e-9:
                g[i], changed = best, True
    return np.concatenate([g, inverse(g)])


def clip(corners, labels, normal, offset, label):
    """A convex polygon cut by normal . y <= offset; labels[i] names the side from corner i to the next."""
    height = [normal.real * c.real + normal.imag * c.imag - offset for c in corners]
    if max(height) <= 1e-13:
        return corners, labels
    new_corners, new_labels = [], []
    for i, corner in enumerate(corners):
        j = (i + 1) % len(corners)
        crossing = None
        if (height[i] <= 0) != (height[j] <= 0):
            crossing = corner + (corners[j] - corner) * (height[i] / (height[i] - height[j]))
        if height[i] <= 0:
            new_corners.append(corner)
            new_labels.append(labels[i])
            if crossing is not None:
                new_corners.append(crossing)
                new_labels.append(label)
        elif crossing is not None:
            new_corners.append(crossing)
            new_labels.append(labels[i])
    return new_corners, new_labels


def polygon(normals, offsets, start=None):
    """The intersection of half planes (Klein model), nearest first: corners and the number of the half plane of each side."""
    corners, labels = start or ([1 - 1j, 1 + 1j, -1 + 1j, -1 - 1j], [-1] * 4)
    for k in np.argsort(offsets):
        corners, labels = clip(corners, labels, normals[k], offsets[k], int(k))
    return corners, labels


def bisectors(g):
    """Half planes nearer to the origin than to its image."""
    ab = g[:, 0] * g[:, 1]
    return ab / np.abs(ab), np.abs(g[:, 1] / g[:, 0])


def area_and_radius(corners):
    """Of a hyperbolic polygon around the origin; infinite where a corner is not inside the disk."""
    y = np.array(corners)
    if not len(y) or np.max(np.abs(y)) >= 1 - 1e-13:
        return math.inf, math.inf
    gamma = 1 / np.sqrt(1 - np.abs(y) ** 2)
    z, delta = np.roll(y, -1), np.roll(gamma, -1)
    volume = gamma * delta * (y.real * z.imag - y.imag * z.real)
    beside = 1 + gamma + delta + gamma * delta * (1 - (y.real * z.real + y.imag * z.imag))
    return float(np.sum(2 * np.arctan2(volume, beside))), float(np.arccosh(np.max(gamma)))


def core_half_planes(elements, boundary):
    """Half planes of the convex core: beyond the axes of conjugates of the boundary's elements lies a funnel."""
    every = np.concatenate([np.array([[1, 0]], dtype=complex), elements])
    conjugates = np.concatenate([multiply(multiply(every, c), inverse(every)) for c in boundary])
    normal, offset = -conjugates[:, 1].imag + 1j * conjugates[:, 1].real, conjugates[:, 0].imag
    flip = np.where(offset < 0, -1, 1)  # the origin lies in the core
    size = np.abs(normal)
    return flip * normal / size, flip * offset / size


class Domain:
    """A Dirichlet domain: side elements, half planes, and area and radius of the part in the convex core."""

    def __init__(self, elements, boundary):
        normals, offsets = bisectors(elements)
        corners, labels = polygon(normals, offsets)
        sides = sorted(set(labels) - {-1})
        self.elements = elements[sides]
        self.normals, self.offsets = normals[sides], offsets[sides]
        self.corners = corners
        if len(boundary):
            reach = np.concatenate([self.elements, multiply(self.elements[:, None], self.elements[None]).reshape(-1, 2)])
            core_normals, core_offsets = core_half_planes(shortest(reach, 400), boundary)
            self.corners, _ = polygon(core_normals, core_offsets, (corners, labels))
        self.area, self.radius = area_and_radius(self.corners)


def cutting(domain, g):
    """Those elements whose bisector cuts off a corner of the domain, or of what it still is."""
    normals, offsets = bisectors(g)
    corners = np.array(domain.corners)
    heights = normals.real[:, None] * corners.real + normals.imag[:, None] * corners.imag - offsets[:, None]
    return g[np.max(heights, axis=1) > 1e-10]


def dirichlet_domain(elements, boundary, area):
    """Products of sides are added until the area is that of the surface. Throws GroupError where it never is."""
    given = shortest(np.concatenate([elements, inverse(elements)]), 120)
    elements = given
    for _ in range(60):
        domain = Domain(elements, boundary)
        if abs(domain.area - area) < 1e-7 * area:
            return domain
        near = shortest(np.concatenate([domain.elements, inverse(domain.elements), given]), 160)
        products = multiply(near[:, None], near[None]).reshape(-1, 2)
        products = shortest(cutting(domain, products[displacement(products) > 1e-2]), 300)
        if not len(products):  # no pair helps: reach farther
            given = shortest(np.concatenate([given, multiply(near[:, None], near[None]).reshape(-1, 2)]), 150)
        elements = np.concatenate([near, products])
    raise GroupError(f"area {domain.area}, not {area}")


def centred_domain(generators, boundary, area, seed=1, tries=60):
    """A domain of small radius about a point in general position, found by a random search; and the boundary's elements
    from there. Made anew from the generators in the end, so that the search leaves no rounding."""
    rng = np.random.default_rng(seed)
    boundary = np.array(boundary).reshape(-1, 2)
    domain, step = dirichlet_domain(reduced(generators), boundary, area), 0.5
    ends, carried = boundary, np.array([1, 0], dtype=complex)
    for trial in range(tries + 3):
        point = math.tanh(step / 2) * math.sqrt(rng.random()) * np.exp(2j * math.pi * rng.random())
        general = trial >= tries  # in the end, a symmetric domain would have axes along its sides
        point = 0.02 * point / abs(point) if general else point
        if len(boundary):  # the base stays in the core
            normals, offsets = core_half_planes(domain.elements, ends)
            if np.max(normals.real * point.real + normals.imag * point.imag - offsets) >= 0:
                continue
        carry = translation(point)
        moved = dirichlet_domain(conjugated(domain.elements, carry), conjugated(ends, carry), area)
        if general or moved.radius < domain.radius:
            domain, ends, carried = moved, conjugated(ends, carry), multiply(carried, carry)
        else:
            step = max(0.02, 0.95 * step)
    ends = conjugated(boundary, carried)
    return dirichlet_domain(reduced(conjugated(np.array(generators), carried)), ends, area), ends


def exit_sides(domain, direction):
    """By which side rays from the centre leave the domain."""
    towards = (direction.real[:, None] * domain.normals.real + direction.imag[:, None] * domain.normals.imag) / domain.offsets
    return np.argmax(towards, axis=1)


def elements_within(domain, limit, keep, most=30_000_000):
    """All elements of displacement <= limit for which `keep` is true, and how many there are at all."""
    sides = domain.elements
    back = [int(np.argmin(np.abs(displacement(multiply(s, sides))))) for s in sides]  # the side paired with each
    frontier, kept, count = np.array([[1, 0]], dtype=complex), [], 1
    bound = math.cosh(limit / 2)
    while len(frontier):
        children = []
        for start in range(0, len(frontier), 100_000):
            for s, side in enumerate(sides):
                child = multiply(frontier[start:start + 100_000], side)
                child = child[(np.abs(child[:, 0]) <= bound) & (np.abs(child[:, 1]) > 1e-6)]
                if not len(child):
                    continue
                child = child[exit_sides(domain, -child[:, 1] * np.conj(child[:, 0])) == back[s]]
                children.append(child)
        frontier = np.concatenate(children) if children else np.zeros((0, 2), dtype=complex)
        count += len(frontier)
        if count > most:
            raise GroupError(f"more than {most} elements within {limit:.2f}")
        if len(frontier):
            kept.append(frontier[keep(frontier)])
    return (np.concatenate(kept) if kept else frontier), count


def axis_pieces(domain, g):
    """Length of the part of each element's axis that lies in the domain."""
    size = np.abs(g[:, 1])
    normal, offset = (-g[:, 1].imag + 1j * g[:, 1].real) / size, g[:, 0].imag / size
    foot, along = offset * normal, 1j * normal
    half = np.sqrt(np.maximum(1 - offset ** 2, 1e-300))
    low, high = -half, half.copy()
    for n, c in zip(domain.normals, domain.offsets):
        slope = n.real * along.real + n.imag * along.imag
        room = c - (n.real * foot.real + n.imag * foot.imag)
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = room / slope
        high = np.where(slope > 0, np.minimum(high, reach), high)
        low = np.where(slope < 0, np.maximum(low, reach), low)
    inside = high > low
    piece = np.zeros(len(g))
    with np.errstate(divide="ignore"):
        piece[inside] = np.arctanh(np.minimum((high / half)[inside], 1)) - np.arctanh(np.maximum((low / half)[inside], -1))
    return piece


def group_lengths(lengths, pieces, tolerance):
    """Equal lengths together: mean length and total of pieces. Axes that miss the domain say nothing."""
    crossing = pieces > 1e-9
    lengths, pieces = lengths[crossing], pieces[crossing]
    order = np.argsort(lengths)
    lengths, pieces = lengths[order], pieces[order]
    starts = np.flatnonzero(np.concatenate([[True], np.diff(lengths) > tolerance]))
    ends = np.append(starts[1:], len(lengths))
    return [(float(np.mean(lengths[i:j])), float(np.sum(pieces[i:j])), float(lengths[j - 1] - lengths[i]))
            for i, j in zip(starts, ends)]


def count_classes(grouped, tolerance):
    """[length, primitive classes, powers] from the totals; the largest distance of a count from a whole number."""
    result, worst = [], 0.0
    for length, total, _ in grouped:
        powers, owed = 0, 0.0
        for shorter, primitive, _ in result:
            k = round(length / shorter)
            if k >= 2 and abs(length / k - shorter) < tolerance:
                powers += primitive
                owed += primitive / k
        count = total / (2 * length) - owed
        worst = max(worst, abs(count - round(count)))
        result.append([length, int(round(count)), powers])
    return result, worst


def spectrum(generators, boundary, euler_characteristic, longest, tolerance=1e-9, seed=1):
    """Complete up to `longest`. Returns a dictionary: lengths (ascending, [length, primitive, powers], unoriented), radius,
    displacement, elements, miscount."""
    domain, boundary = centred_domain(generators, boundary, -2 * math.pi * euler_characteristic, seed)
    limit = 2 * math.asinh(math.cosh(domain.radius) * math.sinh(longest / 2)) + 1e-6
    trace = math.cosh(longest / 2) * (1 + 1e-12)
    kept, count = elements_within(domain, limit, lambda g: np.abs(g[:, 0].real) <= trace)
    pieces = axis_pieces(domain, kept)
    grouped = group_lengths(translation_length(kept), pieces, tolerance)
    lengths, miscount = count_classes(grouped, tolerance)
    return {"lengths": lengths, "radius": domain.radius, "displacement": limit, "elements": count, "sides": len(domain.elements),
            "miscount": miscount, "spread": max((g[2] for g in grouped), default=0.0)}


def group_of(ricci, mesh, options=()):
    """The group of a surface by `ricci layout`: the elements of its letters (the shortest loops at the base, and loops
    around boundaries), those of the boundaries, and the Euler characteristic."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "layout.h5"
        status, _, error = running.run([ricci, "layout", mesh, "-o", str(path), "--quiet", *options], 600)
        if status != 0:
            raise GroupError(f"layout of {mesh}: exit {status} {error}")
        with h5py.File(path) as run:
            (item,) = run["items"].values()
            letters = item["layout/letters"]
            names = [name.decode() for name in letters["name"][:]]
            parts = letters["element"][:]
            chi = int(item.attrs["euler_characteristic"])
    elements = np.stack([parts[:, 0] + 1j * parts[:, 1], parts[:, 2] + 1j * parts[:, 3]], axis=-1)
    return elements, elements[[i for i, name in enumerate(names) if name.startswith("c")]], chi
