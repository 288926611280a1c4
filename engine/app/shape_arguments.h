// What `ricci spectrum` and `ricci teichmuller` share: meshes in, one result per component out.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>

#include "engine/app/solve_arguments.h"
#include "io/store/run_store.h"

namespace ricci::app {

/// Adds MESH... and the solving options that apply to uniformization metrics.
void add_shape_arguments(CLI::App& command, SolveArguments& solve, std::vector<std::string>& files);

/// OUT.obj -> OUT.<suffix>.obj; the file itself where the suffix is empty.
std::string numbered_file(const std::string& path, const std::string& suffix);

/// One component of one file.
struct ShapeItem {
    std::string file, name;  // name: <stem>@<faces>
    std::string suffix;      // for files per item: "" where there is one item only
    const SurfaceMesh& mesh;
    FlowOptions flow;
};
struct ShapeOutcome {
    Status status = Status::converged;
    std::string message;
    ResultGroup group;
    nlohmann::json json;   // printed where asked for, with file, item and seconds
    double seconds = 0.0;  // of the solve alone
};

/// make(), and how long it took.
template <class Make>
auto timed(double& seconds, Make&& make) {
    const auto start = std::chrono::steady_clock::now();
    auto made = make();
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return made;
}

/// Goes through files and components. Failures are logged, printed as JSON objects where asked for, and
/// stored.
class ShapeRun {
  public:
    /// `output`: result file, or "". Throws UsageError.
    ShapeRun(const SolveArguments& solve, std::vector<std::string> files, const std::string& output,
             const CommonOptions& common);
    /// Calls solve(item) for each and stores what it returns. Exit status.
    int each(const std::function<ShapeOutcome(const ShapeItem&)>& solve);

  private:
    bool load_and_solve(const std::string& file, const std::function<ShapeOutcome(const ShapeItem&)>& solve);
    bool solve_item(const LoadedMesh& loaded, std::size_t component, const std::string& file,
                    const std::function<ShapeOutcome(const ShapeItem&)>& solve);
    void fail(const std::string& file, const std::string& item, const std::string& status,
              const std::string& message);

    const SolveArguments& solve_;
    std::vector<std::string> files_;
    const CommonOptions& common_;
    std::unique_ptr<RunStore> store_;
    std::vector<std::string> names_;
    std::map<std::string, int> uses_;
};

}  // namespace ricci::app
