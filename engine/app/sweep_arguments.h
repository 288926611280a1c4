// The options that say what is to be swept, for `ricci sweep` and for what runs it elsewhere.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "engine/app/sweep_config.h"

namespace ricci::app {

/// Arguments as given; empty or zero where the configuration (or its default) rules.
struct SweepArguments {
    std::string config;
    SweepConfig values;
    bool dry_run = false;
};

/// Adds the options but --resume, --dry-run and --shard. `arguments` must outlive the command.
void add_sweep_options(CLI::App* command, SweepArguments* arguments);

/// Options given on the command line replace those of the configuration. Throws as read_sweep_config().
SweepConfig resolved_config(const CLI::App& command, const SweepArguments& arguments);

}  // namespace ricci::app
