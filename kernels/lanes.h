// Lanes: many singularities on one triangulation, solved side by side.
//
// Values lie [row][lane]: one row per vertex, kLanes numbers in it, one per singularity. A pass reads what
// all lanes share (indices, lengths) once and works on contiguous lanes. The width is fixed and every
// operation acts on each lane by itself, so that a lane's bits depend neither on its neighbours nor on its
// position.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/connectivity.h"

namespace ricci {

inline constexpr int kLanes = 16;

/// A set of lanes, bit l for lane l.
using LaneMask = std::uint16_t;

/// One row of lanes.
template <class T>
struct alignas(64) LaneRow {
    T lane[kLanes];
};

/// [row][lane]; 64-byte aligned by its element type.
template <class T>
using LaneArray = std::vector<LaneRow<T>>;

/// The triangulation that all lanes start from, as the passes want it. Everything is written relative to
/// u = 0: a face with corners 0, 1, 2 has squared chords square[k] opposite corner k, and in the metric u
/// they are, up to the common factor exp(u_0 + u_1 + u_2), square[k] exp(-u_k).
struct LaneFaces {
    std::vector<Index> row;      // 3F: the row of each corner; rows may repeat within a face
    std::vector<double> square;  // 3F: squared chord opposite the corner over four times the face's area:
                                 //     half the sum of the other two corners' cotangents
    std::vector<double> cot;     // 2F: cotangents at corners 0 and 1 at u = 0
    std::vector<double> angle;   // 3F, radians: the angles at u = 0
    std::vector<Index> corner;   // 3F: halfedge of the triangulation whose tail the corner is

    [[nodiscard]] Index face_count() const { return static_cast<Index>(row.size() / 3); }
};

/// Corners are rotated so that corner 2 has the angle nearest to a right one: its sine is the best
/// conditioned. `log_chord`: 3F (extended precision, u = 0); `row_of`: row per vertex of the connectivity.
/// Throws std::invalid_argument for a face that is no triangle at u = 0.
LaneFaces make_lane_faces(const Connectivity& connectivity, std::span<const long double> log_chord,
                          std::span<const Index> row_of);

/// The edges of the triangulation between two different faces, for the Delaunay test. Penner's simplicial
/// coordinate is linear in D = exp(-u): edge ij with opposite k and l has cos a + cos b >= 0 iff
///   square[0] D_i + square[1] D_j >= square[2] D_k + square[3] D_l.
struct LaneEdges {
    std::vector<Index> row;       // 4N: i, j (the ends), k, l (opposite, in face 0 and face 1)
    std::vector<double> square;   // 4N: jk/ki + jl/li, ki/jk + li/jl, ij^2/(jk ki), ij^2/(jl li): the squares
                                  //     of both faces, each over the product of its two other sides
    std::vector<Index> face;      // 2N
    std::vector<Index> halfedge;  // N: the one from i to j in face 0

    [[nodiscard]] Index edge_count() const { return static_cast<Index>(halfedge.size()); }
};

LaneEdges make_lane_edges(const Connectivity& connectivity, std::span<const long double> log_chord,
                          std::span<const Index> row_of);

/// shrink = exp(-u), row by row.
void lane_exponentials(const LaneArray<double>& u, LaneArray<double>& shrink);

/// Adds to `change` (rows), per lane, the change of the angle sum at each row against u = 0: the angles that
/// faces have in the metric u minus those at u = 0. Faces with the lane's bit in `owned` (F) are left out
/// for that lane. Absolute error of a corner a few units of 2^-53, for small changes relative to the change
/// (zero where shrink is constant on a face). `shrink` within e^-150 ... e^150.
/// Returns the lanes for which a face that is not left out is no triangle (its angles count as 0, 0, pi).
LaneMask add_angle_changes(const LaneFaces& faces, const LaneArray<double>& shrink,
                           std::span<const LaneMask> owned, LaneArray<double>& change);

/// An edge that is not Delaunay in some lanes.
struct LaneFlip {
    Index edge = 0;  // of LaneEdges
    LaneMask lanes = 0;
};

/// Edges that are not Delaunay, ascending; for each lane only edges neither of whose faces it owns. `flips`
/// is overwritten. The tolerance is 5e-13 of the left side of the inequality at LaneEdges: 1e-12 on sin(a+b)
/// at least, more where triangles are thin.
void find_lane_flips(const LaneEdges& edges, const LaneArray<double>& shrink, std::span<const LaneMask> owned,
                     std::vector<LaneFlip>& flips);

}  // namespace ricci
