// Shape descriptors of closed surfaces of genus 0 and of disks: conformal factor and mean curvature on the
// sphere, in numbers that no rotation changes.
#pragma once

#include <string>
#include <vector>

#include "engine/flow/flow.h"
#include "engine/shape_space/spherical_image.h"

namespace ricci {

struct SphereDescriptorOptions {
    int max_degree = 0;  // of the spherical harmonics; 0: kSphereDegree, kDiskDegree
};
inline constexpr int kSphereDegree = 12, kDiskDegree = 8;

/// All such surfaces are conformally equivalent; what tells them apart is the conformal factor and, up to a
/// rigid motion, the mean curvature (thesis 6.3.2; Gu, Wang, Chan, Thompson, Yau 2004). After the Moebius
/// normalisation of spherical_image.h, which leaves rotations only, three fields are expanded in spherical
/// harmonics Y_lm; A is the area of the surface:
///   area            the area measure: integral of Y_lm dA / A, times sqrt(4 pi / (2l + 1)). The squared norm
///                   of degree l is then the mean of P_l(cos) of the angle between two random points of the
///                   surface: in [0, 1]; degrees 0 and 1 are 1 and 0 and left out;
///   factor          log of the conformal factor, scaled to A = 4 pi: log(length / length on the sphere) =
///                   sum lambda_lm Y_lm, over sqrt(4 pi): the norm of degree l is its root mean square over
///                   the sphere. As K dA = (1 - Laplacian(factor)) dOmega, lambda_lm = sum K_v Y_lm(v) / (l
///                   (l + 1)) for l >= 1, K_v the angle defects of the surface: exact, without differences;
///   mean_curvature  integral of Y_lm H dA, H the mean of the principal curvatures, by dihedral angles
///                   (Steiner), over sqrt(A), times sqrt(4 pi / (2l + 1)) / sqrt(4 pi): a round sphere has 1
///                   at l = 0. Convex is positive: closed surfaces are turned outwards by their volume, the
///                   sign on a disk is as the faces are oriented.
/// A disk stands for its double: harmonics with l + m even. Area, factor and mean curvature of both halves
/// count, the fold between them for the factor alone (as geodesic curvature of the boundary).
///
/// Values: per block the norm of each field, "area_3", and of each pair's sum over sqrt(2),
/// "area+factor_3": as good as the cross spectrum, but Lipschitz in the fields. A block is a degree l
/// ("_3"), on disks the two harmonics of one l and |m| ("_3_1"); a single coefficient keeps its sign and has
/// no sums. Nothing changes under rotation, scaling, relabelling, or by reflection: mirror images are the
/// same. Numbers are of the order of 1, of equal weight in a Euclidean distance.
///
/// Mesh independent to second order in the edge length on the sphere. Measured on sample files, Euclidean per
/// degree, closed surfaces: vertices moved at random by 0.1 % of the diagonal change a degree by 0.005
/// (median; at most 0.05), decimation to 2,000 faces by 0.02 (0.4), degrees 0 to 12 much alike; different
/// shapes differ by 0.6 to 1.3 in every degree but 1 (0.2) and 3 (0.5). Disks, degrees 0 to 8: 0.01 (0.18),
/// 0.01 (0.05), and 1.2 to 1.8 in even degrees, 0.2 to 0.3 in odd ones. Noise adds to mean_curvature where it
/// exceeds the edges: then edges fold.
struct SphereDescriptor {
    std::vector<double> values;
    std::vector<std::string> names;  // as many, equal for equal topological type, degree and `embedded`
    bool embedded = true;            // false: intrinsic surface, without mean curvature
    double imbalance = 0.0;          // see SphericalImage
    std::string message;             // what is missing or doubtful; empty: nothing
};

/// Describes a surface from its spherical flow: what solve_flow or make_surface_structure (`.flow`) found.
/// Throws std::invalid_argument as make_spherical_image does, and for a degree that is negative or above 100.
SphereDescriptor make_sphere_descriptor(const SurfaceMesh& mesh, const FlowResult& flow,
                                        const SphereDescriptorOptions& options = {});

}  // namespace ricci
