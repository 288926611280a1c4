#include "engine/app/slurm_scripts.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

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

std::string shell_quoted(const std::string& text) {
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + '\'';
}

std::string array_script(const SlurmJob& job) {
    return filled(kArrayTemplate, {{"directives", directives(job, job.cpus, true)},
                                   {"ricci", shell_quoted(job.program)},
                                   {"folder", shell_quoted(job.folder)},
                                   {"shards", std::to_string(job.shards)}});
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
