#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/layout_extras.h"
#include "engine/app/layout_record.h"
#include "engine/app/pictures/picture_kinds.h"
#include "engine/app/quality_record.h"
#include "engine/app/records.h"
#include "engine/app/solve_arguments.h"
#include "engine/app/stored_layout.h"
#include "engine/remesh/resample.h"
#include "kernels/parallel.h"

namespace ricci::app {
namespace {

struct LayoutArguments {
    SolveArguments solve;
    std::string output, textured, image, svg, picture = "domain", model = "auto", atlas;
    Index charts = 0;
    bool quality = false;
    Index base = -1, seed_face = -1;
    int digits = 800, checker = 0, subdivisions = 0;
    std::int64_t copies = 0;
    double distance = 12.0;
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

/// Copies of the domain, where asked for.
std::vector<Isometry<double>> copies_of(const LayoutArguments& a, const SurfaceStructure& s) {
    return tessellation_of(s, a.copies, a.distance);
}

/// What was asked for beyond the layout.
LayoutExtras extras_of(const LayoutArguments& a, const SurfaceMesh& mesh, const SurfaceStructure& s) {
    const bool quality = a.quality || (!a.svg.empty() && needs_quality(parse_picture_kind(a.picture)));
    return make_layout_extras(mesh, s, {quality, a.atlas, a.charts});
}

/// OUT.obj, or OUT.c<component>.obj where there are several.
std::string component_file(const std::string& path, std::size_t component, bool several) {
    if (!several) return path;
    const std::size_t dot = path.rfind('.');
    return path.substr(0, dot) + fmt::format(".c{}", component) +
           (dot == std::string::npos ? "" : path.substr(dot));
}

void write_picture(const LayoutArguments& a, const std::string& file, const SurfaceMesh& mesh,
                   const SurfaceStructure& s, const std::optional<ConformalityReport>& quality) {
    StoredLayout stored = stored_layout_of(mesh, s);
    const PictureKind kind = parse_picture_kind(a.picture);
    if (kind == PictureKind::tessellation) stored.copies = copies_of(a, s);
    PictureSource source;
    source.layout = &stored;
    source.mesh = &mesh;
    source.generators = stored.generators;
    if (quality) take_quality(*quality, source);
    draw_picture(kind, parse_layout_model(a.model), source).save(file);
}

void write_files(const LayoutArguments& a, const SurfaceStructure& s, std::size_t component, bool several) {
    if (!s.refinement) return;
    const LayoutModel model = parse_layout_model(a.model);
    if (!a.textured.empty())
        save_textured(component_file(a.textured, component, several),
                      textured_surface(*s.refinement, s.layout, model), a.checker);
    if (!a.image.empty())
        save_textured(component_file(a.image, component, several),
                      layout_surface(*s.refinement, s.layout, model));
}

/// The component, refined where asked.
SurfaceMesh surface_to_solve(const SurfaceMesh& component, const LayoutArguments& a,
                             const FlowOptions& options) {
    SurfaceMesh mesh = a.solve.densify ? densified(component, options) : component;
    for (int k = 0; k < a.subdivisions; ++k) mesh = subdivide_midpoint(mesh);
    return mesh;
}

void print_extras(const LayoutExtras& extras) {
    if (extras.quality) {
        const ConformalityReport& q = *extras.quality;
        fmt::print(
            "  angles within 5 %: {:.2f} % of the corners of pieces, {:.2f} % of faces; quasi-conformal "
            "distortion {:.4f} "
            "on average; area distortion {:.4g}\n",
            100 * q.pieces.regular.within_5, 100 * q.faces.regular.within_5, q.distortion_by_area.mean,
            q.area_distortion);
    }
    if (extras.atlas)
        fmt::print(
            "  {} atlas: {} charts, {} transitions; overlaps agree to {:.2g}, cocycles to {:.2g} ({} of "
            "them), {} vertices "
            "uncovered\n",
            name_of(extras.atlas->kind), extras.atlas->charts.size(), extras.atlas->transitions.size(),
            extras.checks.vertex_disagreement, extras.checks.cocycle_error, extras.checks.triples,
            extras.checks.uncovered_vertices);
}

/// Everything of one component into the result file.
void store_results(RunStore& store, const std::string& name, const LayoutArguments& a,
                   const LoadedMesh& loaded, const SurfaceMesh& mesh, const FlowOptions& options,
                   const SurfaceStructure& s, const LayoutExtras& extras) {
    store.write_item(make_item(name, a.solve.mesh, loaded.content_hash, mesh));
    store.write_flow(make_flow_record(name, s.flow, options, s.seconds.flow));
    store.write_result(make_layout_group(name, mesh, s, copies_of(a, s)));
    const auto status = static_cast<std::uint8_t>(s.flow.outcome.status);
    if (extras.quality) store.write_result(make_quality_group(name, status, *extras.quality));
    if (extras.atlas) store.write_result(make_atlas_group(name, status, *extras.atlas, extras.checks));
    if (s.flow.outcome.status != Status::converged)
        store.write_failure({name, "layout", std::string(name_of(s.flow.outcome.status)), s.flow.message});
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
    parse_picture_kind(a.picture);
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
        const SurfaceMesh mesh = surface_to_solve(loaded->components[c], a, options.flow);
        const std::string name = component_name(*loaded, c, mesh.connectivity.face_count());
        SurfaceStructure s;
        with_thread_limit(common.resolved_threads(), [&] { s = make_surface_structure(mesh, options); });
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        if (s.flow.outcome.status != Status::converged) {
            status = kSomeFailed;
            spdlog::error("{}: {}: {}", name, name_of(s.flow.outcome.status), s.flow.message);
        }
        write_files(a, s, c, several);
        const LayoutExtras extras = extras_of(a, mesh, s);
        if (!a.svg.empty() && s.refinement)
            write_picture(a, component_file(a.svg, c, several), mesh, s, extras.quality);
        if (common.json) {
            nlohmann::json object = layout_json(s);
            object["file"] = a.solve.mesh;
            object["item"] = name;
            object["seconds"] = seconds;
            if (extras.quality) object["quality"] = quality_json(*extras.quality);
            if (extras.atlas) object["atlas"] = atlas_json(*extras.atlas, extras.checks);
            print_json(object);
        } else {
            print_text(name, s, seconds);
            print_extras(extras);
        }
        if (!store) continue;
        names.push_back(name);
        store_results(*store, name, a, *loaded, mesh, options.flow, s, extras);
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
    command->add_option("--svg", a->svg, "Picture without a display");
    command
        ->add_option("--picture", a->picture,
                     "Of --svg: domain, tessellation (with --copies), checkerboard, texture, surface, "
                     "curvature, distortion, "
                     "surface-curvature, surface-distortion, angles")
        ->capture_default_str();
    command
        ->add_option(
            "--model", a->model,
            "auto, plane, poincare, klein, half-plane, disk, sphere: coordinates of --uv and --image")
        ->capture_default_str();
    command->add_flag("--quality", a->quality,
                      "Angle ratios, quasi-conformal and area distortion of the map");
    command->add_option("--atlas", a->atlas,
                        "Charts and transition maps: auto, affine, hyperbolic, projective, spherical");
    command->add_option("--charts", a->charts, "With --atlas: about so many (0: by the number of faces)")
        ->check(CLI::NonNegativeNumber);
    command
        ->add_option("--copies", a->copies, "With -o or a tessellation picture: so many copies of the domain")
        ->check(CLI::Range(std::int64_t{0}, std::int64_t{1'000'000}));
    command
        ->add_option("--copies-within", a->distance, "Hyperbolic copies farther from the origin are left out")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 30.0));
    command
        ->add_option("--subdivide", a->subdivisions,
                     "Midpoint subdivisions first: the same surface, its vertices numbered as before, a map "
                     "that is nearer to "
                     "conformal")
        ->check(CLI::Range(0, 8));
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
