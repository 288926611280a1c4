// Colours, axes and histograms.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "io/picture/colour_map.h"
#include "io/picture/histogram.h"
#include "tests/io/svg_reading.h"

namespace ricci {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(PictureColour, Hexadecimal) {
    EXPECT_EQ(hexadecimal({0, 0, 0}), "#000");
    EXPECT_EQ(hexadecimal({255, 0x11, 0xaa}), "#f1a");
    EXPECT_EQ(hexadecimal({1, 35, 69}), "#012345");
}

TEST(PictureColour, LabOfKnownColours) {
    const LabColour white = lab_of(kWhite), red = lab_of({255, 0, 0}), blue = lab_of({0, 0, 255});
    // Published values have two to four decimals (Lindbloom, D65).
    EXPECT_NEAR(white.lightness, 100.0, 1e-4);
    EXPECT_NEAR(white.a, 0.0, 0.02);
    EXPECT_NEAR(white.b, 0.0, 0.02);
    EXPECT_NEAR(red.lightness, 53.24, 0.01);
    EXPECT_NEAR(red.a, 80.09, 0.01);
    EXPECT_NEAR(red.b, 67.20, 0.01);
    EXPECT_NEAR(blue.lightness, 32.30, 0.01);
    EXPECT_NEAR(blue.a, 79.19, 0.01);
    EXPECT_NEAR(blue.b, -107.86, 0.01);
}

TEST(PictureColour, LabRoundTrips) {
    std::mt19937 random(3);
    std::uniform_int_distribution<int> channel(0, 255);
    const auto any = [&] { return static_cast<std::uint8_t>(channel(random)); };
    for (int i = 0; i < 5000; ++i) {
        const Colour colour{any(), any(), any()};
        EXPECT_EQ(colour_of(lab_of(colour)), colour);
    }
    EXPECT_EQ(colour_of(LabColour{100, 200, 0}).red, 255);  // cut to the range
}

// Machado, Oliveira and Fernandes (2009): how red- and green-blind eyes see linear light.
using Matrix = std::array<std::array<double, 3>, 3>;
constexpr Matrix kProtanopia = {
    {{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}};
constexpr Matrix kDeuteranopia = {
    {{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}};
constexpr Matrix kAll = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

LabColour seen(const Matrix& eye, const Colour& colour) {
    const auto light = [](std::uint8_t c) {
        const double s = c / 255.0;
        return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
    };
    const std::array<double, 3> in = {light(colour.red), light(colour.green), light(colour.blue)};
    std::array<std::uint8_t, 3> out{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double y = std::clamp(eye[i][0] * in[0] + eye[i][1] * in[1] + eye[i][2] * in[2], 0.0, 1.0);
        const double s = y <= 0.0031308 ? 12.92 * y : 1.055 * std::pow(y, 1 / 2.4) - 0.055;
        out[i] = static_cast<std::uint8_t>(std::lround(255 * s));
    }
    return lab_of({out[0], out[1], out[2]});
}
double difference(const LabColour& a, const LabColour& b) {
    return std::hypot(a.lightness - b.lightness, a.a - b.a, a.b - b.b);
}

TEST(PictureColour, SequentialMapAscendsForEveryEye) {
    for (const Matrix& eye : {kAll, kProtanopia, kDeuteranopia}) {
        double shortest = kInfinity, longest = 0.0;
        for (int i = 0; i < 16; ++i) {
            const LabColour a = seen(eye, colour_at(ColourMap::sequential, i / 16.0));
            const LabColour b = seen(eye, colour_at(ColourMap::sequential, (i + 1) / 16.0));
            EXPECT_GT(b.lightness, a.lightness + 2.0) << i;  // of 75 in all
            shortest = std::min(shortest, difference(a, b));
            longest = std::max(longest, difference(a, b));
        }
        // The map is even in a newer measure than L*a*b*, which exaggerates differences of vivid colours.
        EXPECT_LT(longest, 5.0 * shortest);
        EXPECT_GT(shortest, 3.0);  // 2 is just visible
    }
    EXPECT_EQ(colour_at(ColourMap::sequential, 0.0), (Colour{0x44, 0x01, 0x54}));
    EXPECT_EQ(colour_at(ColourMap::sequential, 1.0), (Colour{0xfd, 0xe7, 0x25}));
}

TEST(PictureColour, DivergingMapIsEvenAndItsSidesDifferForEveryEye) {
    const LabColour middle = lab_of(colour_at(ColourMap::diverging, 0.5));
    EXPECT_NEAR(middle.a, 0.0, 0.5);  // grey, to a step of a channel
    EXPECT_NEAR(middle.b, 0.0, 0.5);
    for (int i = 0; i < 32; ++i) {
        const double t = i / 64.0;
        const Colour low = colour_at(ColourMap::diverging, t),
                     high = colour_at(ColourMap::diverging, 1.0 - t);
        // A step of one channel changes the lightness by up to 0.5. The wanted lightness is linear.
        EXPECT_NEAR(lab_of(low).lightness, lab_of(high).lightness, 1.0) << t;
        EXPECT_NEAR(lab_of(low).lightness, 32.0 + 128.0 * t, 1.0) << t;  // also: within the gamut
        for (const Matrix& eye : {kAll, kProtanopia, kDeuteranopia})
            EXPECT_GT(difference(seen(eye, low), seen(eye, high)), 1.6 * (32 - i)) << t;  // 2 is just visible
    }
}

TEST(PictureColour, ScalesCutAndMark) {
    const ColourScale scale{Axis(1, 100, ScaleKind::logarithmic)};
    EXPECT_EQ(scale.colour_of(10), colour_at(ColourMap::sequential, 0.5));
    EXPECT_EQ(scale.colour_of(-3), colour_at(ColourMap::sequential, 0.0));
    EXPECT_EQ(scale.colour_of(kInfinity), colour_at(ColourMap::sequential, 1.0));
    EXPECT_EQ(scale.colour_of(kNan), kGrey);
    const ColourScale constant{Axis(2, 2), ColourMap::diverging};
    EXPECT_EQ(constant.colour_of(2), colour_at(ColourMap::diverging, 0.5));
}

TEST(PictureColour, BarShowsItsTicks) {
    SvgPicture picture(300, 300, {0, 0, 3, 3});
    draw_colour_bar(picture, {Axis(-1, 1), ColourMap::diverging}, {0.5, 0.5, 0.2, 2}, "log <ratio>");
    const std::string text = picture.document();
    EXPECT_EQ(svg_reading::malformed(text), "");
    for (const char* words : {">-1<", ">-0.5<", ">0<", ">0.5<", ">1<", ">log &lt;ratio&gt;<"})
        EXPECT_NE(text.find(words), std::string::npos) << words;
    EXPECT_EQ(text.find(">1.5<"), std::string::npos);
}

TEST(PictureAxis, TicksAreRoundEvenAndInside) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> mantissa(-3, 3), exponent(-12, 12);
    for (int i = 0; i < 2000; ++i) {
        const double size = std::pow(10.0, exponent(random));
        double low = size * mantissa(random), high = size * mantissa(random);
        if (low > high) std::swap(low, high);
        const int wanted = 2 + i % 9;
        const std::vector<double> ticks = Axis(low, high).ticks(wanted);
        // A step is at least range/wanted and at most 2.5 times that.
        EXPECT_LE(ticks.size(), static_cast<std::size_t>(wanted) + 1);
        EXPECT_GE(ticks.size(), static_cast<std::size_t>(std::floor(wanted / 2.5)));
        if (ticks.size() < 2) continue;
        const double step = ticks[1] - ticks[0];
        for (std::size_t k = 0; k < ticks.size(); ++k) {
            EXPECT_GE(ticks[k], low - 1e-8 * step);
            EXPECT_LE(ticks[k], high + 1e-8 * step);
            EXPECT_NEAR(ticks[k], ticks[0] + static_cast<double>(k) * step, 1e-9 * step * (1 + wanted));
            EXPECT_NEAR(ticks[k] / step, std::round(ticks[k] / step), 1e-6);
        }
        const double digits = step / std::pow(10.0, std::floor(std::log10(step) + 1e-9));
        const bool round =
            std::abs(digits - 1) < 1e-6 || std::abs(digits - 2) < 1e-6 || std::abs(digits - 5) < 1e-6;
        EXPECT_TRUE(round) << step;
    }
    EXPECT_EQ(Axis(0, 1).ticks(5), (std::vector<double>{0, 0.2, 0.4, 0.6, 0.8, 1}));  // rounded once each
    EXPECT_EQ(Axis(-0.3, 0.3).ticks(6), (std::vector<double>{-0.3, -0.2, -0.1, 0, 0.1, 0.2, 0.3}));
    EXPECT_EQ(Axis(7, 7).ticks(6), std::vector<double>{7});
}

TEST(PictureAxis, LogarithmicTicks) {
    const auto ticks = [](double low, double high, int wanted) {
        return Axis(low, high, ScaleKind::logarithmic).ticks(wanted);
    };
    EXPECT_EQ(ticks(1, 100, 5), (std::vector<double>{1, 2, 5, 10, 20, 50, 100}));
    EXPECT_EQ(ticks(1e-3, 10, 5), (std::vector<double>{1e-3, 1e-2, 1e-1, 1, 10}));
    EXPECT_EQ(ticks(1e-12, 1, 4), (std::vector<double>{1e-12, 1e-9, 1e-6, 1e-3, 1}));
    EXPECT_EQ(ticks(0.9, 1.1, 4), Axis(0.9, 1.1).ticks(4));
}

TEST(PictureAxis, FractionsAndValuesInvert) {
    for (const Axis& axis : {Axis(-3, 7), Axis(1e-6, 1e3, ScaleKind::logarithmic)})
        for (const double t : {-0.5, 0.0, 0.3, 1.0, 1.25})
            // log and pow are within an ulp, which their arguments of size 20 stretch.
            EXPECT_NEAR(axis.fraction_of(axis.value_at(t)), t, 1e-14);
    EXPECT_TRUE(std::isnan(Axis(0, 1).fraction_of(kNan)));
    EXPECT_THROW(Axis(1, 0), std::invalid_argument);
    EXPECT_THROW(Axis(0, kInfinity), std::invalid_argument);
    EXPECT_THROW(Axis(kNan, 1), std::invalid_argument);
    EXPECT_THROW(Axis(0, 1, ScaleKind::logarithmic), std::invalid_argument);
}

TEST(PictureAxis, Labels) {
    EXPECT_EQ(tick_label(-0.0), "0");
    EXPECT_EQ(tick_label(0.1 + 0.2), "0.3");
    EXPECT_EQ(tick_label(20000), "20000");
    EXPECT_EQ(tick_label(1e-7), "1e-7");
    EXPECT_EQ(tick_label(-2.5e20), "-2.5e20");
    EXPECT_EQ(tick_label(1e100), "1e100");
}

TEST(PictureHistogram, CountsEveryValueOnce) {
    const std::vector<double> values = {0.0,     0.1,         0.25, 0.5,       0.99,      1.0,
                                        -1e-300, 1.0 + 1e-15, kNan, kInfinity, -kInfinity};
    const Histogram histogram = count_values(values, Axis(0, 1), 4);
    EXPECT_EQ(histogram.counts, (std::vector<std::int64_t>{2, 1, 1, 2}));
    EXPECT_EQ(histogram.below, 2);
    EXPECT_EQ(histogram.above, 2);
    EXPECT_EQ(histogram.not_a_number, 1);
    EXPECT_EQ(histogram.total(), 11);
    const Histogram decades = count_values(std::vector<double>{0, 0.5, 2, 3, 20, 999, 1000},
                                           Axis(1, 1000, ScaleKind::logarithmic), 3);
    EXPECT_EQ(decades.counts, (std::vector<std::int64_t>{2, 1, 2}));
    EXPECT_EQ(decades.below, 2);
    EXPECT_EQ(count_values(std::vector<double>{5, 5}, Axis(5, 5), 3).counts,
              (std::vector<std::int64_t>{0, 2, 0}));
    EXPECT_THROW(count_values(values, Axis(0, 1), 0), std::invalid_argument);
}

TEST(PictureHistogram, BarsAreAsHighAsTheirCounts) {
    Histogram histogram{Axis(0, 4), {3, 0, 12, 6}};
    histogram.above = 5;
    const Histogram other{Axis(0, 4), {1, 2, 3, 4}};
    const SvgPicture picture =
        draw_histogram(histogram, other, {"T & t", "x", "a", "b"}, ScaleKind::linear, 2.0);
    const std::string text = picture.document();
    EXPECT_EQ(svg_reading::malformed(text), "");
    EXPECT_NE(text.find("a: 26 values, 5 above"), std::string::npos);
    EXPECT_NE(text.find("b: 10 values<"), std::string::npos);
    const auto bars = svg_reading::read_path(svg_reading::paths(text).at(0));
    ASSERT_EQ(bars.size(), 3U * 5U);  // m l l l z; none of the empty bin
    std::array<double, 3> height{}, left{}, width{};
    for (std::size_t i = 0; i < 3; ++i) {
        left[i] = bars[5 * i].to[0];
        width[i] = bars[5 * i + 1].to[0] - left[i];
        height[i] = bars[5 * i + 1].to[1] - bars[5 * i + 2].to[1];
    }
    // Both ends are rounded to 1/100 pixel.
    EXPECT_NEAR(height[0], height[1] / 4, 0.02);
    EXPECT_NEAR(height[2], height[1] / 2, 0.02);
    EXPECT_GT(height[1], 150);
    EXPECT_NEAR(left[1] - left[0], 2 * width[0], 0.02);
    EXPECT_NEAR(left[2] - left[1], width[1], 0.02);
}

TEST(PictureHistogram, LogarithmicCountsAndRefusals) {
    const Histogram histogram{Axis(0, 30), {1, 10, 100}};
    const std::string text =
        draw_histogram(histogram, std::nullopt, {"", "", "", ""}, ScaleKind::logarithmic).document();
    const auto bars = svg_reading::read_path(svg_reading::paths(text).at(0));
    const auto top = [&](std::size_t i) { return bars[5 * i + 2].to[1]; };
    EXPECT_NEAR(top(0) - top(1), top(1) - top(2), 0.03);  // equal factors, equal steps
    EXPECT_EQ(text.find(">0.5<"), std::string::npos) << "half a value";
    EXPECT_THROW(draw_histogram(histogram, Histogram{Axis(0, 20), {1, 2, 3}}, {}), std::invalid_argument);
    EXPECT_THROW(draw_histogram(histogram, Histogram{Axis(0, 30), {1, 2}}, {}), std::invalid_argument);
    EXPECT_EQ(svg_reading::malformed(draw_histogram({Axis(0, 0), {0, 0}}, std::nullopt, {}).document()), "");
}

}  // namespace
}  // namespace ricci
