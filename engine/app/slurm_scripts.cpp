#include "engine/app/slurm_scripts.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <stdexcept>
#include <utility>

#include "engine/app/console.h"
#include "engine/app/slurm_templates.h"

namespace ricci::app {
namespace {

std::string directives(const SlurmJob& job, int cpus, bool array) {
    std::string text = fmt::format("#SBATCH --job-name={}{}\n", job.name, array ? "" : "-merge");
    if (array)
        text += fmt::format("#SBATCH --array=0-{}{}\n", job.shards - 1,
                            job.at_once > 0 ? fmt::format("%{}", job.at_once) : "");
    text += fmt::format("#SBATCH --nodes=1\n#SBATCH --ntasks=1\n#SBATCH --cpus-per-task={}\n", cpus);
    if (!job.time.empty()) text += fmt::format("#SBATCH --time={}\n", job.time);
    if (!job.memory.empty()) text += fmt::format("#SBATCH --mem={}\n", job.memory);
    for (const std::string& option : job.options) text += fmt::format("#SBATCH {}\n", option);
    text += "#SBATCH --requeue\n#SBATCH --open-mode=append";
    if (array) text += fmt::format("\n#SBATCH --signal=B:USR1@{}", job.grace);
    return text;
}

std::string exports(const SlurmJob& job) {
    std::string text;
    for (const auto& [name, value] : job.environment)
        text += fmt::format("export {}={}\n", name, shell_quoted(value));
    return text;
}

/// The numbers of "1-02:30:00" by their separators; nothing where it is none of that kind.
std::vector<std::int64_t> numbers_of(const std::string& text) {
    std::vector<std::int64_t> numbers;
    const char *at = text.data(), *const end = at + text.size();
    for (;;) {
        std::int64_t number = 0;
        const auto [after, error] = std::from_chars(at, end, number);
        if (error != std::errc() || number < 0 || number > 1'000'000'000) return {};
        numbers.push_back(number);
        if (after == end) return numbers;
        if (*after != ':' && !(*after == '-' && numbers.size() == 1)) return {};
        at = after + 1;
    }
}

using Values = std::vector<std::pair<std::string, std::string>>;

/// The template with each {{name}} replaced.
std::string filled(std::string text, const Values& values) {
    for (const auto& [name, value] : values) {
        const std::string place = "{{" + name + "}}";
        const std::size_t at = text.find(place);
        if (at == std::string::npos) throw std::logic_error("a template lacks " + place);
        text.replace(at, place.size(), value);
    }
    return text;
}

}  // namespace

std::optional<std::int64_t> seconds_of_time_limit(const std::string& text) {
    std::string lower = text;
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (lower == "infinite" || lower == "unlimited" || lower == "-1") return std::nullopt;
    const std::vector<std::int64_t> n = numbers_of(text);
    const bool days = text.find('-') != std::string::npos;
    std::int64_t seconds = 0;
    if (days && n.size() >= 2 && n.size() <= 4) {
        const std::int64_t units[] = {86400, 3600, 60, 1};
        for (std::size_t k = 0; k < n.size(); ++k) seconds += n[k] * units[k];
    } else if (!days && n.size() == 3) {
        seconds = 3600 * n[0] + 60 * n[1] + n[2];
    } else if (!days && !n.empty() && n.size() <= 2) {
        seconds = 60 * n[0] + (n.size() == 2 ? n[1] : 0);
    } else {
        throw UsageError(
            fmt::format("--time '{}' is no time limit of sbatch (like 90, 4:00:00 or 1-12)", text));
    }
    if (seconds == 0) return std::nullopt;
    return (seconds + 59) / 60 * 60;
}

std::string shell_quoted(const std::string& text) {
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + '\'';
}

std::string array_script(const SlurmJob& job) {
    return filled(kArrayTemplate, {{"directives", directives(job, job.cpus, true)},
                                   {"ricci", shell_quoted(job.program)},
                                   {"folder", shell_quoted(job.folder)},
                                   {"shards", std::to_string(job.shards)},
                                   {"environment", exports(job)}});
}

std::string merge_script(const SlurmJob& job) {
    return filled(kMergeTemplate, {{"directives", directives(job, 1, false)},
                                   {"ricci", shell_quoted(job.program)},
                                   {"folder", shell_quoted(job.folder)},
                                   {"output", shell_quoted(job.output)}});
}

std::string submit_script(const SlurmJob& job) {
    return filled(kSubmitTemplate,
                  {{"folder", shell_quoted(job.folder)}, {"directory", shell_quoted(job.directory)}});
}

}  // namespace ricci::app
