#include "io/mesh/save_curves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "tests/io/mesh_test_files.h"

namespace ricci {
namespace {

using testing::TemporaryFolder;

/// A closed triangle whose coordinates need every digit, and an open line.
std::vector<NamedCurve> samples() {
    const Point p{0.1, 1.0 / 3.0, -2e-17}, q{1e300, std::sqrt(2.0), 7}, r{-1, 0, 5};
    return {{"a1 b1^-1", 3.057141838962, {p, q, r, p}}, {"waist<&>", 0.25, {r, q}}};
}

std::string saved(const TemporaryFolder& folder, const std::string& name) {
    save_curves(folder.path(name), samples());
    std::ifstream file(folder.path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// The numbers behind a mark, as many as asked for.
std::vector<double> numbers_after(const std::string& text, const std::string& mark, std::size_t count) {
    const std::size_t place = text.find(mark);
    EXPECT_NE(place, std::string::npos) << mark;
    std::istringstream in(text.substr(place + mark.size()));
    std::vector<double> numbers(count);
    for (double& x : numbers) in >> x;
    EXPECT_TRUE(static_cast<bool>(in)) << mark;
    return numbers;
}

/// All points of the samples, the repeated one left out.
std::vector<double> sample_coordinates() {
    std::vector<double> all;
    const auto curves = samples();
    for (const NamedCurve& curve : curves)
        for (std::size_t i = 0; i < (curve.points.size() == 4 ? 3U : 2U); ++i)
            all.insert(all.end(), curve.points[i].begin(), curve.points[i].end());
    return all;
}

TEST(SaveCurves, ObjHasAnObjectForEveryCurve) {
    const TemporaryFolder folder;
    const std::string text = saved(folder, "curves.obj");
    std::vector<double> coordinates;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (line.rfind("v ", 0) == 0)
            for (const double x : numbers_after(line, "v ", 3)) coordinates.push_back(x);
    EXPECT_EQ(coordinates, sample_coordinates());
    EXPECT_NE(text.find("o a1_b1^-1\nl 1 2 3 1\n"), std::string::npos);
    EXPECT_NE(text.find("o waist<&>\nl 4 5\n"), std::string::npos);
}

TEST(SaveCurves, LegacyVtkHasLinesAndCellData) {
    const TemporaryFolder folder;
    const std::string text = saved(folder, "curves.vtk");
    EXPECT_EQ(text.rfind("# vtk DataFile Version 3.0\n", 0), 0U);
    EXPECT_EQ(numbers_after(text, "POINTS 5 double", 15), sample_coordinates());
    EXPECT_EQ(numbers_after(text, "LINES 2 8", 8), (std::vector<double>{4, 0, 1, 2, 0, 2, 3, 4}));
    EXPECT_EQ(numbers_after(text, "SCALARS curve int 1\nLOOKUP_TABLE default", 2),
              (std::vector<double>{0, 1}));
    EXPECT_EQ(numbers_after(text, "SCALARS length double 1\nLOOKUP_TABLE default", 2),
              (std::vector<double>{3.057141838962, 0.25}));
    EXPECT_NE(text.find("name 1 2 string\na1%20b1^-1\nwaist%3C%26%3E\n"), std::string::npos);
}

TEST(SaveCurves, VtpHoldsTheSame) {
    const TemporaryFolder folder;
    const std::string text = saved(folder, "curves.VTP");
    EXPECT_NE(text.find("NumberOfPoints=\"5\""), std::string::npos);
    EXPECT_NE(text.find("NumberOfLines=\"2\""), std::string::npos);
    const std::string ascii = "\" format=\"ascii\">";
    EXPECT_EQ(numbers_after(text, "Name=\"Points\" NumberOfComponents=\"3" + ascii, 15),
              sample_coordinates());
    EXPECT_EQ(numbers_after(text, "\"connectivity" + ascii, 6), (std::vector<double>{0, 1, 2, 0, 3, 4}));
    EXPECT_EQ(numbers_after(text, "\"offsets" + ascii, 2), (std::vector<double>{4, 6}));
    EXPECT_EQ(numbers_after(text, "\"length" + ascii, 2), (std::vector<double>{3.057141838962, 0.25}));
    std::string names;
    for (const double code : numbers_after(text, "\"name" + ascii, 9 + 9))
        names += static_cast<char>(static_cast<int>(code));
    EXPECT_EQ(names, std::string("a1 b1^-1\0waist<&>\0", 18));
}

TEST(SaveCurves, RefusesWhatIsNoCurve) {
    const TemporaryFolder folder;
    const std::string path = folder.path("c.obj");
    EXPECT_THROW(save_curves(path, std::vector<NamedCurve>{{"a", 1, {{0, 0, 0}}}}), std::invalid_argument);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(save_curves(path, std::vector<NamedCurve>{{"a", 1, {{0, 0, 0}, {0, nan, 0}}}}),
                 std::invalid_argument);
    EXPECT_THROW(save_curves(path, std::vector<NamedCurve>{{"a", nan, {{0, 0, 0}, {0, 1, 0}}}}),
                 std::invalid_argument);
    EXPECT_THROW(save_curves(folder.path("c.off"), samples()), FileError);
    EXPECT_THROW(save_curves(folder.path("no/such/folder/c.obj"), samples()), FileError);
}

}  // namespace
}  // namespace ricci
