#include "engine/app/console.h"

#include <fmt/format.h>
#include <glob.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <numbers>

#include "kernels/parallel.h"

namespace ricci::app {
namespace {

volatile std::sig_atomic_t signal_seen = 0;
std::atomic<std::int64_t> first_signal{0};  // nanoseconds of the monotonic clock

/// Batch systems signal a script and its children, and the script passes its signal on: what comes within a
/// second is one signal.
extern "C" void on_signal(int number) {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    const std::int64_t now = std::int64_t{1000000000} * time.tv_sec + time.tv_nsec;
    std::int64_t first = 0;
    if (first_signal.compare_exchange_strong(first, now))
        signal_seen = number;
    else if (now - first > 1000000000)
        std::_Exit(128 + number);
}

bool stderr_is_terminal() {
    return isatty(STDERR_FILENO) == 1;
}

std::string duration(double seconds) {
    const std::int64_t s = std::llround(seconds);
    if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
    return fmt::format("{}:{:02}", s / 60, s % 60);
}

std::string progress_text(const SchedulerProgress& p) {
    const double rate = p.seconds > 0.0 ? static_cast<double>(p.solves_done) / p.seconds : 0.0;
    // Sources not opened yet are taken to hold as much as those that are.
    const double per_source =
        p.sources_opened > 0 ? static_cast<double>(p.solves_known) / static_cast<double>(p.sources_opened)
                             : 0.0;
    const double left = static_cast<double>(p.solves_known - p.solves_done) +
                        per_source * static_cast<double>(p.sources - p.sources_opened);
    std::string text =
        fmt::format("mesh {}/{}  solves {}/{}", p.sources_opened, p.sources, p.solves_done, p.solves_known);
    if (rate > 0.0) text += fmt::format("  {:.1f}/s  ETA {}", rate, duration(left / rate));
    return text;
}

bool is_mesh_name(const std::filesystem::path& path) {
    std::string name = path.filename().string();
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    if (name.ends_with(".gz")) name.resize(name.size() - 3);
    return std::any_of(std::begin({".obj", ".off", ".ply", ".stl", ".len"}),
                       std::end({".obj", ".off", ".ply", ".stl", ".len"}),
                       [&](const char* suffix) { return name.ends_with(suffix); });
}

double parse_number(const std::string& text, const std::string& whole) {
    double value = 0.0;
    const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || text.empty() || !std::isfinite(value))
        throw UsageError(fmt::format("'{}' is not a number, nor [number][*]pi[/number]", whole));
    return value;
}

}  // namespace

int CommonOptions::resolved_threads() const {
    return threads > 0 ? threads : hardware_threads();
}

void set_up_log(const CommonOptions& options) {
    const bool colour = stderr_is_terminal() && std::getenv("NO_COLOR") == nullptr;
    auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>(colour ? spdlog::color_mode::always
                                                                             : spdlog::color_mode::never);
    auto logger = std::make_shared<spdlog::logger>("ricci", sink);
    logger->set_pattern("%^%l%$: %v");
    logger->set_level(options.quiet ? spdlog::level::err
                                    : (options.verbose ? spdlog::level::debug : spdlog::level::info));
    spdlog::set_default_logger(logger);
}

void print_json(const nlohmann::json& object) {
    const std::string line = object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    std::fputs(line.c_str(), stdout);
    std::fflush(stdout);
}

nlohmann::json finite_or_null(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

void catch_signals() {
    struct sigaction action {};
    action.sa_handler = on_signal;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    // A file that grows past its limit is an error of the write, with a message, not the end of the process.
    signal(SIGXFSZ, SIG_IGN);
}

int caught_signal() {
    return signal_seen;
}

bool stopped_by_signal() {
    return caught_signal() != 0;
}

ProgressLine::ProgressLine(bool quiet)
    : terminal_(stderr_is_terminal()), quiet_(quiet), last_(std::chrono::steady_clock::now()) {}

ProgressLine::~ProgressLine() {
    clear();
}

void ProgressLine::show(const SchedulerProgress& progress) {
    if (quiet_) return;
    const auto now = std::chrono::steady_clock::now();
    const auto pause = terminal_ ? std::chrono::milliseconds(200) : std::chrono::milliseconds(30000);
    if (now - last_ < pause) return;
    last_ = now;
    if (!terminal_) {
        spdlog::info("{}", progress_text(progress));
        return;
    }
    const double share = progress.solves_known > 0 ? static_cast<double>(progress.solves_done) /
                                                         static_cast<double>(progress.solves_known)
                                                   : 0.0;
    const auto filled = static_cast<std::size_t>(share * 24.0);
    std::fprintf(stderr, "\r\x1b[K[%s%s] %s", std::string(filled, '#').c_str(),
                 std::string(24 - filled, '.').c_str(), progress_text(progress).c_str());
    std::fflush(stderr);
    drawn_ = true;
}

void ProgressLine::clear() {
    if (!drawn_) return;
    std::fputs("\r\x1b[K", stderr);
    std::fflush(stderr);
    drawn_ = false;
}

std::vector<std::string> expand_inputs(const std::vector<std::string>& arguments) {
    namespace fs = std::filesystem;
    std::vector<std::string> files;
    for (const std::string& argument : arguments) {
        if (fs::is_directory(argument)) {
            std::vector<std::string> found;
            for (const auto& entry : fs::recursive_directory_iterator(argument))
                if (entry.is_regular_file() && is_mesh_name(entry.path()))
                    found.push_back(entry.path().string());
            if (found.empty()) throw UsageError(fmt::format("the folder '{}' holds no mesh file", argument));
            std::sort(found.begin(), found.end());
            files.insert(files.end(), found.begin(), found.end());
        } else if (!fs::exists(argument) && argument.find_first_of("*?[") != std::string::npos) {
            glob_t matches{};
            const int status = glob(argument.c_str(), 0, nullptr, &matches);
            for (std::size_t k = 0; status == 0 && k < matches.gl_pathc; ++k)
                files.emplace_back(matches.gl_pathv[k]);
            globfree(&matches);
            if (status != 0) throw UsageError(fmt::format("no file matches '{}'", argument));
        } else {
            files.push_back(argument);
        }
    }
    return files;
}

double parse_curvature(const std::string& text) {
    const auto pi_at = text.find("pi");
    if (pi_at == std::string::npos) return parse_number(text, text);
    std::string factor = text.substr(0, pi_at);
    const std::string rest = text.substr(pi_at + 2);
    if (factor.ends_with('*')) {
        factor.pop_back();
        if (factor.empty()) throw UsageError(fmt::format("'{}' has nothing before '*'", text));
    }
    if (factor.empty() || factor == "+") factor = "1";
    if (factor == "-") factor = "-1";
    double value = parse_number(factor, text) * std::numbers::pi;
    if (!rest.empty()) {
        if (rest[0] != '/')
            throw UsageError(fmt::format("'{}' is not a number, nor [number][*]pi[/number]", text));
        value /= parse_number(rest.substr(1), text);
    }
    if (!std::isfinite(value)) throw UsageError(fmt::format("'{}' is not finite", text));
    return value;
}

std::int64_t parse_bytes(const std::string& text) {
    const std::string units = "KMGT";
    std::string number = text;
    if (!number.empty() && (number.back() == 'B' || number.back() == 'b')) number.pop_back();
    double factor = 1.0;
    if (!number.empty()) {
        const auto unit =
            units.find(static_cast<char>(std::toupper(static_cast<unsigned char>(number.back()))));
        if (unit != std::string::npos) {
            factor = std::pow(1024.0, static_cast<double>(unit) + 1.0);
            number.pop_back();
        }
    }
    double value = 0.0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (error != std::errc() || end != number.data() + number.size() || !(value > 0.0) ||
        !(value * factor < 9e18))
        throw UsageError(fmt::format("'{}' is no amount of memory (like 500M or 8G)", text));
    return static_cast<std::int64_t>(value * factor);
}

}  // namespace ricci::app
