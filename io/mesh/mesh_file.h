// Mesh input: files become validated surfaces, or errors that name file, element and defect.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "kernels/surface_mesh.h"

namespace ricci {

/// A file that cannot be read at all (missing, permission, truncated gzip, …): exit status 3 if it is the only input.
class FileError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A defect, or a note, about one element of an input.
struct Defect {
    std::string code;         // stable identifier, snake_case: non_manifold_edge, unoriented, zero_area_face, …
    std::string element;      // "vertex", "edge", "face", "line", "file", "component"
    std::int64_t index = -1;  // zero-based element number in the input's numbering (line numbers from 1); -1: none
    std::string message;      // a sentence for the user: what, where, and which --repair flag helps
};

/// The changes a user may ask for with --repair; nothing of this happens unasked.
struct RepairOptions {
    bool orient = false;           // flip faces so that each orientable component is consistently oriented
    bool weld = false;             // merge vertices with bitwise equal coordinates (-0 = 0)
    bool drop_degenerate = false;  // drop faces of zero area (after welding: faces with repeated vertices)
};
/// Parses "orient,weld,drop-degenerate". Throws std::invalid_argument naming the unknown word.
RepairOptions parse_repair(const std::string& text);

/// What `ricci info` prints: counts (unset where unknown), quality, notes, defects. Counts are of the triangulated
/// input over all components, unused vertices left out.
struct MeshReport {
    std::string file;
    std::optional<Index> vertices, edges, faces, components, boundaries, genus, euler_characteristic;
    std::optional<bool> manifold, oriented;
    std::optional<double> min_angle_deg, obtuse_fraction;  // obtuse_fraction: faces with an angle above 90 degrees
    std::vector<Defect> notes, errors;
};

/// One input file after validation. `components` is empty exactly when `report.errors` is not.
struct LoadedMesh {
    MeshReport report;
    std::string stem;                     // file name without folder, .gz and format suffix
    std::uint64_t content_hash = 0;       // XXH3-64 of the file's bytes as stored
    std::vector<SurfaceMesh> components;  // ordered by lowest vertex. A single component keeps the input's vertex
                                          // numbers (unused vertices included); several ones are compacted in
                                          // ascending order, with input_vertex telling the input's numbers.
};

/// Reads and validates OBJ, OFF, PLY (ASCII, binary), STL (ASCII, binary), each also .gz, and intrinsic .len.
/// Throws FileError when the file cannot be read; every defect of the contents is reported, not thrown.
LoadedMesh load_mesh(const std::string& path, const RepairOptions& repair = {});

/// Writes points and triangles as OFF, OBJ or PLY (by suffix), or an intrinsic surface as .len; shortest
/// round-trip decimals. Throws FileError.
void save_mesh(const std::string& path, const SurfaceMesh& mesh);

}  // namespace ricci
