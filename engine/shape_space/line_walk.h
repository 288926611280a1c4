// Geodesic lines of the final metric, followed from piece to piece of the common refinement.
#pragma once

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/layout/final_metric.h"

namespace ricci {

/// The unit normal vector n of a line's plane through the origin, in the frame of a final face. The line is
/// where line_side is 0, and runs with its positive side on the left. kappa = -1: n_x^2 + n_y^2 - n_t^2 = 1;
/// kappa = 0: n_x^2 + n_y^2 = 1, and n_t is the offset.
using LineNormal = std::array<double, 3>;

/// n_x x + n_y y - n_t t on the hyperboloid (t last), n_x x + n_y y + n_t t in the plane. For points: sinh of
/// the distance from the line, or the distance, positive on the left.
double line_side(int kappa, const LineNormal& normal, const std::array<double, 3>& x);
/// Scaled to a unit normal.
LineNormal unit_normal(int kappa, const LineNormal& normal);
/// The image of the line under an isometry.
LineNormal moved_line(int kappa, const Isometry<double>& motion, const LineNormal& normal);
/// The line at right angles that crosses `normal` in its point x, from the left to the right: positive ahead
/// of x.
LineNormal line_across(int kappa, const LineNormal& normal, const std::array<double, 3>& x);
/// The point, as a vector (x, t), where two lines cross; they must.
std::array<double, 3> line_crossing(int kappa, const LineNormal& first, const LineNormal& second);

/// The line that a translation moves along itself, in its direction; in the plane the one through the origin.
/// None for isometries that are no translations (rotations, the identity).
std::optional<LineNormal> translation_axis(int kappa, const Isometry<double>& element);
/// Length of a translation.
double translation_length(int kappa, const Isometry<double>& element);

/// A point of a piece's side: `along` from the corner that owns it (0) to the next (1), in the flat metric.
struct SidePoint {
    Index corner = -1;
    double along = 0.0;
};

/// How a line passes through one piece.
struct Passage {
    SidePoint entry, exit;
    double length = 0.0;  // from entry to exit in the final metric
    LineNormal normal{};  // in the frame of the piece's final face
};

/// Where a line leaves the surface; the message names the boundary edge.
class LeavesSurface : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Steps along a line. All decisions are made by the signs of line_side at the corners, once for each vertex
/// as long as the walk turns about it: a side that is entered has its start on the left and its end on the
/// right of the line whatever rounding says in the next piece, so there always is another side to leave by,
/// and the walk cannot get stuck at a vertex or on an edge. A vertex that the line meets, to 1e-8 of the
/// piece's extent, is taken to lie on its left (`touching_left`, or its right, as the reversed line asks
/// for), so that on symmetric surfaces the two halves of a geodesic pass along the same side of edges and
/// vertices on it.
///
/// Within a piece, weights are a linear function of the position (x, y, 1) in the flat metric: barycentric
/// coordinates of the flat triangle and the coefficients of a final face's corners are coordinates of one
/// vector in two bases (crossing_points.h), and the corners of a piece share one scale. So where line_side is
/// p and q for the combinations of a side's ends as they stand in `weight`, the line divides the flat side
/// as p : -q.
class LineWalk {
  public:
    /// Refers to its arguments.
    LineWalk(const CommonRefinement& refinement, const FinalMetric<double>& metric)
        : refinement_(&refinement), metric_(&metric) {}

    /// The passage of a piece by a line, and none where all corners lie on one side of it.
    std::optional<Passage> through(Index piece, const LineNormal& normal, bool touching_left = true);
    /// The passage of the piece of corner `entry.corner` by a line that enters there from its right side.
    Passage from(const SidePoint& entry, const LineNormal& normal, bool touching_left = true);
    /// The passage of the next piece. Throws LeavesSurface where there is none.
    Passage next(const Passage& passage, bool touching_left = true);

    /// A line, in the frame of the neighbour's final face across the side of `corner`, and the other way
    /// round: from the frame of the piece of `corner` to that of the piece across.
    [[nodiscard]] LineNormal across(Index corner, const LineNormal& normal) const;
    /// The same point as one of the neighbour's side.
    [[nodiscard]] SidePoint across(const SidePoint& point) const;
    /// In the frame of the piece's final face.
    [[nodiscard]] std::array<double, 3> position(const SidePoint& point) const;
    /// A point inside a piece, in the frame of its final face.
    [[nodiscard]] std::array<double, 3> middle(Index piece) const;
    /// In space. Needs points.
    [[nodiscard]] Point in_space(const SidePoint& point) const;
    /// Distance in the final metric of two points of the same piece.
    [[nodiscard]] double distance(const SidePoint& p, const SidePoint& q) const;

    [[nodiscard]] const CommonRefinement& refinement() const { return *refinement_; }
    [[nodiscard]] const FinalMetric<double>& metric() const { return *metric_; }

  private:
    void measure(Index piece, const LineNormal& normal, bool touching_left);
    [[nodiscard]] SidePoint crossing(Index corner) const;
    [[nodiscard]] std::optional<Index> exit_after(Index entry) const;
    [[nodiscard]] std::string place_of(Index corner) const;

    const CommonRefinement* refinement_;
    const FinalMetric<double>* metric_;
    // Of the corners of the piece at hand.
    std::vector<double> side_;
    std::vector<std::uint8_t> left_;
};

}  // namespace ricci
