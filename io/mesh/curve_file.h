// Closed curves on a mesh that users give as lists of vertices.
#pragma once

#include <string>
#include <vector>

#include "kernels/connectivity.h"

namespace ricci {

/// One line of a curve file.
struct VertexCurve {
    std::string name;
    std::vector<Index> vertices;  // zero-based; the last is joined to the first
    std::int64_t line = 0;        // where it stands in the file, from 1
};

/// Reads a text file with one closed curve per line: `NAME v0 v1 v2 ...`. Vertices are zero-based,
/// consecutive ones joined by an edge, the last to the first; whether the mesh has these edges is not checked
/// here (closed_path). '#' starts a comment, empty lines are skipped. Throws FileError, naming the file, the
/// line and the word: what is not an integer, negative vertices, lines without vertices, names that occur
/// twice, files without a curve or that cannot be read.
std::vector<VertexCurve> read_curves(const std::string& path);

}  // namespace ricci
