// Everything that writes an index, for the command line and for the Python module.
#pragma once

#include <string>
#include <vector>

#include "engine/app/index_build.h"

namespace ricci::app {

/// What an index is to be made of.
struct IndexWork {
    IndexConfig config;
    std::vector<IndexInput> inputs;
    std::vector<FailureRecord> failures;  // known before
};

/// Files, folders and globs, each file once. Throws UsageError.
IndexWork index_of(const IndexConfig& config, const std::vector<std::string>& paths);
/// The index at `index` with further files, or with files that are read again, by its own options. Throws
/// UsageError; FileError.
IndexWork index_with(const std::string& index, const std::vector<std::string>& paths);

/// What became of it.
struct IndexJob {
    std::vector<BuiltShape> shapes;
    bool stopped = false;  // what is finished is durable in OUTPUT.parts; nothing is assembled
};

/// Describes what is not known and writes options.output. Throws FileError.
IndexJob write_index(const IndexWork& work, const BuildOptions& options, bool resume);

struct IndexRemoval {
    std::size_t removed = 0, left = 0;     // shapes
    std::vector<std::string> not_found{};  // paths that name nothing in the index
};

/// Takes out the shapes and failures of files: paths as the index has them, folders above them, or globs.
IndexRemoval remove_from_index(const std::string& index, const std::vector<std::string>& paths, int threads);

}  // namespace ricci::app
