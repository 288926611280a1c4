#include "io/store/fault_point.h"

#include <unistd.h>

#include <charconv>
#include <csignal>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace ricci {
namespace {

struct Fault {
    std::string_view point;
    std::optional<std::string_view> subject;
    int pass = 0;
    std::string_view action;
};

std::optional<int> number_in(std::string_view text) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

/// Read from the right, for a subject may hold colons.
Fault parse(std::string_view text) {
    Fault fault;
    fault.action = "kill";
    const auto last_part = [&] {
        const std::size_t colon = text.rfind(':');
        const std::string_view part = colon == std::string_view::npos ? text : text.substr(colon + 1);
        text = text.substr(0, colon == std::string_view::npos ? 0 : colon);
        return part;
    };
    std::string_view last = last_part();
    if (!number_in(last)) {
        fault.action = last;
        last = last_part();
    }
    fault.pass = number_in(last).value_or(0);
    const std::size_t at = text.find('@');
    fault.point = text.substr(0, at);
    if (at != std::string_view::npos) fault.subject = text.substr(at + 1);
    return fault;
}

using Pieces = std::vector<std::unique_ptr<char[]>>;

void allocate_all() {
    constexpr std::size_t kPiece = std::size_t{1} << 20U, kPieces = 4096;
    Pieces pieces;
    while (pieces.size() < kPieces) {
        pieces.push_back(std::make_unique<char[]>(kPiece));
        ::usleep(1000);
    }
}

void reserve_all() {
    constexpr std::size_t kPiece = std::size_t{64} << 20U, kPieces = 1024;
    Pieces pieces;
    while (pieces.size() < kPieces) pieces.push_back(std::make_unique_for_overwrite<char[]>(kPiece));
}

void act(std::string_view action) {
    if (action == "kill") std::raise(SIGKILL);
    if (action == "segv") std::raise(SIGSEGV);
    if (action == "abort") std::abort();
    if (action == "allocate") allocate_all();
    if (action == "reserve") reserve_all();
    if (action == "throw") throw std::runtime_error("thrown by RICCI_FAULT");
    while (action == "hang") ::sleep(1000);
}

/// Counts the pass of this fault.
int passes_of(std::string_view text) {
    static std::mutex mutex;
    static std::map<std::string, int, std::less<>> passes;
    const std::lock_guard lock(mutex);
    return ++passes.try_emplace(std::string(text)).first->second;
}

}  // namespace

void fault_point(const char* name, std::string_view subject) {
    const char* wanted = std::getenv("RICCI_FAULT");  // NOLINT(concurrency-mt-unsafe): tests set it before
    if (wanted == nullptr) return;
    for (std::string_view rest = wanted; !rest.empty();) {
        const std::string_view text = rest.substr(0, rest.find(';'));
        rest = rest.substr(std::min(rest.size(), text.size() + 1));
        const Fault fault = parse(text);
        if (fault.point != name || (fault.subject && *fault.subject != subject)) continue;
        if (passes_of(text) == fault.pass) act(fault.action);
    }
}

}  // namespace ricci
