// Mesh input: files become validated surfaces, or errors that name file, element and defect.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "kernels/surface_mesh.h"

namespace ricci {

/// A file that cannot be read at all (missing, permission, damaged or truncated gzip): exit status 3 if it is
/// the only input.
class FileError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A defect, or a note, about one element of an input.
struct Defect {
    std::string code;         // stable identifier, snake_case; docs/mesh_input.md lists them all
    std::string element;      // "vertex", "edge", "face", "line", "file"
    std::int64_t index = -1;  // zero-based element number in the input's numbering (lines from 1); -1: none,
                              // or a summary "and N more". Edges have no numbers in files: as in
                              // Connectivity, by lowest halfedge; the message names the two vertices.
    std::string message;      // a sentence for the user: what, where, and which --repair flag helps
};

/// The changes a user may ask for with --repair; nothing of this happens unasked.
struct RepairOptions {
    bool orient = false;           // flip faces so that each orientable component is consistently oriented
    bool weld = false;             // merge vertices with bitwise equal coordinates (-0 = 0)
    bool drop_degenerate = false;  // drop faces with fewer than three different vertices; remove faces of
                                   // zero area without changing the surface (see docs/mesh_input.md)
};
/// Parses "orient,weld,drop-degenerate" (any of them, any order; empty: none). Throws std::invalid_argument
/// naming the unknown word.
RepairOptions parse_repair(const std::string& text);

/// What `ricci info` prints: counts (unset where unknown), quality, notes, defects. Counts are of the
/// triangulated input (after repair) over all components, unused vertices left out. boundaries and genus are
/// set for manifolds only, genus for orientable ones only; everything is unset where the file could not be
/// parsed.
struct MeshReport {
    std::string file;
    std::optional<Index> vertices, edges, faces, components, boundaries, genus, euler_characteristic;
    std::optional<bool> manifold, oriented;
    std::optional<double> min_angle_deg, obtuse_fraction;  // obtuse: an angle above 90 degrees by more than
                                                           // 1e-8 degrees
    std::vector<Defect> notes, errors;
};

/// One input file after validation. `components` is empty exactly when `report.errors` is not.
struct LoadedMesh {
    MeshReport report;
    std::string stem;                // file name without folder, .gz and format suffix
    std::uint64_t content_hash = 0;  // XXH3-64 of the file's bytes as stored
    // Ordered by lowest vertex. A single component keeps the input's vertex numbers (unused vertices
    // included); several ones are compacted in ascending order, with input_vertex telling the input's
    // numbers.
    std::vector<SurfaceMesh> components;
};

/// Reads and validates OBJ, OFF, PLY (ASCII, binary), STL (ASCII, binary), each also .gz, and intrinsic .len.
/// Throws FileError when the file cannot be read; every defect of the contents is reported, not thrown.
LoadedMesh load_mesh(const std::string& path, const RepairOptions& repair = {});

/// The same for the bytes of a file in memory; the suffix of `path` tells the format. Throws FileError for
/// gzip data that cannot be unpacked.
LoadedMesh load_mesh_bytes(const std::string& path, std::string bytes, const RepairOptions& repair = {});

/// The same for elements in memory: what load_mesh says of a file with these points and triangles, whose stem
/// is `name`. content_hash is XXH3-64 of the bytes of the points followed by those of the triangles. Corners
/// may name vertices that there are not: that is reported.
LoadedMesh check_mesh(const std::string& name, std::span<const Point> points,
                      std::span<const Triangle> triangles, const RepairOptions& repair = {});
/// The hash alone.
std::uint64_t mesh_hash(std::span<const Point> points, std::span<const Triangle> triangles);

/// How many bytes a .gz may unpack to, for this process; 0: the default, the larger of 64 MiB and 200 times
/// its packed size. At most 16 GiB either way. Real meshes stay far below (bench figures in
/// docs/reliability/hostile_input.md); a few bytes that would fill the memory do not. Thread-safe.
void set_max_unpacked(std::uint64_t bytes);
/// What was set; 0: the default.
std::uint64_t max_unpacked_set();

/// Writes points and triangles as OFF, OBJ or PLY (by suffix), or an intrinsic surface as .len; shortest
/// round-trip decimals. Throws FileError.
void save_mesh(const std::string& path, const SurfaceMesh& mesh);

}  // namespace ricci
