// The surfaces that benchmarks run on: generated ones everywhere, real meshes where they are installed.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "engine/surfaces/generate.h"
#include "io/mesh/mesh_file.h"
#include "kernels/surface_mesh.h"

namespace ricci::bench {

inline std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// A generated surface of about `faces` faces, with vertices displaced so that its triangles differ; kept for
/// reuse.
inline const SurfaceMesh& generated(const std::string& name, Index faces, double jitter = 0.3) {
    static std::map<std::pair<std::string, Index>, SurfaceMesh> made;
    const auto key = std::make_pair(name, faces);
    const auto found = made.find(key);
    if (found != made.end()) return found->second;
    GenerateOptions options;
    options.faces = faces;
    options.jitter = jitter;
    options.seed = 1;
    return made.emplace(key, generate(name, options)).first->second;
}

/// Path of a sample mesh below $RICCI_DATA (else <source>/../shared/data), or nothing where it is not
/// installed.
inline std::optional<std::string> sample_path(const std::string& relative) {
    const char* named = std::getenv("RICCI_DATA");  // NOLINT(concurrency-mt-unsafe): one thread
    const std::filesystem::path folder =
        named != nullptr ? std::filesystem::path(named)
                         : std::filesystem::path(RICCI_SOURCE_DIR) / ".." / "shared" / "data";
    const std::filesystem::path path = folder / relative;
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return std::nullopt;
    return path.lexically_normal().string();
}

/// The only component of a mesh file. Throws std::runtime_error otherwise.
inline SurfaceMesh load_single(const std::string& path) {
    LoadedMesh loaded = load_mesh(path);
    if (loaded.components.size() != 1) throw std::runtime_error(path + ": not one sound component");
    return std::move(loaded.components.front());
}

}  // namespace ricci::bench
