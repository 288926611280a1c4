#include "io/exchange/vertex_normals.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ricci {
namespace {

/// Twice the vector area.
Point area_vector(const GeometryBlock& block, std::span<const Index> cell) {
    Point sum{};
    for (std::size_t i = 0; i < cell.size(); ++i) {
        const Point& p = block.points[static_cast<std::size_t>(cell[i])];
        const Point& q = block.points[static_cast<std::size_t>(cell[(i + 1) % cell.size()])];
        sum[0] += (p[1] - q[1]) * (p[2] + q[2]);
        sum[1] += (p[2] - q[2]) * (p[0] + q[0]);
        sum[2] += (p[0] - q[0]) * (p[1] + q[1]);
    }
    return sum;
}

}  // namespace

std::vector<Point> vertex_normals(const GeometryBlock& block, std::span<const Index> identity) {
    const auto of = [&](std::size_t v) {
        return identity.empty() ? v : static_cast<std::size_t>(identity[v]);
    };
    std::size_t count = block.points.size();
    for (const Index v : identity) count = std::max(count, static_cast<std::size_t>(v) + 1);
    std::vector<Point> sum(count, Point{});
    for (std::size_t i = 0; i < block.cell_count(); ++i) {
        const Point area = area_vector(block, block.cell(i));
        for (const Index v : block.cell(i))
            for (std::size_t k = 0; k < 3; ++k) sum[of(static_cast<std::size_t>(v))][k] += area[k];
    }
    std::vector<Point> normals(block.points.size());
    for (std::size_t v = 0; v < normals.size(); ++v) {
        const Point& n = sum[of(v)];
        const double length = std::hypot(n[0], n[1], n[2]);
        normals[v] = length > 0.0 && std::isfinite(length)
                         ? Point{n[0] / length, n[1] / length, n[2] / length}
                         : Point{0.0, 0.0, 1.0};
    }
    return normals;
}

void add_normals(GeometryBlock& block, std::span<const Index> identity) {
    std::vector<double> values;
    values.reserve(3 * block.points.size());
    for (const Point& n : vertex_normals(block, identity)) values.insert(values.end(), n.begin(), n.end());
    block.point_data.push_back({"normal", "1", 3, std::move(values)});
    block.normals = "normal";
}

}  // namespace ricci
