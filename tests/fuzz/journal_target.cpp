// The journal of a run in progress, and a run resumed from it.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "engine/app/records.h"
#include "io/store/index_store.h"
#include "io/store/journal.h"
#include "io/store/run_store.h"
#include "tests/fuzz/allocation_meter.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/fuzz/scratch_folder.h"

namespace ricci::fuzz {
namespace {

RunInfo run_info() {
    return app::make_run_info("[sweep]\n", "fingerprint", 1);
}

/// The checksum that a journal's reader asks for. Without it no change of a line would get past the first
/// check.
std::string sealed(std::string_view line) {
    if (!line.ends_with('}')) return std::string(line);
    line.remove_suffix(1);
    return fmt::format("{},\"line\":\"{}\"}}", line, hex16(checksum_of(line)));
}

void write(const std::string& path, std::string_view text) {
    std::ofstream file(path, std::ios::binary);
    file.write(text.data(), static_cast<std::streamsize>(text.size()));
    require(file.good(), "the journal cannot be written");
}

/// Lines sealed, behind a first line that fits the run.
std::string sealed_journal(const std::string& fingerprint, Bytes bytes) {
    const nlohmann::json header{
        {"kind", "run"}, {"fingerprint", fingerprint}, {"status_names", run_info().status.names}};
    std::string text = sealed(header.dump()) + "\n";
    std::istringstream lines(text_of(bytes));
    for (std::string line; std::getline(lines, line);) text += sealed(line) + "\n";
    return text;
}

template <class Work>
void attempt(Work work) {
    try {
        work();
    } catch (const FileError&) {
    } catch (const std::invalid_argument&) {
    }
}

void read_journal_of(const std::string& folder, const std::string& text) {
    std::filesystem::create_directories(folder);
    write(journal_path(folder), text);
    // JSON of two bytes ("[[[[...") is a node of a tree.
    const AllocationMeter meter(memory_allowed(2 * text.size()));
    attempt([&] { read_journal(folder); });
}

}  // namespace

void read_journal_file(Bytes bytes) {
    const std::string output = scratch_folder().file("run.h5"), folder = output + ".parts";
    read_journal_of(folder, text_of(bytes));
    read_journal_of(folder, sealed_journal("fingerprint", bytes));
    // Names in the journal are of files in the folder: whatever they say, this one is not.
    const std::string bystander = scratch_folder().file("bystander");
    write(bystander, "untouched");
    attempt([&] {
        RunStore store(output, run_info(), true);
        static_cast<void>(store.finished_rows("a"));
        static_cast<void>(store.failures());
        static_cast<void>(store.notes());
    });
    require(std::filesystem::exists(bystander), "resuming removed a file outside of its folder");
    scratch_folder().remove("run.h5.parts");
    read_journal_of(folder, sealed_journal("index, descriptor version 1\nfingerprint", bytes));
    attempt([&] {
        IndexStore store(output, run_info(), 1, true);
        static_cast<void>(store.known_components(0));
    });
    scratch_folder().remove("run.h5.parts");
}

}  // namespace ricci::fuzz
