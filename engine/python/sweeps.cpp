// The main job: every vertex in turn as the only cone.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "engine/app/sweep_job.h"
#include "engine/python/bindings.h"
#include "engine/python/long_call.h"
#include "engine/python/stored.h"
#include "engine/python/surface.h"
#include "kernels/parallel.h"

namespace py = pybind11;

namespace ricci::python {
namespace {

using app::SweepConfig;
using app::SweepSource;
using Input = std::variant<std::string, std::shared_ptr<Surface>>;  // path, folder or glob; or a mesh

/// The inputs in their order, as sources and as the configuration names them.
std::vector<SweepSource> sources_of(const std::vector<Input>& inputs, SweepConfig& config) {
    std::vector<SweepSource> sources;
    config.meshes.clear();
    for (const Input& input : inputs) {
        if (const auto* surface = std::get_if<std::shared_ptr<Surface>>(&input)) {
            sources.push_back(source_of(**surface));
            const std::string& file = sources.back().file;
            config.meshes.push_back(file.empty() ? "<" + sources.back().stem() + ">" : file);
            continue;
        }
        config.meshes.push_back(std::get<std::string>(input));
        for (const std::string& file : app::expand_inputs({config.meshes.back()}))
            sources.push_back({file, ""});
    }
    if (sources.empty()) throw app::UsageError("no meshes to sweep");
    app::name_sources(sources);
    return sources;
}

std::shared_ptr<Run> sweep(const std::vector<Input>& inputs, SweepConfig config, const py::object& progress) {
    if (config.threads <= 0) config.threads = hardware_threads();
    app::sweep_options(config);  // complains before anything is done
    app::parse_vertices(config.vertices);
    app::parse_keep(config.keep);
    const std::size_t resolutions = app::parse_resolutions(config.resolutions).size();
    const std::vector<SweepSource> sources = sources_of(inputs, config);
    return run_long(progress, [&](Call& call) {
        ReportedProgress reported(call);
        if (config.output.empty())
            return std::make_shared<Run>(
                run_of(app::sweep_in_memory(config, sources, reported, call.stop())));
        const app::SweepPlan plan(sources.size(), resolutions);
        const app::SweepJob job = app::sweep_to_file(config, sources, plan, reported, call.stop());
        return std::make_shared<Run>(job.stopped ? Run{} : run_of(read_run(config.output)));
    });
}

}  // namespace

void add_sweeps(py::module_& m) {
    m.def("sweep", &sweep, py::arg("inputs"), py::arg("options"), py::arg("progress"));
}

}  // namespace ricci::python
