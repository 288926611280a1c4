// `ricci path`: order of frames, outputs that agree, failures, several sequences, pictures.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <sstream>

#include "engine/app/natural_order.h"
#include "engine/app/pictures/draw_path.h"
#include "engine/app/pictures/text_places.h"
#include "io/mesh/mesh_file.h"
#include "io/store/hdf5_file.h"
#include "tests/io/svg_reading.h"
#include "tests/support/program.h"

namespace ricci {
namespace {

namespace fs = std::filesystem;
using app::DrawnSequence;
using ricci::testing::make;
using ricci::testing::objects;
using ricci::testing::ProgramResult;
using ricci::testing::read_text;
using ricci::testing::run_ricci;
using ricci::testing::TemporaryFolder;
using ricci::testing::write_text;
using Words = std::vector<std::string>;

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t p = text.find(part); p != std::string::npos; p = text.find(part, p + 1)) ++found;
    return found;
}

/// Eleven frames of a one-holed torus that is stretched (frame1 ... frame11), three of it being twisted.
struct Frames {
    TemporaryFolder folder;
    SurfaceMesh start;

    Frames() {
        start = load_mesh(make(folder, "punctured-torus", 400)).components.at(0);
        fs::create_directory(folder / "stretch");
        fs::create_directory(folder / "twist");
        for (int k = 1; k <= 11; ++k) save("stretch/frame" + std::to_string(k) + ".off", 0.03 * (k - 1), 0.0);
        for (int k = 0; k < 3; ++k) save("twist/t" + std::to_string(k) + ".off", 0.0, 0.1 * k);
    }
    void save(const std::string& name, double stretch, double twist) const {
        SurfaceMesh mesh = start;
        for (Point& p : mesh.points) {
            const double c = std::cos(twist * p[0]), s = std::sin(twist * p[0]);
            p = {(1 + stretch) * p[0], c * p[1] - s * p[2], s * p[1] + c * p[2]};
        }
        save_mesh(folder / name, mesh);
    }
    [[nodiscard]] ProgramResult run(Words words) const {
        words.insert(words.begin(), "path");
        return run_ricci(folder, words);
    }
};

std::vector<std::vector<std::string>> read_csv(const std::string& path) {
    std::istringstream lines(read_text(path));
    std::vector<std::vector<std::string>> rows;
    for (std::string line; std::getline(lines, line);) {
        std::vector<std::string>& row = rows.emplace_back();
        std::string cell;
        bool quoted = false;
        for (const char c : line) {
            if (c == '"')
                quoted = !quoted;
            else if (c == ',' && !quoted)
                row.push_back(std::exchange(cell, {}));
            else
                cell += c;
        }
        row.push_back(cell);
    }
    return rows;
}

/// A column of numbers of a table: NaN where cells are empty.
std::vector<double> column(const std::vector<std::vector<std::string>>& rows, const std::string& name) {
    const auto& head = rows.front();
    const auto k = static_cast<std::size_t>(std::find(head.begin(), head.end(), name) - head.begin());
    std::vector<double> values;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        const std::string& cell = rows[i].at(k);
        values.push_back(cell.empty() ? NAN : std::stod(cell));
    }
    return values;
}

void expect_number(const nlohmann::json& json, double other) {
    if (json.is_null())
        EXPECT_TRUE(std::isnan(other));
    else
        EXPECT_EQ(json.get<double>(), other);
}

TEST(PathCommand, FoldersAndGlobsAreTakenInNaturalOrder) {
    const Frames f;
    const ProgramResult result = f.run({f.folder / "stretch", "--json"}),
                        glob = f.run({f.folder / "stretch/*.off", "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.out, glob.out);
    const auto lines = objects(result.out);
    ASSERT_EQ(lines.size(), 11U);
    for (std::size_t k = 0; k < lines.size(); ++k) {
        EXPECT_TRUE(lines[k]["file"].get<std::string>().ends_with("frame" + std::to_string(k + 1) + ".off"));
        EXPECT_EQ(lines[k]["frame"], k);
        EXPECT_EQ(lines[k]["marking"], k == 0 ? "own" : "carried");
    }
    // In natural order all steps are alike.
    for (std::size_t k = 2; k < lines.size(); ++k)
        EXPECT_NEAR(lines[k]["step"].get<double>() / lines[1]["step"].get<double>(), 1.0, 0.5);
    const ProgramResult given =
        f.run({f.folder / "stretch/frame10.off", f.folder / "stretch/frame2.off", "--json"});
    EXPECT_TRUE(objects(given.out)[0]["file"].get<std::string>().ends_with("frame10.off")) << "as given";
    EXPECT_NE(given.err.find("quote the glob"), std::string::npos);
}

TEST(PathCommand, TableFileAndJsonAgreeAndABadFrameIsRecorded) {
    const Frames f;
    write_text(f.folder / "stretch/frame5.off", "OFF\n3 1 0\n0 0 0\n");
    const std::string csv = f.folder / "p.csv", h5 = f.folder / "p.h5";
    const Words files{f.folder / "stretch", "--and", f.folder / "twist", "--json"};
    Words to_csv = files, to_h5 = files;
    to_csv.insert(to_csv.end(), {"-o", csv});
    to_h5.insert(to_h5.end(), {"-o", h5});
    const ProgramResult result = f.run(to_csv);
    EXPECT_EQ(result.status, 1);
    EXPECT_NE(result.err.find("frame5.off"), std::string::npos);
    ASSERT_EQ(f.run(to_h5).out, result.out);
    const auto lines = objects(result.out);
    const auto rows = read_csv(csv);
    ASSERT_EQ(lines.size(), 14U);
    ASSERT_EQ(rows.size(), 15U);
    EXPECT_EQ(lines[4]["status"], "invalid_input");
    EXPECT_TRUE(lines[4]["coordinates"].empty());
    EXPECT_FALSE(lines[4]["message"].get<std::string>().empty());
    EXPECT_EQ(lines[5]["marking"], "carried");
    EXPECT_GT(lines[5]["step"].get<double>(), 1.5 * lines[6]["step"].get<double>()) << "from frame 4";
    EXPECT_EQ(lines[11]["marking"], "carried") << "the second sequence has the triangles of the first";
    EXPECT_EQ(lines[11]["length"], 0.0);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(lines[11]["coordinates"][i].get<double>(), lines[0]["coordinates"][i].get<double>(),
                    1e-10);

    const hdf5::Session session;
    const hdf5::Handle file = hdf5::open_input(h5);
    EXPECT_EQ(hdf5::read_text_attribute(file, "kind"), "paths");
    EXPECT_EQ(hdf5::read_attribute<std::int32_t>(file, "complete"), 1);
    EXPECT_TRUE(hdf5::checksum_complaints(file, "/").empty());
    for (std::size_t s = 0, row = 0; s < 2; ++s) {
        const hdf5::Handle group = hdf5::open_group(file, "paths/" + std::to_string(s + 1));
        EXPECT_EQ(hdf5::read_text_attribute(group, "type"), "g1b1");
        const std::size_t frames = s == 0 ? 11 : 3;
        const auto coordinates = hdf5::read_array<double>(group, "coordinates", hdf5::Shape{frames, 3});
        const auto status = hdf5::read_array<std::uint8_t>(group, "status", hdf5::Shape{frames});
        const auto numbers = hdf5::read_array<std::int32_t>(group, "marking_number", hdf5::Shape{frames});
        for (std::size_t k = 0; k < frames; ++k, ++row) {
            EXPECT_EQ(lines[row]["sequence"], s + 1);
            EXPECT_EQ(rows[row + 1][0], std::to_string(s + 1));
            EXPECT_EQ(rows[row + 1][2], lines[row]["file"].get<std::string>());
            EXPECT_EQ(status[k] == 0, lines[row]["status"] == "converged");
            EXPECT_EQ(lines[row]["marking_number"], numbers[k]);
            EXPECT_EQ(lines[row]["marking_number"].get<double>(), column(rows, "marking_number")[row]);
            for (const char* name : {"step", "free_step", "length"}) {
                const auto values = hdf5::read_array<double>(group, name, hdf5::Shape{frames});
                expect_number(lines[row][name], values[k]);
                expect_number(lines[row][name], column(rows, name)[row]);
            }
            const std::vector<std::string> names{"a1", "b1", "a1b1"};
            for (std::size_t i = 0; i < 3; ++i) {
                const auto& c = lines[row]["coordinates"];
                expect_number(c.empty() ? nlohmann::json() : c[i], coordinates[3 * k + i]);
                expect_number(c.empty() ? nlohmann::json() : c[i], column(rows, names[i])[row]);
            }
        }
    }
}

TEST(PathCommand, DrawsSeveralSequences) {
    const Frames f;
    const std::string svg = f.folder / "p.svg";
    ASSERT_EQ(f.run({f.folder / "stretch", "--and", f.folder / "twist", "--svg", svg}).status, 0);
    const std::string document = read_text(svg);
    EXPECT_EQ(count(document, "0 stretch/frame1.off</text>"), 1U);
    EXPECT_EQ(count(document, "10 stretch/frame11.off</text>"), 1U);
    EXPECT_EQ(count(document, "2 twist/t2.off</text>"), 1U);
    for (const char* name : {">a1<", ">b1<", ">a1b1<"}) EXPECT_EQ(count(document, name), 1U);
    EXPECT_NE(document.find("principal component 1"), std::string::npos);
}

TEST(PathCommand, SaysWhatIsWrong) {
    const Frames f;
    EXPECT_EQ(f.run({f.folder / "twist", "-o", "p.txt"}).status, 2);
    EXPECT_EQ(f.run({f.folder / "nothing*.off"}).status, 2);
    EXPECT_EQ(f.run({f.folder / "missing.off"}).status, 3);
    const ProgramResult missing = f.run({f.folder / "twist", f.folder / "missing.off", "--json"});
    EXPECT_EQ(missing.status, 1);
    EXPECT_EQ(objects(missing.out).size(), 4U);
    const ProgramResult help = f.run({"--help"});
    EXPECT_NE(help.out.find("Example: ricci path"), std::string::npos);
}

TEST(NaturalOrder, CountsAsPeopleDo) {
    const Words sorted{"a", "a/frame2.off", "a/frame10.off", "b01", "b1", "b1c", "b2", "c007x3", "c7x10"};
    for (std::size_t i = 0; i < sorted.size(); ++i)
        for (std::size_t j = 0; j < sorted.size(); ++j)
            EXPECT_EQ(app::natural_less(sorted[i], sorted[j]), i < j) << sorted[i] << " " << sorted[j];
    EXPECT_TRUE(app::natural_less("x99999999999999999999", "x100000000000000000000"));
}

TEST(TextPlaces, SpreadsOutAsLittleAsNeedsBe) {
    EXPECT_EQ(app::spread_out({1, 20, 50}, 10), (std::vector<double>{1, 20, 50}));
    EXPECT_EQ(app::spread_out({10, 10}, 10), (std::vector<double>{5, 15}));
    const std::vector<double> wanted{0, 1, 2, 30, 33, 34, 80}, got = app::spread_out(wanted, 12);
    double moved = 0.0;
    for (std::size_t k = 0; k < got.size(); ++k) {
        if (k > 0) {
            EXPECT_GE(got[k] - got[k - 1], 12 - 1e-9);
        }
        moved += got[k] - wanted[k];
    }
    EXPECT_NEAR(moved, 0.0, 1e-9);
    EXPECT_EQ(got.back(), 80);
}

/// Two half circles in a space of three dimensions, the second with a failure and another marking in between.
std::vector<DrawnSequence> half_circles() {
    std::vector<DrawnSequence> sequences(2);
    for (int k = 0; k <= 8; ++k) {
        const double angle = 3.14159265358979 * k / 8;
        const std::string name = "f" + std::to_string(k);
        sequences[0].frames.push_back({name, {std::cos(angle), std::sin(angle), 2.0}, false});
        sequences[1].frames.push_back(
            {"g" + std::to_string(k), {std::cos(angle), -std::sin(angle), 2.0}, k == 5});
    }
    sequences[1].frames[2].coordinates.clear();
    return sequences;
}

TEST(DrawPath, KeepsEqualScalesAndMarksWhatIsNotContinuous) {
    const std::string document = app::draw_path(half_circles(), {"x", "y", "z"}, "circle").document();
    EXPECT_EQ(document, app::draw_path(half_circles(), {"x", "y", "z"}, "circle").document());
    // One dashed segment on the left; dots: 9 + 8 there, 9 x 3 on the right.
    EXPECT_EQ(count(document, "stroke-dasharray=\"3"), 1U);
    EXPECT_EQ(count(document, "<title>"), 18U) << "17 dots and the picture";
    EXPECT_EQ(count(document, ">z<"), 1U);
    EXPECT_THROW(app::draw_path(half_circles(), {"x", "y"}, ""), std::invalid_argument);
    EXPECT_THROW(app::draw_path({}, {"x"}, ""), std::invalid_argument);
}

}  // namespace
}  // namespace ricci
