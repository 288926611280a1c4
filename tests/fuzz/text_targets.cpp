// Configurations, lists of vertices and curvatures, curves, and the small languages of arguments.
#include <sys/mman.h>
#include <unistd.h>

#include "engine/app/console.h"
#include "engine/app/index_config.h"
#include "engine/app/solve_options.h"
#include "engine/app/sweep_config.h"
#include "engine/topology/closed_path.h"
#include "io/mesh/curve_file.h"
#include "io/mesh/mesh_file.h"
#include "tests/fuzz/allocation_meter.h"
#include "tests/fuzz/fuzz_targets.h"

namespace ricci::fuzz {
namespace {

/// A file that lives in memory.
class MemoryFile {
  public:
    explicit MemoryFile(Bytes bytes) : descriptor_(::memfd_create("input", MFD_CLOEXEC)) {
        require(descriptor_ >= 0, "no memory file");
        require(::write(descriptor_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()),
                "the memory file cannot be written");
    }
    ~MemoryFile() { ::close(descriptor_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

  private:
    int descriptor_;
};

/// Runs `read`, which may take the file in or refuse it, within the memory it may take.
template <class Read>
void attempt(std::size_t size, Read read) {
    const AllocationMeter meter(memory_allowed(size));
    try {
        read();
    } catch (const app::UsageError&) {
    } catch (const FileError&) {
    } catch (const std::invalid_argument&) {
    }
}

/// A configuration that was read is what it prints.
void read_sweep(const std::string& text) {
    const app::SweepConfig config = app::sweep_config_from_toml(text, "sweep.toml");
    const std::string printed = app::to_toml(config, false);
    require(app::to_toml(app::sweep_config_from_toml(printed, "printed"), false) == printed,
            "a configuration changes when it is printed and read");
    app::sweep_options(config);
    app::parse_keep(config.keep);
    app::parse_resolutions(config.resolutions);
    app::parse_shard(config.shard);
    parse_repair(config.repair);
    if (!config.max_memory.empty()) app::parse_bytes(config.max_memory);
}

Connectivity octahedron() {
    const std::vector<Triangle> faces{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1},
                                      {5, 2, 1}, {5, 3, 2}, {5, 4, 3}, {5, 1, 4}};
    return build_connectivity(faces, 6);
}

}  // namespace

void read_configuration(Bytes bytes) {
    const std::string text = text_of(bytes);
    // A parsed value of two bytes is a node of a tree.
    constexpr std::size_t kNodes = 8;
    attempt(kNodes * bytes.size(), [&] { read_sweep(text); });
    attempt(kNodes * bytes.size(), [&] { app::shape_options(app::index_config_from_toml(text)); });
}

void read_lists(Bytes bytes) {
    const MemoryFile file(bytes);
    static const Connectivity surface = octahedron();
    attempt(bytes.size(), [&] {
        for (const VertexCurve& curve : read_curves(file.path())) closed_path(surface, curve.vertices);
    });
    attempt(bytes.size(), [&] { app::read_vertex_list(file.path()); });
    attempt(bytes.size(), [&] {
        FlowOptions options;
        app::parse_target(file.path(), options);
    });
    const std::string text = text_of(bytes.first(std::min<std::size_t>(bytes.size(), 256)));
    attempt(bytes.size(), [&] { app::parse_cone(text); });
    attempt(bytes.size(), [&] { app::parse_curvature(text); });
    attempt(bytes.size(), [&] { app::parse_bytes(text); });
    attempt(bytes.size(), [&] { parse_repair(text); });
    attempt(bytes.size(), [&] { app::parse_keep(text); });
    attempt(bytes.size(), [&] { app::parse_shard(text); });
}

}  // namespace ricci::fuzz
