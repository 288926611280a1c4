#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "engine/app/report/page.h"
#include "engine/surfaces/generate.h"

namespace ricci::app {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The bytes of a text in base64, by the definition.
std::string from_base64(const std::string& text) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    std::uint32_t bits = 0;
    int held = 0;
    for (const char c : text) {
        if (c == '=') break;
        bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
        held += 6;
        if (held >= 8) {
            held -= 8;
            bytes += static_cast<char>(bits >> held & 0xFFU);
        }
    }
    return bytes;
}

TEST(Base64, KnownTexts) {  // RFC 4648, section 10
    EXPECT_EQ(base64_text(""), "");
    EXPECT_EQ(base64_text("f"), "Zg==");
    EXPECT_EQ(base64_text("fo"), "Zm8=");
    EXPECT_EQ(base64_text("foo"), "Zm9v");
    EXPECT_EQ(base64_text("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64_text(std::string("\xff\xfe\x00", 3)), "//4A");
}

TEST(ByteStore, GivesBackWhatItTook) {
    ByteStore store;
    const std::vector<std::uint16_t> shorts = {1, 65535, 7};
    const std::vector<double> doubles = {M_PI, kNaN, -0.0};
    const nlohmann::json a = store.add(std::span<const std::uint16_t>(shorts)),
                         b = store.add(std::span<const double>(doubles));
    EXPECT_EQ(a, (nlohmann::json{{"t", "u2"}, {"o", 0}, {"n", 3}}));
    EXPECT_EQ(b, (nlohmann::json{{"t", "f8"}, {"o", 8}, {"n", 3}}));
    const std::string packed = from_base64(store.packed());
    std::string bytes(store.size(), '\0');
    uLongf size = bytes.size();
    ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                         reinterpret_cast<const Bytef*>(packed.data()), packed.size()),
              Z_OK);
    ASSERT_EQ(size, store.size());
    EXPECT_EQ(std::memcmp(bytes.data(), shorts.data(), 6), 0);
    EXPECT_EQ(std::memcmp(bytes.data() + 8, doubles.data(), 24), 0);
}

TEST(FittingScale, LogarithmicOnlyWhereThatHelps) {
    EXPECT_EQ(fitting_scale({1.0, 2.0, 3.0}).axis.kind(), ScaleKind::linear);
    EXPECT_EQ(fitting_scale({1e-3, 1.0, 10.0, kNaN}).axis.kind(), ScaleKind::logarithmic);
    EXPECT_EQ(fitting_scale({0.0, 1.0, 1000.0}).axis.kind(), ScaleKind::linear);
    const ColourScale around = fitting_scale({-3.0, 0.5, 1.0}, 0.0);
    EXPECT_EQ(around.map, ColourMap::diverging);
    EXPECT_DOUBLE_EQ(around.axis.low(), -around.axis.high());
    EXPECT_DOUBLE_EQ(around.axis.high(), 3.0);
    EXPECT_EQ(fitting_scale({kNaN}).axis, Axis(0.0, 1.0));
}

TEST(FittingScale, OneOutlierDoesNotHideTheRest) {
    std::vector<double> values(1000, 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = 1.0 + 0.001 * static_cast<double>(i);
    values.back() = 20.0;
    EXPECT_LT(fitting_scale(values).axis.high(), 3.0);
    EXPECT_DOUBLE_EQ(fitting_scale(values).axis.low(), 1.0);
}

TEST(FittingScale, RoundingGetsNoColours) {
    std::vector<double> flat(500, 1e-13);
    flat[3] = -2e-13;
    EXPECT_DOUBLE_EQ(fitting_scale(flat, 0.0, 1e-3).axis.high(), 1e-3);
    flat[7] = -6.28;  // a cone among many: it decides, though one in 500 only
    EXPECT_DOUBLE_EQ(fitting_scale(flat, 0.0, 1e-3).axis.high(), 6.28);
    // Nearly all alike: the few others are told apart from them.
    std::vector<double> counts(500, 4.0);
    counts[5] = 9.0;
    EXPECT_DOUBLE_EQ(fitting_scale(counts).axis.high(), 9.0);
    EXPECT_DOUBLE_EQ(median_of({5.0, kNaN, 1.0, 3.0}), 3.0);
}

TEST(Invariants, BoundsAndCounts) {
    EXPECT_EQ(bounded("", "", "", 1e-12, 1e-10, 1e-6).verdict, Verdict::holds);
    EXPECT_EQ(bounded("", "", "", 1e-8, 1e-10, 1e-6).verdict, Verdict::look);
    EXPECT_EQ(bounded("", "", "", 1e-3, 1e-10, 1e-6).verdict, Verdict::fails);
    EXPECT_EQ(bounded("", "", "", kNaN, 1e-10, 1e-6).verdict, Verdict::look);
    EXPECT_EQ(bounded("", "", "", INFINITY, 1e-10, 1e-6).verdict, Verdict::fails);
    EXPECT_EQ(bounded("", "", "", -1.0, 1e-10, 1e-6).verdict, Verdict::fails);
    EXPECT_EQ(bounded("", "", "", kNaN, 1e-10, 1e-6).note, "not recorded");
    EXPECT_EQ(none_of("", "", "", 0, Verdict::fails).verdict, Verdict::holds);
    EXPECT_EQ(none_of("", "", "", 2, Verdict::look).verdict, Verdict::look);
    EXPECT_EQ(none_of("", "", "", std::optional<std::int64_t>(), Verdict::fails).verdict, Verdict::look);
}

TEST(ViewMesh, LightSurfacesAreShownAsTheyAre) {
    const SurfaceMesh mesh = generate("eight", {.faces = 600});
    const ViewMesh view = make_view_mesh(mesh, 100000);
    EXPECT_FALSE(view.decimated);
    EXPECT_EQ(static_cast<Index>(view.triangles.size()), mesh.connectivity.face_count());
    for (std::size_t v = 0; v < view.points.size(); ++v)
        EXPECT_EQ(view.points[v], mesh.points[static_cast<std::size_t>(view.vertex[v])]);
}

TEST(ViewMesh, HeavyOnesAreDecimatedAndKnowTheirVertices) {
    const SurfaceMesh mesh = generate("eight", {.faces = 4000});
    const ViewMesh view = make_view_mesh(mesh, 800);
    EXPECT_TRUE(view.decimated);
    EXPECT_LE(view.triangles.size(), 800U);
    EXPECT_GT(view.triangles.size(), 600U);
    EXPECT_EQ(view.faces, mesh.connectivity.face_count());
    EXPECT_EQ(view.shown, view.points.size());
    ViewMesh more = view;
    add_vertices(more, mesh, {17});
    EXPECT_EQ(more.vertex.back(), 17);
    EXPECT_EQ(more.points.back(), mesh.points[17]);
    EXPECT_EQ(more.shown, view.shown);
    for (std::size_t v = 0; v < view.points.size(); ++v) {
        double least = INFINITY;
        std::size_t nearest = 0;
        for (std::size_t w = 0; w < mesh.points.size(); ++w) {
            double far = 0;
            for (std::size_t k = 0; k < 3; ++k) far += std::pow(mesh.points[w][k] - view.points[v][k], 2);
            if (far < least) {
                least = far;
                nearest = w;
            }
        }
        ASSERT_EQ(view.vertex[v], static_cast<Index>(nearest));
    }
}

TEST(ReportPage, TextIsTextWhateverItHolds) {
    ReportPage page;
    page.begin_section("</h2><script>alert(1)</script>");
    page.note("a < b & \"c\"");
    page.check({"<b>", "<i>", "status", "<img src=x onerror=alert(1)>", "", Verdict::fails, "<u>"});
    page.failure("<img>", "load", "invalid_input", "'x' > y");
    page.end_section();
    Scene scene;
    scene.title = "</script><b>";
    scene.mesh = make_view_mesh(generate("sphere", {.faces = 20}), 100);
    page.view(scene);
    const std::string text =
        page.document({"<file>.h5", "kind", {{"command", "a && b <c>"}}, "key = \"</pre>\"", {"x > y"}});
    EXPECT_EQ(text.find("<script>alert"), std::string::npos);
    EXPECT_EQ(text.find("</script><b>"), std::string::npos);
    for (const char* const tag : {"<img>", "<img ", "<b><", "<u>"})
        EXPECT_EQ(text.find(tag), std::string::npos) << tag;
    EXPECT_EQ(text.find("</pre>\""), std::string::npos);
    EXPECT_NE(text.find("a &lt; b &amp; "), std::string::npos);
    EXPECT_EQ(text, page.document(
                        {"<file>.h5", "kind", {{"command", "a && b <c>"}}, "key = \"</pre>\"", {"x > y"}}));
}

TEST(NumberText, SixDigits) {
    EXPECT_EQ(number_text(0.1234567), "0.123457");
    EXPECT_EQ(number_text(-0.0), "0");
    EXPECT_EQ(number_text(3e-12), "3e-12");
    EXPECT_EQ(number_text(kNaN), "\u2013");
    EXPECT_EQ(number_text(INFINITY), "inf");
}

}  // namespace
}  // namespace ricci::app
