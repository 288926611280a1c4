// The subcommands: each adds itself to the command line and leaves a function to be run.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "engine/app/console.h"

namespace ricci::app {

/// Set by the chosen subcommand; returns the exit status.
using Action = std::function<int()>;

void add_info(CLI::App& app, CommonOptions& common, Action& action);
void add_generate(CLI::App& app, CommonOptions& common, Action& action);
void add_flow(CLI::App& app, CommonOptions& common, Action& action);
void add_layout(CLI::App& app, CommonOptions& common, Action& action);
void add_spectrum(CLI::App& app, CommonOptions& common, Action& action);
void add_teichmuller(CLI::App& app, CommonOptions& common, Action& action);
void add_sweep(CLI::App& app, CommonOptions& common, Action& action);
void add_index(CLI::App& app, CommonOptions& common, Action& action);
void add_path(CLI::App& app, CommonOptions& common, Action& action);
void add_merge(CLI::App& app, CommonOptions& common, Action& action);
void add_submit(CLI::App& app, CommonOptions& common, Action& action);
void add_verify(CLI::App& app, CommonOptions& common, Action& action);
void add_report(CLI::App& app, CommonOptions& common, Action& action);
void add_export(CLI::App& app, CommonOptions& common, Action& action);

/// Adds --json, --threads, --quiet, --verbose to a subcommand.
void add_common(CLI::App& command, CommonOptions& common);

/// The whole command line as it was typed, for the result file.
std::string& command_line();

}  // namespace ricci::app
