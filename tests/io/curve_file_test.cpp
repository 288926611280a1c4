#include "io/mesh/curve_file.h"

#include <gtest/gtest.h>

#include "tests/io/mesh_test_files.h"

namespace ricci {
namespace {

using testing::TemporaryFolder;

/// What the reader says about a file.
std::string complaint(const TemporaryFolder& folder, const std::string& bytes) {
    try {
        read_curves(folder.write("curves.txt", bytes));
    } catch (const FileError& error) {
        return error.what();
    }
    return "";
}

TEST(CurveFile, HoldsOneCurvePerLine) {
    const TemporaryFolder folder;
    const auto curves = read_curves(
        folder.write("c.txt", "# a marking\r\nwaist 3 1 4\r\n\n  b 10 11 12 13 # comment\nloop 7\n"));
    ASSERT_EQ(curves.size(), 3U);
    EXPECT_EQ(curves[0].name, "waist");
    EXPECT_EQ(curves[0].vertices, (std::vector<Index>{3, 1, 4}));
    EXPECT_EQ(curves[0].line, 2);
    EXPECT_EQ(curves[1].name, "b");
    EXPECT_EQ(curves[1].vertices, (std::vector<Index>{10, 11, 12, 13}));
    EXPECT_EQ(curves[1].line, 4);
    EXPECT_EQ(curves[2].vertices, (std::vector<Index>{7}));
}

TEST(CurveFile, NamesWhatIsWrongAndWhere) {
    const TemporaryFolder folder;
    const std::vector<std::array<std::string, 3>> files{
        {"a 1 2 3\nb 1 x 3\n", "line 2", "'x'"},
        {"a 1 2.5 3\n", "line 1", "'2.5'"},
        {"\na 1 -2 3\n", "line 2", "-2"},
        {"a 1 4294967297 3\n", "line 1", "4294967297"},
        {"a 1 2 3\n\nb\n", "line 3", "'b' has no vertices"},
        {"a 1 2 3\nb 1 2\na 4 5 6\n", "line 3", "'a' has been given in line 1"},
        {"# nothing\n", "curves.txt", "no curve"}};
    for (const auto& [bytes, place, what] : files) {
        const std::string message = complaint(folder, bytes);
        EXPECT_NE(message.find(place), std::string::npos) << message;
        EXPECT_NE(message.find(what), std::string::npos) << message;
        EXPECT_NE(message.find("curves.txt"), std::string::npos) << message;
    }
    EXPECT_THROW(read_curves(folder.path("missing.txt")), FileError);
}

}  // namespace
}  // namespace ricci
