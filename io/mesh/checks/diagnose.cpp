#include "io/mesh/checks/diagnose.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "io/mesh/checks/collinear.h"
#include "io/mesh/checks/orientation.h"
#include "io/mesh/checks/quality.h"
#include "io/mesh/repair/repair_triangles.h"
#include "kernels/point_distance.h"

namespace ricci {
namespace {

class Diagnosis {
  public:
    Diagnosis(const TriangleSoup& soup, std::span<const Point> points, const RepairOptions& repair,
              DefectList& errors)
        : soup_(soup),
          points_(points),
          repair_(repair),
          errors_(errors),
          edges_(soup_edges(soup, static_cast<Index>(points.size()))),
          halfedge_count_(static_cast<Index>(3 * soup.triangles.size())) {}

    void run(MeshReport& report) {
        check_duplicates();
        const bool edges_manifold = check_edges();
        check_orientation(report);
        const bool vertices_manifold = check_vertices();
        check_lengths();
        check_areas();
        report.manifold = edges_manifold && vertices_manifold;
        count(report);
    }

  private:
    [[nodiscard]] std::string edge_name(Index h) const {
        const auto [low, high] = std::minmax({soup_.tail(h), soup_.head(h)});
        return "edge (" + std::to_string(low) + ", " + std::to_string(high) + ")";
    }

    [[nodiscard]] std::string face_names(std::span<const Index> halfedges) const {
        constexpr std::size_t kNamed = 8;
        std::string names;
        for (std::size_t i = 0; i < halfedges.size() && i < kNamed; ++i) {
            names += (i > 0 ? ", " : "") + std::to_string(soup_.source(halfedges[i]));
        }
        return names + (halfedges.size() > kNamed ? ", ..." : "");
    }

    void check_duplicates() {
        std::vector<std::pair<Triangle, Index>> sorted(soup_.triangles.size());
        for (std::size_t f = 0; f < sorted.size(); ++f) {
            sorted[f] = {soup_.triangles[f], static_cast<Index>(f)};
            std::sort(sorted[f].first.begin(), sorted[f].first.end());
        }
        std::sort(sorted.begin(), sorted.end());
        std::vector<std::pair<Index, Index>> repeats;  // face, first face with the same vertices
        for (std::size_t i = 1, first = 0; i < sorted.size(); ++i) {
            if (sorted[i].first == sorted[first].first) {
                repeats.emplace_back(sorted[i].second, sorted[first].second);
            } else {
                first = i;
            }
        }
        std::sort(repeats.begin(), repeats.end());
        for (const auto& [f, original] : repeats) add_duplicate(f, original);
    }

    void add_duplicate(Index f, Index original) {
        const Index face = soup_.source_face[to_size(f)];
        errors_.add("duplicate_face", "face", face, [&] {
            const Triangle& t = soup_.triangles[to_size(f)];
            return "face " + std::to_string(face) + " has the same vertices (" + std::to_string(t[0]) + ", " +
                   std::to_string(t[1]) + ", " + std::to_string(t[2]) + ") as face " +
                   std::to_string(soup_.source_face[to_size(original)]) +
                   "; no --repair flag helps, delete one of them";
        });
    }

    bool check_edges() {
        bool manifold = true;
        for (Index e = 0; e < edges_.count(); ++e) {
            const std::span<const Index> halfedges = edges_.of(e);
            if (halfedges.size() <= 2) continue;
            manifold = false;
            errors_.add("non_manifold_edge", "edge", e, [&] {
                return edge_name(halfedges[0]) + " has " + std::to_string(halfedges.size()) + " faces (" +
                       face_names(halfedges) + "), but a surface has at most two; no --repair flag helps";
            });
        }
        return manifold;
    }

    void check_orientation(MeshReport& report) {
        const Orientation orientation = orientation_of(soup_, edges_);
        orientable_ = orientation.contradiction.empty();
        report.oriented = orientable_;
        for (const Index e : orientation.contradiction) {
            errors_.add("non_orientable", "edge", e, [&] {
                return "the surface is one-sided (like a Moebius band or Klein bottle): orienting it from "
                       "face to "
                       "face contradicts itself at " +
                       edge_name(edges_.of(e)[0]) + " between faces " + face_names(edges_.of(e)) +
                       "; no --repair flag helps, the surface would have to be cut";
            });
        }
        for (std::size_t f = 0; f < orientation.flip.size(); ++f) {
            if (orientation.flip[f] == 0) continue;
            report.oriented = false;
            const Index face = soup_.source_face[f];
            errors_.add("unoriented", "face", face, [&] {
                return "face " + std::to_string(face) +
                       " is oriented against the majority of the faces it is connected to; --repair orient "
                       "flips it";
            });
        }
    }

    /// A vertex is a pinch where its faces fall into several fans; fans are joined by shared edges.
    bool check_vertices() {
        DisjointSets corners(halfedge_count_);
        for (Index e = 0; e < edges_.count(); ++e) {
            const std::span<const Index> halfedges = edges_.of(e);
            const Index h = halfedges[0];
            for (const Index g : halfedges.subspan(1)) {
                const bool same = soup_.tail(g) == soup_.tail(h);
                corners.unite(h, same ? g : next_halfedge(g));
                corners.unite(next_halfedge(h), same ? next_halfedge(g) : g);
            }
        }
        std::vector<Index> fans(points_.size(), 0);
        for (Index h = 0; h < halfedge_count_; ++h)
            fans[to_size(soup_.tail(h))] += corners.find(h) == h ? 1 : 0;
        bool manifold = true;
        for (std::size_t v = 0; v < fans.size(); ++v) {
            if (fans[v] <= 1) continue;
            manifold = false;
            errors_.add("non_manifold_vertex", "vertex", static_cast<Index>(v), [&] {
                return "vertex " + std::to_string(v) + " joins " + std::to_string(fans[v]) +
                       " separate fans of faces that meet in this point only (a pinch); no --repair flag "
                       "helps, "
                       "split the vertex";
            });
        }
        return manifold;
    }

    void check_lengths() {
        for (Index e = 0; e < edges_.count(); ++e) {
            const Index h = edges_.of(e)[0];
            const Point& tail = points_[to_size(soup_.tail(h))];
            const Point& head = points_[to_size(soup_.head(h))];
            if (!std::isfinite(point_distance(tail, head))) {
                errors_.add("not_finite", "edge", e, [&] {
                    return edge_name(h) + " of face " + std::to_string(soup_.source(h)) +
                           " is longer than the range of double precision; scale the mesh down";
                });
            }
            if (tail != head) continue;
            errors_.add("zero_length_edge", "edge", e, [&] {
                return edge_name(h) + " of face " + std::to_string(soup_.source(h)) +
                       " has length zero: its vertices have equal coordinates; --repair weld,drop-degenerate "
                       "helps";
            });
        }
    }

    [[nodiscard]] std::string flat_advice(bool needle) const {
        if (needle) return "two of its vertices have equal coordinates; --repair weld,drop-degenerate helps";
        if (!repair_.drop_degenerate)
            return "its vertices lie exactly on one line; --repair drop-degenerate helps";
        return std::string(
                   "its vertices lie exactly on one line, and it cannot be repaired: flipping its longest "
                   "edge ") +
               "would "
               "double an edge, or that edge is non-manifold or borders on another face that cannot be "
               "repaired, or "
               "it belongs to a chain of more than " +
               std::to_string(flat_rounds(soup_.triangles.size())) + " such faces";
    }

    void check_areas() {
        for (std::size_t f = 0; f < soup_.triangles.size(); ++f) {
            const Triangle& t = soup_.triangles[f];
            const Point& a = points_[to_size(t[0])];
            const Point& b = points_[to_size(t[1])];
            const Point& c = points_[to_size(t[2])];
            if (!collinear(a, b, c)) continue;
            const Index face = soup_.source_face[f];
            errors_.add("zero_area_face", "face", face, [&] {
                return "face " + std::to_string(face) + " (" + std::to_string(t[0]) + ", " +
                       std::to_string(t[1]) + ", " + std::to_string(t[2]) +
                       ") has zero area: " + flat_advice(a == b || b == c || c == a);
            });
        }
    }

    void count(MeshReport& report) {
        std::vector<std::uint8_t> used(points_.size(), 0);
        DisjointSets pieces(static_cast<Index>(points_.size()));
        for (Index h = 0; h < halfedge_count_; ++h) {
            used[to_size(soup_.tail(h))] = 1;
            pieces.unite(soup_.tail(h), soup_.head(h));
        }
        Index vertices = 0;
        Index components = 0;
        for (std::size_t v = 0; v < used.size(); ++v) {
            vertices += used[v];
            components += used[v] != 0 && pieces.find(static_cast<Index>(v)) == static_cast<Index>(v) ? 1 : 0;
        }
        report.vertices = vertices;
        report.edges = edges_.count();
        report.faces = static_cast<Index>(soup_.triangles.size());
        report.components = components;
        report.euler_characteristic = vertices - edges_.count() + *report.faces;
        if (!*report.manifold) return;  // boundaries and genus are defined for surfaces only
        report.boundaries = count_boundaries();
        if (orientable_)
            report.genus = (2 * components - *report.boundaries - *report.euler_characteristic) / 2;
    }

    /// On a manifold each boundary vertex has two boundary edges, so that connected boundary edges are loops.
    [[nodiscard]] Index count_boundaries() const {
        DisjointSets loops(static_cast<Index>(points_.size()));
        std::vector<std::uint8_t> boundary(points_.size(), 0);
        for (Index e = 0; e < edges_.count(); ++e) {
            if (edges_.of(e).size() != 1) continue;
            const Index h = edges_.of(e)[0];
            loops.unite(soup_.tail(h), soup_.head(h));
            boundary[to_size(soup_.tail(h))] = boundary[to_size(soup_.head(h))] = 1;
        }
        Index boundaries = 0;
        for (std::size_t v = 0; v < boundary.size(); ++v) {
            boundaries +=
                boundary[v] != 0 && loops.find(static_cast<Index>(v)) == static_cast<Index>(v) ? 1 : 0;
        }
        return boundaries;
    }

    const TriangleSoup& soup_;
    std::span<const Point> points_;
    RepairOptions repair_;
    DefectList& errors_;
    SoupEdges edges_;
    Index halfedge_count_;
    bool orientable_ = true;
};

}  // namespace

void diagnose(const TriangleSoup& soup, std::span<const Point> points, const RepairOptions& repair,
              MeshReport& report, DefectList& errors) {
    Diagnosis(soup, points, repair, errors).run(report);
    const Quality quality = quality_of(soup.triangles, points);
    report.min_angle_deg = quality.min_angle_deg;
    report.obtuse_fraction = quality.obtuse_fraction;
}

void describe(const SurfaceMesh& mesh, MeshReport& report) {
    const Topology topology = topology_of(mesh.connectivity);
    report.vertices = topology.vertices;
    report.edges = topology.edges;
    report.faces = topology.faces;
    report.components = topology.components;
    report.boundaries = topology.boundaries;
    report.genus = topology.genus;
    report.euler_characteristic = topology.euler_characteristic;
    report.manifold = true;
    report.oriented = true;
    const Quality quality = mesh.intrinsic() ? quality_of(mesh.edge_length)
                                             : quality_of(triangles_of(mesh.connectivity), mesh.points);
    report.min_angle_deg = quality.min_angle_deg;
    report.obtuse_fraction = quality.obtuse_fraction;
}

}  // namespace ricci
