// Describing many files for an index: which are new, in parallel, durable block by block.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "engine/app/console.h"
#include "engine/app/index_config.h"
#include "io/mesh/mesh_file.h"
#include "io/store/index_store.h"

namespace ricci::app {

/// A file of the index to be.
struct IndexInput {
    std::string file;
    std::vector<IndexSource> kept;  // entries of an older index that stay as they are, unread; empty: read it
};

struct BuildOptions {
    int threads = 1;
    std::int64_t max_memory = 0;
    bool quiet = false;
    bool isolate = false;         // a child process per file
    double hang_timeout = 600.0;  // seconds without a sign of life, where isolated
    std::string output;           // of the index; reproducers lie beside it
    std::function<bool()> stop = stopped_by_signal;
    ProgressLine* progress = nullptr;  // null: one of its own
};

/// What became of one shape, or of a file that gave none.
struct BuiltShape {
    std::string file;
    std::int32_t component = 0, components = 1;
    bool reused = false;    // known before
    FailureRecord failure;  // status "": described
};

/// What is wrong with a mesh, in one text.
std::string joined_errors(const LoadedMesh& loaded);

/// One build under way.
class IndexBuild {
  public:
    IndexBuild(const IndexConfig& config, std::vector<IndexInput> inputs, IndexStore& store);

    /// Reads and describes what is not known. Returns early when it is stopped; what is finished is durable
    /// then. Throws FileError when the store cannot be written.
    void run(const BuildOptions& options);

    /// After run(): entries and failures for IndexStore::assemble(), in the order of the inputs.
    [[nodiscard]] std::vector<IndexSource> sources() const;
    [[nodiscard]] std::vector<FailureRecord> load_failures() const;
    /// Shapes of the files that were read, in their order.
    [[nodiscard]] std::vector<BuiltShape> shapes() const;
    /// Names of the reproducers of shapes that have failed.
    [[nodiscard]] std::vector<std::string> failed_bundles() const;

  private:
    friend class IsolatedIndex;

    /// What is known of one input that is read.
    struct Reading {
        std::size_t input = 0;
        std::uintmax_t size = 0;
        std::uint64_t hash = 0;
        bool reused = false;
        std::string load_error;
        std::vector<ShapeRecord> shapes;  // described, until handed over
    };

    void run_in_children(const std::vector<Reading*>& order, const BuildOptions& build,
                         ProgressLine& progress);
    bool read(Reading& reading);
    bool describe(Reading& reading, std::string bytes);
    [[nodiscard]] bool claim(std::uint64_t hash, std::int32_t component);
    void hand_over(const std::vector<Reading*>& finished);

    IndexConfig config_;
    ShapeOptions options_;
    std::function<bool()> stop_;
    std::vector<Index> resolutions_;
    std::vector<IndexInput> inputs_;
    IndexStore* store_;
    std::vector<Reading> readings_;  // in the order of the inputs
    std::mutex mutex_;
    std::set<std::pair<std::uint64_t, std::int32_t>> claimed_;
};

}  // namespace ricci::app
