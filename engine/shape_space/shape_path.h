// A sequence of meshes as a curve in shape space: deformation paths (thesis, section 6.3.2, Figure 35).
#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/shape_space/carried_marking.h"
#include "engine/shape_space/shape_descriptor.h"

namespace ricci {

/// Where the marking of a frame comes from. none: its coordinates need none (annulus, sphere, disk). own:
/// chosen on the frame by the rule of marking.h (a torus: by its reduced basis, or the one that keeps the
/// modulus nearest to that of the frame before). carried: the curves of an earlier frame with the same
/// triangles, so that coordinates are continuous along the deformation, also where the rule would turn to
/// other curves.
enum class MarkingSource : std::uint8_t { none, own, carried };
std::string_view name_of(MarkingSource source);

struct PathFrame {
    Index genus = 0, boundaries = 0;
    Status status = Status::converged;
    std::string message;  // why, where not converged; notes otherwise
    // Of equal names for all frames. chi < 0: lengths (teichmuller.h); torus: the modulus "modulus_re",
    // "modulus_im", followed in the upper half plane and so not always reduced; annulus, sphere, disk: as
    // describe_shape.
    std::vector<double> coordinates;
    std::vector<std::string> names;
    std::vector<double> fingerprint;  // as describe_shape
    MarkingSource marking = MarkingSource::none;
    Index marking_number = -1;  // frames of one number are measured along the same curves; -1: no marking
    // Smallest gap of the rule's choices on this frame: small where it may turn to others.
    double marking_gap = 0.0;
    double marking_spread = 0.0;  // relative: own: how far the curves drawn on the mesh differ from those of
                                  // the rule; carried: PathLength::spread
    // From the last frame of the sequence that converged; NaN for failures, 0 for the first. `step`:
    // Euclidean between coordinates; torus, annulus: Teichmueller distance. `free_step`, without marking:
    // Euclidean between fingerprints; torus: Teichmueller distance over all markings.
    double step = 0.0, free_step = 0.0;
    double length = 0.0;  // sum of steps so far
};

/// A frame that could not be described: all its numbers are NaN, its lists empty.
PathFrame failed_frame(Status status, const std::string& message);

/// Follows sequences of frames that are handed over one by one, all of the topological type of the first that
/// converged. Curves are kept for every connectivity that was met, so sequences that share their triangles
/// share their marking too.
class ShapePath {
  public:
    explicit ShapePath(const ShapeOptions& options) : options_(options) {}

    /// Distances begin anew; a torus is followed from the first of all frames.
    void begin_sequence();
    /// Of the flow of frames to come.
    void set_interruption(std::function<std::optional<Status>()> interrupted) {
        options_.flow.interrupted = std::move(interrupted);
    }
    /// Whatever goes wrong is the frame's status and message.
    PathFrame add(const SurfaceMesh& mesh);

  private:
    struct TorusBasis {
        EdgePath first, second;
    };
    struct KnownMarking {
        Index number = 0;
        Connectivity connectivity;
        DrawnMarking curves;
        TorusBasis basis;
    };
    void describe(const SurfaceMesh& mesh, PathFrame& frame);
    void describe_hyperbolic(const SurfaceMesh& mesh, PathFrame& frame);
    void describe_own_marking(const SurfaceMesh& mesh, const SurfaceStructure& structure,
                              const CoarseSurface& coarse, PathFrame& frame);
    void describe_torus(const SurfaceMesh& mesh, PathFrame& frame);
    void measure_step(PathFrame& frame);
    [[nodiscard]] const KnownMarking* known(const Connectivity& connectivity) const;

    ShapeOptions options_;
    std::optional<std::pair<Index, Index>> type_;  // genus, boundaries
    std::vector<KnownMarking> markings_;
    Index next_number_ = 0;
    std::optional<std::complex<double>> first_modulus_, modulus_;  // modulus_: of the frame before
    std::optional<PathFrame> last_;
};

}  // namespace ricci
