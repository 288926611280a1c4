// Curves on a surface: what is seen and what is dashed.
#include <gtest/gtest.h>

#include <numeric>

#include "engine/app/console.h"
#include "engine/app/pictures/draw_curves.h"
#include "tests/io/svg_reading.h"
#include "tests/support/small_surfaces.h"

namespace ricci::app {
namespace {

using ricci::testing::at;
using ricci::testing::bumpy_torus;

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t p = text.find(part); p != std::string::npos; p = text.find(part, p + 1)) ++found;
    return found;
}

/// The closed polyline through the vertices of a column (around the hole) or row (around the tube) of a torus
/// grid.
DrawnCurve grid_line(const SurfaceMesh& mesh, Index n, Index m, Index line, bool around_hole) {
    DrawnCurve curve{around_hole ? "hole" : "tube", {}, {}};
    const Index length = around_hole ? n : m;
    for (Index i = 0; i <= length; ++i)
        curve.points.push_back(
            mesh.points[at(around_hole ? (i % length) * m + line : line * m + i % length)]);
    return curve;
}

/// Pixels that the polylines of the element with an attribute run over.
double drawn_length(const std::string& document, const std::string& attribute) {
    double length = 0.0;
    for (std::size_t p = document.find("<path"); p != std::string::npos; p = document.find("<path", p + 1)) {
        const std::string element = document.substr(p, document.find('>', p) - p);
        const std::size_t d = element.find(" d=\"");
        if (element.find(attribute) == std::string::npos || d == std::string::npos) continue;
        const std::string data = element.substr(d + 4, element.find('"', d + 4) - d - 4);
        for (const auto& command : svg_reading::read_path(data))
            if (command.verb == 'l')
                length += std::hypot(command.to[0] - command.from[0], command.to[1] - command.from[1]);
    }
    return length;
}

TEST(DrawCurves, DashesWhatTheSurfaceHides) {
    constexpr Index kN = 48, kM = 24;
    const SurfaceMesh mesh = bumpy_torus(kN, kM, 0.0);
    const Colour red{200, 20, 30};
    std::vector<DrawnCurve> curves{grid_line(mesh, kN, kM, 5, false)};
    curves[0].colour = red;
    const std::string document = draw_curves(mesh, curves).document();
    EXPECT_EQ(count(document, ">tube</text>"), 1U);
    EXPECT_EQ(count(document, "curves"), 1U);
    const double hidden = drawn_length(document, "stroke-dasharray"),
                 both = drawn_length(document, "stroke=\"#c8141e\"");
    // A circle around the tube is seen on the viewer's side, about half of it.
    EXPECT_GT(hidden, 0.3 * both);
    EXPECT_LT(hidden, 0.7 * both);
    // The picture turns so that curves are in front: one that lies in front is not dashed much.
    const std::string front = draw_curves(mesh, std::vector{grid_line(mesh, kN, kM, 6, true)}).document();
    const std::string back = draw_curves(mesh, std::vector{grid_line(mesh, kN, kM, 18, true)}).document();
    EXPECT_LT(drawn_length(front, "stroke-dasharray"), 0.25 * hidden);
    EXPECT_LT(drawn_length(back, "stroke-dasharray"), 0.25 * hidden);
}

TEST(DrawCurves, TellsCurvesApartAndDrawsTheSameTwice) {
    const SurfaceMesh mesh = bumpy_torus(30, 16);
    std::vector<DrawnCurve> curves{grid_line(mesh, 30, 16, 3, false), grid_line(mesh, 30, 16, 5, true)};
    const std::string document = draw_curves(mesh, curves).document();
    EXPECT_EQ(document, draw_curves(mesh, curves).document());
    EXPECT_GE(count(document, "#d55e00"), 2U);
    EXPECT_GE(count(document, "#0072b2"), 2U);
    curves[0].name.clear();
    EXPECT_EQ(count(draw_curves(mesh, curves).document(), "</text>"), 1U);
    const std::string empty = draw_curves(mesh, {}).document();
    EXPECT_EQ(count(empty, "stroke-dasharray"), 0U);
    EXPECT_GT(count(empty, "<path"), 3U) << "the surface alone";
}

TEST(DrawCurves, IntrinsicSurfacesHaveNoPlaceInSpace) {
    const SurfaceMesh mesh = ricci::testing::intrinsic_mesh(ricci::testing::one_vertex_torus(1.0, 1.1, 1.3));
    EXPECT_THROW(draw_curves(mesh, {}), UsageError);
}

}  // namespace
}  // namespace ricci::app
