// The subcommands of `ricci index`: each takes what was typed and returns the exit status.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/app/console.h"
#include "engine/app/index_config.h"

namespace ricci::app {

struct IndexArguments {
    std::string index;               // the file
    std::vector<std::string> paths;  // files, folders, globs
    IndexConfig config;
    std::string max_memory, metric = "spectrum", linkage = "average", type, output, heatmap, dendrogram;
    bool resume = false, others = false, isolate = false;
    double hang_timeout = 600.0;
    std::int64_t neighbours = 5, clusters = 0;
};

int index_build(const IndexArguments& arguments, const CommonOptions& common);
int index_add(const IndexArguments& arguments, const CommonOptions& common);
int index_remove(const IndexArguments& arguments, const CommonOptions& common);
int index_query(const IndexArguments& arguments, const CommonOptions& common);
int index_stats(const IndexArguments& arguments, const CommonOptions& common);
int index_distances(const IndexArguments& arguments, const CommonOptions& common);

}  // namespace ricci::app
