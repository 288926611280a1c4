#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/layout_record.h"
#include "engine/app/records.h"
#include "engine/app/solve_arguments.h"
#include "kernels/parallel.h"

namespace ricci::app {
namespace {

struct LayoutArguments {
    SolveArguments solve;
    std::string output, textured, image, model = "auto";
    Index base = -1, seed_face = -1;
    int digits = 800, checker = 0;
    double goal = 1e-10;
};

void print_text(const std::string& item, const SurfaceStructure& s, double seconds) {
    if (!s.refinement) {
        fmt::print("{}: {} ({}), {}\n", item, name_of(s.flow.outcome.status), name_of(s.flow.geometry),
                   s.flow.message);
        return;
    }
    fmt::print(
        "{}: {} ({}), {} generators, relator error {:.2g} ({} digits), closing error {:.2g} ({} digits)\n",
        item, name_of(s.flow.outcome.status), name_of(s.flow.geometry), s.group.generators.size(),
        s.group.relator_error, s.group.digits, s.layout.closing_error, s.layout.digits);
    fmt::print("  {} pieces, {} flipped, {} degenerate, {} unresolved; {} sides, radius {:.3f}; {:.3f} s\n",
               s.refinement->piece_count(), s.layout.flipped, s.layout.degenerate, s.layout.unresolved,
               s.cut.sides.size(), s.layout.radius, seconds);
    const std::vector<std::string> letters = s.basis->letter_names();
    for (const GroupGenerator& g : s.group.generators)
        fmt::print("  {} = {}\n", g.name, to_text(g.word, letters));
}

/// OUT.obj, or OUT.c<component>.obj where there are several.
std::string component_file(const std::string& path, std::size_t component, bool several) {
    if (!several) return path;
    const std::size_t dot = path.rfind('.');
    return path.substr(0, dot) + fmt::format(".c{}", component) +
           (dot == std::string::npos ? "" : path.substr(dot));
}

void write_files(const LayoutArguments& a, const SurfaceMesh& mesh, const SurfaceStructure& s,
                 std::size_t component, bool several) {
    if (!s.refinement) return;
    const LayoutModel model = parse_layout_model(a.model);
    if (!a.textured.empty())
        save_textured(component_file(a.textured, component, several), textured_surface(mesh, s, model),
                      a.checker);
    if (!a.image.empty())
        save_textured(component_file(a.image, component, several), layout_surface(s, model));
}

int layout(const LayoutArguments& a, const CommonOptions& common) {
    using Clock = std::chrono::steady_clock;
    StructureOptions options;
    options.flow = flow_options(a.solve);
    options.base = a.base;
    options.seed_face = a.seed_face;
    options.max_digits = a.digits;
    options.goal = a.goal;
    parse_layout_model(a.model);
    const std::optional<LoadedMesh> loaded = load_input(a.solve.mesh, a.solve.repair, common);
    if (!loaded) return kSomeFailed;
    require_one_component(*loaded, options.flow);
    const bool several = loaded->components.size() > 1;
    if (several && (a.base >= 0 || a.seed_face >= 0))
        throw UsageError(
            "--base and --seed-face name elements of one surface; this input has several components");
    options.flow.parallel = common.resolved_threads() > 1;
    std::unique_ptr<RunStore> store;
    std::vector<std::string> names;
    if (!a.output.empty())
        store = std::make_unique<RunStore>(
            a.output, make_run_info(to_toml(a.solve), command_line(), common.resolved_threads()), false);
    catch_signals();
    int status = kDone;
    for (std::size_t c = 0; c < loaded->components.size(); ++c) {
        const auto start = Clock::now();
        options.flow.interrupted = interruption(a.solve.timeout);
        const SurfaceMesh mesh =
            a.solve.densify ? densified(loaded->components[c], options.flow) : loaded->components[c];
        const std::string name = component_name(*loaded, c, mesh.connectivity.face_count());
        SurfaceStructure s;
        with_thread_limit(common.resolved_threads(), [&] { s = make_surface_structure(mesh, options); });
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        if (s.flow.outcome.status != Status::converged) {
            status = kSomeFailed;
            spdlog::error("{}: {}: {}", name, name_of(s.flow.outcome.status), s.flow.message);
        }
        write_files(a, mesh, s, c, several);
        if (common.json) {
            nlohmann::json object = layout_json(s);
            object["file"] = a.solve.mesh;
            object["item"] = name;
            object["seconds"] = seconds;
            print_json(object);
        } else {
            print_text(name, s, seconds);
        }
        if (!store) continue;
        names.push_back(name);
        store->write_item(make_item(name, a.solve.mesh, loaded->content_hash, mesh));
        store->write_flow(make_flow_record(name, s.flow, options.flow, s.seconds.flow));
        store->write_result(make_layout_group(name, mesh, s));
        if (s.flow.outcome.status != Status::converged)
            store->write_failure(
                {name, "layout", std::string(name_of(s.flow.outcome.status)), s.flow.message});
    }
    if (store) store->assemble(names, {});
    return caught_signal() != 0 ? 128 + caught_signal() : status;
}

}  // namespace

void add_layout(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command = app.add_subcommand("layout",
                                       "The geometric structure: generators, deck transformations, one "
                                       "domain laid out, the map onto the mesh");
    auto a = std::make_shared<LayoutArguments>();
    add_solve_arguments(*command, a->solve);
    command->add_option("-o,--output", a->output, "Result file (HDF5)");
    command->add_option("--uv", a->textured,
                        "OBJ: the input refined so that its pieces map exactly, layout coordinates as vt");
    command->add_option("--checker", a->checker, "With --uv: a checkerboard texture of so many squares")
        ->check(CLI::Range(0, 1024));
    command->add_option("--image", a->image, "OBJ: the layout itself, in the plane z = 0 or on the sphere");
    command
        ->add_option(
            "--model", a->model,
            "auto, plane, poincare, klein, half-plane, disk, sphere: coordinates of --uv and --image")
        ->capture_default_str();
    command->add_option("--base", a->base, "Base vertex of the generators (default: one in the middle)")
        ->check(CLI::NonNegativeNumber);
    command
        ->add_option("--seed-face", a->seed_face, "Face laid out first, at the origin (default: the middle)")
        ->check(CLI::NonNegativeNumber);
    command->add_option("--goal", a->goal, "Relator and closing error beyond which more digits are taken")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    command->add_option("--digits", a->digits, "At most so many digits; 16: double only")
        ->capture_default_str()
        ->check(CLI::Range(16, 800));
    add_common(*command, common);
    command->footer("Example: ricci layout eight.off -o eight.h5 --uv eight.obj --model poincare");
    command->callback([&common, &action, a] { action = [&common, a] { return layout(*a, common); }; });
}

}  // namespace ricci::app
