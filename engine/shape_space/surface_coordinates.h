// Coordinates of any surface in its shape space, with the curves that they are lengths of.
#pragma once

#include <optional>
#include <string>

#include "engine/shape_space/surface_curve.h"
#include "engine/shape_space/teichmuller.h"
#include "engine/structure/surface_structure.h"

namespace ricci {

/// A closed edge path of the input with a name.
struct NamedPath {
    std::string name;
    EdgePath path;
};

struct SurfaceCoordinateOptions {
    FlowOptions flow;
    MarkingOptions marking;
    std::vector<NamedPath>
        marking_curves;               // their geodesics' lengths are the coordinates, instead of the rule's
    std::vector<NamedPath> loops;     // further ones whose class and length are asked for
    bool words = true, draw = false;  // of the coordinates' curves
};

/// A curve: the geodesic in its class.
struct CoordinateCurve {
    std::string name;
    double length = 0.0;  // 0: none (a point, or a cusp-like class that double does not resolve)
    std::string word;     // in the canonical generators
    SurfaceCurve curve;   // empty where not asked for
};

struct SurfaceCoordinates {
    Index genus = 0, boundaries = 0;
    Geometry geometry = Geometry::hyperbolic;
    Status status = Status::converged;
    MetricAccuracy accuracy;
    std::string message;
    std::vector<double> coordinates;
    std::vector<std::string> names;
    std::string marking;  // "geometric" (marking.h), "curves" (given), "none" needed
    // chi < 0:
    std::vector<CoordinateCurve> curves;  // one per coordinate
    std::vector<MarkingChoice> choices;
    double smallest_gap = 1.0;
    std::vector<FenchelNielsen> pants;
    std::optional<std::array<double, 3>>
        seams;  // pants: of the right-angled hexagon, seams[k] opposite coordinate k
    // Torus: modulus, length ratio and angle (lattice.h). Annulus: modulus.
    double modulus_re = 0.0, modulus_im = 0.0, length_ratio = 0.0, angle = 0.0, modulus = 0.0;
    std::vector<CoordinateCurve> loops;
    SurfaceStructure structure;  // where words, curves or loops were asked for, and for chi = 0
};

/// chi < 0: TeichmullerCoordinates; torus: (Re, Im) of the modulus; annulus: the modulus; sphere, disk: the
/// values of sphere_descriptor.h. `mesh` must outlive the result. Throws std::invalid_argument for curves on
/// a sphere or disk, and marking curves where chi >= 0.
SurfaceCoordinates make_surface_coordinates(const SurfaceMesh& mesh, const SurfaceCoordinateOptions& options);

}  // namespace ricci
