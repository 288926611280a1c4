// What it costs that nothing finished is lost: the same sweep with its journal (segments written,
// synchronised, read back; journal lines), and with rows thrown away as they come. In turn, in one process.
// The assembled file, which any program that keeps results writes, is counted apart.
//
// Times on the wall tell what waiting for the disk costs, processor times what writing does.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "bench/clocks.h"
#include "bench/scratch_folder.h"
#include "bench/surfaces.h"
#include "engine/app/records.h"
#include "engine/app/sweep_run.h"

namespace {

using namespace ricci;
using bench::Cost;
using bench::cost_of;

/// Many small files, or one larger.
struct Work {
    std::size_t files;
    Index faces;
    std::string vertices;
};

std::vector<std::string> write_files(const bench::ScratchFolder& folder, const Work& work) {
    std::vector<std::string> files;
    for (std::size_t k = 0; k < work.files; ++k) {
        files.push_back(folder.file("m" + std::to_string(k) + ".off"));
        save_mesh(files.back(), bench::generated("eight", work.faces));
    }
    return files;
}

struct Costs {
    Cost sweep, assembly;
    bool good = false;
};

/// One sweep; `store` may be null.
Costs sweep(const app::SweepConfig& config, RunStore* store) {
    app::ProgressLine progress(true);
    app::StoreRecords records(store, false, progress);
    const app::SweepPlan plan(config.meshes.size(), 1);
    app::SweepRun run(config, app::sweep_sources(config.meshes), plan, records, progress);
    SchedulerOptions options;
    options.threads = config.threads;
    Costs costs;
    costs.sweep = cost_of([&] {
        run_sweeps(
            plan.files().size(), [&](std::size_t i) { return run.open(i); }, run, options);
    });
    if (store != nullptr)
        costs.assembly =
            cost_of([&] { store->assemble(app::stored_names(run.items()), app::parse_keep(config.keep)); });
    costs.good = !run.any_failure();
    return costs;
}

void journal(benchmark::State& state, const Work& work, int threads) {
    const bench::ScratchFolder folder("ricci_bench_journal");
    app::SweepConfig config;
    config.meshes = write_files(folder, work);
    config.vertices = work.vertices;
    config.threads = threads;
    config.output = folder.file("out.h5");
    std::vector<double> wall, processor, without, assembly;
    bool good = true;
    int turn = 0;
    for (auto _ : state) {
        // Now one first, now the other: the second finds the files in the cache and the memory warm.
        Costs plain, safe;
        for (const bool with_journal : {turn % 2 == 0, turn % 2 != 0}) {
            if (!with_journal) {
                plain = sweep(config, nullptr);
                continue;
            }
            RunStore store(config.output,
                           app::make_run_info(to_toml(config, false), to_toml(config, true), threads), false);
            safe = sweep(config, &store);
        }
        ++turn;
        good = good && plain.good && safe.good;
        wall.push_back(safe.sweep.wall / plain.sweep.wall);
        processor.push_back(safe.sweep.processor / plain.sweep.processor);
        assembly.push_back(safe.assembly.wall / plain.sweep.wall);
        without.push_back(plain.sweep.wall);
        state.SetIterationTime(safe.sweep.wall);
    }
    if (!good) state.SkipWithError("a solve failed");
    state.counters["without_ms"] = 1e3 * bench::median(without);
    state.counters["wall_percent"] = 100.0 * (bench::median(wall) - 1.0);
    state.counters["processor_percent"] = 100.0 * (bench::median(processor) - 1.0);
    state.counters["assembly_percent"] = 100.0 * bench::median(assembly);
}

void add(const std::string& name, const Work& work) {
    for (const int threads : {1, 2})
        benchmark::RegisterBenchmark(("journal/" + name + "/threads:" + std::to_string(threads)).c_str(),
                                     journal, work, threads)
            ->UseManualTime()
            ->Iterations(10)
            ->Unit(benchmark::kMillisecond);
}

const bool kRegistered = [] {
    add("one_of_10000_faces", {1, 10000, "sample:1000"});
    add("twenty_of_2000_faces", {20, 2000, "sample:200"});
    add("sixty_of_400_faces", {60, 400, "all"});
    return true;
}();

}  // namespace
