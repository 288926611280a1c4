#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/records.h"
#include "engine/app/shape_arguments.h"
#include "engine/app/spectrum_record.h"
#include "io/mesh/save_curves.h"
#include "kernels/parallel.h"

namespace ricci::app {
namespace {

struct SpectrumArguments {
    SolveArguments solve;
    std::vector<std::string> files;
    std::string output, curves, svg;
    double max_length = 4.0;
    std::int64_t count = 0, drawn = 0;
    bool words = true;
};

void print_text(const std::string& item, const SurfaceSpectrum& s) {
    if (s.status != Status::converged) {
        fmt::print("{}: {}, {}\n", item, name_of(s.status), s.message);
        return;
    }
    fmt::print("{}: genus {}, {} boundaries: {} closed geodesics up to {:.6g}{}\n", item, s.genus,
               s.boundaries, s.lengths.size(), s.complete_up_to, s.unit.empty() ? "" : " (" + s.unit + ")");
    for (std::size_t k = 0; k < s.lengths.size(); ++k) {
        const SurfaceGeodesic& g = s.geodesics[s.geodesic[k]];
        fmt::print("  {:.9f}{}{}{}\n", s.lengths[k],
                   s.power[k] > 1 ? fmt::format("  power {}", s.power[k]) : "",
                   g.boundary >= 0 ? fmt::format("  boundary c{}", g.boundary + 1) : "",
                   g.word.empty() ? "" : "  " + g.word);
    }
}

/// The drawn curves of an item into files.
void write_curves(const SpectrumArguments& a, const std::string& suffix, const SurfaceMesh& mesh,
                  const SurfaceSpectrum& s) {
    if (!a.curves.empty()) save_curves(numbered_file(a.curves, suffix), named_curves(s));
    if (!a.svg.empty()) draw_spectrum(mesh, s).save(numbered_file(a.svg, suffix));
}

int spectrum(const SpectrumArguments& arguments, const CommonOptions& common) {
    if (!arguments.curves.empty()) require_curve_file(arguments.curves);
    ShapeRun run(arguments.solve, arguments.files, arguments.output, common);
    SurfaceSpectrumOptions options;
    options.max_length = arguments.max_length;
    options.count = arguments.count;
    options.words = arguments.words;
    options.draw = !arguments.curves.empty() || !arguments.svg.empty() || !arguments.output.empty();
    options.drawn = arguments.drawn;
    return run.each([&](const ShapeItem& item) {
        options.flow = item.flow;
        ShapeOutcome outcome;
        const SurfaceSpectrum s =
            timed(outcome.seconds, [&] { return make_surface_spectrum(item.mesh, options); });
        if (s.status == Status::converged) write_curves(arguments, item.suffix, item.mesh, s);
        if (common.json)
            outcome.json = spectrum_json(s);
        else
            print_text(item.name, s);
        outcome.status = s.status;
        outcome.message = s.message;
        outcome.group = make_spectrum_group(item.name, s);
        return outcome;
    });
}

}  // namespace

void add_spectrum(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command = app.add_subcommand(
        "spectrum", "The length spectrum of closed geodesics, complete, with their words and curves");
    auto a = std::make_shared<SpectrumArguments>();
    add_shape_arguments(*command, a->solve, a->files);
    command
        ->add_option("--max-length", a->max_length,
                     "All closed geodesics up to this length (torus: in units of the shortest)")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command
        ->add_option("--count", a->count, "At least so many lengths instead; the last multiplet is finished")
        ->check(CLI::Range(std::int64_t{1}, std::int64_t{1000000}));
    command->add_flag("!--no-words", a->words, "Lengths alone: no words in the canonical generators");
    command->add_option("-o,--output", a->output, "Result file (HDF5)");
    command->add_option("--curves", a->curves,
                        "The geodesics as polylines on the surface: .obj, .vtk or .vtp");
    command->add_option("--svg", a->svg, "Picture of the geodesics on the surface");
    command->add_option("--draw", a->drawn, "Draw the so many shortest primitive ones only (0: all)")
        ->check(CLI::NonNegativeNumber);
    command->footer(
        "Lengths are in the uniformization metric: hyperbolic (curvature -1, boundaries geodesic) for chi < "
        "0, flat "
        "with the shortest set to 1 for a torus, the core set to 1 for an annulus. Each closed geodesic "
        "counts once, "
        "whatever its direction; powers are listed too.\n"
        "Example: ricci spectrum eight.off --max-length 5 --curves eight.obj --json");
    add_common(*command, common);
    command->callback([a, &common, &action] { action = [a, &common] { return spectrum(*a, common); }; });
}

}  // namespace ricci::app
