// Whole sweeps against their honest baseline, in the same run and on the same vertices (sample:1000:1).
//
// The sweep is `ricci sweep` itself, run in this process by the program's own entry point: reading the file,
// preparing the surface, every solve and writing the HDF5 file are in its time. The baseline reads the same
// file, prepares it once, solves by IndependentNewton and writes the same kind of file. A thousand of its
// solves would take too long, so it solves an evenly drawn part of the very same vertices, half of them
// before the sweep and half after, and its mean time per solve counts a thousand times; what it does once is
// measured once. Its solutions are those that the sweep finds for the same vertices, or the benchmark fails.
//
// Times are on the wall; `processor_ratio` is the same ratio in processor time, which a busy machine changes
// less.
#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "bench/clocks.h"
#include "bench/independent_newton.h"
#include "bench/scratch_folder.h"
#include "bench/surfaces.h"
#include "engine/app/app.h"
#include "engine/app/records.h"
#include "engine/remesh/resample.h"
#include "engine/sweep/area_distortion.h"
#include "engine/sweep/scheduler.h"
#include "io/store/run_store.h"
#include "kernels/lanes.h"
#include "kernels/parallel.h"

namespace {

using namespace ricci;
using bench::at;
using bench::Samples;

constexpr double kTolerance = 1e-10;
constexpr std::int64_t kSolves = 1000;
constexpr int kPairs = 5;

const bench::ScratchFolder& folder() {
    static const bench::ScratchFolder made("ricci_bench_sweep");
    return made;
}

/// Keeps standard output for the benchmark's own table.
class Silence {
  public:
    Silence() : kept_(dup(STDOUT_FILENO)) {
        flush();
        const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
        dup2(nowhere, STDOUT_FILENO);
        close(nowhere);
    }
    ~Silence() {
        flush();
        dup2(kept_, STDOUT_FILENO);
        close(kept_);
    }
    Silence(const Silence&) = delete;
    Silence& operator=(const Silence&) = delete;

  private:
    static void flush() {
        std::cout.flush();
        std::fflush(stdout);
    }
    int kept_;
};

using bench::Cost;
using bench::cost_of;

/// `ricci sweep` of one file.
struct CommandSweep {
    Cost cost;
    int status = 0;
    StoredSweep stored;
};

CommandSweep sweep_command(const std::string& mesh, const std::string& vertices, const std::string& keep,
                           int threads) {
    const std::string output = folder().file("sweep.h5");
    std::vector<std::string> words = {"ricci", "sweep", mesh, "--quiet"};
    const std::pair<const char*, std::string> options[] = {
        {"--vertices", vertices}, {"--keep", keep},      {"--threads", std::to_string(threads)},
        {"--output", output},     {"--solver", "lanes"}, {"--tolerance", "1e-10"}};
    for (const auto& [name, value] : options) words.insert(words.end(), {name, value});
    std::vector<char*> arguments;
    arguments.reserve(words.size());
    for (std::string& word : words) arguments.push_back(word.data());
    CommandSweep result;
    {
        const Silence silence;
        result.cost =
            cost_of([&] { result.status = app::run(static_cast<int>(arguments.size()), arguments.data()); });
    }
    if (result.status != app::kDone && result.status != app::kSomeFailed) return result;
    StoredRun run = read_run(output);
    if (run.items.size() == 1 && run.items.front().sweep) result.stored = std::move(*run.items.front().sweep);
    std::filesystem::remove(output);
    return result;
}

bool all_converged(const CommandSweep& sweep, std::int64_t solves) {
    return sweep.status == app::kDone && static_cast<std::int64_t>(sweep.stored.rows.size()) == solves &&
           std::all_of(sweep.stored.rows.begin(), sweep.stored.rows.end(), [](const SweepRow& row) {
               return row.status == static_cast<std::uint8_t>(Status::converged) &&
                      row.residual_max <= kTolerance;
           });
}

/// The baseline's sweep, in the parts that its time is made of.
struct Baseline {
    Cost once;  // reading, preparing, writing
    Samples solves;
    std::vector<Index> chosen, part;  // all vertices, and those that are solved
    std::vector<std::vector<double>> solutions;
    std::vector<SweepRow> rows;
    double steps = 0.0, flips = 0.0, worst_residual = 0.0;
    bool converged = true;
};

int baseline_solves(Index vertices) {
    return vertices < 10000 ? 100 : (vertices < 30000 ? 48 : 24);
}

class BaselineSweep {
  public:
    explicit BaselineSweep(const std::string& file) : file_(file) {
        add(result.once, cost_of([&] {
                loaded_ = load_mesh(file);
                independent_.emplace(mesh(), kTolerance);
                area_ = face_areas(mesh());
                // As in a sweep: the interior vertices.
                const std::vector<std::uint8_t> boundary = boundary_vertices(mesh().connectivity),
                                                used = used_vertices(mesh().connectivity);
                std::vector<Index> candidates;
                for (Index v = 0; v < mesh().connectivity.vertex_count; ++v)
                    if (used[at(v)] != 0 && boundary[at(v)] == 0) candidates.push_back(v);
                result.chosen = sample_vertices(candidates, kSolves, 1);
            }));
        const auto part = static_cast<std::size_t>(baseline_solves(mesh().connectivity.vertex_count));
        for (std::size_t k = 0; k < part; ++k)
            result.part.push_back(result.chosen[(2 * k + 1) * result.chosen.size() / (2 * part)]);
        result.solutions.resize(part);
        result.rows.resize(part);
    }

    /// Every other vertex of the part, from the first or the second on.
    void solve_half(std::size_t first) {
        for (std::size_t k = first; k < result.part.size(); k += 2) {
            SolveOutcome outcome;
            SweepRow& row = result.rows[k];
            std::vector<double>& u = result.solutions[k];
            result.solves.measure([&] {
                outcome = independent_->solve(result.part[k], u);
                row.area_distortion = area_distortion_of_scaling(area_, mesh().connectivity.tail, u);
            });
            row.vertex = result.part[k];
            row.status = static_cast<std::uint8_t>(outcome.status);
            row.newton_iterations = static_cast<std::uint16_t>(outcome.iterations);
            row.residual_max = outcome.residual_max;
            row.flips = static_cast<std::int32_t>(outcome.flips);
            row.seconds = static_cast<float>(result.solves.wall.back());
            result.steps += outcome.iterations;
            result.flips += static_cast<double>(outcome.flips);
            result.worst_residual = std::max(result.worst_residual, outcome.residual_max);
            result.converged = result.converged && outcome.status == Status::converged;
        }
    }

    void write() {
        const std::string output = folder().file("baseline.h5");
        add(result.once, cost_of([&] {
                RunStore store(output, app::make_run_info("", "", 1), false);
                const std::string name = app::item_name(loaded_.stem, mesh().connectivity.face_count());
                store.write_item(app::make_item(name, file_, loaded_.content_hash, mesh()));
                SweepBlock block{name, result.rows, {}};
                const auto [best, worst] = std::minmax_element(
                    result.rows.begin(), result.rows.end(), [](const SweepRow& a, const SweepRow& b) {
                        return a.area_distortion < b.area_distortion;
                    });
                for (const auto& row : {best, worst})
                    block.kept.push_back(
                        {row->vertex, row->area_distortion,
                         result.solutions[static_cast<std::size_t>(row - result.rows.begin())]});
                store.write_sweep_block(block);
                store.assemble({name}, {});
            }));
        std::filesystem::remove(output);
    }

    [[nodiscard]] const SurfaceMesh& mesh() const { return loaded_.components.front(); }

    Baseline result;

  private:
    static void add(Cost& sum, const Cost& cost) {
        sum.wall += cost.wall;
        sum.processor += cost.processor;
    }

    std::string file_;
    LoadedMesh loaded_;
    std::optional<bench::IndependentNewton> independent_;
    std::vector<double> area_;
};

double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

/// The nearest-rank quantile.
double quantile(std::vector<double> values, double q) {
    std::sort(values.begin(), values.end());
    const double rank = std::ceil(q * static_cast<double>(values.size()));
    return values[static_cast<std::size_t>(std::max(rank - 1.0, 0.0))];
}

/// Largest difference after both are shifted to the same mean.
double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double shift = 0.0, largest = 0.0;
    for (std::size_t v = 0; v < a.size(); ++v) shift += (a[v] - b[v]) / static_cast<double>(a.size());
    for (std::size_t v = 0; v < a.size(); ++v) largest = std::max(largest, std::abs(a[v] - b[v] - shift));
    return largest;
}

/// Sweeps the baseline's part again, keeping the solutions: largest distance from the baseline's. Nothing
/// where a solution is missing or another sweep gave the vertex other bits.
std::optional<double> compare(const std::string& file, const Baseline& baseline,
                              const std::vector<SweepRow>& rows) {
    const std::string list = folder().file("vertices.txt");
    {
        std::ofstream out(list);
        for (const Index vertex : baseline.part) out << vertex << '\n';
    }
    const StoredSweep again = sweep_command(file, list, "all", 1).stored;
    double worst = 0.0;
    for (std::size_t k = 0; k < baseline.part.size(); ++k) {
        const auto is_it = [&](const auto& x) { return x.vertex == baseline.part[k]; };
        const auto factor = std::find_if(again.kept.begin(), again.kept.end(), is_it);
        const auto row = std::find_if(rows.begin(), rows.end(), is_it);
        if (factor == again.kept.end() || row == rows.end()) return std::nullopt;
        if (factor->area_distortion != row->area_distortion) return std::nullopt;
        worst = std::max(worst, distance(factor->conformal_factor, baseline.solutions[k]));
    }
    return worst;
}

/// The file of a surface, made when first asked for.
using MeshFile = std::function<std::string()>;

void against_newton(benchmark::State& state, const MeshFile& make_file) {
    const std::string file = make_file();
    BaselineSweep baseline(file);
    CommandSweep sweep;
    for (auto _ : state) {
        baseline.solve_half(0);
        sweep = sweep_command(file, "sample:1000:1", "best,worst", 1);
        baseline.solve_half(1);
        state.SetIterationTime(sweep.cost.wall);
    }
    baseline.write();
    const Baseline& b = baseline.result;
    const auto solves = static_cast<double>(b.chosen.size());
    const std::vector<SweepRow>& rows = sweep.stored.rows;
    const std::optional<double> difference = compare(file, b, rows);
    std::vector<double> seconds;
    double solving = 0.0, steps = 0.0, flips = 0.0, worst_residual = b.worst_residual;
    for (const SweepRow& row : rows) {
        seconds.push_back(row.seconds);
        solving += row.seconds;
        steps += row.newton_iterations;
        flips += row.flips;
        worst_residual = std::max(worst_residual, row.residual_max);
    }
    const double baseline_wall = b.once.wall + solves * mean(b.solves.wall),
                 baseline_processor = b.once.processor + solves * mean(b.solves.thread);
    state.SetItemsProcessed(static_cast<std::int64_t>(solves));
    state.counters["vertices"] = baseline.mesh().connectivity.vertex_count;
    state.counters["solves"] = solves;
    state.counters["baseline_solves"] = static_cast<double>(b.part.size());
    state.counters["baseline_ms"] = 1e3 * baseline_wall / solves;
    state.counters["baseline_once_ms"] = 1e3 * b.once.wall;
    state.counters["baseline_p50_ms"] = 1e3 * quantile(b.solves.wall, 0.5);
    state.counters["baseline_p99_ms"] = 1e3 * quantile(b.solves.wall, 0.99);
    state.counters["sweep_ms"] = 1e3 * sweep.cost.wall / solves;
    state.counters["sweep_processor_ms"] = 1e3 * sweep.cost.processor / solves;
    state.counters["sweep_rest_ms"] = 1e3 * (sweep.cost.wall - solving);
    state.counters["sweep_p50_ms"] = seconds.empty() ? 0.0 : 1e3 * quantile(seconds, 0.5);
    state.counters["sweep_p99_ms"] = seconds.empty() ? 0.0 : 1e3 * quantile(seconds, 0.99);
    state.counters["ratio"] = baseline_wall / sweep.cost.wall;
    state.counters["processor_ratio"] = baseline_processor / sweep.cost.processor;
    state.counters["baseline_steps"] = b.steps / static_cast<double>(b.part.size());
    state.counters["steps"] = steps / solves;
    state.counters["flips"] = flips / solves;
    state.counters["worst_residual"] = worst_residual;
    state.counters["worst_distance"] = difference.value_or(std::numeric_limits<double>::quiet_NaN());
    // Residuals below 1e-10 leave the conformal factors uncertain by that times the norm of the inverse
    // Hessian.
    if (!b.converged || !all_converged(sweep, static_cast<std::int64_t>(solves))) {
        state.SkipWithError("a solve did not converge");
    } else if (!difference) {
        state.SkipWithError("the same vertex gave different results");
    } else if (*difference > 1e-6) {
        state.SkipWithError("sweep and baseline differ");
    }
}

/// A fixed amount of arithmetic on few numbers, taken in small portions as a sweep's vertices are: what the
/// machine itself gives at the moment.
Cost control(int threads) {
    constexpr int kPortions = 40000, kRounds = 10;
    std::atomic<int> taken = 0;
    return cost_of([&] {
        run_workers(threads, [&](int) {
            LaneArray<double> u(16), shrink(16);
            for (std::size_t row = 0; row < u.size(); ++row)
                for (std::size_t lane = 0; lane < kLanes; ++lane)
                    u[row].lane[lane] = 0.01 * static_cast<double>(row * kLanes + lane);
            while (taken++ < kPortions)
                for (int round = 0; round < kRounds; ++round) {
                    lane_exponentials(u, shrink);
                    benchmark::ClobberMemory();
                }
        });
    });
}

/// One thread and two in turn, each pair beside the same of the control. `processors`: those that the two
/// threads had on average, which a busy machine keeps below two.
void two_threads(benchmark::State& state, const MeshFile& make_file) {
    const std::string file = make_file();
    std::vector<double> ratios, control_ratios, growth, processors, control_processors;
    bool converged = true;
    for (auto _ : state) {
        const Cost control_one = control(1), control_two = control(2);
        const CommandSweep one = sweep_command(file, "sample:1000:1", "best,worst", 1);
        const CommandSweep two = sweep_command(file, "sample:1000:1", "best,worst", 2);
        converged = converged && all_converged(one, kSolves) && all_converged(two, kSolves);
        for (std::size_t k = 0; converged && k < one.stored.rows.size(); ++k)
            converged = one.stored.rows[k].area_distortion == two.stored.rows[k].area_distortion;
        ratios.push_back(one.cost.wall / two.cost.wall);
        control_ratios.push_back(control_one.wall / control_two.wall);
        growth.push_back(two.cost.processor / one.cost.processor);
        processors.push_back(two.cost.processor / two.cost.wall);
        control_processors.push_back(control_two.processor / control_two.wall);
        state.SetIterationTime(two.cost.wall);
    }
    if (!converged) state.SkipWithError("a solve did not converge, or differs between one thread and two");
    state.counters["threads_ratio"] = bench::median(ratios);
    state.counters["threads_ratio_least"] = *std::min_element(ratios.begin(), ratios.end());
    state.counters["threads_ratio_most"] = *std::max_element(ratios.begin(), ratios.end());
    state.counters["control_ratio"] = bench::median(control_ratios);
    state.counters["processor_growth"] = bench::median(growth);
    state.counters["processors"] = bench::median(processors);
    state.counters["control_processors"] = bench::median(control_processors);
}

MeshFile written(const std::string& name, const std::function<SurfaceMesh()>& make_mesh) {
    return [name, make_mesh] {
        std::string file = folder().file(name + ".off");
        if (!std::filesystem::exists(file)) save_mesh(file, make_mesh());
        return file;
    };
}

void add(const std::string& name, const MeshFile& file, bool with_threads) {
    benchmark::RegisterBenchmark(("sweep/" + name).c_str(), against_newton, file)
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
    if (with_threads && hardware_threads() >= 2)
        benchmark::RegisterBenchmark(("sweep_threads/" + name).c_str(), two_threads, file)
            ->UseManualTime()
            ->Iterations(kPairs)
            ->Unit(benchmark::kMillisecond);
}

const bool kRegistered = [] {
    // As the program does, so that the baseline has the same allocator.
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
    const auto sample = [](const std::string& name, const std::string& relative, bool loop) {
        const auto path = bench::sample_path("meshes/" + relative);
        if (!path) return;
        add(name,
            loop ? written(name, [path = *path] { return subdivide_loop(bench::load_single(path)); })
                 : MeshFile([path = *path] { return path; }),
            true);
    };
    sample("eight", "closed_g2/eight.off", false);
    sample("brezel", "closed_g2/brezel.obj", false);
    sample("fertility_14k", "families/fertility_resolutions/fertility_13971v.obj", false);
    sample("eight_loop_22k", "closed_g2/eight.off", true);
    sample("botijo", "closed_g5plus/botijo_g5.obj", false);
    for (const Index faces : {10000, 24000, 50000, 100000, 200000})
        add("generated_eight/faces:" + std::to_string(faces),
            written("generated_eight_" + std::to_string(faces),
                    [faces] { return bench::generated("eight", faces); }),
            false);
    return true;
}();

}  // namespace
