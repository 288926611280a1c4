#include "engine/surfaces/grid.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "engine/surfaces/pattern_size.h"

namespace ricci {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

struct GridSize {
    Index around, across;  // numbers of cells
};

/// Cells for about `faces` triangles, nearly square when the grid is `aspect` times as long around as across;
/// at least three around and `least_across` across.
GridSize grid_size(Index faces, double aspect, Index least_across) {
    check_face_count(faces);
    const double cells = faces / 2.0;
    const double across = std::max<double>(least_across, std::round(std::sqrt(cells / aspect)));
    const double around = std::max(3.0, std::round(cells / across));
    check_face_count(2.0 * around * across);
    return {static_cast<Index>(around), static_cast<Index>(across)};
}

/// Two triangles per cell; vertex (i, j) has number i * columns + j, with i modulo `rows`, j modulo
/// `columns`. Counterclockwise where the directions of growing i and j are.
std::vector<Triangle> grid_triangles(GridSize cells, Index columns) {
    std::vector<Triangle> triangles;
    triangles.reserve(2 * static_cast<std::size_t>(cells.around) * static_cast<std::size_t>(cells.across));
    const auto vertex = [&](Index i, Index j) { return (i % cells.around) * columns + j % columns; };
    for (Index i = 0; i < cells.around; ++i) {
        for (Index j = 0; j < cells.across; ++j) {
            triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
            triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
        }
    }
    return triangles;
}

void check_radii(double major_radius, double minor_radius) {
    if (!(minor_radius > 0.0 && minor_radius < major_radius) || !std::isfinite(major_radius)) {
        throw std::invalid_argument("generate: the radii must satisfy 0 < minor < major");
    }
}

}  // namespace

SurfaceMesh make_torus(Index faces, double major_radius, double minor_radius) {
    check_radii(major_radius, minor_radius);
    const GridSize cells = grid_size(faces, major_radius / minor_radius, 3);
    std::vector<Point> points;
    for (Index i = 0; i < cells.around; ++i) {
        const double u = kTwoPi * i / cells.around;
        for (Index j = 0; j < cells.across; ++j) {
            const double v = kTwoPi * j / cells.across;
            const double distance = major_radius + minor_radius * std::cos(v);
            points.push_back({distance * std::cos(u), distance * std::sin(u), minor_radius * std::sin(v)});
        }
    }
    return make_surface_mesh(std::move(points), grid_triangles(cells, cells.across));
}

SurfaceMesh make_cylinder(Index faces, double height) {
    if (!(height > 0.0) || !std::isfinite(height)) {
        throw std::invalid_argument("generate: the height of an annulus must be positive");
    }
    const GridSize cells = grid_size(faces, kTwoPi / height, 1);
    const double radius = std::numbers::pi / (cells.around * std::sin(std::numbers::pi / cells.around));
    std::vector<Point> points;
    for (Index i = 0; i < cells.around; ++i) {
        const double u = kTwoPi * i / cells.around;
        for (Index j = 0; j <= cells.across; ++j) {
            points.push_back({radius * std::cos(u), radius * std::sin(u), height * j / cells.across});
        }
    }
    return make_surface_mesh(std::move(points), grid_triangles(cells, cells.across + 1));
}

SurfaceMesh make_plane_annulus(Index faces, double major_radius, double minor_radius) {
    check_radii(major_radius, minor_radius);
    const double logarithm = std::log(major_radius / minor_radius);
    const GridSize cells = grid_size(faces, kTwoPi / logarithm, 1);
    std::vector<Point> points;
    for (Index i = 0; i < cells.around; ++i) {
        const double u = kTwoPi * i / cells.around;
        for (Index j = 0; j <= cells.across; ++j) {
            // From the outer circle inwards, in geometric progression: similar triangles, seen from above.
            const double r = major_radius * std::exp(-logarithm * j / cells.across);
            points.push_back({r * std::cos(u), r * std::sin(u), 0.0});
        }
    }
    return make_surface_mesh(std::move(points), grid_triangles(cells, cells.across + 1));
}

SurfaceMesh make_disk(Index faces) {
    const Index rings = pattern_repeats(faces, 6.0);
    std::vector<Point> points = {{0.0, 0.0, 0.0}};
    for (Index k = 1; k <= rings; ++k) {
        const double radius = static_cast<double>(k) / rings;
        for (Index i = 0; i < 6 * k; ++i) {
            const double u = kTwoPi * i / (6 * k);
            points.push_back({radius * std::cos(u), radius * std::sin(u), 0.0});
        }
    }
    const auto vertex = [](Index k, Index i) { return k == 0 ? 0 : 1 + 3 * k * (k - 1) + i % (6 * k); };
    std::vector<Triangle> triangles;
    for (Index k = 0; k < rings; ++k) {
        for (Index sector = 0; sector < 6; ++sector) {
            const Index inner = sector * k, outer = sector * (k + 1);
            for (Index i = 0; i <= k; ++i) {
                triangles.push_back(
                    {vertex(k, inner + i), vertex(k + 1, outer + i), vertex(k + 1, outer + i + 1)});
                if (i < k) {
                    triangles.push_back(
                        {vertex(k, inner + i), vertex(k + 1, outer + i + 1), vertex(k, inner + i + 1)});
                }
            }
        }
    }
    return make_surface_mesh(std::move(points), triangles);
}

}  // namespace ricci
