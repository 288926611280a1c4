// The deck transformation group of a surface with a uniformized metric: one isometry per canonical generator.
#pragma once

#include <string>
#include <vector>

#include "engine/layout/transport.h"
#include "engine/topology/canonical_basis.h"

namespace ricci {

struct PolishedScales;  // polished_scales.h

/// A generator: its name ("a1", "b1", ..., "c1" for boundaries, "p1" for cones), the word in the letters of
/// the homotopy basis, and the isometry in the frame at the base.
struct GroupGenerator {
    std::string name;
    Word word;
    Isometry<double> element;
};

/// Fuchsian group, lattice of translations, or group of rigid motions. [a1,b1] ... [ag,bg] c_1 ... c_n = 1.
struct SurfaceGroup {
    int kappa = 0;
    std::vector<GroupGenerator> generators;
    std::vector<Isometry<double>> letters;  // of the homotopy basis, rounded
    double relator_error =
        0.0;          // largest entry of the product above, less +-identity, in SU(1,1) / E(2) at the base
    int digits = 16;  // of the arithmetic that the error was measured in (16: double)
    double metric_residual = 0.0;  // max |K| of the metric used, where it was solved anew; else 0
    double reach = 0.0;            // log10 of the largest |a|^2 + |b|^2 met while multiplying
};

struct GroupOptions {
    double goal = 1e-10;  // on the relator error: more digits are taken until it is met
    int max_digits = 800;
    PolishedScales* scales = nullptr;  // starts from these and leaves what was solved, for the layout
};

/// `input`: connectivity of the mesh that `refinement` and `basis` were made of. Where double does not reach
/// the goal on a hyperbolic surface, the metric is solved and multiplied anew with 50, 150, 500 and 1500
/// digits, as far as needed.
SurfaceGroup make_surface_group(int kappa, const CommonRefinement& refinement, const Connectivity& input,
                                const HomotopyBasis& basis, const CanonicalBasis& canonical,
                                const GroupOptions& options = {});

/// Matrices, row by row: SL(2,R) of the upper half plane (w = i (1 + z) / (1 - z)); rigid motion of
/// homogeneous (x, y, 1).
std::array<double, 4> half_plane_matrix(const Isometry<double>& element);
std::array<double, 9> plane_matrix(const Isometry<double>& element);
/// SO(2,1), on (x, y, t) of the hyperboloid: the projective transformation of the Klein disk (thesis,
/// section 6.2.4). SO(3) for kappa = 1.
std::array<double, 9> projective_matrix(int kappa, const Isometry<double>& element);

}  // namespace ricci
