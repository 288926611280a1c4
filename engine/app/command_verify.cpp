#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdio>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/verify_results.h"
#include "io/store/run_store.h"

namespace ricci::app {
namespace {

int verify(const std::string& path, bool recompute, const CommonOptions& common) {
    const std::vector<std::string> complaints = verify_structure(path);
    std::vector<RecomputedSolution> solutions;
    if (complaints.empty() && recompute)
        solutions = recompute_solutions(read_run(path), common.resolved_threads());
    bool sound = complaints.empty();
    for (const std::string& complaint : complaints)
        spdlog::error("{}", complaint.starts_with(path) ? complaint : path + ": " + complaint);
    for (const RecomputedSolution& s : solutions) {
        sound = sound && s.sound;
        if (!s.sound) spdlog::error("{}: {} {}: {}", path, s.item, s.what, s.message);
    }
    if (common.json) {
        nlohmann::json list = nlohmann::json::array();
        for (const RecomputedSolution& s : solutions)
            list.push_back({{"item", s.item},
                            {"what", s.what},
                            {"residual_stored", finite_or_null(s.residual_stored)},
                            {"residual_recomputed", finite_or_null(s.residual_recomputed)},
                            {"gauss_bonnet_error_stored", finite_or_null(s.gauss_bonnet_stored)},
                            {"gauss_bonnet_error_recomputed", finite_or_null(s.gauss_bonnet_recomputed)},
                            {"digits", s.digits},
                            {"area_distortion_stored", finite_or_null(s.distortion_stored)},
                            {"area_distortion_recomputed", finite_or_null(s.distortion_recomputed)},
                            {"flips", s.flips},
                            {"sound", s.sound},
                            {"message", s.message}});
        print_json({{"file", path}, {"sound", sound}, {"complaints", complaints}, {"recomputed", list}});
        return sound ? kDone : kSomeFailed;
    }
    if (!solutions.empty())
        fmt::print("{:<40}  {:<22}  {:>10}  {:>10}  {:>16}  {:>16}\n", "item", "solution", "stored",
                   "recomputed", "distortion", "recomputed");
    for (const RecomputedSolution& s : solutions)
        fmt::print("{:<40}  {:<22}  {:>10.2e}  {:>10.2e}  {:>16.10g}  {:>16.10g}  {}\n", s.item, s.what,
                   s.residual_stored, s.residual_recomputed, s.distortion_stored, s.distortion_recomputed,
                   s.sound ? "" : s.message);
    fmt::print(
        "{}: {}{}\n", path, sound ? "sound" : "NOT sound",
        recompute && complaints.empty() ? fmt::format(", {} solutions recomputed", solutions.size()) : "");
    return sound ? kDone : kSomeFailed;
}

}  // namespace

void add_verify(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command =
        app.add_subcommand("verify", "Check a result file; --recompute rebuilds every stored solution");
    auto path = std::make_shared<std::string>();
    auto recompute = std::make_shared<bool>(false);
    command->add_option("FILE", *path, "Result file (HDF5)")->required();
    command->add_flag(
        "--recompute", *recompute,
        "Rebuild every stored metric from mesh/ and its conformal factor by separate code in long double");
    add_common(*command, common);
    command->footer("Example: ricci verify eight.h5 --recompute");
    command->callback([&common, &action, path, recompute] {
        action = [&common, path, recompute] { return verify(*path, *recompute, common); };
    });
}

}  // namespace ricci::app
