// SVG files: shapes lie where they belong, text is escaped, bytes are the same for the same calls.
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <locale>
#include <random>

#include "io/picture/polygon_batch.h"
#include "io/picture/svg.h"
#include "io/picture/svg_text.h"
#include "io/store/durable.h"
#include "tests/io/mesh_test_files.h"
#include "tests/io/svg_reading.h"

namespace ricci {
namespace {

using testing::TemporaryFolder;

// Half of 1/100 pixel, and the rounding of sums of thousands of such numbers.
constexpr double kRounding = 0.005 + 1e-7;

TEST(PictureSvg, NumbersAreShort) {
    EXPECT_EQ(svg_decimal(0), "0");
    EXPECT_EQ(svg_decimal(1250), "12.5");
    EXPECT_EQ(svg_decimal(-5), "-.05");
    EXPECT_EQ(svg_decimal(100), "1");
    EXPECT_EQ(svg_decimal(-12345678), "-123456.78");
    EXPECT_EQ(svg_decimal(10), ".1");
    EXPECT_EQ(svg_number(-0.001), "0");
    EXPECT_EQ(svg_number(2.0 / 3.0), ".67");
    std::string data;
    append_svg_numbers(data, 'l', {-5, 7, -100, 0});
    EXPECT_EQ(data, "l-.05 .07-1 0");
    EXPECT_THROW(svg_number(std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
    EXPECT_THROW(svg_number(std::numeric_limits<double>::infinity()), std::invalid_argument);
}

TEST(PictureSvg, ViewIsCentredWithYUpwards) {
    SvgPicture picture(200, 200, {10, 20, 2, 1});  // 100 pixels per unit, 50 free above and below
    EXPECT_EQ(picture.scale(), 100.0);
    picture.line({10, 20}, {12, 21}, stroked(kBlack));
    picture.circle({11, 20.5}, 0.25, filled(kWhite));
    const std::string text = picture.document();
    EXPECT_NE(text.find("<path d=\"m0 150l200-100\" fill=\"none\" stroke=\"#000\"/>\n"), std::string::npos)
        << text;
    EXPECT_NE(text.find("<circle cx=\"100\" cy=\"100\" r=\"25\" fill=\"#fff\"/>\n"), std::string::npos)
        << text;
    EXPECT_NE(text.find("width=\"200\" height=\"200\" viewBox=\"0 0 200 200\""), std::string::npos);
}

TEST(PictureSvg, LongPathsDoNotDrift) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> step(0.0, 0.01);
    std::vector<PlanePoint> points = {{0, 0}};
    for (int i = 0; i < 20000; ++i)
        points.push_back({points.back()[0] + step(random), points.back()[1] + step(random)});
    SvgPicture picture(640, 480, {-4, -3, 8, 6});
    // Two closed pieces: after "z" a relative move starts from the first piece's start.
    picture.path(SvgPath().polygon(points).polygon(points), stroked(kBlack));
    const auto commands = svg_reading::read_path(svg_reading::paths(picture.document()).at(0));
    ASSERT_EQ(commands.size(), 2 * (points.size() + 1));
    for (std::size_t i = 0; i < commands.size(); ++i) {
        const std::size_t k = i % (points.size() + 1);
        if (k == points.size()) continue;
        EXPECT_EQ(commands[i].verb, k == 0 ? 'm' : 'l');
        ASSERT_NEAR(commands[i].to[0], 80.0 * (points[k][0] + 4.0), kRounding);
        ASSERT_NEAR(commands[i].to[1], 80.0 * (3.0 - points[k][1]), kRounding);
    }
}

// Ends and radius of a quarter of a circle are off by half a unit each, which moves the centre by no more
// than four of these.
constexpr double kCentre = 4 * kRounding;

TEST(PictureSvg, ArcsHaveTheirCentres) {
    SvgPicture picture(1000, 1000, {-1, -1, 2, 2});
    for (const double sense : {1.0, -1.0}) {
        const PlanePoint up{0, 0.7}, down{0, -0.7};
        // To the left of a path from below to above lies the left.
        picture.path(SvgPath().move_to(down).arc_to(up, sense / 0.7), stroked(kBlack));
        const auto commands = svg_reading::read_path(svg_reading::paths(picture.document()).back());
        ASSERT_EQ(commands.size(), 3U);  // two quarters
        for (std::size_t i = 1; i < 3; ++i) {
            EXPECT_EQ(commands[i].verb, 'a');
            EXPECT_NEAR(commands[i].radius, 350.0, kRounding);
            EXPECT_NEAR(svg_reading::centre_of(commands[i])[0], 500.0, kCentre);
            EXPECT_NEAR(svg_reading::centre_of(commands[i])[1], 500.0, kCentre);
        }
        // Turning left from below to above goes through the right.
        EXPECT_NEAR(commands[1].to[0], 500.0 + 350.0 * sense, kRounding);
    }
    picture.path(SvgPath().circle({0.25, 0.5}, 0.125), stroked(kBlack));
    const auto circle = svg_reading::read_path(svg_reading::paths(picture.document()).back());
    ASSERT_EQ(circle.size(), 6U);
    for (std::size_t i = 1; i < 5; ++i) {
        EXPECT_FALSE(circle[i].sweep);  // left in the plane is anticlockwise on the screen
        EXPECT_NEAR(svg_reading::centre_of(circle[i])[0], 625.0, kCentre);
        EXPECT_NEAR(svg_reading::centre_of(circle[i])[1], 250.0, kCentre);
    }
}

TEST(PictureSvg, FlatArcsAreLines) {
    SvgPicture picture(1000, 1000, {-1, -1, 2, 2});
    const auto verb = [&](double curvature) {
        picture.path(SvgPath().move_to({-1, 0}).arc_to({1, 0}, curvature), stroked(kBlack));
        return svg_reading::read_path(svg_reading::paths(picture.document()).back()).at(1).verb;
    };
    // The arc rises by curvature/2 units: 1/200 pixel is where the file cannot tell any more.
    EXPECT_EQ(verb(0.0), 'l');
    EXPECT_EQ(verb(1.9e-5), 'l');
    EXPECT_EQ(verb(2.1e-5), 'a');
    EXPECT_EQ(verb(-2.1e-5), 'a');
    EXPECT_EQ(verb(1e-300), 'l');
}

TEST(PictureSvg, ArcsThatMeetMakeOnePiece) {
    SvgPath path;
    path.arc({{0, 0}, {1, 0}, 0.5}).arc({{1, 0}, {1, 1}, 0.0}).arc({{1, 1}, {0, 0}, -0.25}).close();
    path.arc({{2, 2}, {3, 2}, 0.0});
    SvgPicture picture(100, 100, {0, 0, 4, 4});
    picture.path(path, filled(kGrey));
    std::string verbs;
    for (const auto& command : svg_reading::read_path(svg_reading::paths(picture.document()).at(0)))
        verbs += command.verb;
    EXPECT_EQ(verbs,
              "mala"
              "zml");
}

TEST(PictureSvg, AnyTextIsWellFormed) {
    SvgPicture picture(100, 100, {});
    const std::string nasty =
        std::string("<a href=\"x\">&amp;\x01\x1b \xC3\xA9 \xFF\xC0\x80 ]]>") + '\0' + "'";
    picture.set_title(nasty);
    picture.begin_group(nasty, 0.5);
    picture.begin_group(nasty, SvgPath().circle({0, 0}, 1));
    picture.text({0, 0}, nasty, {14.0, TextAnchor::middle, {1, 2, 3}, 0.5, 1.0, 2.0, true, true});
    picture.polygon(std::vector<PlanePoint>{{0, 0}, {1, 0}, {0, 1}}, filled(kBlack), nasty);
    picture.dot({0, 0}, 3.0, filled(kBlack), nasty);
    EXPECT_EQ(svg_reading::malformed(picture.document()), "");  // closes what is open
    picture.end_group();
    picture.end_group();
    EXPECT_EQ(svg_reading::malformed(picture.document()), "");
    EXPECT_NE(picture.document().find("\xC3\xA9 \\xff\\xc0\\x80"), std::string::npos);
    EXPECT_NE(picture.document().find("text-anchor=\"middle\" font-weight=\"bold\" font-style=\"italic\""),
              std::string::npos);
    EXPECT_THROW(picture.end_group(), std::logic_error);
    EXPECT_NE(svg_reading::malformed("<?xml?><a><b></a>"), "");  // the reader can tell
    EXPECT_NE(svg_reading::malformed("<?xml?><a>x & y</a>"), "");
}

TEST(PictureSvg, TurnedTextKeepsItsPlace) {
    SvgPicture picture(200, 200, {0, 0, 2, 2});
    TextStyle style;
    style.angle = std::acos(-1.0) / 2;  // upwards
    style.right = 10;
    style.up = 4;  // to the left, once turned
    picture.text({1, 1}, "x", style);
    EXPECT_NE(picture.document().find("x=\"96\" y=\"90\""), std::string::npos) << picture.document();
    EXPECT_NE(picture.document().find("rotate(-90 96 90)"), std::string::npos);
}

TEST(PictureSvg, RefusesWhatCannotBeDrawn) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(SvgPicture(0, 100, {}), std::invalid_argument);
    EXPECT_THROW(SvgPicture(100, 100, {0, 0, nan, 1}), std::invalid_argument);
    SvgPicture picture(100, 100, {});
    const std::string before = picture.document();
    EXPECT_THROW(picture.line({0, 0}, {nan, 0}, stroked(kBlack)), std::invalid_argument);
    EXPECT_THROW(picture.circle({0, 0}, nan, stroked(kBlack)), std::invalid_argument);
    EXPECT_THROW(picture.circle({0, 0}, -1, stroked(kBlack)), std::invalid_argument);
    EXPECT_THROW(SvgPath().line_to({0, 0}), std::logic_error);
    EXPECT_THROW(SvgPath().move_to({0, 0}).close().line_to({0, 0}), std::logic_error);
    EXPECT_THROW(SvgPath().circle({0, 0}, 0.0), std::invalid_argument);
    EXPECT_EQ(picture.document(), before);                   // nothing of it is left behind
    picture.line({-1e300, 0}, {1e300, 0}, stroked(kBlack));  // cut
    EXPECT_EQ(svg_reading::paths(picture.document()).at(0), "m-10000000 50l20000000 0");
}

struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

TEST(PictureSvg, BytesDoNotDependOnTheLocale) {
    const auto document = [] {
        SvgPicture picture(12345.5, 100, {});
        picture.line({0.3, 0.1}, {1000.0, 0.25}, stroked(kBlack, 1.25));
        picture.text({0.1, 0.1}, "x", {11.5});
        return picture.document();
    };
    const std::string expected = document();
    const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
    EXPECT_EQ(document(), expected);
    std::locale::global(before);
}

TEST(PictureSvg, SavesWholeOrNotAtAll) {
    const TemporaryFolder folder;
    SvgPicture picture(100, 100, {});
    picture.dot({0, 0}, 1, filled(kBlack));
    picture.save(folder.path("a.svg"));
    EXPECT_EQ(read_text(folder.path("a.svg")), picture.document());
    EXPECT_THROW(picture.save(folder.path("no/such/a.svg")), FileError);
    std::filesystem::create_directory(folder.path("b.svg"));
    EXPECT_THROW(picture.save(folder.path("b.svg")), FileError);
    EXPECT_FALSE(std::filesystem::exists(folder.path("b.svg.tmp")));
}

TEST(PictureSvg, BatchHasOnePathPerColourAndOneSense) {
    PolygonBatch batch;
    const Colour red{255, 0, 0}, blue{0, 0, 255};
    const std::vector<PlanePoint> forth = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const std::vector<PlanePoint> back(forth.rbegin(), forth.rend());
    for (int i = 0; i < 50; ++i) {
        batch.add(i % 2 == 0 ? red : blue, forth);
        batch.add(red, back);
    }
    SvgPicture picture(100, 100, {0, 0, 1, 1});
    batch.draw(picture);
    const auto paths = svg_reading::paths(picture.document());
    ASSERT_EQ(paths.size(), 2U);
    EXPECT_EQ(svg_reading::attributes(picture.document(), "fill").back(), "#f00");  // ascending by colour
    double area = 0.0;                                                              // signed, y downwards
    for (const auto& command : svg_reading::read_path(paths[1]))
        area += 0.5 * (command.from[0] * command.to[1] - command.from[1] * command.to[0]) *
                (command.verb == 'm' ? 0.0 : 1.0);
    // "z" ends at the start but has its own from; all numbers are whole, so sums are exact.
    EXPECT_EQ(area, -75 * 100.0 * 100.0);
}

}  // namespace
}  // namespace ricci
