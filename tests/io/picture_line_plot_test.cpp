#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/picture/line_plot.h"

namespace ricci {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::size_t count(const std::string& text, const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
    return found;
}

TEST(AxisAround, HoldsAllValuesAndIgnoresOthers) {
    const Axis linear = axis_around({3.0, -1.0, kNaN, 2.0, INFINITY}, ScaleKind::linear);
    EXPECT_LT(linear.low(), -1.0);
    EXPECT_GT(linear.high(), 3.0);
    EXPECT_LT(linear.high(), 3.5);
    const Axis logarithmic = axis_around({1e-12, 0.0, -3.0, 5.0}, ScaleKind::logarithmic);
    EXPECT_EQ(logarithmic.kind(), ScaleKind::logarithmic);
    EXPECT_LT(logarithmic.low(), 1e-12);
    EXPECT_GT(logarithmic.low(), 1e-14);
    EXPECT_GT(logarithmic.high(), 5.0);
}

TEST(AxisAround, SomethingForNothing) {
    EXPECT_EQ(axis_around({}, ScaleKind::linear), Axis(0.0, 1.0));
    EXPECT_GT(axis_around({-1.0, kNaN}, ScaleKind::logarithmic).low(), 0.0);
    const Axis one = axis_around({7.0}, ScaleKind::linear);
    EXPECT_LT(one.low(), 7.0);
    EXPECT_GT(one.high(), 7.0);
}

TEST(LinePlot, BreaksWhereAPointIsMissing) {
    const PlotSeries series{"residual", {{0, 1e-1}, {1, 1e-3}, {2, 0.0}, {3, 1e-8}, {4, 1e-11}}};
    const std::string text = draw_line_plot({series}, Axis(0, 4), Axis(1e-12, 1, ScaleKind::logarithmic),
                                            {"Residual", "iteration", "radians"}, 1e-10)
                                 .document();
    EXPECT_EQ(count(text, "<circle"), 4U);  // the zero has no place on a logarithmic axis
    EXPECT_EQ(count(text, "stroke-dasharray"), 1U);
    // One path with two pieces: two moves.
    const std::size_t at = text.find("inkscape:label=\"series\"");
    const std::string path =
        text.substr(text.find("<path", at), text.find("/path>", at) - text.find("<path", at));
    EXPECT_EQ(count(path, "m"), 2U) << path;
    EXPECT_NE(text.find(">iteration<"), std::string::npos);
    EXPECT_NE(text.find(">radians<"), std::string::npos);
}

TEST(LinePlot, ListsSeveralSeriesAndTellsRepeatedColoursApart) {
    std::vector<PlotSeries> series;
    for (int k = 0; k < 9; ++k)
        series.push_back({"surface " + std::to_string(k), {{1, 1.0 + k}, {2, 2.0 + k}}});
    const std::string text = draw_line_plot(series, Axis(0, 3), Axis(0, 12), {"Spectra", "", ""}).document();
    for (int k = 0; k < 9; ++k)
        EXPECT_NE(text.find(">surface " + std::to_string(k) + "<"), std::string::npos);
    // Two of nine go beyond the seven colours: dashed, as lines and in the legend.
    EXPECT_EQ(count(text, "stroke-dasharray"), 4U);
}

TEST(LinePlot, LongSeriesHaveNoDots) {
    PlotSeries series{"", {}};
    for (int k = 0; k < 500; ++k) series.points.push_back({1.0 * k, std::sin(0.1 * k)});
    EXPECT_EQ(count(draw_line_plot({series}, Axis(0, 500), Axis(-1, 1), {"", "", ""}).document(), "<circle"),
              0U);
}

TEST(EmbeddedPicture, HasNamesOfItsOwnAndSaysWhereItLies) {
    SvgPicture picture(200, 100, {-1.0, -1.0, 2.0, 2.0});
    SvgPath clip;
    clip.circle({0, 0}, 1.0);
    picture.begin_group("first", clip);
    picture.dot({0, 0}, 3.0, filled(kBlack));
    picture.end_group();
    picture.begin_group("second", clip);
    picture.end_group();
    const std::string text = picture.embedded("p7");
    EXPECT_TRUE(text.starts_with("<svg "));
    EXPECT_EQ(text.find("<?xml"), std::string::npos);
    for (const char* const name : {"id=\"p7clip1\"", "id=\"p7clip2\"", "url(#p7clip1)", "url(#p7clip2)"})
        EXPECT_EQ(count(text, name), 1U) << name;
    EXPECT_EQ(count(text, "\"clip"), 0U);
    // The dot at the origin lies at (left, top) times the scale.
    const auto number = [&](const std::string& name) {
        const std::size_t at = text.find(name + "=\"") + name.size() + 2;
        return std::stod(text.substr(at));
    };
    EXPECT_NEAR((0.0 - number("data-left")) * number("data-scale"), number("cx"), 0.01);
    EXPECT_NEAR((number("data-top") - 0.0) * number("data-scale"), number("cy"), 0.01);
}

}  // namespace
}  // namespace ricci
