#include "engine/atlas/atlas.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "engine/atlas/chart_layout.h"
#include "engine/atlas/disk_growth.h"
#include "engine/atlas/face_patches.h"
#include "engine/atlas/transitions.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

// How far a hyperbolic chart may reach: coordinates there lose e^10 of the 16 digits.
constexpr double kReach = 5.0;

int curvature_of(AtlasKind kind) {
    return kind == AtlasKind::affine ? 0 : kind == AtlasKind::spherical ? 1 : -1;
}

/// 1 at cones. // V
std::vector<std::uint8_t> marked_cones(const Connectivity& input, const std::vector<Index>& cones) {
    const std::vector<std::uint8_t> used = used_vertices(input), boundary = boundary_vertices(input);
    std::vector<std::uint8_t> marked(used.size(), 0);
    for (const Index v : cones) {
        if (v < 0 || v >= input.vertex_count || used[at(v)] == 0 || boundary[at(v)] != 0)
            throw std::invalid_argument("atlas: a cone must be an interior vertex");
        marked[at(v)] = 1;
    }
    return marked;
}

void check_options(const FinalMetric<double>& metric, const AtlasOptions& options) {
    if (curvature_of(options.kind) != metric.kappa)
        throw std::invalid_argument("atlas: the kind does not fit the curvature of the metric");
    if (options.kind == AtlasKind::spherical && !options.cones.empty())
        throw std::invalid_argument("atlas: a spherical atlas has no cones");
    if (options.charts < 0 || options.rings < 0)
        throw std::invalid_argument("atlas: the numbers of charts and rings must not be negative");
}

Index chart_count(const Connectivity& input, Index wanted) {
    if (wanted > 0) return std::min(wanted, input.face_count());
    const Index most = 12 + 6 * std::abs(topology_of(input).euler_characteristic);
    return std::clamp<Index>(input.face_count() / 100, 4, most);
}

/// Pieces of a list of faces, face by face. `first`, `piece`: pieces by input face.
struct PiecesByFace {
    std::vector<Index> first, piece;

    PiecesByFace(const CommonRefinement& r, Index faces)
        : first(at(faces) + 1, 0), piece(r.input_face.size()) {
        for (const Index f : r.input_face) ++first[at(f) + 1];
        for (std::size_t f = 1; f < first.size(); ++f) first[f] += first[f - 1];
        std::vector<Index> next(first.begin(), first.end() - 1);
        for (Index p = 0; p < r.piece_count(); ++p) piece[at(next[at(r.input_face[at(p)])]++)] = p;
    }
    [[nodiscard]] std::vector<Index> of(std::span<const Index> faces) const {
        std::vector<Index> all;
        for (const Index f : faces)
            all.insert(all.end(), piece.begin() + first[at(f)], piece.begin() + first[at(f) + 1]);
        return all;
    }
};

/// Makes charts until every vertex and side of the refinement lies inside one, cones apart.
class Cover {
  public:
    Cover(const Connectivity& input, const CommonRefinement& refinement, const FinalMetric<double>& metric,
          const AtlasOptions& options, Atlas& atlas)
        : r_(refinement),
          faces_(polygons_of(input)),
          pieces_(polygons_of(refinement)),
          by_face_(refinement, input.face_count()),
          cone_(marked_cones(input, options.cones)),
          face_growth_(faces_, cone_),
          piece_growth_(pieces_, widened(cone_, refinement.vertex_count)),
          layout_(refinement, metric, options.kind),
          atlas_(atlas),
          covered_(widened(cone_, refinement.vertex_count)) {}

    /// A chart from every patch, grown beyond it.
    void cover_patches(Index count, Index rings) {
        const std::vector<Index> seeds = farthest_seeds(faces_, count);
        const std::vector<Index> owner = nearest_seeds(faces_, seeds);
        for (std::size_t s = 0; s < seeds.size(); ++s) {
            std::vector<std::uint8_t> allowed;
            allowed.reserve(owner.size());
            for (const Index o : owner) allowed.push_back(o == static_cast<Index>(s) ? 1 : 0);
            add_rings(faces_, rings, allowed);
            add_chart_of_faces(std::span(&seeds[s], 1), allowed, std::numeric_limits<std::size_t>::max());
        }
    }

    /// Charts around the input's vertices that are left, then around all others, and across sides between
    /// cones.
    void cover_rest() {
        const std::vector<Index> at_face = lowest_corners(faces_), at_piece = lowest_corners(pieces_);
        for (Index v = 0; v < faces_.vertex_count; ++v)
            if (covered_[at(v)] == 0 && at_face[at(v)] >= 0)
                add_chart_of_faces(star_of(faces_, at_face[at(v)]), {}, usual_faces_);
        for (Index v = 0; v < r_.vertex_count; ++v) {
            if (covered_[at(v)] != 0 || at_piece[at(v)] < 0) continue;
            add_chart_of_pieces(star_of(pieces_, at_piece[at(v)]));
            if (covered_[at(v)] == 0) atlas_.uncovered.push_back(v);
        }
        const auto is_cone = [&](Index v) { return v < r_.input_vertices && cone_[at(v)] != 0; };
        for (Index c = 0; c < r_.corner_count(); ++c) {
            const Index t = r_.twin[at(c)];
            if (t < c || !is_cone(r_.vertex[at(c)]) || !is_cone(r_.vertex[at(t)])) continue;
            const std::array<Index, 2> both{r_.piece[at(c)], r_.piece[at(t)]};
            const bool known = std::any_of(atlas_.charts.begin(), atlas_.charts.end(), [&](const Chart& x) {
                return std::binary_search(x.pieces.begin(), x.pieces.end(), both[0]) &&
                       std::binary_search(x.pieces.begin(), x.pieces.end(), both[1]);
            });
            if (!known) add_chart_of_pieces(both);
        }
    }

  private:
    static std::vector<std::uint8_t> widened(std::vector<std::uint8_t> marks, Index size) {
        marks.resize(at(size), 0);
        return marks;
    }

    void add_chart_of_faces(std::span<const Index> start, const std::vector<std::uint8_t>& allowed,
                            std::size_t limit) {
        const std::vector<Index> grown = face_growth_.grow(start, allowed, limit);
        const std::size_t count = add_largest(start.size(), grown, [&](std::span<const Index> faces) {
            return layout_.lay_out(by_face_.of(faces));
        });
        usual_faces_ = std::max(usual_faces_, count);
    }

    void add_chart_of_pieces(std::span<const Index> start) {
        const std::vector<Index> grown = piece_growth_.grow(start, {}, usual_faces_);
        add_largest(start.size(), grown,
                    [&](std::span<const Index> pieces) { return layout_.lay_out(pieces); });
    }

    /// Every beginning of what has grown is a disk: takes all of it, or half, or a quarter, ... until it is
    /// one to one and near enough, or only the start is left. Returns how much, 0 where not even that can be
    /// laid out.
    template <class LayOut>
    std::size_t add_largest(std::size_t start, std::span<const Index> grown, LayOut lay_out) {
        for (std::size_t count = grown.size(); count > 0; count = std::max(start, count / 2)) {
            std::optional<Chart> chart = lay_out(grown.first(count));
            const bool too_far = chart && atlas_.kappa < 0 && chart->radius > kReach && count > start;
            if (chart && !too_far) {
                for (const Index v : layout_.inside()) covered_[at(v)] = 1;
                atlas_.charts.push_back(std::move(*chart));
                return count;
            }
            if (count <= start) break;
        }
        return 0;
    }

    const CommonRefinement& r_;
    PolygonSurface faces_, pieces_;
    PiecesByFace by_face_;
    std::vector<std::uint8_t> cone_;  // V
    DiskGrowth face_growth_, piece_growth_;
    ChartLayout layout_;
    Atlas& atlas_;
    std::vector<std::uint8_t> covered_;  // N, cones count as covered
    std::size_t usual_faces_ = 1;        // of the largest chart so far
};

}  // namespace

std::string_view name_of(AtlasKind kind) {
    switch (kind) {
        case AtlasKind::hyperbolic:
            return "hyperbolic";
        case AtlasKind::projective:
            return "projective";
        case AtlasKind::spherical:
            return "spherical";
        case AtlasKind::affine:
            break;
    }
    return "affine";
}

Atlas make_atlas(const Connectivity& input, const CommonRefinement& refinement,
                 const FinalMetric<double>& metric, const AtlasOptions& options) {
    check_options(metric, options);
    Atlas atlas;
    atlas.kind = options.kind;
    atlas.kappa = metric.kappa;
    atlas.dimension = options.kind == AtlasKind::spherical ? 3 : 2;
    Cover cover(input, refinement, metric, options, atlas);
    cover.cover_patches(chart_count(input, options.charts), options.rings);
    cover.cover_rest();
    atlas.transitions = make_transitions(refinement, atlas);
    return atlas;
}

}  // namespace ricci
