// One surface, one result: flow, layout, spectrum, coordinates.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <chrono>

#include "engine/app/coordinates_record.h"
#include "engine/app/layout_extras.h"
#include "engine/app/layout_record.h"
#include "engine/app/quality_record.h"
#include "engine/app/records.h"
#include "engine/app/solve_arguments.h"
#include "engine/app/spectrum_record.h"
#include "engine/python/bindings.h"
#include "engine/python/long_call.h"
#include "engine/python/stored.h"
#include "engine/python/surface.h"
#include "engine/remesh/resample.h"
#include "engine/topology/closed_path.h"
#include "kernels/parallel.h"

namespace py = pybind11;

namespace ricci::python {
namespace {

using app::SolveArguments;
using StoredPtr = std::shared_ptr<Stored>;
using Target = std::optional<std::vector<double>>;  // V

class Clock {
  public:
    [[nodiscard]] double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

int resolved(int threads) {
    return threads > 0 ? threads : hardware_threads();
}

FlowOptions options_of(const SolveArguments& arguments, const Target& target, int threads) {
    FlowOptions options = app::flow_options(arguments);
    if (target) {
        if (arguments.densify)
            throw std::invalid_argument("densify adds vertices, which an array of targets cannot name");
        options.target = TargetKind::values;
        options.target_values = *target;
    }
    options.parallel = resolved(threads) > 1;
    return options;
}

/// What the call adds to the options while it runs.
void attach(FlowOptions& options, double timeout, Call& call) {
    options.interrupted = app::interruption(timeout, call.stop());
    options.progress = [&call](const IterationLog& line) { call.report(line); };
}

/// A result to be, with what all of them have.
StoredPtr begin(const Surface& surface, const SurfaceMesh& mesh, SolveArguments arguments,
                const Target& target, int threads) {
    auto stored = std::make_shared<Stored>();
    if (target) arguments.target = "<array>";
    stored->item.item = item_of(surface, mesh);
    arguments.mesh = surface.source.empty() ? "<" + surface.loaded->stem + ">" : surface.source;
    const std::string toml = app::to_toml(arguments);
    stored->info = std::make_shared<const RunInfo>(app::make_run_info(toml, toml, resolved(threads)));
    return stored;
}

/// How it ended; a failure goes with it as the command line records it.
void note_outcome(Stored& stored, const char* stage, Status status, const std::string& message) {
    stored.message = message;
    if (status == Status::converged) return;
    stored.failures.push_back({stored.item.item.name, stage, std::string(name_of(status)), message});
}

StoredPtr flow(const Surface& surface, const SolveArguments& arguments, const Target& target, int threads,
               const py::object& progress) {
    FlowOptions options = options_of(arguments, target, threads);
    return run_long(progress, [&](Call& call) {
        attach(options, arguments.timeout, call);
        const Clock clock;
        const SurfaceMesh mesh = arguments.densify ? app::densified(surface.mesh(), options) : surface.mesh();
        const StoredPtr stored = begin(surface, mesh, arguments, target, threads);
        FlowResult result;
        with_thread_limit(resolved(threads), [&] { result = solve_flow(mesh, options); });
        stored->seconds = clock.seconds();
        stored->item.flow = app::make_flow_record(stored->item.item.name, result, options, stored->seconds);
        stored->area = result.area;
        if (result.packing) {
            stored->max_length_error = result.packing->max_length_error;
            stored->mean_length_error = result.packing->mean_length_error;
        }
        note_outcome(*stored, "flow", result.outcome.status, result.message);
        return stored;
    });
}

struct LayoutOptions {
    Index base = -1, seed_face = -1, charts = 0;
    int digits = 800, subdivide = 0;
    double goal = 1e-10, copies_within = 12.0;
    std::int64_t copies = 0;
    bool quality = false;
    std::string atlas;
};

StoredPtr layout(const Surface& surface, const SolveArguments& arguments, const Target& target,
                 const LayoutOptions& wanted, int threads, const py::object& progress) {
    StructureOptions options;
    options.flow = options_of(arguments, target, threads);
    options.base = wanted.base;
    options.seed_face = wanted.seed_face;
    options.max_digits = wanted.digits;
    options.goal = wanted.goal;
    return run_long(progress, [&](Call& call) {
        attach(options.flow, arguments.timeout, call);
        const Clock clock;
        SurfaceMesh mesh = arguments.densify ? app::densified(surface.mesh(), options.flow) : surface.mesh();
        for (int k = 0; k < wanted.subdivide; ++k) mesh = subdivide_midpoint(mesh);
        const StoredPtr stored = begin(surface, mesh, arguments, target, threads);
        const std::string& name = stored->item.item.name;
        with_thread_limit(resolved(threads), [&] {
            const SurfaceStructure s = make_surface_structure(mesh, options);
            const auto status = static_cast<std::uint8_t>(s.flow.outcome.status);
            const app::LayoutExtras extras =
                app::make_layout_extras(mesh, s, {wanted.quality, wanted.atlas, wanted.charts});
            stored->item.flow = app::make_flow_record(name, s.flow, options.flow, s.seconds.flow);
            stored->item.results.push_back(app::make_layout_group(
                name, mesh, s, app::tessellation_of(s, wanted.copies, wanted.copies_within)));
            if (extras.quality)
                stored->item.results.push_back(app::make_quality_group(name, status, *extras.quality));
            if (extras.atlas)
                stored->item.results.push_back(
                    app::make_atlas_group(name, status, *extras.atlas, extras.checks));
            stored->area = s.flow.area;
            note_outcome(*stored, "layout", s.flow.outcome.status, s.flow.message);
        });
        stored->seconds = clock.seconds();
        return stored;
    });
}

StoredPtr spectrum(const Surface& surface, const SolveArguments& arguments, double max_length,
                   std::int64_t count, bool words, std::int64_t draw, int threads,
                   const py::object& progress) {
    SurfaceSpectrumOptions options;
    options.flow = options_of(arguments, std::nullopt, threads);
    options.max_length = max_length;
    options.count = count;
    options.words = words;
    options.draw = draw >= 0;
    options.drawn = std::max<std::int64_t>(draw, 0);
    return run_long(progress, [&](Call& call) {
        attach(options.flow, arguments.timeout, call);
        const Clock clock;
        const StoredPtr stored = begin(surface, surface.mesh(), arguments, std::nullopt, threads);
        with_thread_limit(resolved(threads), [&] {
            const SurfaceSpectrum s = make_surface_spectrum(surface.mesh(), options);
            stored->item.results.push_back(app::make_spectrum_group(stored->item.item.name, s));
            note_outcome(*stored, "shape", s.status, s.message);
        });
        stored->seconds = clock.seconds();
        return stored;
    });
}

using Curves = std::vector<std::pair<std::string, std::vector<Index>>>;

std::vector<NamedPath> paths_of(const Curves& curves, const Connectivity& connectivity) {
    std::vector<NamedPath> paths;
    for (const auto& [name, vertices] : curves) try {
            paths.push_back({name, closed_path(connectivity, vertices)});
        } catch (const std::invalid_argument& e) {
            throw std::invalid_argument(fmt::format("curve {}: {}", name, e.what()));
        }
    return paths;
}

StoredPtr teichmuller(const Surface& surface, const SolveArguments& arguments, const Curves& marking,
                      const Curves& loops, bool words, bool draw, int threads, const py::object& progress) {
    SurfaceCoordinateOptions options;
    options.flow = options_of(arguments, std::nullopt, threads);
    options.words = words;
    options.draw = draw;
    options.marking_curves = paths_of(marking, surface.mesh().connectivity);
    options.loops = paths_of(loops, surface.mesh().connectivity);
    return run_long(progress, [&](Call& call) {
        attach(options.flow, arguments.timeout, call);
        const Clock clock;
        const StoredPtr stored = begin(surface, surface.mesh(), arguments, std::nullopt, threads);
        with_thread_limit(resolved(threads), [&] {
            const SurfaceCoordinates s = make_surface_coordinates(surface.mesh(), options);
            stored->item.results.push_back(app::make_coordinates_group(stored->item.item.name, s));
            note_outcome(*stored, "shape", s.status, s.message);
        });
        stored->seconds = clock.seconds();
        return stored;
    });
}

}  // namespace

void add_solves(py::module_& m) {
    py::class_<LayoutOptions>(m, "LayoutOptions")
        .def(py::init<>())
        .def_readwrite("base", &LayoutOptions::base)
        .def_readwrite("seed_face", &LayoutOptions::seed_face)
        .def_readwrite("charts", &LayoutOptions::charts)
        .def_readwrite("digits", &LayoutOptions::digits)
        .def_readwrite("subdivide", &LayoutOptions::subdivide)
        .def_readwrite("goal", &LayoutOptions::goal)
        .def_readwrite("copies_within", &LayoutOptions::copies_within)
        .def_readwrite("copies", &LayoutOptions::copies)
        .def_readwrite("quality", &LayoutOptions::quality)
        .def_readwrite("atlas", &LayoutOptions::atlas);
    m.def("flow", &flow);
    m.def("layout", &layout);
    m.def("spectrum", &spectrum);
    m.def("teichmuller", &teichmuller);
}

}  // namespace ricci::python
