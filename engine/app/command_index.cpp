#include <CLI/CLI.hpp>
#include <memory>

#include "engine/app/commands.h"
#include "engine/app/index_commands.h"

namespace ricci::app {
namespace {

using Arguments = std::shared_ptr<IndexArguments>;

constexpr const char* kPaths = "Files, folders (searched for meshes) or globs";

void add_index_file(CLI::App& command, const Arguments& a) {
    command.add_option("INDEX", a->index, "Index file (HDF5)")->required();
}

void add_metric(CLI::App& command, const Arguments& a) {
    command
        .add_option(
            "--metric", a->metric,
            "spectrum: free of markings (tori, annuli: Teichmueller distance); coordinates: Euclidean "
            "distance of Teichmueller coordinates")
        ->capture_default_str();
}

void add_running(CLI::App& command, const Arguments& a) {
    command.add_flag("--resume", a->resume, "Continue what an interrupted run finished");
    command.add_option("--max-memory", a->max_memory,
                       "Bound on the predicted memory, like 8G; with --isolate on the memory itself");
    command.add_flag("--isolate", a->isolate,
                     "Each file in a child process: a crash, a hang or a memory blow-up becomes a recorded "
                     "failure with a reproducer in INDEX.failures/, and everything else goes on");
    command
        .add_option("--hang-timeout", a->hang_timeout,
                    "With --isolate: seconds without a sign of life after which a child is killed; 0: never")
        ->capture_default_str()
        ->check(CLI::NonNegativeNumber);
}

CLI::App* add_command(CLI::App& parent, const char* name, const char* description, const char* example) {
    auto* command = parent.add_subcommand(name, description);
    command->footer(std::string("Example: ") + example);
    return command;
}

void add_build(CLI::App& parent,
               const std::function<void(CLI::App&, Arguments, decltype(&index_build))>& end) {
    auto a = std::make_shared<IndexArguments>();
    auto* command =
        add_command(parent, "build", "Describe many shapes; unchanged ones are not described again",
                    "ricci index build meshes/ 'more/*.obj' -o shapes.h5");
    command->add_option("PATH", a->paths, kPaths)->required();
    command->add_option("-o,--output", a->index, "Index file (HDF5)")->required();
    add_index_options(*command, a->config);
    add_running(*command, a);
    end(*command, a, &index_build);
}

void add_add(CLI::App& parent, const std::function<void(CLI::App&, Arguments, decltype(&index_build))>& end) {
    auto a = std::make_shared<IndexArguments>();
    auto* command = add_command(parent, "add", "Describe more shapes, with the index's own options",
                                "ricci index add shapes.h5 new/");
    add_index_file(*command, a);
    command->add_option("PATH", a->paths, kPaths)->required();
    add_running(*command, a);
    end(*command, a, &index_add);
}

void add_remove(CLI::App& parent,
                const std::function<void(CLI::App&, Arguments, decltype(&index_build))>& end) {
    auto a = std::make_shared<IndexArguments>();
    auto* command = add_command(parent, "remove", "Take shapes out",
                                "ricci index remove shapes.h5 meshes/old.off 'meshes/draft*'");
    add_index_file(*command, a);
    command->add_option("PATH", a->paths, "Paths as the index has them, folders above them, or globs")
        ->required();
    end(*command, a, &index_remove);
}

void add_query(CLI::App& parent,
               const std::function<void(CLI::App&, Arguments, decltype(&index_build))>& end) {
    auto a = std::make_shared<IndexArguments>();
    auto* command =
        add_command(parent, "query", "The shapes most alike", "ricci index query shapes.h5 cup.off -k 5");
    add_index_file(*command, a);
    command->add_option("MESH", a->paths, kPaths)->required();
    command->add_option("-k", a->neighbours, "So many neighbours")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    command->add_flag("--others", a->others, "Leave out entries with the same bytes as the query");
    add_metric(*command, a);
    end(*command, a, &index_query);
}

void add_stats(CLI::App& parent,
               const std::function<void(CLI::App&, Arguments, decltype(&index_build))>& end) {
    auto a = std::make_shared<IndexArguments>();
    auto* command = add_command(parent, "stats", "What the index holds, by topological type",
                                "ricci index stats shapes.h5");
    add_index_file(*command, a);
    end(*command, a, &index_stats);
}

void add_distances(CLI::App& parent,
                   const std::function<void(CLI::App&, Arguments, decltype(&index_build))>& end) {
    auto a = std::make_shared<IndexArguments>();
    auto* command = add_command(
        parent, "distances", "All distances within a topological type, and clusters",
        "ricci index distances shapes.h5 --type g2b0 -o genus2.csv --svg map.svg --dendrogram tree.svg");
    add_index_file(*command, a);
    command->add_option("--type", a->type, "Topological type like g2b0 (default: all that hold two shapes)");
    add_metric(*command, a);
    command->add_option("--linkage", a->linkage, "average, single, complete")->capture_default_str();
    command->add_option("--clusters", a->clusters, "Cut the tree into so many")->check(CLI::PositiveNumber);
    command->add_option("-k", a->neighbours, "So many neighbours of each shape in the text")
        ->capture_default_str()
        ->check(CLI::NonNegativeNumber);
    command->add_option("-o,--output", a->output,
                        "FILE.csv or FILE.h5; CSV of several types becomes FILE.g2b0.csv, ...");
    command->add_option("--svg", a->heatmap, "Heat map, ordered by the tree's leaves");
    command->add_option("--dendrogram", a->dendrogram, "Picture of the tree");
    end(*command, a, &index_distances);
}

}  // namespace

void add_index(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command =
        app.add_subcommand("index", "Shape space: describe thousands of shapes, ask which are alike");
    command->require_subcommand(1);
    command->footer(
        "Example: ricci index build meshes/ -o shapes.h5 && ricci index query shapes.h5 cup.off -k 5");
    const auto end = [&](CLI::App& sub, const Arguments& a, decltype(&index_build) run) {
        add_common(sub, common);
        sub.callback([&common, &action, a, run] { action = [&common, a, run] { return run(*a, common); }; });
    };
    for (const auto add : {add_build, add_add, add_remove, add_query, add_stats, add_distances})
        add(*command, end);
}

}  // namespace ricci::app
