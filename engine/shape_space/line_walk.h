// Geodesic lines of the final metric, followed from piece to piece of the common refinement.
#pragma once

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/layout/final_metric.h"
#include "engine/layout/line.h"

namespace ricci {

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
