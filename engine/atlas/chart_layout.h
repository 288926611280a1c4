// Charts laid out in their plane.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/atlas/atlas.h"

namespace ricci {

/// Lays out disks of pieces. Refers to what it is made of.
class ChartLayout {
  public:
    ChartLayout(const CommonRefinement& refinement, const FinalMetric<double>& metric, AtlasKind kind);

    /// The chart of a disk of pieces, the first its seed; nothing where it would overlap itself. On the
    /// sphere that is not tested: the metric is that of the whole round sphere, and charts are parts of it.
    [[nodiscard]] std::optional<Chart> lay_out(std::span<const Index> pieces);
    /// Vertices of the refinement whose whole star is in the chart last laid out, in no order.
    [[nodiscard]] const std::vector<Index>& inside() const { return inside_; }

  private:
    void carry_frames(Index root, Chart& chart);
    void place_vertices(Chart& chart);
    void list_faces(Chart& chart) const;
    void list_inside(const Chart& chart);
    [[nodiscard]] bool rim_is_simple(const Chart& chart) const;

    const CommonRefinement& r_;
    const FinalMetric<double>& metric_;
    AtlasKind kind_;
    std::vector<Index> pieces_of_face_;  // number of pieces of each input face
    std::vector<Index> star_size_;       // N, pieces around a vertex
    // Of the chart at hand.
    std::vector<Isometry<double>> frame_;          // P
    std::vector<std::uint8_t> piece_in_, known_;   // P
    std::vector<std::array<double, 3>> position_;  // V of the input
    std::vector<Index> about_;                     // N, pieces of the chart around a vertex
    std::vector<Index> inside_;
};

}  // namespace ricci
