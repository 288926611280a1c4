#include "engine/shape_space/clustering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "kernels/parallel.h"

namespace ricci {
namespace {

constexpr std::int64_t kRowsPerBlock = 8;

// Lance, Williams 1967: the distance of the union of clusters a, b to a third one.
double joined_distance(Linkage linkage, double a, double b, double members_a, double members_b) {
    switch (linkage) {
        case Linkage::single:
            return std::min(a, b);
        case Linkage::complete:
            return std::max(a, b);
        case Linkage::average:
            break;
    }
    return (members_a * a + members_b * b) / (members_a + members_b);
}

/// Clusters under way; each lives in the slot of its lowest member.
class Chain {
  public:
    Chain(const DistanceMatrix& distances, Linkage linkage)
        : size_(distances.size), linkage_(linkage), distance_(distances.values), members_(size_, 1.0) {
        alive_.resize(size_);
        std::iota(alive_.begin(), alive_.end(), std::size_t{0});
    }

    /// The next pair of mutual nearest neighbours, joined: merges by slot, not in order of height.
    Merge join_next() {
        for (;;) {
            if (chain_.empty()) chain_.push_back(alive_.front());
            const std::size_t last = chain_.back();
            const std::size_t previous = chain_.size() > 1 ? chain_[chain_.size() - 2] : last;
            const std::size_t next = nearest(last, previous);
            if (chain_.size() > 1 && next == previous) {
                chain_.resize(chain_.size() - 2);
                return join(std::min(last, next), std::max(last, next));
            }
            chain_.push_back(next);
        }
    }

  private:
    double& at(std::size_t i, std::size_t j) { return distance_[i * size_ + j]; }

    // Ties go to the previous link of the chain, which makes the two each other's nearest, then to the lowest
    // slot.
    std::size_t nearest(std::size_t slot, std::size_t previous) {
        std::size_t best = previous;
        double least = previous == slot ? std::numeric_limits<double>::infinity() : at(slot, previous);
        for (const std::size_t other : alive_) {
            if (other == slot || !(at(slot, other) < least)) continue;
            least = at(slot, other);
            best = other;
        }
        return best;
    }

    Merge join(std::size_t a, std::size_t b) {
        const Merge merge{a, b, at(a, b), static_cast<std::size_t>(members_[a] + members_[b])};
        for (const std::size_t other : alive_) {
            if (other == a || other == b) continue;
            at(a, other) = at(other, a) =
                joined_distance(linkage_, at(a, other), at(b, other), members_[a], members_[b]);
        }
        members_[a] += members_[b];
        alive_.erase(std::lower_bound(alive_.begin(), alive_.end(), b));
        return merge;
    }

    std::size_t size_;
    Linkage linkage_;
    std::vector<double> distance_, members_;
    std::vector<std::size_t> alive_, chain_;  // slots, ascending; the chain
};

/// Which cluster a shape belongs to as merges go by.
class Forest {
  public:
    explicit Forest(std::size_t leaves) : parent_(leaves), label_(leaves) {
        std::iota(parent_.begin(), parent_.end(), std::size_t{0});
        std::iota(label_.begin(), label_.end(), std::size_t{0});
    }
    /// The lowest member of the shape's cluster.
    std::size_t root(std::size_t shape) {
        while (parent_[shape] != shape) shape = parent_[shape] = parent_[parent_[shape]];
        return shape;
    }
    [[nodiscard]] std::size_t label(std::size_t root) const { return label_[root]; }
    void join(std::size_t root, std::size_t other, std::size_t label) {
        parent_[other] = root;
        label_[root] = label;
    }

  private:
    std::vector<std::size_t> parent_, label_;
};

// Lowest member of every cluster.
std::vector<std::size_t> lowest_members(const Dendrogram& tree) {
    std::vector<std::size_t> lowest(tree.leaves);
    std::iota(lowest.begin(), lowest.end(), std::size_t{0});
    for (const Merge& merge : tree.merges)
        lowest.push_back(std::min(lowest[merge.first], lowest[merge.second]));
    return lowest;
}

}  // namespace

std::string_view name_of(Linkage linkage) {
    switch (linkage) {
        case Linkage::single:
            return "single";
        case Linkage::complete:
            return "complete";
        case Linkage::average:
            break;
    }
    return "average";
}

DistanceMatrix distance_matrix(const ShapeVectors& shapes, bool parallel) {
    const std::size_t count = shapes.size();
    DistanceMatrix matrix{count, std::vector<double>(count * count, 0.0)};
    for_blocks(
        static_cast<std::int64_t>(count), kRowsPerBlock, parallel, [&](std::int64_t begin, std::int64_t end) {
            for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
                for (std::size_t j = 0; j < i; ++j)
                    matrix.values[i * count + j] = shape_distance(shapes, shapes.row(i), shapes.row(j));
        });
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i + 1; j < count; ++j) matrix.values[i * count + j] = matrix(j, i);
    return matrix;
}

Dendrogram cluster_shapes(const DistanceMatrix& distances, Linkage linkage) {
    if (distances.values.size() != distances.size * distances.size)
        throw std::invalid_argument("the distances do not fill a square");
    for (const double d : distances.values)
        if (!std::isfinite(d) || d < 0.0)
            throw std::invalid_argument("a distance is not finite, or is negative");
    Dendrogram tree{distances.size, {}};
    if (distances.size < 2) return tree;
    Chain chain(distances, linkage);
    for (std::size_t k = 1; k < distances.size; ++k) tree.merges.push_back(chain.join_next());
    std::stable_sort(tree.merges.begin(), tree.merges.end(),
                     [](const Merge& a, const Merge& b) { return a.height < b.height; });
    // From slots, which name clusters by a member, to the clusters as they are at that height.
    Forest forest(tree.leaves);
    std::vector<std::size_t> members(tree.leaves, 1);
    for (std::size_t k = 0; k < tree.merges.size(); ++k) {
        Merge& merge = tree.merges[k];
        std::size_t a = forest.root(merge.first), b = forest.root(merge.second);
        if (a > b) std::swap(a, b);
        merge.first = forest.label(a);
        merge.second = forest.label(b);
        merge.members = members[merge.first] + members[merge.second];
        members.push_back(merge.members);
        forest.join(a, b, tree.leaves + k);
    }
    return tree;
}

std::vector<std::size_t> leaf_order(const Dendrogram& tree) {
    if (tree.merges.empty()) return lowest_members(tree);  // one shape, or none
    std::vector<std::size_t> order, open{tree.leaves + tree.merges.size() - 1};
    while (!open.empty()) {
        const std::size_t cluster = open.back();
        open.pop_back();
        if (cluster < tree.leaves) {
            order.push_back(cluster);
            continue;
        }
        const Merge& merge = tree.merges[cluster - tree.leaves];
        open.push_back(merge.second);
        open.push_back(merge.first);
    }
    return order;
}

std::vector<std::size_t> flat_clusters(const Dendrogram& tree, std::size_t count) {
    if (count == 0) throw std::invalid_argument("no clusters hold no shapes");
    const std::size_t kept = tree.leaves > count ? tree.leaves - count : 0;
    const std::vector<std::size_t> lowest = lowest_members(tree);
    Forest forest(tree.leaves);
    for (std::size_t k = 0; k < kept; ++k) {
        const std::size_t a = lowest[tree.merges[k].first], b = lowest[tree.merges[k].second];
        forest.join(std::min(a, b), std::max(a, b), 0);
    }
    std::vector<std::size_t> number(tree.leaves), clusters(tree.leaves);
    std::size_t next = 0;
    for (std::size_t i = 0; i < tree.leaves; ++i) {
        const std::size_t root = forest.root(i);
        if (root == i) number[i] = next++;
        clusters[i] = number[root];
    }
    return clusters;
}

}  // namespace ricci
