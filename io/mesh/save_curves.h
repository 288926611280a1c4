// Curves in space as files for viewers.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kernels/surface_mesh.h"

namespace ricci {

/// A polyline; closed where the last point is the first.
struct NamedCurve {
    std::string name;
    double length = 0.0;  // a number kept with it; not measured here
    std::vector<Point> points;
};

/// Throws FileError for a suffix that save_curves does not know.
void require_curve_file(const std::string& path);

/// Writes curves by suffix, coordinates as shortest round-trip decimals:
///   .obj  `v` and one `l` element per curve, each an object of its name (blanks become '_');
///   .vtk  legacy VTK, POLYDATA with one line per curve and the cell data `curve` (number), `length`, `name`;
///   .vtp  the same as VTK XML.
/// A closed curve uses its first point again. Throws std::invalid_argument for curves of fewer than two
/// points or with numbers that are not finite, FileError for another suffix and where writing fails.
void save_curves(const std::string& path, std::span<const NamedCurve> curves);

}  // namespace ricci
