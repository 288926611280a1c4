// A sphere with one vertex sent to infinity, made flat: the planar half of discrete uniformisation.
#pragma once

#include <span>
#include <vector>

#include "engine/flow/newton.h"

namespace ricci {

/// The faces of a closed genus-0 surface that do not touch the vertex at infinity, scaled so that they become
/// a convex polygon of the plane (Rivin's ideal polyhedron in the upper half-space; Springborn 2019, Ideal
/// hyperbolic polyhedra and discrete uniformization, section 3).
///
/// An edge from vertex i to infinity has the chord lambda_i e^{u_i/2} times a constant. The energy of the
/// Euclidean flow is minimised under u_i >= -2 log lambda_i, lambda_i the shortest such chord: the rim, where
/// equality holds, is the convex hull, and every other vertex is flat. With that scaling each vertex of the
/// rim has distance 1 from infinity, so Ptolemy's relation for the edges there needs no chords of their own:
///
///         k              k comes to the rim when its chord (jk + ki)/ij falls to 1: when the triangle over
///       /   \            the rim edge ij breaks. Then the face goes and jk, ki are rim edges.
///      i --- j           k leaves the rim when its angle exceeds pi: the face comes back with ij = jk + ki.
///     (infinity)
class PuncturedPlane {
  public:
    /// `infinity`: a vertex of the surface's triangulation (on the mirror, for a double) with a star that is
    /// a disk: see embedded_star. `surface` must outlive this.
    PuncturedPlane(const FlowSurface& surface, Index infinity, bool parallel);

    /// Newton's method with an active set. Converged: every vertex off the rim has |K| <= tolerance, or as
    /// little as long double reaches but below `floor`; no angle of the rim exceeds pi by more than
    /// kReflexAngle.
    SolveOutcome flatten(const SolveOptions& options, double floor);

    /// All faces but those at infinity, Delaunay, with the lengths of the flat metric.
    [[nodiscard]] const IntrinsicTriangulation<long double>& triangulation() const { return disk_; }
    /// Planar conformal factor. // V, of the input's vertices; 0 at infinity, where chords from the rim are 1
    [[nodiscard]] std::span<const long double> factor() const { return u_; }
    /// Edges of the rim: the valence of the vertex at infinity.
    [[nodiscard]] Index rim_size() const { return rim_size_; }

    /// A rim angle above pi by less changes curvatures by its square only, the energy being C^2 across flips.
    static constexpr double kReflexAngle = 1e-7;

  private:
    void scale(std::span<const long double> change);
    void start_factor(Index infinity);
    void find_rim();
    bool admit();
    bool release();
    void remove_faces(const std::vector<std::uint8_t>& gone);
    void add_face_at(Index vertex);
    double evaluate(const IntrinsicTriangulation<long double>& disk, std::span<const double> u,
                    bool derivatives);
    bool find_direction(SolveOutcome& outcome);
    double line_search(double residual);

    const FlowSurface* surface_;
    bool parallel_;
    IntrinsicTriangulation<long double> disk_, trial_disk_;
    std::vector<long double> u_;           // V
    std::vector<std::uint8_t> on_rim_;     // per vertex of the triangulation
    std::vector<std::uint8_t> rim_orbit_;  // V: fixed
    Index rim_size_ = 0;
    std::int64_t flips_ = 0;
    std::vector<long double> angle_, total_;
    std::vector<double> curvature_;  // V, summed over the orbit's vertices off the rim
    std::vector<double> off_, diagonal_, direction_, trial_;
    std::vector<Index> unknown_;  // V
    Index unknown_count_ = 0;
    DelaunayWorkspace workspace_;
};

/// Whether the faces at a vertex form a disk with at least three different vertices around it.
bool embedded_star(const Connectivity& connectivity, Index vertex);

}  // namespace ricci
