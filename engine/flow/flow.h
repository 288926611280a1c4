// One solve, from an input surface to its metric of prescribed curvature.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/flow/newton.h"
#include "engine/flow/precision.h"

namespace ricci {

enum class Method : std::uint8_t { newton, gradient };
std::string_view name_of(Method method);

/// flat: 0 everywhere; uniform: 2 pi chi / V (Euclidean, closed) or 0 (other geometries: the constant
/// curvature is the background's); boundary: interior 0, 2 pi chi / B on each of B boundary vertices; values:
/// given.
enum class TargetKind : std::uint8_t { flat, uniform, boundary, values };

/// How a closed sphere or a disk with geodesic boundary gets its spherical metric. robust: through the plane
/// (engine/sphere/solve_sphere.h), for Newton and vertex scaling without cones or targets; everything else,
/// and direct: Newton or gradient descent on the spherical energy, which is not convex (thesis section 7.1).
enum class SphereRoute : std::uint8_t { robust, direct };
std::string_view name_of(SphereRoute route);

/// A prescribed cone: curvature of one vertex, replacing the target's.
struct Cone {
    Index vertex = 0;
    double curvature = 0.0;  // radians
};

struct FlowOptions {
    std::optional<Geometry> geometry;  // unset: auto (hyperbolic chi < 0, Euclidean chi = 0, spherical closed
                                       // genus 0 and disks; Euclidean whenever a target or cone is given)
    Scheme scheme = Scheme::vertex_scaling;
    Method method = Method::newton;
    std::optional<TargetKind> target;
    std::vector<double> target_values;  // V, for TargetKind::values
    std::vector<Cone> cones;
    std::optional<Boundary>
        boundary;  // unset: curvature when the target speaks of the boundary, else geodesic
    SphereRoute sphere_route = SphereRoute::robust;
    bool delaunay = true;
    double tolerance = 1e-10;
    Precision precision = Precision::automatic;  // vertex scaling
    /// More digits are asked for where the rounding of lengths may change the residual by more. 0: a tenth of
    /// the tolerance.
    double tolerated_rounding = 0.0;
    std::int32_t max_iterations = 0;  // 0: 500 (Newton), 100000 (gradient)
    bool parallel = true;             // faces in parallel
    std::function<std::optional<Status>()> interrupted;
    std::function<void(const IterationLog&)> progress;
};

struct FlowResult {
    Geometry geometry = Geometry::euclidean;
    Boundary boundary = Boundary::geodesic;
    SolveOutcome outcome;
    std::string message;              // why, where the status is not converged; notes otherwise
    int precision_digits = 16;        // decimal digits of the lengths in which the residual was measured: 16
                                      // (double), 19 (long double) or 50
    double gauss_bonnet_error = 0.0;  // |sum K + kappa A - 2 pi chi|
    double area = 0.0;
    std::vector<double> conformal_factor;  // V; 0 for unused vertices. By the robust route to the sphere the
                                           // centre of the vertices, weighted by area, is the sphere's
    /// V: the factor is the unevaluated sum conformal_factor + conformal_factor_low; empty where the double
    /// alone has the residual.
    std::vector<double> conformal_factor_low;
    std::vector<double> target_curvature;  // V
    std::vector<double> curvature;         // V
    std::optional<CirclePacking> packing;  // circle packings: how far the initial metric was off
    bool doubled = false;
    Connectivity triangulation;       // final one (of the double where doubled)
    std::vector<double> edge_length;  // 3F' in the background geometry
};

/// How far a metric is to be trusted: part of every result made from one.
struct MetricAccuracy {
    double residual_max = 0.0, gauss_bonnet_error = 0.0;
    int precision_digits = 16;  // of the arithmetic in which both were measured
};
MetricAccuracy accuracy_of(const FlowResult& result);

Geometry resolve_geometry(const FlowOptions& options, const Topology& topology);

/// Solves. Throws std::invalid_argument for options that do not fit the surface (cone at a vertex that does
/// not exist, target of the wrong length, …); every numerical outcome is a status.
FlowResult solve_flow(const SurfaceMesh& mesh, const FlowOptions& options);

}  // namespace ricci
