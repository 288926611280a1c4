// The checkerboard against its definition at random points, and its areas.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "io/picture/checkerboard.h"

namespace ricci {
namespace {

double area_of(std::span<const PlanePoint> polygon) {
    double sum = 0.0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
        sum += 0.5 * ((polygon[i][0] - polygon[0][0]) * (polygon[i + 1][1] - polygon[0][1]) -
                      (polygon[i][1] - polygon[0][1]) * (polygon[i + 1][0] - polygon[0][0]));
    return sum;
}
double area_of(const PlanePolygons& polygons) {
    double sum = 0.0;
    for (std::size_t i = 0; i < polygons.size(); ++i) sum += area_of(polygons.polygon(i));
    return sum;
}

// Whether a convex anticlockwise polygon holds the point, and how close it is to changing its mind.
std::pair<bool, double> holds(std::span<const PlanePoint> polygon, const PlanePoint& p) {
    bool inside = true;
    double margin = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const PlanePoint &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
        if (length == 0.0) continue;
        const double side = ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])) / length;
        inside = inside && side > 0.0;
        margin = std::min(margin, std::abs(side));
    }
    return {inside, margin};
}

TEST(PictureCheckerboard, SquareOfSquares) {
    // [0, 4]^2 in two triangles, drawn at twice the size: 8 of 16 squares of area 4.
    const std::vector<TexturedTriangle> triangles = {
        {{{{0, 0}, {8, 0}, {8, 8}}}, {{{0, 0}, {4, 0}, {4, 4}}}},
        {{{{0, 0}, {8, 8}, {0, 8}}}, {{{0, 0}, {4, 4}, {0, 4}}}}};
    const PlanePolygons black = black_squares(triangles);
    EXPECT_EQ(area_of(black), 32.0);   // all numbers are small dyadic ones
    EXPECT_EQ(black.size(), 6U + 6U);  // in each triangle two whole squares and four halves
    EXPECT_TRUE(holds(black.polygon(0), {0.9, 0.5}).first);  // square (0, 0) is black
    EXPECT_EQ(black_squares(triangles, 4.0).size(), 2U);     // one black square
    EXPECT_EQ(area_of(black_squares(triangles, 4.0)), 64.0);
    EXPECT_EQ(area_of(black_squares(triangles, 0.5)), 32.0);
    EXPECT_EQ(black_squares({}).size(), 0U);
}

TEST(PictureCheckerboard, RandomPointsAgreeWithTheDefinition) {
    std::mt19937_64 random(17);
    std::uniform_real_distribution<double> place(-1.0, 1.0), texture(-4.0, 4.0), unit(0.0, 1.0);
    int decided = 0;
    for (int i = 0; i < 300; ++i) {
        TexturedTriangle triangle;
        for (std::size_t k = 0; k < 3; ++k) {
            triangle.corners[k] = {place(random), place(random)};
            triangle.uv[k] = {texture(random), texture(random)};
        }
        if (area_of(std::span<const PlanePoint>(triangle.corners)) < 0.0) {
            std::swap(triangle.corners[0], triangle.corners[1]);
            std::swap(triangle.uv[0], triangle.uv[1]);
        }
        const PlanePolygons black = black_squares(std::span(&triangle, 1));
        for (int j = 0; j < 30; ++j) {
            double s = unit(random), t = unit(random);
            if (s + t > 1.0) s = 1.0 - s, t = 1.0 - t;
            const auto mix = [&](const std::array<PlanePoint, 3>& p, std::size_t k) {
                return p[0][k] + s * (p[1][k] - p[0][k]) + t * (p[2][k] - p[0][k]);
            };
            const PlanePoint point{mix(triangle.corners, 0), mix(triangle.corners, 1)};
            const bool expected =
                std::fmod(std::floor(mix(triangle.uv, 0)) + std::floor(mix(triangle.uv, 1)), 2.0) == 0.0;
            int found = 0;
            double margin = std::numeric_limits<double>::infinity();
            for (std::size_t n = 0; n < black.size(); ++n) {
                const auto [inside, distance] = holds(black.polygon(n), point);
                found += inside ? 1 : 0;
                margin = std::min(margin, distance);
            }
            if (margin < 1e-9) continue;  // too close to a side to say
            ++decided;
            EXPECT_EQ(found, expected ? 1 : 0);
        }
    }
    EXPECT_GT(decided, 8900);
}

TEST(PictureCheckerboard, BlackAndWhiteMakeTheWholeTriangle) {
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> any(-5.0, 5.0);
    for (int i = 0; i < 500; ++i) {
        TexturedTriangle triangle;
        for (std::size_t k = 0; k < 3; ++k) {
            triangle.corners[k] = {any(random), any(random)};
            // Corners on lines of the grid, and sides along them, are among these.
            triangle.uv[k] = i % 2 == 0 ? PlanePoint{any(random), any(random)}
                                        : PlanePoint{std::round(any(random)), std::round(any(random))};
        }
        // A triangle without area in texture coordinates lies in no square or along a line.
        if (area_of(std::span<const PlanePoint>(triangle.uv)) == 0.0) continue;
        TexturedTriangle shifted = triangle;
        for (PlanePoint& uv : shifted.uv) uv[0] += 1.0;
        const double whole = area_of(std::span<const PlanePoint>(triangle.corners));
        // Up to 100 pieces, each with roundings of coordinates up to 5 by slivers 1e3 times as long as wide.
        EXPECT_NEAR(
            area_of(black_squares(std::span(&triangle, 1))) + area_of(black_squares(std::span(&shifted, 1))),
            whole, 1e-10);
    }
}

TEST(PictureCheckerboard, NeighboursCutTheirEdgeAlike) {
    std::mt19937_64 random(8);
    std::uniform_real_distribution<double> any(-3.0, 3.0);
    const auto random_point = [&] { return PlanePoint{any(random), any(random)}; };
    for (int i = 0; i < 200; ++i) {
        const PlanePoint a = random_point(), b = random_point(), ta = random_point(), tb = random_point();
        const auto cuts = [&](bool forth) {
            const TexturedTriangle triangle =
                forth ? TexturedTriangle{{a, b, random_point()}, {ta, tb, random_point()}}
                      : TexturedTriangle{{random_point(), b, a}, {random_point(), tb, ta}};
            std::set<PlanePoint> points;
            for (const PlanePoint& p : black_squares(std::span(&triangle, 1)).points) {
                const double side = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
                // Points on the edge are off by a few roundings; others by chance are not as close.
                if (std::abs(side) < 1e-12) points.insert(p);
            }
            return points;
        };
        EXPECT_EQ(cuts(true), cuts(false));
    }
}

TEST(PictureCheckerboard, Refusals) {
    TexturedTriangle triangle{{{{0, 0}, {1, 0}, {0, 1}}}, {{{0, 0}, {1000, 0}, {0, 1000}}}};
    EXPECT_THROW(black_squares(std::span(&triangle, 1), 1.0, 1000000), std::invalid_argument);
    EXPECT_NO_THROW(black_squares(std::span(&triangle, 1), 10.0, 1000000));
    EXPECT_THROW(black_squares(std::span(&triangle, 1), 0.0), std::invalid_argument);
    triangle.uv = {
        {{1e17, 0}, {1e17 + 16, 0}, {1e17, 1}}};  // neighbouring doubles: squares cannot be counted
    EXPECT_THROW(black_squares(std::span(&triangle, 1)), std::invalid_argument);
    triangle.uv[1][0] = 1e300;
    EXPECT_THROW(black_squares(std::span(&triangle, 1)), std::invalid_argument);
    triangle.uv[1][0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(black_squares(std::span(&triangle, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace ricci
