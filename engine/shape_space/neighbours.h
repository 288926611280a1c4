// Nearest neighbours among shapes of one topological type.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/connectivity.h"

namespace ricci {

/// spectrum: of fingerprints, free of markings. Where chi < 0, and for spheres and disks, their Euclidean
/// distance; tori and annuli: the exact Teichmueller distance (flat_distance.h).
/// coordinates: Euclidean distance of Teichmueller coordinates (thesis section 6.3.4.2), which depends on the
/// marking.
enum class ShapeMetric : std::uint8_t { spectrum, coordinates };
std::string_view name_of(ShapeMetric metric);

/// Shapes of one topological type as vectors.
struct ShapeVectors {
    Index genus = 0, boundaries = 0;
    ShapeMetric metric = ShapeMetric::spectrum;
    std::size_t dimension = 0;
    std::vector<double> values;  // N x dimension, row by row; a row that holds NaN has no distance to any

    [[nodiscard]] std::size_t size() const { return dimension == 0 ? 0 : values.size() / dimension; }
    [[nodiscard]] std::span<const double> row(std::size_t shape) const {
        return std::span(values).subspan(shape * dimension, dimension);
    }
};

/// Distance of two vectors of these shapes' kind; NaN where one holds NaN. Throws std::invalid_argument for
/// vectors of another size, and for moduli that are none.
double shape_distance(const ShapeVectors& shapes, std::span<const double> a, std::span<const double> b);

struct Neighbour {
    std::size_t shape = 0;
    double distance = 0.0;
    bool operator==(const Neighbour&) const = default;
};

/// Answers "which are nearest". Exact: Euclidean distances by a k-d tree (nanoflann), others one by one.
class NeighbourSearch {
  public:
    /// Throws std::invalid_argument when the values do not fill whole rows.
    explicit NeighbourSearch(ShapeVectors shapes);
    ~NeighbourSearch();
    NeighbourSearch(NeighbourSearch&&) noexcept;
    NeighbourSearch& operator=(NeighbourSearch&&) noexcept;

    [[nodiscard]] const ShapeVectors& shapes() const;
    /// The `count` nearest shapes, or all that have a distance, ascending; equal distances in the order of
    /// the shapes. Throws std::invalid_argument for a query of another size, or one that is not finite.
    [[nodiscard]] std::vector<Neighbour> nearest(std::span<const double> query, std::size_t count) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace ricci
