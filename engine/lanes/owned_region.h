// The faces of one lane that the passes over all lanes leave to it: those around its cone, and those that
// flips have changed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/lanes/lane_surface.h"

namespace ricci {

/// A small triangulation of its own, cut out of the start triangulation, in which edges flip and around whose
/// cone Newton's method runs with everything else held (a nonlinear Schwarz step).
///
/// Invariants: a face of the start triangulation has the lane's bit in `owned` iff its part of the surface
/// belongs to the region; vertices 0 … patch-1 are those that relax() moves, the outermost ring first and the
/// cone last, and all faces around them belong to the region; a side without twin is an edge of the start
/// triangulation, whose halfedge inside the region is kept in `start_halfedge_`.
class OwnedRegion {
  public:
    /// `owned`: F, shared by the lanes of a block.
    OwnedRegion(const LaneSurface& surface, int lane, std::vector<LaneMask>& owned);

    /// Cuts out the faces around the vertices within `rings` rings of `cone` (a row), whose target curvature
    /// there is `curvature` more than the surface's.
    void start(Index cone, double curvature, int rings);
    /// Gives all faces back.
    void clear();

    /// Takes u of the region's vertices from the rows.
    void load(const LaneArray<double>& u, const LaneArray<double>& shrink);
    /// Adds both faces of an edge of LaneEdges, for make_delaunay().
    void take_edge(Index edge, const LaneArray<double>& shrink);
    /// Flips edges of the region and on its rim until all are Delaunay, taking in neighbouring faces where an
    /// edge on the rim is not. Returns false if the flips did not end.
    bool make_delaunay(const LaneArray<double>& shrink);
    /// Newton's method on the patch with everything else held, until its residual is at most `goal` or there
    /// is no way down; `flips`: edges around the patch flip on the way. Uses the last factor while it serves.
    /// False: the region's faces are no triangles any more, or numbers not finite.
    bool relax(double goal, bool flips, const LaneArray<double>& shrink);
    /// The same from the linear prediction of u, which falls without bound towards the cone: from a blunted
    /// one, the innermost rings first.
    bool relax_first(const LaneArray<double>& shrink);
    /// Writes u of the patch to the rows; adds what has changed since load() to `step`.
    void store(LaneArray<double>& u, LaneArray<double>& shrink, LaneArray<float>& step) const;
    /// Adds to `residual`, at the region's rows, the angles of its faces less the same faces' at u = 0, and
    /// the cone's curvature over side.
    bool add_residual(LaneArray<double>& residual);

    [[nodiscard]] std::int64_t flips() const { return flips_; }
    [[nodiscard]] Index face_count() const { return static_cast<Index>(tail_.size() / 3); }
    /// More has been done on the patch than a solve is worth; nothing moves any more.
    [[nodiscard]] bool exhausted() const;
    [[nodiscard]] int newton_steps() const { return newton_steps_; }

  private:
    Index vertex_of_row(Index row, const LaneArray<double>* shrink);
    void add_face(Index face, const LaneArray<double>* shrink);
    void flip(Index h);
    bool flip_stack(const LaneArray<double>& shrink, std::int64_t most);
    bool make_core_delaunay(Index first, const LaneArray<double>& shrink);
    [[nodiscard]] bool edge_fails(Index h, const LaneArray<double>& shrink) const;
    bool relax_from(Index first, double goal, bool flips, const LaneArray<double>& shrink);
    bool settle(Index first, bool flips, const LaneArray<double>& shrink);
    bool try_step(Index first, double length, double& largest, bool flips, const LaneArray<double>& shrink);
    void blunt(int rings);
    void find_core(Index first);
    bool evaluate(std::span<const Index> faces);
    bool evaluate_thin(std::size_t h);
    double patch_residual(Index first);
    bool factorize(Index first);

    const LaneSurface* surface_;
    int lane_;
    std::vector<LaneMask>* owned_;
    std::vector<Index> taken_;  // faces of the start triangulation

    // Triangulation, as Connectivity. chord_: at u = 0.
    std::vector<Index> tail_, twin_, start_halfedge_;
    std::vector<double> chord_;
    std::vector<Index> local_halfedge_;  // 3F of the start triangulation: side of the rim, or -1
    // Vertices.
    std::vector<Index> row_;
    std::vector<double> u_, loaded_u_, shrink_;
    std::vector<double> start_angle_;  // sum over the region's faces at u = 0
    std::vector<Index> local_vertex_;  // rows: vertex of the region, or -1
    Index patch_ = 0, cone_row_ = -1;
    std::vector<Index> ring_begin_;  // first patch vertex of the rings up to a distance: [d] for d rings
    double cone_curvature_ = 0.0;    // over side, as all residuals here

    // Faces around the patch, and what evaluate() says of faces.
    std::vector<Index> core_, rest_;
    std::vector<std::uint8_t> in_core_;
    bool core_stale_ = true;   // core_ and rest_ are out of date
    bool core_fresh_ = false;  // angle_ and cot_ of core_ are up to date
    Index core_first_ = 0;
    std::vector<double> angle_, cot_;  // 3F
    std::vector<double> angle_sum_;    // per vertex

    // Scratch.
    std::vector<Index> stack_, queue_;
    std::vector<double> direction_, residual_, before_u_;
    std::vector<Index> skyline_first_, skyline_begin_;
    std::vector<double> skyline_;
    std::int64_t flips_ = 0;
    int newton_steps_ = 0;
    std::int64_t work_ = 0;    // faces evaluated around the patch
    Index factor_first_ = -1;  // the factor is of the patch from here on
};

}  // namespace ricci
