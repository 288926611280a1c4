// What hides what in a picture of a surface: distances to the viewer on a grid of samples.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "io/picture/svg.h"

namespace ricci::app {

/// A triangle as it is seen: its corners in the picture, and how near each is to the viewer (larger is
/// nearer).
struct SeenTriangle {
    std::array<PlanePoint, 3> corner;
    std::array<double, 3> depth;
};

enum class Visibility : std::uint8_t { hidden, partial, whole };

/// The depth of the nearest triangle at every sample.
class DepthImage {
  public:
    /// `samples`: of the longer side of the box. `range`: of all depths, the measure of what counts as equal.
    DepthImage(const ViewBox& box, int samples, double range);

    /// All triangles are added before anything is asked.
    void add(const SeenTriangle& triangle);
    /// By the samples in the triangle. One that lies between samples is judged by its middle, and never
    /// whole.
    [[nodiscard]] Visibility visibility(const SeenTriangle& triangle) const;
    /// Whether a point of the surface is not behind another part of it; `slack` is how far it may lie behind
    /// the farthest of the nine samples around it, as a fraction of the range.
    [[nodiscard]] bool shows(const PlanePoint& point, double depth, double slack = 0.005) const;

  private:
    template <class Visit>
    void for_samples(const SeenTriangle& triangle, Visit visit) const;
    [[nodiscard]] std::size_t sample_at(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(column);
    }

    ViewBox box_;
    double step_, range_;
    int columns_, rows_;
    std::vector<double> depth_;
};

}  // namespace ricci::app
