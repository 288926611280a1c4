#include "io/store/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace ricci {
namespace {

using nlohmann::json;

constexpr std::string_view kLineChecksum = R"(,"line":")";

// The object's text with the checksum of that text as its last member, and a newline.
std::string sealed_line(const json& object) {
    std::string text = object.dump();
    text.pop_back();  // the closing brace
    return fmt::format("{}{}{}\"}}\n", text, kLineChecksum, hex16(checksum_of(std::string_view(text))));
}

// The object of a line (without newline), or nothing when the line is not what was written.
std::optional<json> believed(std::string_view line) {
    constexpr std::size_t kTail = kLineChecksum.size() + 16 + 2;
    if (line.size() <= kTail) return std::nullopt;
    const std::string_view text = line.substr(0, line.size() - kTail);
    const std::string expected = fmt::format("{}{}\"}}", kLineChecksum, hex16(checksum_of(text)));
    if (line.substr(text.size()) != expected) return std::nullopt;
    json object = json::parse(line, nullptr, false);
    if (!object.is_object()) return std::nullopt;
    return object;
}

json json_of(const std::vector<VertexRun>& runs) {
    json list = json::array();
    for (const VertexRun& run : runs) list.push_back({run.first, run.count});
    return list;
}

// What the journal's JSON does not rule out, and no run has written.
[[noreturn]] void refuse(const char* what) {
    throw std::invalid_argument(what);
}

std::vector<VertexRun> runs_of(const json& list) {
    std::vector<VertexRun> runs;
    std::int64_t end = 0;
    for (const json& run : list) {
        const auto first = run.at(0).get<std::int64_t>(), count = run.at(1).get<std::int64_t>();
        constexpr std::int64_t kMax = std::numeric_limits<Index>::max();
        if (first < end || first > kMax || count < 1 || count > kMax - first)
            refuse("runs of vertices that do not ascend");
        end = first + count;
        runs.push_back({static_cast<Index>(first), static_cast<Index>(count)});
    }
    return runs;
}

// A file in the folder itself: a name that leads out of it would have its target read, and removed.
std::string file_name(const json& name) {
    auto text = name.get<std::string>();
    if (text.empty() || text == "." || text == ".." ||
        text.find_first_of(std::string_view("/\0", 2)) != std::string::npos)
        refuse("the name of a segment is no file name");
    return text;
}

std::uint64_t checksum_from(const json& digits) {
    const auto text = digits.get<std::string>();
    std::uint64_t checksum = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), checksum, 16);
    if (error != std::errc() || end != text.data() + text.size())
        refuse("a checksum is no hexadecimal number");
    return checksum;
}

json object_of(const JournalEntry& entry) {
    json object{{"kind", entry.kind}};
    if (entry.kind == "failure" || entry.kind == "retract") {
        object["item"] = entry.failure.item;
        object["stage"] = entry.failure.stage;
        object["status"] = entry.failure.status;
        object["message"] = entry.failure.message;
        return object;
    }
    object["name"] = entry.name;
    if (!entry.result()) return object;
    object["item"] = entry.item;
    object["checksum"] = hex16(entry.checksum);
    if (entry.kind == "sweep") object["vertices"] = json_of(entry.vertices);
    return object;
}

// Throws json::exception or std::invalid_argument on a line of another shape.
JournalEntry entry_of(const json& object) {
    JournalEntry entry;
    entry.kind = object.at("kind").get<std::string>();
    if (entry.kind == "failure" || entry.kind == "retract") {
        entry.failure = {object.at("item").get<std::string>(), object.at("stage").get<std::string>(),
                         object.at("status").get<std::string>(), object.at("message").get<std::string>()};
        return entry;
    }
    if (entry.kind == "processor") {
        entry.name = object.at("name").get<std::string>();
        return entry;
    }
    entry.name = file_name(object.at("name"));
    if (!entry.result()) return entry;
    entry.item = object.at("item").get<std::string>();
    entry.checksum = checksum_from(object.at("checksum"));
    if (entry.kind == "sweep") entry.vertices = runs_of(object.at("vertices"));
    return entry;
}

void read_header(const std::string& path, const std::optional<json>& object, JournalHeader& header) {
    if (!object || object->value("kind", "") != "run")
        throw FileError(path +
                        ": the first line is damaged, so nothing can be resumed; run without --resume");
    header.fingerprint = object->at("fingerprint").get<std::string>();
    header.status_names = object->at("status_names").get<std::vector<std::string>>();
    header.processor = object->value("processor", "");
}

}  // namespace

std::vector<VertexRun> runs_of(const std::vector<Index>& vertices) {
    std::vector<VertexRun> runs;
    for (const Index vertex : vertices) {
        if (runs.empty() || runs.back().first + runs.back().count != vertex) runs.push_back({vertex, 0});
        ++runs.back().count;
    }
    return runs;
}

std::string journal_path(const std::string& folder) {
    return folder + "/journal";
}

JournalContents read_journal(const std::string& folder) {
    const std::string path = journal_path(folder);
    const std::string text = read_text(path);
    JournalContents contents;
    try {
        std::size_t number = 0;
        for (std::size_t start = 0; start < text.size();) {
            ++number;
            const std::size_t newline = text.find('\n', start);
            const bool whole = newline != std::string::npos;
            const std::string_view line(text.data() + start, (whole ? newline : text.size()) - start);
            const std::optional<json> object = whole ? believed(line) : std::nullopt;
            if (number == 1) {
                read_header(path, object, contents.header);
            } else if (object) {
                contents.entries.push_back(entry_of(*object));
            } else {
                contents.notes.push_back(
                    fmt::format("{}: line {} is {}, ignored", path, number, whole ? "damaged" : "torn"));
            }
            start = whole ? newline + 1 : text.size();
            if (whole) contents.end = start;
        }
        if (number == 0) read_header(path, std::nullopt, contents.header);
    } catch (const json::exception& error) {
        throw FileError(fmt::format("{}: not a journal of this program: {}", path, error.what()));
    } catch (const std::invalid_argument& error) {
        throw FileError(fmt::format("{}: not a journal of this program: {}", path, error.what()));
    }
    return contents;
}

Journal::Journal(std::string path, std::uint64_t end)
    : path_(std::move(path)), file_(open_file(path_, O_WRONLY | O_APPEND)), end_(end) {}

Journal Journal::create(const std::string& folder, const JournalHeader& header) {
    json object{{"kind", "run"}, {"fingerprint", header.fingerprint}, {"status_names", header.status_names}};
    if (!header.processor.empty()) object["processor"] = header.processor;
    const std::string line = sealed_line(object);
    write_text_durably(journal_path(folder), line);
    return {journal_path(folder), line.size()};
}

Journal Journal::reopen(const std::string& folder, const JournalContents& contents) {
    Journal journal(journal_path(folder), contents.end);
    if (::ftruncate(journal.file_.get(), static_cast<off_t>(contents.end)) != 0)
        throw system_error(journal.path_, "cannot cut the torn end off", errno);
    sync_file(journal.file_.get(), journal.path_);
    return journal;
}

void Journal::append(const JournalEntry& entry) {
    if (broken_) throw FileError(path_ + ": takes no more lines after an earlier failure");
    const std::string line = sealed_line(object_of(entry));
    try {
        fault_point("journal_before");
        // Two halves, so that the tests can tear the line.
        write_all(file_.get(), std::string_view(line).substr(0, line.size() / 2), path_);
        fault_point("journal_half");
        write_all(file_.get(), std::string_view(line).substr(line.size() / 2), path_);
        fault_point("journal_written");
        sync_file(file_.get(), path_);
    } catch (const FileError&) {
        broken_ = ::ftruncate(file_.get(), static_cast<off_t>(end_)) != 0;
        throw;
    }
    end_ += line.size();
}

}  // namespace ricci
