#include "engine/shape_space/surface_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <unordered_set>
#include <utility>

#include "engine/shape_space/line_walk.h"

namespace ricci {
namespace {

using Vector = std::array<double, 3>;

constexpr std::size_t kMostPassages = 2'000'000;  // of one curve
constexpr std::size_t kOverlap = 8;               // passages of either half beyond the middle
constexpr double kWrongTurn = 1e-3;               // relative: the walk closed up around another class

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

LineNormal reversed_line(const LineNormal& n) {
    return {-n[0], -n[1], -n[2]};
}

/// One half of a closed geodesic: passages, and the length from the start to the middle of each.
struct Half {
    std::vector<Passage> passages;
    std::vector<double> middle;
};

/// Walks on from `first` until half of `length` is behind.
Half follow(LineWalk& walk, const Passage& first, double length, bool touching_left) {
    Half half;
    double done = 0.0;
    std::size_t beyond = 0;
    for (Passage passage = first;; passage = walk.next(passage, touching_left)) {
        half.passages.push_back(passage);
        half.middle.push_back(done + 0.5 * passage.length);
        done += passage.length;
        if (done >= 0.5 * length && ++beyond == kOverlap) return half;
        if (!std::isfinite(done) || half.passages.size() > kMostPassages)
            throw std::runtime_error("a geodesic was lost after length " + std::to_string(done));
    }
}

/// The passages, one of each half, that are the same one: in the same piece at places that agree best.
struct Meeting {
    std::size_t ahead = 0, behind = 0;
    double gap = std::numeric_limits<double>::infinity();
};

Meeting meet(const CommonRefinement& r, const Half& ahead, const Half& behind, double length) {
    const auto piece = [&r](const Half& half, std::size_t i) {
        return r.piece[at(half.passages[i].entry.corner)];
    };
    const auto begin = [](const Half& half) {
        return half.passages.size() - std::min(half.passages.size(), 4 * kOverlap);
    };
    Meeting best;
    for (std::size_t i = begin(ahead); i < ahead.passages.size(); ++i)
        for (std::size_t j = begin(behind); j < behind.passages.size(); ++j) {
            const double gap = std::abs(ahead.middle[i] + behind.middle[j] - length);
            if (piece(ahead, i) == piece(behind, j) && gap < best.gap) best = {i, j, gap};
        }
    return best;
}

/// The sides through which a closed walk leaves its pieces, one after the other, and the lengths between.
struct ClosedWalk {
    std::vector<SidePoint> gates;
    std::vector<double> lengths;  // from the gate before (cyclically) to each
    double length = 0.0, closing_error = 0.0;
};

ClosedWalk close(const LineWalk& walk, const Half& ahead, const Half& behind, const Meeting& meeting) {
    const Passage &p = ahead.passages[meeting.ahead], &q = behind.passages[meeting.behind];
    ClosedWalk closed;
    for (std::size_t i = 0; i < meeting.ahead; ++i) {
        closed.gates.push_back(ahead.passages[i].exit);
        closed.lengths.push_back(ahead.passages[i].length);
    }
    closed.gates.push_back(q.entry);
    closed.lengths.push_back(walk.distance(p.entry, q.entry));
    for (std::size_t j = meeting.behind; j > 0; --j) {
        closed.gates.push_back(behind.passages[j - 1].entry);
        closed.lengths.push_back(behind.passages[j - 1].length);
    }
    for (const double l : closed.lengths) closed.length += l;
    closed.closing_error = std::max(walk.distance(p.entry, q.exit), walk.distance(p.exit, q.entry));
    return closed;
}

/// Follows the line of a passage once around, from where that ends.
ClosedWalk walk_around(LineWalk& walk, const Passage& start, double length, bool touching_left) {
    const Half ahead = follow(walk, walk.next(start, touching_left), length, touching_left);
    const Passage back = walk.from(start.exit, reversed_line(start.normal), !touching_left);
    const Half behind = follow(walk, back, length, !touching_left);
    const Meeting meeting = meet(walk.refinement(), ahead, behind, length);
    if (!(meeting.gap <= kWrongTurn * length))
        throw std::runtime_error("a geodesic does not close at length " + std::to_string(length));
    return close(walk, ahead, behind, meeting);
}

/// The axis of the faces crossed, in the frame of the piece that gates.back() leaves.
std::optional<LineNormal> axis_of(const LineWalk& walk, const ClosedWalk& closed) {
    const FinalMetric<double>& metric = walk.metric();
    const CommonRefinement& r = walk.refinement();
    const auto move = [&](const SidePoint& gate) {
        const Index g = r.final_halfedge[at(gate.corner)];
        return g < 0 ? Isometry<double>{} : metric.crossing(r.final_triangulation.connectivity, g);
    };
    Isometry<double> around = move(closed.gates.back());
    for (std::size_t k = 0; k + 1 < closed.gates.size(); ++k)
        around = compose(metric.kappa, around, move(closed.gates[k]));
    const double length = translation_length(metric.kappa, around);
    if (std::abs(length - closed.length) > kWrongTurn * closed.length) return std::nullopt;
    return translation_axis(metric.kappa, around);
}

/// The point's least distance from a side of the piece, in units that suit all pieces of a face: negative
/// outside.
double depth_in_piece(const CommonRefinement& r, Index piece, const Vector& w) {
    const auto shares = [](const Vector& v) {
        const double sum = v[0] + v[1] + v[2];
        return std::array<double, 2>{v[1] / sum, v[2] / sum};
    };
    const auto x = shares(w);
    double depth = std::numeric_limits<double>::infinity();
    for (Index c = r.first[at(piece)]; c < r.first[at(piece) + 1]; ++c) {
        const auto p = shares(r.weight[at(c)]), q = shares(r.weight[at(r.next(c))]);
        const double dx = q[0] - p[0], dy = q[1] - p[1], size = std::hypot(dx, dy);
        if (size > 0.0) depth = std::min(depth, (dx * (x[1] - p[1]) - dy * (x[0] - p[0])) / size);
    }
    return depth;
}

/// A vector as a combination of the corners of a final face.
Vector coefficients(const std::array<Vector, 3>& vertex, const Vector& x) {
    const auto det = [](const Vector& a, const Vector& b, const Vector& c) {
        return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    };
    const double whole = det(vertex[0], vertex[1], vertex[2]);
    return {det(x, vertex[1], vertex[2]) / whole, det(vertex[0], x, vertex[2]) / whole,
            det(vertex[0], vertex[1], x) / whole};
}

/// The piece of the start's face in which it lies deepest.
Index piece_of(const LineWalk& walk, const GeodesicStart& start) {
    const CommonRefinement& r = walk.refinement();
    const Vector w = coefficients(walk.metric().corners(start.final_face), start.point);
    Index best = -1;
    double deepest = -1e-6;  // a share of the face: rounding, and nothing like a wrong face
    for (Index p = 0; p < r.piece_count(); ++p) {
        if (r.final_face[at(p)] != start.final_face) continue;
        const double depth = depth_in_piece(r, p, w);
        if (depth <= deepest) continue;
        best = p;
        deepest = depth;
    }
    if (best < 0)
        throw std::runtime_error("the start of a geodesic does not lie in final face " +
                                 std::to_string(start.final_face) + " of the surface");
    return best;
}

/// A line passing through a piece, and another line, in the same frame.
struct Found {
    Passage passage;
    LineNormal companion{};
};

/// Of a line given in the frame of a piece: its passage there, or, where all corners count as one side, that
/// of the nearest piece, in steps from piece to piece, which the line passes through.
Found passage_near(LineWalk& walk, Index piece, const LineNormal& normal, const LineNormal& companion,
                   bool touching_left) {
    constexpr std::size_t kMostTried = 4096;  // more than there are around a vertex
    struct Reached {
        Index piece;
        LineNormal line, companion;
    };
    const CommonRefinement& r = walk.refinement();
    std::vector<Reached> reached{{piece, normal, companion}};
    std::unordered_set<Index> seen{piece};
    for (std::size_t i = 0; i < reached.size() && i < kMostTried; ++i) {
        const Reached here = reached[i];
        if (const auto passage = walk.through(here.piece, here.line, touching_left))
            return {*passage, here.companion};
        for (Index c = r.first[at(here.piece)]; c < r.first[at(here.piece) + 1]; ++c) {
            const Index t = r.twin[at(c)];
            if (t >= 0 && seen.insert(r.piece[at(t)]).second)
                reached.push_back(
                    {r.piece[at(t)], walk.across(c, here.line), walk.across(c, here.companion)});
        }
    }
    throw LeavesSurface("a geodesic misses the surface near final face " +
                        std::to_string(r.final_face[at(piece)]));
}

ClosedWalk closed_walk(LineWalk& walk, const GeodesicStart& start, bool touching_left) {
    const LineNormal normal = unit_normal(walk.metric().kappa, start.normal);
    const Passage first = passage_near(walk, piece_of(walk, start), normal, normal, touching_left).passage;
    ClosedWalk closed = walk_around(walk, first, start.length, touching_left);
    if (walk.metric().kappa == 0) return closed;
    const std::optional<LineNormal> axis = axis_of(walk, closed);
    if (!axis) throw std::runtime_error("a geodesic closes up in another homotopy class");
    const Index piece = walk.refinement().piece[at(first.exit.corner)];
    const Passage again = passage_near(walk, piece, *axis, *axis, touching_left).passage;
    return walk_around(walk, again, closed.length, touching_left);
}

void check_start(const FinalMetric<double>& metric, const GeodesicStart& start) {
    if (metric.kappa > 0) throw std::invalid_argument("geodesics are traced for kappa -1 and 0 only");
    if (start.final_face < 0 || 3 * at(start.final_face) >= metric.half_chord.size())
        throw std::invalid_argument("geodesic: final face " + std::to_string(start.final_face) +
                                    " is out of range");
    if (!(start.length > 0.0) || !std::isfinite(start.length))
        throw std::invalid_argument("geodesic: the length is not positive");
}

SurfaceCurve curve_of(const LineWalk& walk, const Connectivity& input, const ClosedWalk& closed) {
    const CommonRefinement& r = walk.refinement();
    SurfaceCurve curve;
    curve.lengths = closed.lengths;
    curve.length = closed.length;
    curve.closing_error = closed.closing_error;
    if (!r.points.empty()) curve.points.push_back(walk.in_space(closed.gates.back()));
    std::vector<Index> crossed;
    for (const SidePoint& gate : closed.gates) {
        curve.face.push_back(r.input_face[at(r.piece[at(gate.corner)])]);
        if (!r.points.empty()) curve.points.push_back(walk.in_space(gate));
        const Index h = r.input_halfedge[at(gate.corner)];
        if (h >= 0) crossed.push_back(h);
    }
    curve.path = path_along(input, crossed);
    return curve;
}

}  // namespace

SurfaceCurve trace_geodesic(const CommonRefinement& r, const FinalMetric<double>& metric,
                            const Connectivity& input, const GeodesicStart& start) {
    check_start(metric, start);
    LineWalk walk(r, metric);
    try {
        return curve_of(walk, input, closed_walk(walk, start, true));
    } catch (const LeavesSurface&) {
        // Along the boundary, perhaps: on the other side of the vertices it meets.
        return curve_of(walk, input, closed_walk(walk, start, false));
    }
}

GeodesicStart start_on_line(const CommonRefinement& r, const FinalMetric<double>& metric, Index piece,
                            const LineNormal& normal, double length) {
    const int kappa = metric.kappa;
    LineWalk walk(r, metric);
    const Vector middle = walk.middle(piece);
    const LineNormal unit = unit_normal(kappa, normal);
    // From the middle at right angles to the line.
    const double side = line_side(kappa, unit, middle);
    LineNormal perpendicular = unit_normal(kappa, line_across(kappa, unit, middle));
    if (side < 0.0) perpendicular = reversed_line(perpendicular);
    auto [passage, line] = passage_near(walk, piece, perpendicular, unit, true);
    for (std::size_t count = 0;; ++count) {
        const double to_go = line_side(kappa, line, walk.position(passage.exit)) * (side < 0.0 ? -1.0 : 1.0);
        const bool at_boundary = r.twin[at(passage.exit.corner)] < 0;  // which may be the line
        if (to_go <= 0.0 || (at_boundary && to_go < 1e-6)) break;
        if (count == kMostPassages) throw std::runtime_error("the axis of a geodesic is out of reach");
        line = walk.across(passage.exit.corner, line);
        passage = walk.next(passage);
    }
    return {r.final_face[at(r.piece[at(passage.exit.corner)])], line_crossing(kappa, passage.normal, line),
            line, length};
}

GeodesicStart start_on_axis(const CommonRefinement& r, const FinalMetric<double>& metric, Index corner,
                            const Isometry<double>& element) {
    std::optional<LineNormal> axis = translation_axis(metric.kappa, element);
    if (!axis) throw std::invalid_argument("geodesic: the isometry is not a translation");
    const Index piece = r.piece[at(corner)];
    if (metric.kappa == 0) (*axis)[2] -= line_side(0, *axis, LineWalk(r, metric).middle(piece));
    return start_on_line(r, metric, piece, *axis, translation_length(metric.kappa, element));
}

EdgePath path_along(const Connectivity& input, std::span<const Index> crossed) {
    EdgePath path;
    for (std::size_t i = 0; i < crossed.size(); ++i) {
        // In the face behind crossed[i] from the head of its halfedge there to the tail of the one it is left
        // by.
        const Index entered = input.twin[at(crossed[i])], left = crossed[(i + 1) % crossed.size()];
        if (face_of(entered) != face_of(left))
            throw std::logic_error("a curve leaves a face that it has not entered");
        for (Index h = next_halfedge(entered); h != left; h = next_halfedge(h)) path.push_back(h);
    }
    return path;
}

}  // namespace ricci
