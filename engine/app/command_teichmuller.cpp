#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/coordinates_record.h"
#include "engine/app/pictures/draw_curves.h"
#include "engine/app/shape_arguments.h"
#include "engine/topology/closed_path.h"
#include "io/mesh/curve_file.h"
#include "io/mesh/save_curves.h"

namespace ricci::app {
namespace {

struct TeichmullerArguments {
    SolveArguments solve;
    std::vector<std::string> files;
    std::string output, marking, loops, curves, svg;
    bool words = true;
};

/// Curves that a user gave by vertices, as edge paths. Throws UsageError naming file, line and curve.
std::vector<NamedPath> paths_from(const std::string& file, const std::vector<VertexCurve>& curves,
                                  const Connectivity& connectivity) {
    std::vector<NamedPath> paths;
    for (const VertexCurve& c : curves) try {
            paths.push_back({c.name, closed_path(connectivity, c.vertices)});
        } catch (const std::invalid_argument& e) {
            throw UsageError(fmt::format("{}: line {}: {}: {}", file, c.line, c.name, e.what()));
        }
    return paths;
}

void print_text(const std::string& item, const SurfaceCoordinates& s) {
    if (s.status != Status::converged) {
        fmt::print("{}: {}, {}\n", item, name_of(s.status), s.message);
        return;
    }
    fmt::print("{}: genus {}, {} boundaries, {} coordinates", item, s.genus, s.boundaries,
               s.coordinates.size());
    if (s.marking != "none")
        fmt::print(", marking {}{}", s.marking,
                   s.marking == "geometric" ? fmt::format(", smallest gap {:.3g}", s.smallest_gap) : "");
    fmt::print("\n");
    for (std::size_t k = 0; k < s.coordinates.size(); ++k)
        fmt::print("  {:<12} {:.9f}{}\n", s.names[k], s.coordinates[k],
                   k < s.curves.size() && !s.curves[k].word.empty() ? "  " + s.curves[k].word : "");
    if (s.geometry == Geometry::euclidean && s.genus == 1)
        fmt::print("  length ratio {:.9f}, angle {:.9f}\n", s.length_ratio, s.angle);
    for (const FenchelNielsen& f : s.pants)
        fmt::print("  Fenchel-Nielsen {:<4} length {:.9f}, twist {:.9f}\n", f.name, f.length, f.twist);
    if (s.seams)
        fmt::print("  hexagon: halves {:.9f} {:.9f} {:.9f}, seams opposite them {:.9f} {:.9f} {:.9f}\n",
                   s.coordinates[0] / 2, s.coordinates[1] / 2, s.coordinates[2] / 2, (*s.seams)[0],
                   (*s.seams)[1], (*s.seams)[2]);
    for (const CoordinateCurve& c : s.loops)
        fmt::print("  loop {:<8} {:.9f}  {}\n", c.name, c.length, c.word);
}

void write_curves(const TeichmullerArguments& a, const ShapeItem& item, const SurfaceCoordinates& s) {
    const std::vector<NamedCurve> curves = named_curves(s);
    if (!a.curves.empty()) save_curves(numbered_file(a.curves, item.suffix), curves);
    if (a.svg.empty()) return;
    std::vector<DrawnCurve> drawn;
    for (const NamedCurve& c : curves) drawn.push_back({c.name, c.points, {}});
    draw_curves(item.mesh, drawn).save(numbered_file(a.svg, item.suffix));
}

int teichmuller(const TeichmullerArguments& a, const CommonOptions& common) {
    if (!a.curves.empty()) require_curve_file(a.curves);
    std::vector<VertexCurve> marking, loops;
    if (!a.marking.empty()) marking = read_curves(a.marking);
    if (!a.loops.empty()) loops = read_curves(a.loops);
    ShapeRun run(a.solve, a.files, a.output, common);
    return run.each([&](const ShapeItem& item) {
        SurfaceCoordinateOptions options;
        options.flow = item.flow;
        options.words = a.words;
        options.draw = !a.curves.empty() || !a.svg.empty();
        options.marking_curves = paths_from(a.marking, marking, item.mesh.connectivity);
        options.loops = paths_from(a.loops, loops, item.mesh.connectivity);
        ShapeOutcome outcome;
        const SurfaceCoordinates s =
            timed(outcome.seconds, [&] { return make_surface_coordinates(item.mesh, options); });
        if (s.status == Status::converged) write_curves(a, item, s);
        if (common.json)
            outcome.json = coordinates_json(s);
        else
            print_text(item.name, s);
        outcome.status = s.status;
        outcome.message = s.message;
        outcome.group = make_coordinates_group(item.name, s);
        return outcome;
    });
}

}  // namespace

void add_teichmuller(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command =
        app.add_subcommand("teichmuller", "Coordinates in Teichmueller space, and the curves behind them");
    auto a = std::make_shared<TeichmullerArguments>();
    add_shape_arguments(*command, a->solve, a->files);
    command
        ->add_option(
            "--marking", a->marking,
            "File of closed curves, one per line: NAME v0 v1 v2 ... (vertices joined by edges, the last to "
            "the first). The lengths of their geodesics are the coordinates, instead of those by the rule")
        ->check(CLI::ExistingFile);
    command
        ->add_option("--loops", a->loops,
                     "File of further closed curves: their words and lengths are printed")
        ->check(CLI::ExistingFile);
    command->add_flag("!--no-words", a->words, "No words of the coordinates' curves");
    command->add_option("-o,--output", a->output, "Result file (HDF5)");
    command->add_option("--curves", a->curves,
                        "The coordinates' geodesics on the surface: .obj, .vtk or .vtp");
    command->add_option("--svg", a->svg, "Picture of these geodesics on the surface");
    command->footer(
        "Negative Euler characteristic: 6g-5+3r lengths of closed geodesics (Luo), pants three, one-holed "
        "tori three, "
        "with Fenchel-Nielsen lengths and twists. Torus: modulus, length ratio, angle. Annulus: modulus. "
        "Sphere, "
        "disk: conformal factor and mean curvature in spherical harmonics. docs/shape_space.md has the "
        "rules.\n"
        "Example: ricci teichmuller eight.off --curves marking.vtp --json");
    add_common(*command, common);
    command->callback([a, &common, &action] { action = [a, &common] { return teichmuller(*a, common); }; });
}

}  // namespace ricci::app
