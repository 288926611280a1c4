#include "engine/remesh/openmesh.h"

#include <Eigen/Dense>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace ricci {
namespace {

struct DoubleTraits : public OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
    VertexAttributes(OpenMesh::Attributes::Status);
    EdgeAttributes(OpenMesh::Attributes::Status);
    HalfedgeAttributes(OpenMesh::Attributes::Status | OpenMesh::Attributes::PrevHalfedge);
    FaceAttributes(OpenMesh::Attributes::Status);
};
using OpenMeshSurface = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;
using Vector = OpenMesh::Vec3d;

struct Converted {
    OpenMeshSurface surface;
    Vector low;  // a point p of the source is at (p - low) / size
    double size = 1.0;
};

/// The used vertices in their order, moved and scaled into the unit cube (collapse errors are single
/// precision numbers in OpenMesh, fourth powers of lengths).
Converted to_openmesh(const SurfaceMesh& mesh) {
    if (mesh.intrinsic())
        throw std::invalid_argument("resample: an intrinsic surface has no positions to work on");
    const std::vector<std::uint8_t> used = used_vertices(mesh.connectivity);
    Vector low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (used[v] == 0) continue;
        const Vector p(mesh.points[v][0], mesh.points[v][1], mesh.points[v][2]);
        low.minimize(p);
        high.maximize(p);
    }
    const double size = (high - low).max();
    Converted result;
    result.low = low;
    result.size = size;
    std::vector<OpenMeshSurface::VertexHandle> handle(used.size());
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (used[v] == 0) continue;
        const Vector p(mesh.points[v][0], mesh.points[v][1], mesh.points[v][2]);
        handle[v] = result.surface.add_vertex((p - low) / size);
    }
    for (const Triangle& t : triangles_of(mesh.connectivity)) {
        const auto corner = [&](std::size_t k) { return handle[static_cast<std::size_t>(t[k])]; };
        if (!result.surface.add_face(corner(0), corner(1), corner(2)).is_valid()) {
            throw std::invalid_argument(
                "resample: OpenMesh cannot represent this surface (a vertex or edge where "
                "two sheets touch)");
        }
    }
    return result;
}

/// Triangles of what was not deleted, in OpenMesh's vertex numbers.
std::vector<Triangle> triangles_of_openmesh(const OpenMeshSurface& surface) {
    std::vector<Triangle> triangles;
    for (const auto face : surface.faces()) {  // skips deleted ones
        Triangle t{};
        std::size_t k = 0;
        for (const auto vertex : surface.fv_range(face)) t[k++] = vertex.idx();
        triangles.push_back(t);
    }
    return triangles;
}

/// Order and legality of collapses, as one OpenMesh module.
template <class MeshT>
class SurfaceError : public OpenMesh::Decimater::ModBaseT<MeshT> {
  public:
    DECIMATING_MODULE(SurfaceError, MeshT, SurfaceError)

    explicit SurfaceError(MeshT& mesh) : Base(mesh, false) {}

    void initialize() override {
        quadric_.assign(Base::mesh().n_vertices(), Quadric());
        for (const auto face : Base::mesh().faces()) add_face(face);
        for (const auto halfedge : Base::mesh().halfedges()) {
            if (Base::mesh().is_boundary(halfedge))
                add_boundary(Base::mesh().opposite_halfedge_handle(halfedge));
        }
    }

    float collapse_priority(const CollapseInfo& collapse) override {
        const double worst = worst_quality_with(collapse.v0, collapse.v1, collapse.p1);
        if (!(worst > 0.0)) return Base::ILLEGAL_COLLAPSE;
        const Quadric sum = quadric(collapse.v0) + quadric(collapse.v1);
        // Quadric error alone makes thin triangles, and the flow has to live with them: measured on the
        // samples, the fourth power takes the share of faces with an angle above 120 degrees from 12 % to 1
        // %, the smallest angle from 7 to 16 degrees, and costs 0.1 % of the area.
        return static_cast<float>(std::max(0.0, sum(collapse.p1)) / (worst * worst * worst * worst));
    }

    void postprocess_collapse(const CollapseInfo& collapse) override {
        quadric(collapse.v1) += quadric(collapse.v0);
    }

    /// Moves every vertex to the point nearest to the planes of all faces that ended in it, as far as the
    /// faces around it allow: a subset of the input's vertices lies on one side of a curved surface, and its
    /// faces are shrunk. In order, each vertex seeing those before it in their new places.
    void place_vertices() {
        for (const auto vertex : Base::mesh().vertices()) {  // skips deleted ones
            const Vector from = Base::mesh().point(vertex);
            const Vector step = best_place(quadric(vertex)) - from;
            for (double share = 1.0; share > kLeastShare; share *= 0.5) {
                if (!(worst_quality_with(vertex, vertex, from + share * step) > 0.0)) continue;
                Base::mesh().set_point(vertex, from + share * step);
                break;
            }
        }
    }

  private:
    using Quadric = OpenMesh::Geometry::QuadricT<double>;

    // Weight of a boundary's plane against a face's of equal area: the outline matters more than the surface.
    static constexpr double kBoundaryWeight = 10.0;
    // Weight of the distance to the vertex itself: decides where the surface is flat and every collapse would
    // do.
    static constexpr double kSpacingWeight = 1e-3;
    // A face may turn by 60 degrees at most in one collapse.
    static constexpr double kLeastNormalProduct = 0.5;
    // Faces below this quality (1: equilateral; 0.2: smallest angle about seven degrees) are made only out of
    // worse ones.
    static constexpr double kLeastQuality = 0.2;
    // A vertex that cannot go this part of its way stays.
    static constexpr double kLeastShare = 0.1;

    Quadric& quadric(OpenMesh::VertexHandle v) { return quadric_[static_cast<std::size_t>(v.idx())]; }

    void add_face(OpenMesh::FaceHandle face) {
        std::array<OpenMesh::VertexHandle, 3> corner;
        std::size_t k = 0;
        for (const auto vertex : Base::mesh().fv_range(face)) corner[k++] = vertex;
        const Vector& p = Base::mesh().point(corner[0]);
        Vector normal = (Base::mesh().point(corner[1]) - p) % (Base::mesh().point(corner[2]) - p);
        const double twice_area = normal.norm();
        if (!(twice_area > 0.0)) return;
        normal /= twice_area;
        for (const OpenMesh::VertexHandle v : corner) {
            quadric(v) += Quadric(normal, p) * (0.5 * twice_area);
            quadric(v) += Quadric(Base::mesh().point(v)) * (0.5 * twice_area * kSpacingWeight);
        }
    }

    /// The plane through a boundary edge, orthogonal to its face.
    void add_boundary(OpenMesh::HalfedgeHandle inner) {
        const OpenMesh::VertexHandle from = Base::mesh().from_vertex_handle(inner);
        const OpenMesh::VertexHandle to = Base::mesh().to_vertex_handle(inner);
        const OpenMesh::VertexHandle apex =
            Base::mesh().to_vertex_handle(Base::mesh().next_halfedge_handle(inner));
        const Vector& p = Base::mesh().point(from);
        const Vector edge = Base::mesh().point(to) - p;
        Vector normal = edge % (edge % (Base::mesh().point(apex) - p));
        const double length = normal.norm();
        if (!(length > 0.0)) return;
        normal /= length;
        const Quadric plane = Quadric(normal, p) * (kBoundaryWeight * edge.sqrnorm());
        quadric(from) += plane;
        quadric(to) += plane;
    }

    /// 4 sqrt(3) area / (a^2 + b^2 + c^2).
    static double quality(const Vector& a, const Vector& b, const Vector& c, double twice_area) {
        constexpr double kTwoSqrt3 = 3.4641016151377544;
        return kTwoSqrt3 * twice_area / ((b - a).sqrnorm() + (c - b).sqrnorm() + (a - c).sqrnorm());
    }

    /// Where the quadric is smallest. Distances to vertices are part of it, so that there is one such point.
    static Vector best_place(const Quadric& q) {
        Eigen::Matrix3d a;
        a << q.xx(), q.xy(), q.xz(), q.xy(), q.yy(), q.yz(), q.xz(), q.yz(), q.zz();
        const Eigen::Vector3d place = a.ldlt().solve(-Eigen::Vector3d(q.xw(), q.yw(), q.zw()));
        return {place[0], place[1], place[2]};
    }

    /// Quality of the worst face at `moved` when that goes to `place`, faces that also hold `target` vanish
    /// (a collapse; target == moved: none does); 0 when one turns over or becomes a sliver.
    double worst_quality_with(OpenMesh::VertexHandle moved, OpenMesh::VertexHandle target,
                              const Vector& place) {
        double worst_before = 1.0, worst_after = 1.0;
        for (const auto face : Base::mesh().vf_range(moved)) {
            std::array<OpenMesh::VertexHandle, 3> corner;
            std::size_t k = 0;
            for (const auto vertex : Base::mesh().fv_range(face)) corner[k++] = vertex;
            std::array<Vector, 3> before, after;
            bool vanishes = false;
            for (std::size_t c = 0; c < 3; ++c) {
                before[c] = Base::mesh().point(corner[c]);
                after[c] = corner[c] == moved ? place : before[c];
                vanishes = vanishes || (target != moved && corner[c] == target);
            }
            const Vector old_normal = (before[1] - before[0]) % (before[2] - before[0]);
            const double old_area = old_normal.norm();
            worst_before = std::min(worst_before, quality(before[0], before[1], before[2], old_area));
            if (vanishes) continue;
            const Vector new_normal = (after[1] - after[0]) % (after[2] - after[0]);
            const double new_area = new_normal.norm();
            if (!(new_area > 0.0)) return 0.0;
            if ((old_normal | new_normal) < kLeastNormalProduct * old_area * new_area) return 0.0;
            worst_after = std::min(worst_after, quality(after[0], after[1], after[2], new_area));
        }
        return worst_after >= std::min(kLeastQuality, worst_before) ? worst_after : 0.0;
    }

    std::vector<Quadric> quadric_;
};

}  // namespace

SurfaceMesh decimate(const SurfaceMesh& mesh, Index target_faces) {
    Converted source = to_openmesh(mesh);
    OpenMesh::Decimater::DecimaterT<OpenMeshSurface> decimater(source.surface);
    SurfaceError<OpenMeshSurface>::Handle module;
    decimater.add(module);
    decimater.initialize();
    decimater.decimate_to_faces(0, static_cast<std::size_t>(std::max<Index>(target_faces, 0)));
    decimater.module(module).place_vertices();
    std::vector<Triangle> triangles = triangles_of_openmesh(source.surface);
    std::vector<Index> number(source.surface.n_vertices(), -1);
    for (const Triangle& t : triangles) {
        for (const Index v : t) number[static_cast<std::size_t>(v)] = 0;
    }
    std::vector<Point> points;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] < 0) continue;
        number[v] = static_cast<Index>(points.size());
        const Vector p = source.low + source.size * source.surface.point(
                                                        OpenMeshSurface::VertexHandle(static_cast<int>(v)));
        points.push_back({p[0], p[1], p[2]});
    }
    for (Triangle& t : triangles) {
        for (Index& v : t) v = number[static_cast<std::size_t>(v)];
    }
    return make_surface_mesh(std::move(points), triangles);
}

}  // namespace ricci
