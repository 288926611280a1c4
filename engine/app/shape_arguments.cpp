#include "engine/app/shape_arguments.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/records.h"
#include "kernels/parallel.h"

namespace ricci::app {

void add_shape_arguments(CLI::App& command, SolveArguments& a, std::vector<std::string>& files) {
    command.add_option("MESH", files, "Meshes, folders or globs: OBJ, OFF, PLY, STL (each also .gz) or .len")
        ->required();
    command.add_option("--tolerance", a.tolerance, "On max |K|, radians; 1e-12 is tried first")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    command.add_option("--max-iterations", a.max_iterations, "0: 500")->check(CLI::NonNegativeNumber);
    command.add_option("--delaunay", a.delaunay, "isometric, or none: start from the input triangulation")
        ->capture_default_str();
    command.add_option("--repair", a.repair, "Changes to make: orient,weld,drop-degenerate");
    command.add_option("--timeout", a.timeout, "Seconds for each solve; 0: none")
        ->check(CLI::NonNegativeNumber);
}

std::string numbered_file(const std::string& path, const std::string& suffix) {
    if (suffix.empty()) return path;
    const std::size_t slash = path.rfind('/'), dot = path.rfind('.');
    if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) return path + "." + suffix;
    return path.substr(0, dot) + "." + suffix + path.substr(dot);
}

ShapeRun::ShapeRun(const SolveArguments& solve, std::vector<std::string> files, const std::string& output,
                   const CommonOptions& common)
    : solve_(solve), files_(expand_inputs(files)), common_(common) {
    flow_options(solve);  // throws before anything is done
    if (!output.empty())
        store_ = std::make_unique<RunStore>(
            output, make_run_info(to_toml(solve), command_line(), common.resolved_threads()), false);
}

void ShapeRun::fail(const std::string& file, const std::string& item, const std::string& status,
                    const std::string& message) {
    spdlog::error("{}: {}: {}", item, status, message);
    if (common_.json) print_json({{"file", file}, {"item", item}, {"status", status}, {"message", message}});
}

bool ShapeRun::solve_item(const LoadedMesh& loaded, std::size_t component, const std::string& file,
                          const std::function<ShapeOutcome(const ShapeItem&)>& solve) {
    const SurfaceMesh& mesh = loaded.components[component];
    std::string name = component_name(loaded, component, mesh.connectivity.face_count());
    if (const int use = ++uses_[name]; use > 1) name += fmt::format("~{}", use);
    const bool alone = files_.size() == 1 && loaded.components.size() == 1;
    FlowOptions flow = flow_options(solve_);
    flow.parallel = common_.resolved_threads() > 1;
    flow.interrupted = interruption(solve_.timeout);
    ShapeOutcome outcome;
    try {
        with_thread_limit(common_.resolved_threads(), [&] {
            outcome = solve({file, name, alone ? "" : name, mesh, std::move(flow)});
        });
    } catch (const std::invalid_argument& e) {
        if (alone) throw;
        outcome.status = Status::invalid_input;
        outcome.message = e.what();
        fail(file, name, std::string(name_of(outcome.status)), outcome.message);
    }
    if (common_.json && !outcome.json.is_null()) {
        outcome.json["file"] = file;
        outcome.json["item"] = name;
        outcome.json["seconds"] = outcome.seconds;
        print_json(outcome.json);
    }
    const bool good = outcome.status == Status::converged;
    if (!good && outcome.status != Status::invalid_input)
        spdlog::error("{}: {}: {}", name, name_of(outcome.status), outcome.message);
    else if (good && !outcome.message.empty())
        spdlog::warn("{}: {}", name, outcome.message);
    if (!store_) return good;
    names_.push_back(name);
    store_->write_item(make_item(name, file, loaded.content_hash, mesh));
    if (!outcome.group.kind.empty()) store_->write_result(outcome.group);
    if (!good) store_->write_failure({name, "shape", std::string(name_of(outcome.status)), outcome.message});
    return good;
}

bool ShapeRun::load_and_solve(const std::string& file,
                              const std::function<ShapeOutcome(const ShapeItem&)>& solve) {
    std::optional<LoadedMesh> loaded;
    try {
        loaded = load_input(file, solve_.repair, common_);
    } catch (const FileError& e) {
        if (files_.size() == 1) throw;
        fail(file, file, std::string(name_of(Status::invalid_input)), e.what());
    }
    if (!loaded) return false;
    bool good = true;
    for (std::size_t c = 0; c < loaded->components.size() && caught_signal() == 0; ++c)
        good = solve_item(*loaded, c, file, solve) && good;
    return good;
}

int ShapeRun::each(const std::function<ShapeOutcome(const ShapeItem&)>& solve) {
    catch_signals();
    bool good = true;
    for (const std::string& file : files_) {
        if (caught_signal() != 0) break;
        good = load_and_solve(file, solve) && good;
    }
    if (store_) store_->assemble(names_, {});
    return caught_signal() != 0 ? 128 + caught_signal() : good ? kDone : kSomeFailed;
}

}  // namespace ricci::app
