// One flow as a user calls it, in the three geometries, over sizes and threads. The baseline, at small sizes,
// is gradient descent (thesis section 4.3.1) to the same tolerance. One item is one vertex.
#include <benchmark/benchmark.h>

#include <numbers>
#include <string>

#include "bench/surfaces.h"
#include "engine/flow/flow.h"
#include "kernels/parallel.h"

namespace {

using namespace ricci;

struct Job {
    std::string surface;
    Geometry geometry;
    bool cone;  // all curvature at one vertex
};

FlowOptions options_of(const Job& job, const SurfaceMesh& mesh, Method method, double tolerance) {
    FlowOptions options;
    options.geometry = job.geometry;
    options.method = method;
    options.tolerance = tolerance;
    if (job.cone)
        options.cones.push_back(
            {mesh.connectivity.vertex_count / 2,
             2.0 * std::numbers::pi * topology_of(mesh.connectivity).euler_characteristic});
    return options;
}

void flow(benchmark::State& state, const Job& job, Index faces, int threads, Method method,
          double tolerance) {
    const SurfaceMesh& mesh = bench::generated(job.surface, faces);
    FlowOptions options = options_of(job, mesh, method, tolerance);
    options.parallel = threads > 1;
    FlowResult result;
    with_thread_limit(threads, [&] {
        for (auto _ : state) result = solve_flow(mesh, options);
    });
    if (result.outcome.status != Status::converged || !(result.outcome.residual_max <= tolerance))
        state.SkipWithError("did not converge");
    if (!(result.gauss_bonnet_error < 1e-6)) state.SkipWithError("Gauss-Bonnet does not hold");
    state.SetItemsProcessed(state.iterations() * mesh.connectivity.vertex_count);
    state.counters["steps"] = result.outcome.iterations;
    state.counters["flips"] = static_cast<double>(result.outcome.flips);
}

void add(const std::string& name, const Job& job, Index faces, int threads, Method method, double tolerance) {
    benchmark::RegisterBenchmark(name.c_str(), flow, job, faces, threads, method, tolerance)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
}

const bool kRegistered = [] {
    const Job jobs[] = {{"torus", Geometry::euclidean, false},
                        {"eight", Geometry::euclidean, true},
                        {"eight", Geometry::hyperbolic, false}};
    for (const Job& job : jobs) {
        const std::string name =
            job.surface + (job.cone ? "_cone/" : "/") + std::string(name_of(job.geometry));
        for (const Index faces : {2000, 20000, 100000})
            for (int threads = 1; threads <= hardware_threads(); threads *= 2)
                add(name + "/newton/faces:" + std::to_string(faces) + "/threads:" + std::to_string(threads),
                    job, faces, threads, Method::newton, 1e-10);
        // One cone is hopeless for gradient descent: it is shown where it ends.
        if (job.cone) continue;
        add(name + "/newton/faces:2000/tolerance:1e-6", job, 2000, 1, Method::newton, 1e-6);
        add(name + "/gradient/faces:2000/tolerance:1e-6", job, 2000, 1, Method::gradient, 1e-6);
    }
    return true;
}();

}  // namespace
