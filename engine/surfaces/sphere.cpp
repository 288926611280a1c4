#include "engine/surfaces/sphere.h"

#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "engine/surfaces/pattern_size.h"

namespace ricci {
namespace {

constexpr double kGolden = 1.6180339887498949;

constexpr std::array<Point, 12> kCorners = {{{0, 1, kGolden},
                                             {0, 1, -kGolden},
                                             {0, -1, kGolden},
                                             {0, -1, -kGolden},
                                             {1, kGolden, 0},
                                             {1, -kGolden, 0},
                                             {-1, kGolden, 0},
                                             {-1, -kGolden, 0},
                                             {kGolden, 0, 1},
                                             {-kGolden, 0, 1},
                                             {kGolden, 0, -1},
                                             {-kGolden, 0, -1}}};

double squared_distance(const Point& a, const Point& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

double triple_product(const Point& a, const Point& b, const Point& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// The twenty triples of mutually adjacent corners (edges have length 2), counterclockwise from outside.
std::vector<Triangle> icosahedron_faces() {
    const auto adjacent = [](std::size_t a, std::size_t b) {
        return squared_distance(kCorners[a], kCorners[b]) < 4.5;
    };
    std::vector<Triangle> faces;
    for (std::size_t a = 0; a < 12; ++a) {
        for (std::size_t b = a + 1; b < 12; ++b) {
            for (std::size_t c = b + 1; c < 12; ++c) {
                if (!adjacent(a, b) || !adjacent(b, c) || !adjacent(a, c)) continue;
                Triangle face = {static_cast<Index>(a), static_cast<Index>(b), static_cast<Index>(c)};
                if (triple_product(kCorners[a], kCorners[b], kCorners[c]) < 0.0) std::swap(face[1], face[2]);
                faces.push_back(face);
            }
        }
    }
    return faces;
}

/// The points of the subdivided icosahedron, each shared by all faces that contain it.
class GeodesicPoints {
  public:
    explicit GeodesicPoints(Index frequency) : frequency_(frequency) {}

    /// The point with these integer weights (summing to the frequency) on the corners of `face`.
    Index at(const Triangle& face, const std::array<Index, 3>& weights) {
        std::map<Index, Index> key;  // corner -> weight: the same whichever face asks
        for (std::size_t k = 0; k < 3; ++k) {
            if (weights[k] > 0) key[face[k]] = weights[k];
        }
        const auto [place, is_new] = number_.try_emplace(key, static_cast<Index>(points_.size()));
        if (is_new) points_.push_back(on_sphere(key));
        return place->second;
    }

    std::vector<Point> take() { return std::move(points_); }

  private:
    [[nodiscard]] Point on_sphere(const std::map<Index, Index>& key) const {
        Point p = {0.0, 0.0, 0.0};
        for (const auto& [corner, weight] : key) {
            for (std::size_t k = 0; k < 3; ++k) {
                p[k] += kCorners[static_cast<std::size_t>(corner)][k] * weight / frequency_;
            }
        }
        const double length = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        return {p[0] / length, p[1] / length, p[2] / length};
    }

    Index frequency_;
    std::map<std::map<Index, Index>, Index> number_;
    std::vector<Point> points_;
};

}  // namespace

SurfaceMesh make_ellipsoid(Index faces, const std::array<double, 3>& semi_axes) {
    for (const double axis : semi_axes) {
        if (!(axis > 0.0) || !std::isfinite(axis)) {
            throw std::invalid_argument("generate: the semi-axes of an ellipsoid must be positive");
        }
    }
    const Index n = pattern_repeats(faces, 20.0);
    GeodesicPoints geodesic(n);
    std::vector<Triangle> triangles;
    for (const Triangle& face : icosahedron_faces()) {
        const auto point = [&](Index i, Index j) { return geodesic.at(face, {n - i - j, i, j}); };
        for (Index i = 0; i < n; ++i) {
            for (Index j = 0; i + j < n; ++j) {
                triangles.push_back({point(i, j), point(i + 1, j), point(i, j + 1)});
                if (i + j + 1 < n)
                    triangles.push_back({point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)});
            }
        }
    }
    std::vector<Point> points = geodesic.take();
    for (Point& p : points) {
        for (std::size_t k = 0; k < 3; ++k) p[k] *= semi_axes[k];
    }
    return make_surface_mesh(std::move(points), triangles);
}

}  // namespace ricci
