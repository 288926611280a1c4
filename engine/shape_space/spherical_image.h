// A surface of genus 0 on the unit sphere, normalised by a Moebius map: where its vertices lie, and how its
// faces and edges spread over the sphere.
#pragma once

#include <array>
#include <vector>

#include "engine/flow/flow.h"

namespace ricci {

/// The discrete conformal map between vertices: a point with barycentric coordinates b in a face of the
/// surface goes to the direction of sum b_i scale_i position_i. On faces of the final triangulation that are
/// faces of the surface this is the projective map that takes circumcircle to circumcircle; everywhere it is
/// continuous, and within second order of the common refinement's.
struct SphericalImage {
    std::vector<Point> position;  // V, on the unit sphere; 0 for unused vertices
    std::vector<double> scale;    // V, length on the surface (in its own units) over length on the sphere
    // The map is made where the vertices, with a third of the faces around them each, are in balance, and
    // then moved with all its points: a boost does not commute with it where faces are wide.
    std::vector<Point> corner;       // V, scale times position in that place
    std::array<double, 16> boost{};  // from there, on (x, y, z, 1), row by row
    bool hemisphere = false;         // a disk: z >= 0, its boundary on the equator
    double imbalance = 0.0;      // distance of the centre of area from the sphere's centre (a disk: from the
                                 // axis; its double's centre is meant)
    double closing_error = 0.0;  // largest distance between positions of a vertex as seen from its faces
    double equator_error = 0.0;  // a disk: largest |z| of a boundary vertex
};

/// Lays out the final triangulation, straightens a disk, and applies the Moebius map (for a disk one that
/// keeps the half sphere) after which the area of the surface, spread over the sphere by the map above, has
/// its centre in the centre: unique up to rotations (of a disk: about the axis), the conformal barycentre of
/// Douady, Earle 1986. Newton's method in the boosts of the light cone. Where no vertex has half of the area,
/// imbalance ends below 1e-12. Throws std::invalid_argument unless the flow is a converged spherical one of a
/// closed surface of genus 0 or, through the double, a disk.
SphericalImage make_spherical_image(const SurfaceMesh& mesh, const FlowResult& flow);

/// A point of the sphere that stands for a bit of the surface.
struct SphereSample {
    Point position;
    double weight = 0.0;
};

/// Area of the surface over the sphere (units of the input squared): a rule of second degree on every face,
/// cut until a triangle is no wider than 0.1 on the sphere or its width times its share of the area is below
/// 1e-7.
std::vector<SphereSample> area_samples(const SurfaceMesh& mesh, const SphericalImage& image);

/// Integrated mean curvature of an embedded surface over the sphere (units of the input): per inner edge,
/// half of the exterior dihedral angle per length (Steiner), convex positive where the faces are oriented
/// outwards; Gauss's rule on pieces no longer than 0.1 on the sphere. Half of an edge belongs to either end.
/// As a boundary vertex misses edges on one side, a third of the faces around it gets the density of its
/// inner neighbours instead: so the sum is right to second order there too. Throws std::invalid_argument for
/// an intrinsic surface.
std::vector<SphereSample> mean_curvature_samples(const SurfaceMesh& mesh, const SphericalImage& image);

}  // namespace ricci
