#include "engine/remesh/nearest_vertex.h"

#include <limits>
#include <nanoflann.hpp>
#include <stdexcept>

namespace ricci {
namespace {

/// The used vertices of a surface, as nanoflann wants to see them.
struct VertexCloud {
    std::vector<Index> vertex;  // ascending
    std::span<const Point> points;

    [[nodiscard]] std::size_t kdtree_get_point_count() const { return vertex.size(); }
    [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const {
        return points[static_cast<std::size_t>(vertex[i])][axis];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

/// nanoflann's own result set keeps whichever of equally near points it meets first; this one the lowest.
class LowestNearest {
  public:
    using DistanceType = double;
    [[nodiscard]] std::size_t size() const { return full() ? 1 : 0; }
    [[nodiscard]] bool full() const { return distance_ < std::numeric_limits<double>::infinity(); }
    // The search skips branches and points that are not nearer than this: equal ones must pass.
    [[nodiscard]] double worstDist() const {
        return std::nextafter(distance_, std::numeric_limits<double>::infinity());
    }
    bool addPoint(double distance, std::size_t number) {
        if (distance < distance_ || (distance == distance_ && number < number_)) {
            distance_ = distance;
            number_ = number;
        }
        return true;
    }
    [[nodiscard]] std::size_t number() const { return number_; }

  private:
    double distance_ = std::numeric_limits<double>::infinity();
    std::size_t number_ = std::numeric_limits<std::size_t>::max();
};

}  // namespace

std::vector<Index> nearest_vertices(const SurfaceMesh& mesh, std::span<const Point> points) {
    if (mesh.intrinsic())
        throw std::invalid_argument("nearest_vertices: an intrinsic surface has no positions");
    VertexCloud cloud{{}, mesh.points};
    const std::vector<std::uint8_t> used = used_vertices(mesh.connectivity);
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (used[v] != 0) cloud.vertex.push_back(static_cast<Index>(v));
    }
    using Distance = nanoflann::L2_Simple_Adaptor<double, VertexCloud>;
    nanoflann::KDTreeSingleIndexAdaptor<Distance, VertexCloud, 3, std::size_t> tree(3, cloud);
    tree.buildIndex();
    std::vector<Index> nearest;
    nearest.reserve(points.size());
    for (const Point& p : points) {
        LowestNearest result;
        tree.findNeighbors(result, p.data(), nanoflann::SearchParams());
        nearest.push_back(cloud.vertex[result.number()]);
    }
    return nearest;
}

}  // namespace ricci
