// Replays the corpus of every fuzz target: reproducers of what was found, and nasties made by hand.
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "io/store/run_store.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/fuzz/scratch_folder.h"
#include "tests/support/digests.h"
#include "tests/support/test_data.h"

namespace ricci::fuzz {
namespace {

namespace fs = std::filesystem;

std::vector<std::uint8_t> bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<fs::path> files_in(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

class Corpus : public ::testing::TestWithParam<Target> {};

TEST_P(Corpus, IsTakenInOrRefused) {
    spdlog::set_level(spdlog::level::off);
    const fs::path folder = fs::path(RICCI_SOURCE_DIR) / "tests" / "fuzz" / "corpus" / GetParam().name;
    const std::vector<fs::path> files = files_in(folder);
    ASSERT_FALSE(files.empty()) << folder;
    for (const fs::path& file : files)
        EXPECT_NO_THROW(GetParam().run(bytes_of(file)))
            << file << "\nran through the target " << GetParam().name;
}

INSTANTIATE_TEST_SUITE_P(OfEveryTarget, Corpus, ::testing::ValuesIn(targets().begin(), targets().end()),
                         [](const auto& of) { return std::string(of.param.name); });

/// The target that reads files with this suffix.
const Target* target_of(const fs::path& file) {
    const std::string suffix = file.extension() == ".gz" ? "gzip" : file.extension().string().substr(1);
    const auto found = std::find_if(targets().begin(), targets().end(),
                                    [&](const Target& target) { return target.name == suffix; });
    return found == targets().end() ? nullptr : &*found;
}

// The bad files of the sample set, and cut off at every eighth part; within the memory that a reader may
// take.
TEST(BadSamples, AreTakenInOrRefusedWhereverTheyEnd) {
    const fs::path folder = testing::data_folder();
    if (folder.empty())
        GTEST_SKIP() << "no sample files; set RICCI_DATA to the folder that holds meshes/ and bad/";
    constexpr std::uintmax_t kLargest = 200'000;
    for (const fs::path& file : files_in(folder / "bad")) {
        const Target* target = target_of(file);
        if (target == nullptr || fs::file_size(file) > kLargest) continue;
        const std::vector<std::uint8_t> bytes = bytes_of(file);
        for (std::size_t eighth = 1; eighth <= 8; ++eighth)
            EXPECT_NO_THROW(target->run(Bytes(bytes).first(bytes.size() * eighth / 8)))
                << file << " " << eighth;
    }
}

// What the HDF5 targets change is sound before they change it; else everything would be refused at the door.
TEST(ResultFiles, AreSoundToBeginWith) {
    for (const std::string& sample : sample_result_files())
        EXPECT_EQ(verify_structure(sample), std::vector<std::string>()) << sample;
}

// Every sample file with one bit after the other turned over, sparsely: an error, or the data.
TEST(ResultFiles, SurviveBitFlipsAndTruncation) {
    spdlog::set_level(spdlog::level::off);
    for (const std::string& sample : sample_result_files()) {
        const std::vector<std::uint8_t> bytes = bytes_of(sample);
        constexpr std::size_t kChanges = 12;
        for (std::size_t i = 0; i < kChanges; ++i) {
            std::vector<std::uint8_t> changed = bytes;
            const std::size_t at = (bytes.size() - 1) * i / (kChanges - 1);
            changed[at] ^= static_cast<std::uint8_t>(1U << (i % 8));
            EXPECT_NO_THROW(read_hdf5_bytes(changed)) << sample << ", byte " << at;
            EXPECT_NO_THROW(read_hdf5_bytes(Bytes(bytes).first(at))) << sample << ", cut at " << at;
        }
    }
}

// A bit more: what verify lets pass reads as before.
TEST(ResultFiles, VerifyNamesEveryBitThatMatters) {
    const std::string path = scratch_folder().file("changed.h5");
    std::size_t named = 0, harmless = 0;
    for (const std::string& sample : sample_result_files()) {
        const std::vector<std::uint8_t> bytes = bytes_of(sample);
        const auto expected = testing::digests(sample);
        constexpr std::size_t kChanges = 40;
        for (std::size_t i = 0; i < kChanges; ++i) {
            std::vector<std::uint8_t> changed = bytes;
            const std::size_t at = (bytes.size() * (2 * i + 1)) / (2 * kChanges);
            changed[at] ^= static_cast<std::uint8_t>(1U << (i % 8));
            std::ofstream(path, std::ios::binary)
                .write(reinterpret_cast<const char*>(changed.data()),
                       static_cast<std::streamsize>(changed.size()));
            if (!verify_structure(path).empty()) {
                ++named;
                continue;
            }
            ++harmless;
            EXPECT_EQ(testing::digests(path), expected) << sample << ", byte " << at;
        }
    }
    EXPECT_GT(named, harmless);
}

// The free space of a heap (FSHD) is what only readers that ask for everything about an object look at.
TEST(ResultFiles, DamagedFreeSpaceIsNamed) {
    const std::string path = scratch_folder().file("changed.h5");
    int found = 0;
    for (const std::string& sample : sample_result_files()) {
        const std::vector<std::uint8_t> bytes = bytes_of(sample);
        std::string text(bytes.begin(), bytes.end());
        const std::size_t at = text.find("FSHD");
        if (at == std::string::npos) continue;
        ++found;
        text[at + 20] = static_cast<char>(text[at + 20] ^ 1);
        std::ofstream(path, std::ios::binary) << text;
        EXPECT_FALSE(verify_structure(path).empty()) << sample;
    }
    EXPECT_GT(found, 0);
}

}  // namespace
}  // namespace ricci::fuzz
