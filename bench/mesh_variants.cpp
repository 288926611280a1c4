#include "bench/mesh_variants.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <unordered_set>
#include <utility>

#include "bench/random_numbers.h"
#include "engine/remesh/resample.h"
#include "kernels/edge_flip.h"

namespace ricci::bench {
namespace {

constexpr Index kRoomForDecimation = 2000;  // faces

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

std::vector<Point> vertex_normals(const SurfaceMesh& mesh) {
    std::vector<Point> normals(mesh.points.size(), Point{});
    for (const Triangle& t : triangles_of(mesh.connectivity)) {
        const Point& a = mesh.points[at(t[0])];
        const Point normal =
            cross(plus(mesh.points[at(t[1])], a, -1.0), plus(mesh.points[at(t[2])], a, -1.0));
        for (const Index v : t) normals[at(v)] = plus(normals[at(v)], normal);
    }
    for (Point& n : normals) n = unit(n);
    return normals;
}

SurfaceMesh with_points(const SurfaceMesh& mesh, std::vector<Point> points) {
    return make_surface_mesh(std::move(points), triangles_of(mesh.connectivity));
}

Point normal_of(const std::array<Point, 3>& t) {
    return cross(plus(t[1], t[0], -1.0), plus(t[2], t[0], -1.0));
}

/// Smallest angle of a triangle in space, radians.
double smallest_corner(const std::array<Point, 3>& t) {
    double smallest = std::numbers::pi;
    for (std::size_t k = 0; k < 3; ++k) {
        const Point u = plus(t[(k + 1) % 3], t[k], -1.0), v = plus(t[(k + 2) % 3], t[k], -1.0);
        const Point n = cross(u, v);
        smallest = std::min(smallest, std::atan2(std::sqrt(dot(n, n)), dot(u, v)));
    }
    return smallest;
}

/// The faces that fill the triangle a b c, whose edges ab, bc, ca are cut at the points in `cut` (kNoTwin:
/// not).
void fill_face(std::array<Index, 3> corner, std::array<Index, 3> cut, const std::vector<Point>& points,
               std::vector<Triangle>& faces) {
    const auto cuts = std::count_if(cut.begin(), cut.end(), [](Index m) { return m != kNoTwin; });
    if (cuts == 0) {
        faces.push_back(corner);
        return;
    }
    // Turned so that ab is cut, and with two cuts ca is not.
    while (cut[0] == kNoTwin || (cuts == 2 && cut[2] != kNoTwin)) {
        std::rotate(corner.begin(), corner.begin() + 1, corner.end());
        std::rotate(cut.begin(), cut.begin() + 1, cut.end());
    }
    const auto [a, b, c] = corner;
    const auto [ab, bc, ca] = cut;
    if (cuts == 1) {
        faces.insert(faces.end(), {{a, ab, c}, {ab, b, c}});
    } else if (cuts == 3) {
        faces.insert(faces.end(), {{a, ab, ca}, {ab, b, bc}, {bc, c, ca}, {ab, bc, ca}});
    } else {
        faces.push_back({ab, b, bc});
        const Point one = plus(points[at(a)], points[at(bc)], -1.0),
                    other = plus(points[at(c)], points[at(ab)], -1.0);
        if (dot(one, one) < dot(other, other)) {
            faces.insert(faces.end(), {{a, ab, bc}, {a, bc, c}});
        } else {
            faces.insert(faces.end(), {{a, ab, c}, {ab, bc, c}});
        }
    }
}

SurfaceMesh cut_edges(const SurfaceMesh& mesh, double share, RandomNumbers& random) {
    const Connectivity& c = mesh.connectivity;
    std::vector<Point> points = mesh.points;
    std::vector<Index> cut(at(c.edge_count), kNoTwin);
    for (const Index h : edge_halfedges(c)) {
        if (random.uniform(0.0, 1.0) >= share) continue;
        const Point &a = mesh.points[at(c.tail[at(h)])], &b = mesh.points[at(c.head(h))];
        cut[at(c.edge[at(h)])] = static_cast<Index>(points.size());
        points.push_back(plus(a, plus(b, a, -1.0), random.uniform(0.25, 0.75)));
    }
    std::vector<Triangle> faces;
    for (Index h = 0; h < c.halfedge_count(); h += 3) {
        fill_face({c.tail[at(h)], c.tail[at(h + 1)], c.tail[at(h + 2)]},
                  {cut[at(c.edge[at(h)])], cut[at(c.edge[at(h + 1)])], cut[at(c.edge[at(h + 2)])]}, points,
                  faces);
    }
    return make_surface_mesh(std::move(points), faces);
}

std::uint64_t vertex_pair(Index a, Index b) {
    return (static_cast<std::uint64_t>(std::min(a, b)) << 32U) | static_cast<std::uint64_t>(std::max(a, b));
}

/// Whether the edge of h may flip without a change of the surface, and without bad triangles.
bool flips_in_place(const SurfaceMesh& mesh, const Connectivity& c, Index h) {
    constexpr double kCoplanar = 1e-6, kSmallestAngle = 15.0 * std::numbers::pi / 180.0;
    if (!flippable(c, h)) return false;
    const Index t = c.twin[at(h)];
    const auto corner = [&](Index g) { return mesh.points[at(c.tail[at(g)])]; };
    const Point i = corner(h), j = corner(t), k = corner(prev_halfedge(h)), l = corner(prev_halfedge(t));
    const std::array<std::array<Point, 3>, 2> before{{{i, j, k}, {j, i, l}}}, after{{{i, l, k}, {l, j, k}}};
    const Point n = unit(normal_of(before[0])), m = unit(normal_of(before[1])), miss = plus(n, m, -1.0);
    if (dot(miss, miss) > kCoplanar * kCoplanar) return false;
    const double now = std::min(smallest_corner(before[0]), smallest_corner(before[1]));
    return std::all_of(after.begin(), after.end(), [&](const std::array<Point, 3>& face) {
        return dot(normal_of(face), n) > 0.0 && smallest_corner(face) >= std::min(now, kSmallestAngle);
    });
}

SurfaceMesh flip_coplanar(const SurfaceMesh& mesh, RandomNumbers& random) {
    Connectivity c = mesh.connectivity;
    std::unordered_set<std::uint64_t> joined;
    for (Index h = 0; h < c.halfedge_count(); ++h) joined.insert(vertex_pair(c.tail[at(h)], c.head(h)));
    for (Index tries = 0; tries < c.halfedge_count(); ++tries) {
        const auto h = static_cast<Index>(random.below(at(c.halfedge_count())));
        if (!flips_in_place(mesh, c, h)) continue;
        const Index k = c.tail[at(prev_halfedge(h))], l = c.tail[at(prev_halfedge(c.twin[at(h)]))];
        if (!joined.insert(vertex_pair(k, l)).second) continue;
        joined.erase(vertex_pair(c.tail[at(h)], c.head(h)));
        flip_edge(c, h);
    }
    return make_surface_mesh(mesh.points, triangles_of(c));
}

/// Cut at random and decimated back to the number of faces before: other vertices on nearly the same surface.
SurfaceMesh remeshed(const SurfaceMesh& mesh, std::uint64_t seed) {
    RandomNumbers random(seed);
    SurfaceMesh room = mesh;
    while (room.connectivity.face_count() < kRoomForDecimation) room = subdivide_midpoint(room);
    const Index faces = room.connectivity.face_count();
    return resample(cut_edges(room, 1.0 / 3.0, random), faces).mesh;
}

SurfaceMesh finer(const SurfaceMesh& mesh, Index most_faces) {
    const auto faces = static_cast<std::int64_t>(mesh.connectivity.face_count());
    if (4 * faces <= most_faces) return subdivide_midpoint(mesh);
    if (faces > most_faces) throw std::invalid_argument("subdivision: more faces than --most-faces already");
    return resample(mesh, most_faces).mesh;
}

}  // namespace

Box bounding_box(const SurfaceMesh& mesh) {
    Point low{}, high{};
    low.fill(1e300);
    high.fill(-1e300);
    for (const Index v : mesh.connectivity.tail)
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], mesh.points[at(v)][k]);
            high[k] = std::max(high[k], mesh.points[at(v)][k]);
        }
    const Point size = plus(high, low, -1.0);
    return {plus(low, size, 0.5), std::sqrt(dot(size, size))};
}

double smallest_angle(const SurfaceMesh& mesh) {
    double smallest = std::numbers::pi;
    for (const Triangle& t : triangles_of(mesh.connectivity))
        smallest = std::min(
            smallest, smallest_corner({mesh.points[at(t[0])], mesh.points[at(t[1])], mesh.points[at(t[2])]}));
    return smallest * 180.0 / std::numbers::pi;
}

SurfaceMesh moebius_image(const SurfaceMesh& mesh, std::uint64_t seed) {
    constexpr double kDistance = 1.25;  // of the centre from the box's middle, in diagonals
    RandomNumbers random(seed);
    const Box box = bounding_box(mesh);
    const Point centre = plus(box.middle, random.direction(), kDistance * box.diagonal);
    const Frame frame = random_frame(random);
    const double scale = box.diagonal * box.diagonal * random.uniform(0.3, 3.0);
    std::vector<Point> points = mesh.points;
    for (Point& p : points) {
        const Point from = plus(p, centre, -1.0);
        const double factor = scale / dot(from, from);
        p = {factor * dot(frame[0], from), factor * dot(frame[1], from), factor * dot(frame[2], from)};
    }
    return with_points(mesh, std::move(points));
}

SurfaceMesh with_noise(const SurfaceMesh& mesh, double share, bool along_normals, std::uint64_t seed) {
    RandomNumbers random(seed);
    const double deviation = share * bounding_box(mesh).diagonal;
    const std::vector<Point> normals = vertex_normals(mesh);
    std::vector<Point> points = mesh.points;
    for (std::size_t v = 0; v < points.size(); ++v) {
        if (along_normals) {
            points[v] = plus(points[v], normals[v], deviation * random.normal());
        } else {
            for (double& x : points[v]) x += deviation / std::numbers::sqrt3 * random.normal();
        }
    }
    return with_points(mesh, std::move(points));
}

SurfaceMesh retriangulated(const SurfaceMesh& mesh, std::uint64_t seed) {
    RandomNumbers random(seed);
    return flip_coplanar(cut_edges(mesh, 1.0 / 3.0, random), random);
}

SurfaceMesh relabelled(const SurfaceMesh& mesh, std::uint64_t seed) {
    RandomNumbers random(seed);
    const auto shuffle = [&](auto& values) {
        for (std::size_t k = values.size(); k > 1; --k) std::swap(values[k - 1], values[random.below(k)]);
    };
    std::vector<Index> order;
    const std::vector<std::uint8_t> used = used_vertices(mesh.connectivity);
    for (std::size_t v = 0; v < used.size(); ++v)
        if (used[v] != 0) order.push_back(static_cast<Index>(v));
    shuffle(order);
    std::vector<Index> number(used.size(), kNoTwin);
    std::vector<Point> points;
    for (const Index v : order) {
        number[at(v)] = static_cast<Index>(points.size());
        points.push_back(mesh.points[at(v)]);
    }
    std::vector<Triangle> faces = triangles_of(mesh.connectivity);
    shuffle(faces);
    for (Triangle& t : faces) {
        for (Index& v : t) v = number[at(v)];
        std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(random.below(3)), t.end());
    }
    return make_surface_mesh(std::move(points), faces);
}

SurfaceMesh decimated(const SurfaceMesh& mesh, double share) {
    SurfaceMesh room = mesh;
    while (room.connectivity.face_count() < kRoomForDecimation) room = subdivide_midpoint(room);
    return resample(room, static_cast<Index>(std::lround(share * room.connectivity.face_count()))).mesh;
}

std::vector<VariantMaker> variant_makers(Index most_faces) {
    constexpr double kNoise = 1e-3;
    using Mesh = const SurfaceMesh&;
    using Seed = std::uint64_t;
    return {{"moebius1", [](Mesh m, Seed s) { return moebius_image(m, s); }},
            {"moebius2", [](Mesh m, Seed s) { return moebius_image(m, s); }},
            {"half", [](Mesh m, Seed) { return decimated(m, 0.5); }},
            {"quarter", [](Mesh m, Seed) { return decimated(m, 0.25); }},
            {"finer", [most_faces](Mesh m, Seed) { return finer(m, most_faces); }},
            {"noise1", [](Mesh m, Seed s) { return with_noise(m, kNoise, true, s); }},
            {"noise2", [](Mesh m, Seed s) { return with_noise(m, kNoise, false, s); }},
            {"retriangulated", [](Mesh m, Seed s) { return retriangulated(m, s); }},
            {"remeshed", [](Mesh m, Seed s) { return remeshed(m, s); }},
            {"relabelled", [](Mesh m, Seed s) { return relabelled(m, s); }}};
}

std::vector<VariantMaker> substitute_makers() {
    using Mesh = const SurfaceMesh&;
    using Seed = std::uint64_t;
    return {{"moebius3", [](Mesh m, Seed s) { return moebius_image(m, s); }},
            {"retriangulated2", [](Mesh m, Seed s) { return retriangulated(m, s); }},
            {"noise3", [](Mesh m, Seed s) { return with_noise(m, 1e-3, true, s); }},
            {"moebius4", [](Mesh m, Seed s) { return moebius_image(m, s); }}};
}

}  // namespace ricci::bench
