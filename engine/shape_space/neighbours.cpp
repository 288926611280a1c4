#include "engine/shape_space/neighbours.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <nanoflann.hpp>
#include <stdexcept>
#include <utility>

#include "engine/shape_space/flat_distance.h"

namespace ricci {
namespace {

bool nearer(const Neighbour& a, const Neighbour& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.shape < b.shape;
}

bool all_finite(std::span<const double> values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

bool is_torus(const ShapeVectors& s) {
    return s.metric == ShapeMetric::spectrum && s.genus == 1 && s.boundaries == 0;
}

bool is_annulus(const ShapeVectors& s) {
    return s.metric == ShapeMetric::spectrum && s.genus == 0 && s.boundaries == 2;
}

void require_size(const ShapeVectors& shapes, std::size_t size) {
    if (size != shapes.dimension)
        throw std::invalid_argument(fmt::format(
            "a vector of {} numbers among shapes of {}: made with other options?", size, shapes.dimension));
}

double squared_distance(std::span<const double> a, std::span<const double> b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

/// The rows that are finite, as nanoflann wants to see them.
struct Cloud {
    const ShapeVectors* shapes;
    std::vector<std::size_t> rows;  // ascending

    [[nodiscard]] std::size_t kdtree_get_point_count() const { return rows.size(); }
    [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const {
        return shapes->values[rows[i] * shapes->dimension + axis];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

/// nanoflann's own result set keeps whichever of equally near points it meets first; this one the lowest.
class LowestNearest {
  public:
    using DistanceType = double;
    LowestNearest(const Cloud& cloud, std::size_t count) : cloud_(&cloud), count_(count) {}

    [[nodiscard]] std::size_t size() const { return found_.size(); }
    [[nodiscard]] bool full() const { return found_.size() == count_; }
    // The search skips branches and points that are not nearer than this: equal ones must pass, and so must
    // those whose branch's lower bound is off by the rounding of a sum over a few dozen levels.
    [[nodiscard]] double worstDist() const {
        if (!full()) return std::numeric_limits<double>::infinity();
        return std::nextafter(found_.back().distance * (1.0 + 1e-12),
                              std::numeric_limits<double>::infinity());
    }
    bool addPoint(double squared, std::size_t number) {
        const Neighbour candidate{cloud_->rows[number], squared};
        if (full()) {
            if (!nearer(candidate, found_.back())) return true;
            found_.pop_back();
        }
        found_.insert(std::upper_bound(found_.begin(), found_.end(), candidate, nearer), candidate);
        return true;
    }
    [[nodiscard]] std::vector<Neighbour> take() { return std::move(found_); }

  private:
    const Cloud* cloud_;
    std::size_t count_;
    std::vector<Neighbour> found_;
};

using Distance = nanoflann::L2_Simple_Adaptor<double, Cloud>;
using Tree = nanoflann::KDTreeSingleIndexAdaptor<Distance, Cloud, -1, std::size_t>;

}  // namespace

std::string_view name_of(ShapeMetric metric) {
    return metric == ShapeMetric::spectrum ? "spectrum" : "coordinates";
}

double shape_distance(const ShapeVectors& shapes, std::span<const double> a, std::span<const double> b) {
    require_size(shapes, a.size());
    require_size(shapes, b.size());
    if (!all_finite(a) || !all_finite(b)) return std::numeric_limits<double>::quiet_NaN();
    if (is_torus(shapes) && a.size() == 2) return torus_distance({a[0], a[1]}, {b[0], b[1]});
    if (is_annulus(shapes) && a.size() == 1) return annulus_distance(std::exp(a[0]), std::exp(b[0]));
    return std::sqrt(squared_distance(a, b));
}

struct NeighbourSearch::Impl {
    explicit Impl(ShapeVectors given) : shapes(std::move(given)), cloud{&shapes, {}} {
        if (shapes.dimension == 0 ? !shapes.values.empty() : shapes.values.size() % shapes.dimension != 0)
            throw std::invalid_argument("the values of the shapes do not fill whole rows");
        for (std::size_t i = 0; i < shapes.size(); ++i)
            if (all_finite(shapes.row(i))) cloud.rows.push_back(i);
        if (is_torus(shapes) || is_annulus(shapes) || cloud.rows.empty()) return;
        tree = std::make_unique<Tree>(static_cast<int>(shapes.dimension), cloud);
        tree->buildIndex();
    }

    [[nodiscard]] std::vector<Neighbour> by_tree(std::span<const double> query, std::size_t count) const {
        LowestNearest result(cloud, count);
        tree->findNeighbors(result, query.data(), nanoflann::SearchParams());
        return result.take();
    }
    [[nodiscard]] std::vector<Neighbour> one_by_one(std::span<const double> query, std::size_t count) const {
        std::vector<Neighbour> all;
        for (const std::size_t i : cloud.rows)
            all.push_back({i, shape_distance(shapes, query, shapes.row(i))});
        std::sort(all.begin(), all.end(), nearer);
        if (all.size() > count) all.resize(count);
        return all;
    }

    ShapeVectors shapes;
    Cloud cloud;
    std::unique_ptr<Tree> tree;
};

NeighbourSearch::NeighbourSearch(ShapeVectors shapes) : impl_(std::make_unique<Impl>(std::move(shapes))) {}
NeighbourSearch::~NeighbourSearch() = default;
NeighbourSearch::NeighbourSearch(NeighbourSearch&&) noexcept = default;
NeighbourSearch& NeighbourSearch::operator=(NeighbourSearch&&) noexcept = default;

const ShapeVectors& NeighbourSearch::shapes() const {
    return impl_->shapes;
}

std::vector<Neighbour> NeighbourSearch::nearest(std::span<const double> query, std::size_t count) const {
    require_size(impl_->shapes, query.size());
    if (!all_finite(query))
        throw std::invalid_argument("the vector whose neighbours are sought is not finite");
    count = std::min(count, impl_->cloud.rows.size());
    if (count == 0) return {};
    if (!impl_->tree) return impl_->one_by_one(query, count);
    std::vector<Neighbour> found = impl_->by_tree(query, count);
    for (Neighbour& neighbour : found)
        neighbour.distance = shape_distance(impl_->shapes, query, impl_->shapes.row(neighbour.shape));
    // Square roots may make equal what squares told apart.
    std::sort(found.begin(), found.end(), nearer);
    return found;
}

}  // namespace ricci
