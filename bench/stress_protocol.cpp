// stress_protocol: does the flow reach every admissible target, and is it right when it says so?
//
// Random cone angles at all vertices of a sphere and of a surface of genus 2, Euclidean, the seed of a target
// its number. Every result is rebuilt by engine/verify (in 50 digits where the solve took more than double),
// which must agree about curvature, triangles and the Delaunay triangulation. Prints a table; --each a JSON
// object per target. Exit status 1 where a target was not reached, or the check contradicts.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/surfaces.h"
#include "kernels/parallel.h"
#include "tests/support/random_targets.h"

namespace {

using ricci::FlowOptions;
using ricci::FlowResult;
using ricci::Index;
using ricci::SurfaceMesh;
using ricci::testing::FlowCheck;
using ricci::testing::TargetDraw;

struct Options {
    std::vector<std::string> surfaces = {"sphere", "eight"};
    std::vector<std::string> draws = {"mild", "random", "harsh"};
    int count = 1000, first = 0, threads = 0;
    Index faces = 2000;
    double tolerance = 1e-10, jitter = 0.3;
    std::string precision = "auto", each;
};

/// One target: what the solver says, and what the check says.
struct Trial {
    FlowResult flow;
    FlowCheck check;
    double seconds = 0.0;
};

ricci::Precision precision_of(const std::string& name) {
    for (const auto p : {ricci::Precision::automatic, ricci::Precision::plain, ricci::Precision::extended})
        if (name == ricci::name_of(p)) return p;
    throw std::invalid_argument("unknown precision " + name);
}

TargetDraw draw_of(const std::string& name) {
    for (std::size_t k = 0; k < ricci::testing::kDrawNames.size(); ++k)
        if (name == ricci::testing::kDrawNames[k]) return static_cast<TargetDraw>(k);
    throw std::invalid_argument("unknown draw " + name);
}

Trial run_trial(const SurfaceMesh& mesh, TargetDraw draw, int number, const Options& options) {
    using Clock = std::chrono::steady_clock;
    FlowOptions flow;
    flow.geometry = ricci::Geometry::euclidean;
    flow.target = ricci::TargetKind::values;
    flow.target_values = ricci::testing::random_target(mesh, draw, static_cast<std::uint64_t>(number));
    flow.tolerance = options.tolerance;
    flow.precision = precision_of(options.precision);
    flow.parallel = false;
    Trial trial;
    const auto start = Clock::now();
    trial.flow = solve_flow(mesh, flow);
    trial.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    trial.check = ricci::testing::check_flow(mesh, trial.flow, flow.target_values);
    return trial;
}

bool reached(const Trial& t) {
    return t.flow.outcome.status == ricci::Status::converged;
}

/// The check contradicts: what is called converged is not, or is no Delaunay triangulation of triangles.
bool contradicted(const Trial& t, const Options& options) {
    if (!reached(t)) return false;
    return !(t.check.residual_max <= 1.2 * options.tolerance) || !t.check.triangles ||
           t.check.non_delaunay > 0 || t.check.edges_that_differ > 0;
}

/// The row of the table, from what is kept of each trial.
struct Row {
    int reached = 0, at_1e8 = 0, contradicted = 0;
    std::array<int, 3> by_digits{};  // 16, 19, 50
    std::vector<int> steps;
    std::vector<double> seconds;
    std::int64_t flips = 0;
    double residual = 0.0, checked = 0.0, gauss_bonnet = 0.0;
};

void add(const Trial& t, const Options& options, Row& row) {
    row.at_1e8 += t.check.residual_max <= 1e-8 ? 1 : 0;
    row.contradicted += contradicted(t, options) ? 1 : 0;
    row.steps.push_back(t.flow.outcome.iterations);
    row.seconds.push_back(t.seconds);
    row.flips += t.flow.outcome.flips;
    row.residual = std::max(row.residual, t.flow.outcome.residual_max);
    row.checked = std::max(row.checked, t.check.residual_max);
    row.gauss_bonnet = std::max({row.gauss_bonnet, t.flow.gauss_bonnet_error, t.check.gauss_bonnet_error});
    if (!reached(t)) return;
    ++row.reached;
    ++row.by_digits[t.flow.precision_digits <= 16 ? 0 : (t.flow.precision_digits <= 19 ? 1 : 2)];
}

std::string line_of(const std::string& surface, const std::string& draw, Row row) {
    std::sort(row.steps.begin(), row.steps.end());
    std::sort(row.seconds.begin(), row.seconds.end());
    const std::size_t n = row.steps.size(), middle = n / 2;
    return fmt::format(
        "| {} | {} | {} | {} | {} | {} / {} / {} | {} / {} | {} | {:.2g} / {:.2g} | {:.1e} | {:.1e} | {:.1e} "
        "| {} |",
        surface, draw, n, row.reached, row.at_1e8, row.by_digits[0], row.by_digits[1], row.by_digits[2],
        row.steps[middle], row.steps.back(), row.flips / static_cast<std::int64_t>(n), row.seconds[middle],
        row.seconds.back(), row.residual, row.checked, row.gauss_bonnet, row.contradicted);
}

nlohmann::json json_of(const std::string& surface, const std::string& draw, int number, const Trial& t) {
    return {{"surface", surface},
            {"draw", draw},
            {"target", number},
            {"status", name_of(t.flow.outcome.status)},
            {"precision_digits", t.flow.precision_digits},
            {"newton_iterations", t.flow.outcome.iterations},
            {"flips", t.flow.outcome.flips},
            {"residual_max", t.flow.outcome.residual_max},
            {"gauss_bonnet_error", t.flow.gauss_bonnet_error},
            {"residual_checked", t.check.residual_max},
            {"triangles", t.check.triangles},
            {"non_delaunay", t.check.non_delaunay},
            {"edges_that_differ", t.check.edges_that_differ},
            {"seconds", t.seconds}};
}

int run(const Options& options) {
    std::ofstream each;
    if (!options.each.empty()) {
        each.open(options.each);
        if (!each) throw std::runtime_error("cannot write " + options.each);
    }
    bool good = true;
    fmt::print(
        "| surface | draw | targets | converged | to 1e-8 | in 16 / 19 / 50 digits | steps (median / most) | "
        "flips | "
        "seconds (median / most) | worst residual | checked | worst Gauss-Bonnet | contradicted |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const std::string& surface : options.surfaces) {
        const SurfaceMesh& mesh = ricci::bench::generated(surface, options.faces, options.jitter);
        for (const std::string& draw : options.draws) {
            const TargetDraw kind = draw_of(draw);
            std::vector<Trial> trials(static_cast<std::size_t>(options.count));
            const auto body = [&](std::int64_t begin, std::int64_t) {
                trials[static_cast<std::size_t>(begin)] =
                    run_trial(mesh, kind, options.first + static_cast<int>(begin), options);
                trials[static_cast<std::size_t>(begin)]
                    .flow.triangulation = {};  // the large part, looked at already
            };
            const int threads = options.threads > 0 ? options.threads : ricci::hardware_threads();
            ricci::with_thread_limit(threads,
                                     [&] { ricci::for_blocks(options.count, 1, threads > 1, body); });
            Row row;
            for (int k = 0; k < options.count; ++k) {
                const Trial& t = trials[static_cast<std::size_t>(k)];
                add(t, options, row);
                if (each.is_open()) each << json_of(surface, draw, options.first + k, t).dump() << "\n";
                if (reached(t) && !contradicted(t, options)) continue;
                std::fprintf(stderr, "%s\n", json_of(surface, draw, options.first + k, t).dump().c_str());
            }
            good = good && row.reached == options.count && row.contradicted == 0;
            fmt::print("{}\n", line_of(surface, draw, row));
            std::fflush(stdout);
        }
    }
    return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app("Random admissible cone angles at all vertices: every target reached, every result checked");
    app.add_option("--surfaces", options.surfaces, "Of ricci generate; closed")
        ->delimiter(',')
        ->capture_default_str();
    app.add_option("--draws", options.draws, "mild, random, harsh, extreme")
        ->delimiter(',')
        ->capture_default_str();
    app.add_option("--count", options.count, "Targets per surface and draw")->capture_default_str();
    app.add_option("--first", options.first, "Number (seed) of the first")->capture_default_str();
    app.add_option("--faces", options.faces, "About so many")->capture_default_str();
    app.add_option("--tolerance", options.tolerance, "On max |K - target|")->capture_default_str();
    app.add_option("--precision", options.precision, "auto, double, extended")->capture_default_str();
    app.add_option("--threads", options.threads, "0: all");
    app.add_option("--each", options.each, "File for one JSON object per target");
    CLI11_PARSE(app, argc, argv)
    try {
        return run(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "stress_protocol: %s\n", error.what());
        return 3;
    }
}
