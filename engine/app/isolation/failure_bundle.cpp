#include "engine/app/isolation/failure_bundle.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "engine/app/commands.h"
#include "engine/app/records.h"
#include "engine/app/version.h"
#include "io/mesh/mesh_file.h"
#include "io/store/durable.h"

namespace ricci::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecord = "failure.json";

std::string failures_folder(const std::string& output) {
    return output + ".failures";
}

/// For a shell.
std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

/// Only what is a comment whatever the names in it.
std::string one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 0x20; }, ' ');
    return text;
}

std::string script(const FailureBundle& bundle) {
    std::string command;
    for (const std::string& word : bundle.arguments) command += " " + quoted(word);
    if (const std::uint64_t bytes = max_unpacked_set(); bytes > 0)
        command += fmt::format(" --max-unpacked={}", bytes);
    return fmt::format(
        "#!/bin/sh\n"
        "# {} ({}): {}\n"
        "# {}\n"
        "# Another program file than the one that failed: RICCI=/path/to/ricci ./reproduce.sh\n"
        "program={}\n"
        "cd \"$(dirname \"$0\")\" && exec \"${{RICCI:-$program}}\"{} \"$@\"\n",
        one_line(bundle.failure.item), bundle.failure.stage, bundle.failure.status,
        one_line(bundle.failure.message), quoted(own_program()), command);
}

nlohmann::json record(const FailureBundle& bundle) {
    const ChildEnd& end = bundle.end;
    const RunInfo info = make_run_info("", "", 1);
    return {{"item", bundle.failure.item},
            {"stage", bundle.failure.stage},
            {"status", bundle.failure.status},
            {"message", bundle.failure.message},
            {"signal", end.signal != 0 ? nlohmann::json(signal_name(end.signal)) : nlohmann::json()},
            {"exit_status", end.exit_status >= 0 ? nlohmann::json(end.exit_status) : nlohmann::json()},
            {"source", bundle.mesh_file},
            {"software_version", info.software_version},
            {"git", info.git},
            {"host", info.host},
            {"command", info.command}};
}

void write_files(const std::string& folder, const FailureBundle& bundle) {
    fs::remove_all(folder);
    fs::create_directories(folder);
    std::error_code unreadable;  // which may well be what failed
    fs::copy_file(bundle.mesh_file, fs::path(folder) / bundled_mesh(bundle.mesh_file), unreadable);
    for (const auto& [name, text] : bundle.files) write_text_durably(folder + "/" + name, text);
    write_text_durably(folder + "/stderr.txt", bundle.end.errors);
    write_text_durably(folder + "/reproduce.sh", script(bundle));
    fs::permissions(folder + "/reproduce.sh", fs::perms::owner_exec | fs::perms::group_exec,
                    fs::perm_options::add);
    const std::string json = record(bundle).dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
    write_text_durably(folder + "/" + kRecord, json + "\n");
}

}  // namespace

std::string bundle_folder(const std::string& output, const std::string& item) {
    const bool hidden = item.starts_with('.');
    return failures_folder(output) + "/" + (hidden ? "_" : "") + item;
}

std::string bundled_mesh(const std::string& mesh_file) {
    const std::string name = fs::path(mesh_file).filename().string();
    // One that looks like an option, or like a file of the bundle, is neither.
    return name.starts_with('-') || name == kRecord ? "mesh" + name : name;
}

std::string write_bundle(const std::string& output, const FailureBundle& bundle) {
    const std::string folder = bundle_folder(output, bundle.failure.item);
    try {
        write_files(folder, bundle);
    } catch (const std::exception& e) {
        return fmt::format("{}: cannot write the reproducer: {}", folder, e.what());
    }
    return {};
}

void remove_other_bundles(const std::string& output, const std::vector<std::string>& items) {
    std::set<std::string> wanted;
    for (const std::string& item : items)
        wanted.insert(fs::path(bundle_folder(output, item)).filename().string());
    std::error_code ignored;
    std::vector<fs::path> needless;
    for (const auto& entry : fs::directory_iterator(failures_folder(output), ignored))
        if (!wanted.contains(entry.path().filename().string()) && fs::exists(entry.path() / kRecord, ignored))
            needless.push_back(entry.path());
    for (const fs::path& path : needless) fs::remove_all(path, ignored);
    fs::remove(failures_folder(output), ignored);  // succeeds when it is empty
}

}  // namespace ricci::app
