#include "engine/app/app.h"

#include <fmt/format.h>
#include <malloc.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <limits>
#include <new>

#include "engine/app/commands.h"
#include "engine/app/isolation/child_main.h"
#include "engine/app/version.h"
#include "engine/linear/symmetric_solver.h"
#include "io/mesh/mesh_file.h"

namespace ricci::app {
namespace {

std::string version_text() {
    return fmt::format("ricci {} ({}), {}", ricci_version(), ricci_git(), symmetric_solver_name());
}

int report(int status, const std::string& message) {
    spdlog::error("{}", message);
    return status;
}

int execute(const Action& action) {
    try {
        return action();
    } catch (const UsageError& e) {
        return report(kUsage, e.what());
    } catch (const FileError& e) {
        return report(kEnvironment, e.what());
    } catch (const std::invalid_argument& e) {
        return report(kUsage, e.what());
    } catch (const std::bad_alloc&) {
        return report(kEnvironment, "memory ran out");
    } catch (const std::exception& e) {
        return report(kEnvironment, e.what());
    }
}

}  // namespace

std::string& command_line() {
    static std::string text;
    return text;
}

void add_common(CLI::App& command, CommonOptions& common) {
    command.add_flag("--json", common.json, "One JSON object per item on stdout");
    command.add_option("--threads", common.threads, "Threads to use (default: all this process may use)")
        ->check(CLI::Range(1, 4096));
    command.add_option("--max-unpacked", common.max_unpacked,
                       "What a .gz may unpack to, like 2G (default: 200 times its size, at least 64M)");
    command.add_flag("-q,--quiet", common.quiet, "Errors only");
    command.add_flag("-v,--verbose", common.verbose, "More on stderr");
}

int run(int argc, char** argv) {
    // Factors come and go at every step; handing their pages back to the system each time costs more than the
    // analysis.
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
    for (int k = 0; k < argc; ++k) command_line() += (k == 0 ? "" : " ") + std::string(argv[k]);
    CLI::App app{"ricci: discrete surface Ricci flow, one mesh or thousands"};
    app.set_version_flag("--version", version_text());
    app.require_subcommand(1);
    app.footer(
        "Example: ricci generate eight --faces 5000 -o eight.off && ricci sweep eight.off -o eight.h5\n"
        "Exit status: 0 all done; 1 some item failed; 2 usage or configuration; 3 environment or "
        "input/output; "
        "130, 143 stopped by a signal (sweeps resume with --resume)");
    CommonOptions common;
    Action action;
    add_info(app, common, action);
    add_generate(app, common, action);
    add_flow(app, common, action);
    add_sweep(app, common, action);
    add_merge(app, common, action);
    add_submit(app, common, action);
    add_layout(app, common, action);
    add_spectrum(app, common, action);
    add_teichmuller(app, common, action);
    add_index(app, common, action);
    add_path(app, common, action);
    add_verify(app, common, action);
    add_report(app, common, action);
    add_export(app, common, action);
    add_isolated_child(app, action);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? kDone : kUsage;
    }
    set_up_log(common);
    return execute([&] {
        set_max_unpacked(
            common.max_unpacked.empty() ? 0 : static_cast<std::uint64_t>(parse_bytes(common.max_unpacked)));
        return action();
    });
}

}  // namespace ricci::app
