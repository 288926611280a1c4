#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/report/item_report.h"
#include "engine/app/report/page.h"
#include "io/store/distance_file.h"
#include "io/store/durable.h"
#include "io/store/file_kind.h"
#include "io/store/path_file.h"
#include "io/store/shape_index.h"
#include "kernels/parallel.h"

namespace ricci::app {
namespace {

struct ReportArguments {
    std::string path, output;
    std::vector<std::string> items;
    ReportOptions options;
};

/// As a shell takes it back.
std::string quoted(const std::string& word) {
    constexpr std::string_view kPlain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_@%+=:,./-";
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

/// What the file says of itself. `verify`: how to check it.
PageOrigin origin_of(const std::string& path, const std::string& kind, const RunInfo& info,
                     const std::string& verify) {
    PageOrigin origin;
    origin.file = std::filesystem::path(path).filename().string();
    origin.kind = kind;
    origin.facts = {{"file", path},
                    {"made by", fmt::format("Ricci {} ({})", info.software_version, info.git)},
                    {"command", info.command},
                    {"on", info.host},
                    {"processor", info.processor},
                    {"threads", fmt::format("{}", info.threads)},
                    {"assembled", info.created}};
    origin.config = info.config;
    origin.commands = {info.command, verify};
    return origin;
}

/// Leaves the items named. Throws UsageError for a name that is not there.
void keep_items(StoredRun& run, const std::vector<std::string>& names, const std::string& path) {
    for (const std::string& name : names)
        if (std::none_of(run.items.begin(), run.items.end(),
                         [&](const StoredItem& i) { return i.item.name == name; }))
            throw UsageError(fmt::format("{} holds no item named {}", path, name));
    std::erase_if(run.items, [&](const StoredItem& i) {
        return !names.empty() && std::find(names.begin(), names.end(), i.item.name) == names.end();
    });
}

std::string kinds_of(const StoredRun& run) {
    bool sweep = false, flow = false;
    std::set<std::string> kinds;
    for (const StoredItem& item : run.items) {
        sweep = sweep || item.sweep.has_value();
        flow = flow || item.flow.has_value();
        for (const ResultGroup& group : item.results) kinds.insert(group.kind);
    }
    std::string text = sweep ? "sweep" : "";
    if (flow) text += text.empty() ? "flow" : ", flow";
    for (const std::string& kind : kinds) text += (text.empty() ? "" : ", ") + kind;
    return fmt::format("{} item{}: {}", run.items.size(), run.items.size() == 1 ? "" : "s",
                       text.empty() ? "no results" : text);
}

PageOrigin fill_page(const ReportArguments& a, ReportPage& page) {
    const std::string kind = kind_of_file(a.path), verify = "ricci verify " + quoted(a.path);
    if (!kind.empty() && !a.items.empty())
        throw UsageError("--item: " + a.path + " holds no items, but " + kind);
    if (kind == "index") {
        report_index(a.path, a.options, page);
        return origin_of(a.path, "An index of shapes", IndexReader(a.path).info(), verify);
    }
    if (kind == "distances") {
        report_distances(a.path, a.options, page);
        return origin_of(a.path, "Distances between shapes", read_distance_file(a.path).info, verify);
    }
    if (kind == "paths") {
        report_paths(a.path, a.options, page);
        return origin_of(a.path, "Deformation paths in shape space", read_path_file(a.path).info, verify);
    }
    StoredRun run = read_run(a.path);
    keep_items(run, a.items, a.path);
    report_run(run, a.options, page);
    return origin_of(a.path, kinds_of(run), run.info, verify + " --recompute");
}

int report(const ReportArguments& a, const CommonOptions& common) {
    if (!a.output.ends_with(".html") && !a.output.ends_with(".htm"))
        throw UsageError(fmt::format("'{}': a report is written as .html", a.output));
    ReportPage page;
    PageOrigin origin;
    with_thread_limit(common.resolved_threads(), [&] { origin = fill_page(a, page); });
    const std::string text = page.document(origin);
    write_text_durably(a.output, text);
    if (common.json)
        print_json(
            {{"file", a.output},
             {"bytes", text.size()},
             {"failures", page.failure_count()},
             {"checks", page.count(Verdict::holds) + page.count(Verdict::look) + page.count(Verdict::fails)},
             {"checks_failed", page.count(Verdict::fails)},
             {"checks_to_look_at", page.count(Verdict::look)}});
    else
        fmt::print("wrote {} ({:.1f} MB): {} checks hold, {} to look at, {} fail; {} failures recorded\n",
                   a.output, 1e-6 * static_cast<double>(text.size()), page.count(Verdict::holds),
                   page.count(Verdict::look), page.count(Verdict::fails), page.failure_count());
    return kDone;
}

}  // namespace

void add_report(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command = app.add_subcommand(
        "report", "One self-contained page about a result file: views in space, pictures, tables, checks");
    auto a = std::make_shared<ReportArguments>();
    command
        ->add_option("FILE", a->path,
                     "Result file (HDF5) of any command: sweep, flow, layout, spectrum, teichmuller, "
                     "path, index build, index distances")
        ->required();
    command->add_option("-o,--output", a->output, "Page to write, .html")->required();
    command->add_option("--item", a->items, "Only this item, repeatable");
    command
        ->add_option("--view-faces", a->options.view_faces,
                     "A view shows at most so many faces; beyond, a surface is decimated for viewing, and "
                     "the page says so")
        ->capture_default_str()
        ->check(CLI::Range(100, 2'000'000));
    command
        ->add_option("--all-faces", a->options.all_faces,
                     "All views of a page together show about so many faces")
        ->capture_default_str()
        ->check(CLI::Range(100, 20'000'000));
    command
        ->add_option("--layouts", a->options.layouts,
                     "Items of a sweep whose best and worst metrics are laid out, which takes time")
        ->capture_default_str();
    command->add_option("--neighbours", a->options.neighbours, "Of each shape of an index")
        ->capture_default_str()
        ->check(CLI::Range(1, 20));
    add_common(*command, common);
    command->footer(
        "The page needs no network and opens from the disk. Exit status 0 means that it was written; what "
        "the checks "
        "say is on it, and with --json on standard output.\n"
        "Example: ricci report scans.h5 -o scans.html");
    command->callback([&common, &action, a] { action = [&common, a] { return report(*a, common); }; });
}

}  // namespace ricci::app
