// The common refinement (overlay) of an input surface and the triangulation that a flow ends with.
//
// Three triangulations of one surface: the input's; the isometric Delaunay one of the same flat metric,
// across which the input's edges are straight; and the final one, Delaunay in the metric of the solution,
// whose edges cross those of the second as geodesics of ideal hyperbolic triangles. In a face of the second
// both families of edges are straight segments, for the flat triangle with its circumscribed circle is
// Klein's model of the ideal one. They cut it into convex pieces, and on each the discrete conformal map is
// projective: the pieces are what may be mapped, textured and measured.
//
// Which segments cross is decided by the order of their ends alone, so the refinement is right whatever the
// rounding.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/flow/flow_surface.h"

namespace ricci {

/// Polygons by corners. Corner c of piece p, first[p] <= c < first[p+1], owns the side from its vertex to
/// that of the next corner of p (counterclockwise).
struct CommonRefinement {
    // The final triangulation (of the double where doubled), lengths as in IntrinsicTriangulation, u per its
    // vertex.
    IntrinsicTriangulation<long double> final_triangulation;
    std::vector<double> u;
    bool doubled = false;
    std::int64_t isometric_flips = 0, ptolemy_flips = 0;

    Index input_vertices = 0;   // V; vertices 0 ... V-1 are the input's, whether used or not; then crossings
    Index vertex_count = 0;     // N
    std::vector<Point> points;  // N, on the input surface; empty for intrinsic inputs

    // Pieces of the input's faces (the mirror image is left out).
    std::vector<Index> first;                   // P+1
    std::vector<Index> input_face, final_face;  // P
    // Per corner. // C
    std::vector<Index> vertex;          // where the side starts
    std::vector<Index> twin;            // the side of the neighbouring piece, or -1 on the boundary
    std::vector<Index> input_halfedge;  // input halfedge that the side runs along (piece on its left), or -1
    std::vector<Index> final_halfedge;  // the same of the final triangulation
    std::vector<std::array<double, 3>>
        weight;  // the corner as a combination of the corners of its final face: of points
                 // in the plane, on the hyperboloid or on the sphere, seen from the origin
    std::vector<std::array<double, 2>> flat;  // position in the input's metric, unfolded piece by piece
    std::vector<Index> piece;                 // its piece

    /// Overwrites corner `to` by corner `from`, as one of piece `to_piece`; twins are copied as they are.
    void copy_corner(Index from, Index to, Index to_piece);
    /// Cuts the arrays of pieces and corners to these lengths; `first` is left alone.
    void resize(Index pieces, Index corners);
    [[nodiscard]] Index piece_count() const { return static_cast<Index>(input_face.size()); }
    [[nodiscard]] Index corner_count() const { return static_cast<Index>(vertex.size()); }
    [[nodiscard]] Index next(Index corner) const {
        const Index p = piece[static_cast<std::size_t>(corner)];
        return corner + 1 == first[static_cast<std::size_t>(p) + 1] ? first[static_cast<std::size_t>(p)]
                                                                    : corner + 1;
    }
    [[nodiscard]] Index previous(Index corner) const {
        const Index p = piece[static_cast<std::size_t>(corner)];
        return corner == first[static_cast<std::size_t>(p)] ? first[static_cast<std::size_t>(p) + 1] - 1
                                                            : corner - 1;
    }
};

/// Refines `mesh` by the triangulation that is Delaunay at conformal factor `u` (V, of the input's vertices;
/// mirror images share it). `doubled`, `delaunay` as in make_flow_surface. Throws std::logic_error where
/// flips do not end or curves do not add up (lengths that are not finite).
CommonRefinement make_common_refinement(const SurfaceMesh& mesh, std::span<const double> u, bool doubled,
                                        bool delaunay);

/// The refinement of a surface whose triangulation was kept (circle packings): the pieces are its faces.
/// `edge_length`: 3F, in the final metric.
CommonRefinement trivial_refinement(const SurfaceMesh& mesh, std::span<const double> log_chord);

/// Signed areas: of each piece in the flat metric of the input, and by its weights relative to the final face
/// (so that the pieces of a final face add up to 1); and how much of them the rounding of the corners may
/// account for. // P each
struct PieceAreas {
    std::vector<double> flat, final_share, flat_rounding, share_rounding;
};
PieceAreas piece_areas(const CommonRefinement& refinement);

}  // namespace ricci
