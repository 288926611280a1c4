// Result and index files, as bytes and as contents, through the commands that read them.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "engine/app/commands.h"
#include "io/store/durable.h"
#include "io/store/run_store.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/fuzz/hdf5_tree.h"
#include "tests/fuzz/scratch_folder.h"

namespace ricci::fuzz {
namespace {

/// Runs a command as the program does, but lets what it throws through: only refusals may come of a file.
int run_command(std::vector<std::string> arguments) {
    CLI::App app{"ricci"};
    app.require_subcommand(1);
    app::CommonOptions common;
    app::Action action;
    app::add_generate(app, common, action);
    app::add_layout(app, common, action);
    app::add_sweep(app, common, action);
    app::add_index(app, common, action);
    app::add_verify(app, common, action);
    app::add_export(app, common, action);
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
    app.parse(arguments);
    common.threads = common.threads > 0 ? common.threads : 1;
    common.quiet = true;
    return action();
}

void attempt(const std::vector<std::string>& arguments) {
    try {
        run_command(arguments);
    } catch (const FileError&) {
    } catch (const app::UsageError&) {
    } catch (const std::invalid_argument&) {
    }
}

void must(const std::vector<std::string>& arguments) {
    require(run_command(arguments) == 0, "cannot make the sample files: " + arguments.front());
}

constexpr std::size_t kIndex = 2;  // of the samples

std::vector<std::string> make_samples() {
    const ScratchFolder& folder = scratch_folder();
    const std::string eight = folder.file("eight.off"), torus = folder.file("torus.off"),
                      sweep = folder.file("sweep.h5"), layout = folder.file("layout.h5"),
                      index = folder.file("index.h5");
    must({"generate", "eight", "--faces", "120", "-o", eight});
    must({"generate", "torus", "--faces", "40", "-o", torus});
    must({"generate", "torus", "--faces", "60", "-o", folder.file("another.off")});
    must({"sweep", eight, "--vertices", "sample:6", "--keep", "2", "-o", sweep, "--quiet"});
    must({"layout", torus, "-o", layout, "--quality", "--copies", "9", "--quiet"});
    must({"index", "build", torus, eight, folder.file("another.off"), "-o", index, "--max-length", "4",
          "--quiet"});
    return {sweep, layout, index};
}

/// Continuing a run whose output is there already.
void resume_from(const std::string& path) {
    try {
        const StoredRun run = read_run(path);
        RunStore store(path, run.info, true);
        for (const StoredItem& item : run.items) {
            static_cast<void>(store.finished_rows(item.item.name));
            if (store.has_item(item.item.name)) static_cast<void>(store.read_item(item.item.name));
        }
    } catch (const FileError&) {
    } catch (const std::invalid_argument&) {
    }
    std::filesystem::remove_all(path + ".parts");
}

/// One of the uses of a file which somebody hands over, by number: each costs a child process or two.
void use_results(const std::string& path, std::size_t use) {
    const std::string picture = scratch_folder().file("out.svg");
    const std::vector<std::vector<std::string>> commands = {
        {"verify", path, "--recompute"},
        {"export", path, "-o", scratch_folder().file("out.csv")},
        {"export", path, "-o", scratch_folder().file("out.vtu")},
        {"export", path, "-o", scratch_folder().file("out.vtkhdf")},
        {"export", path, "-o", scratch_folder().file("out.vtm")},
        {"export", path, "-o", scratch_folder().file("out.glb"), "--what", "all"},
        {"export", path, "-o", scratch_folder().file("out.npz"), "--model", "half-plane"},
        {"export", path, "-o", scratch_folder().file("out.obj"), "--model", "poincare"},
        {"export", path, "-o", picture, "--picture", "domain"},
        {"export", path, "-o", picture, "--picture", "tessellation"},
        {"export", path, "-o", picture, "--picture", "checkerboard"},
        {"export", path, "-o", picture, "--picture", "surface"},
        {"export", path, "-o", picture, "--picture", "texture"},
        {"export", path, "-o", picture, "--picture", "distortion"},
        {"export", path, "-o", picture, "--picture", "surface-curvature"},
        {"export", path, "-o", picture, "--picture", "angles"}};
    use %= commands.size() + 1;
    return use < commands.size() ? attempt(commands[use]) : resume_from(path);
}

void use_index(const std::string& path, std::size_t use) {
    const std::vector<std::vector<std::string>> commands = {
        {"verify", path},
        {"index", "stats", path},
        {"index", "distances", path, "-o", scratch_folder().file("out.csv"), "--svg",
         scratch_folder().file("out.svg")},
        {"index", "distances", path, "--metric", "coordinates", "--dendrogram",
         scratch_folder().file("out.svg")},
        {"index", "query", path, scratch_folder().file("torus.off")},
        {"index", "query", path, scratch_folder().file("eight.off"), "--others"}};
    attempt(commands[use % commands.size()]);
}

}  // namespace

const std::vector<std::string>& sample_result_files() {
    static const std::vector<std::string> samples = make_samples();
    return samples;
}

void read_hdf5_bytes(Bytes bytes) {
    const std::string path = scratch_folder().file("bytes.h5");
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    file.close();
    require(file.good(), "the file cannot be written");
    const std::uint64_t use = checksum_of(std::as_bytes(bytes));
    if (use % 3 == 0)
        use_index(path, use / 3);
    else
        use_results(path, use / 3);
}

void read_hdf5_contents(Bytes bytes) {
    static const std::vector<Tree> trees = [] {
        std::vector<Tree> read;
        for (const std::string& sample : sample_result_files()) read.push_back(read_tree(sample));
        return read;
    }();
    if (bytes.size() < 2) return;
    const std::size_t sample = bytes[0] % trees.size();
    Tree tree = copy_of(trees[sample]);
    change_tree(tree, bytes.subspan(2));
    const std::string path = scratch_folder().file("contents.h5");
    try {
        write_tree(path, tree);
    } catch (const FileError&) {
        return;  // HDF5 itself does not write that
    }
    if (sample == kIndex)
        use_index(path, bytes[1]);
    else
        use_results(path, bytes[1]);
}

}  // namespace ricci::fuzz
