#include "engine/quality/conformality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/quality/piece_image.h"
#include "kernels/triangle.h"

namespace ricci {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
constexpr double kResolution = 1e-3;                       // of a ratio; a tenth of what is asked of it
constexpr double kCurved = 0.05 * 2.0 * std::numbers::pi;  // change of an angle sum, radians

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

using Vector = std::array<double, 2>;

double cross(const Vector& x, const Vector& y) {
    return x[0] * y[1] - x[1] * y[0];
}
double dot(const Vector& x, const Vector& y) {
    return x[0] * y[0] + x[1] * y[1];
}
double length(const Vector& x) {
    return std::hypot(x[0], x[1]);
}

/// Angle at a corner of a convex polygon and its rounding error, both in radians.
struct Angle {
    double value = 0.0, error = 0.0;
};

/// `ahead`, `back`: to the next and to the previous corner, each coordinate uncertain by `error`.
Angle angle_between(const Vector& ahead, const Vector& back, double error) {
    double angle = std::atan2(cross(ahead, back), dot(ahead, back));
    // A straight angle may come out as -pi.
    if (angle < -std::numbers::pi / 2.0) angle += 2.0 * std::numbers::pi;
    return {angle, error * (1.0 / length(ahead) + 1.0 / length(back))};
}

/// One piece in the input's plane and in the image's.
struct PieceShape {
    std::vector<Vector> flat;
    std::vector<std::array<double, 3>> image;  // in the frame of the final face
    std::vector<Vector> centred;  // the image in the conformal chart about its middle, true to scale there
    double flat_error = 0.0, image_error = 0.0;  // of a coordinate
};

/// Longest edge of every input face: what rounding of flat positions is relative to. // F
std::vector<double> longest_edges(const SurfaceMesh& mesh) {
    std::vector<double> longest;
    for (std::size_t h = 0; h < mesh.edge_length.size(); h += 3)
        longest.push_back(std::max({mesh.edge_length[h], mesh.edge_length[h + 1], mesh.edge_length[h + 2]}));
    return longest;
}

void centre(int kappa, PieceShape& shape) {
    std::array<double, 3> middle{};
    for (const auto& x : shape.image)
        for (std::size_t k = 0; k < 3; ++k) middle[k] += x[k];
    const double norm =
        std::sqrt(middle[2] * middle[2] + kappa * (middle[0] * middle[0] + middle[1] * middle[1]));
    for (double& value : middle) value /= norm;
    const Isometry<double> to_origin = inverse(motion_to(kappa, middle));
    shape.centred.clear();
    for (const auto& x : shape.image) {
        const std::array<double, 3> y = seen_from(kappa, to_origin, middle, x);
        shape.centred.push_back({2.0 * y[0] / (1.0 + y[2]), 2.0 * y[1] / (1.0 + y[2])});
    }
}

void shape_of(const CommonRefinement& r, const FinalMetric<double>& metric, double longest_edge, Index p,
              PieceShape& shape) {
    shape.flat.clear();
    shape.image.clear();
    double reach = longest_edge, extent = 0.0, growth = 1.0;
    for (Index c = r.first[at(p)]; c < r.first[at(p) + 1]; ++c) {
        shape.flat.push_back(r.flat[at(c)]);
        shape.image.push_back(piece_point(metric, r, c));
        reach = std::max(reach, length(r.flat[at(c)]));
        // An isometry that moves a point of the hyperbolic plane to the origin enlarges errors by e^distance.
        const auto& x = shape.image.back();
        if (metric.kappa < 0) growth = std::max(growth, x[2] + length({x[0], x[1]}));
    }
    for (const auto& x : metric.corners(r.final_face[at(p)])) extent = std::max(extent, length({x[0], x[1]}));
    shape.flat_error = kRounding * reach;
    shape.image_error = kRounding * extent * growth;
    centre(metric.kappa, shape);
}

double perimeter(const std::vector<Vector>& polygon) {
    double sum = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector &x = polygon[i], &y = polygon[(i + 1) % polygon.size()];
        sum += length({y[0] - x[0], y[1] - x[1]});
    }
    return sum;
}

double flat_area(const std::vector<Vector>& x) {
    double twice = 0.0;
    for (std::size_t i = 1; i + 1 < x.size(); ++i)
        twice +=
            cross({x[i][0] - x[0][0], x[i][1] - x[0][1]}, {x[i + 1][0] - x[0][0], x[i + 1][1] - x[0][1]});
    return twice / 2.0;
}

/// Signed area of a geodesic polygon about the origin, by the triple product of each side with the origin:
/// tan(area/2) = det(a, b, c) / (1 + ab + bc + ca), which for a = (0, 0, 1) and z = x / (1 + t) is
/// (z x z') / (1 + kappa z z'). Small areas lose nothing.
double image_area(int kappa, const std::vector<Vector>& centred) {
    double sum = 0.0;
    for (std::size_t i = 0; i < centred.size(); ++i) {
        const Vector &x = centred[i], &y = centred[(i + 1) % centred.size()];
        const double product = cross(x, y) / 4.0, cosine = dot(x, y) / 4.0;
        sum += kappa == 0 ? 2.0 * product : 2.0 * std::atan2(product, 1.0 + kappa * cosine);
    }
    return sum;
}

/// sigma1 / sigma2 of the mean derivative, which is an integral along the sides (Green); NaN where that turns
/// the piece over.
double mean_distortion(const PieceShape& shape) {
    double ux = 0, uy = 0, vx = 0, vy = 0;
    for (std::size_t i = 0; i < shape.flat.size(); ++i) {
        const std::size_t j = (i + 1) % shape.flat.size();
        const double dx = shape.flat[j][0] - shape.flat[i][0], dy = shape.flat[j][1] - shape.flat[i][1];
        const double u = shape.centred[i][0] + shape.centred[j][0],
                     v = shape.centred[i][1] + shape.centred[j][1];
        ux += u * dy;
        uy -= u * dx;
        vx += v * dy;
        vy -= v * dx;
    }
    const double holomorphic = std::hypot(ux + vy, vx - uy), other = std::hypot(ux - vy, vx + uy);
    return holomorphic > other ? (holomorphic + other) / (holomorphic - other) : kNaN;
}

/// Angle sums of the final triangulation at the input's vertices, of the half where it is a double. // V
template <int kappa>
std::vector<double> final_angle_sums(const CommonRefinement& r, const FinalMetric<double>& metric) {
    const Connectivity& c = r.final_triangulation.connectivity;
    std::vector<double> sum(at(c.vertex_count), 0.0);
    for (Index h = 0; h < c.halfedge_count(); h += 3) {
        const auto t =
            triangle_terms<kappa, double>(2.0 * metric.half_chord[at(h)], 2.0 * metric.half_chord[at(h) + 1],
                                          2.0 * metric.half_chord[at(h) + 2]);
        for (Index k = 0; k < 3; ++k) sum[at(c.tail[at(h + k)])] += std::atan2(t.root, t.numerator[at(k)]);
    }
    sum.resize(at(r.input_vertices));
    return sum;
}

/// 3F, of the input's faces.
std::vector<double> input_angles(const SurfaceMesh& mesh) {
    std::vector<double> angle;
    const std::vector<double>& l = mesh.edge_length;
    for (std::size_t h = 0; h < l.size(); h += 3) {
        const auto t = triangle_terms<0, double>(l[h], l[h + 1], l[h + 2]);
        for (const double numerator : t.numerator) angle.push_back(std::atan2(t.root, numerator));
    }
    return angle;
}

/// 1 where the angle sum changes too much for angles to be kept. // V
std::vector<std::uint8_t> curved_vertices(const SurfaceMesh& mesh, const std::vector<double>& angle,
                                          const CommonRefinement& r, const FinalMetric<double>& metric) {
    const std::vector<std::uint8_t> boundary = boundary_vertices(mesh.connectivity);
    const std::vector<double> after = metric.kappa == 0  ? final_angle_sums<0>(r, metric)
                                      : metric.kappa < 0 ? final_angle_sums<-1>(r, metric)
                                                         : final_angle_sums<1>(r, metric);
    std::vector<double> before(after.size(), 0.0);
    for (std::size_t h = 0; h < angle.size(); ++h) before[at(mesh.connectivity.tail[h])] += angle[h];
    std::vector<std::uint8_t> curved;
    for (std::size_t v = 0; v < before.size(); ++v) {
        const double half = r.doubled && boundary[v] != 0 ? 0.5 : 1.0;
        curved.push_back(std::abs(half * after[v] - before[v]) > kCurved ? 1 : 0);
    }
    return curved;
}

/// The corner (halfedge) of the input face in which a piece's corner at an input vertex lies: clockwise about
/// the vertex to the face's edge. Vertices do not tell, for a face may have one twice.
Index face_corner(const CommonRefinement& r, Index c) {
    while (r.input_halfedge[at(c)] < 0) c = r.next(r.twin[at(c)]);
    return r.input_halfedge[at(c)];
}

void summarise(const std::vector<double>& weight, AngleRatios& angles) {
    const auto summary = [&](CornerKind kind) {
        std::vector<double> chosen = angles.ratio;
        for (std::size_t i = 0; i < chosen.size(); ++i)
            if (angles.kind[i] != kind) chosen[i] = kNaN;
        AngleSummary s;
        s.ratio = distribution_of(chosen);
        s.within_1 = share_within(chosen, 0.99, 1.01);
        s.within_5 = share_within(chosen, 0.95, 1.05);
        s.area_within_1 = share_within(chosen, 0.99, 1.01, weight);
        s.area_within_5 = share_within(chosen, 0.95, 1.05, weight);
        return s;
    };
    angles.regular = summary(CornerKind::regular);
    angles.curved = summary(CornerKind::curved);
    angles.unresolved = std::count(angles.kind.begin(), angles.kind.end(), CornerKind::unresolved);
}

/// Everything that is collected piece by piece.
class Measurement {
  public:
    Measurement(const SurfaceMesh& mesh, const CommonRefinement& r, const FinalMetric<double>& metric)
        : r_(r),
          metric_(metric),
          input_angle_(input_angles(mesh)),
          curved_(curved_vertices(mesh, input_angle_, r, metric)),
          face_angle_(input_angle_.size()) {
        report_.image_area.assign(at(mesh.connectivity.face_count()), 0.0);
        const std::vector<double> longest = longest_edges(mesh);
        for (Index p = 0; p < r.piece_count(); ++p) {
            shape_of(r, metric, longest[at(r.input_face[at(p)])], p, shape_);
            add_piece(p);
        }
        finish(mesh);
    }
    ConformalityReport take() { return std::move(report_); }

  private:
    void add_piece(Index p) {
        const double before = flat_area(shape_.flat), after = image_area(metric_.kappa, shape_.centred);
        const double doubt_before = shape_.flat_error * perimeter(shape_.flat),
                     doubt_after = shape_.image_error * perimeter(shape_.centred);
        report_.image_area[at(r_.input_face[at(p)])] += after;
        report_.total_image_area += after;
        const bool flipped = before < -doubt_before || after < -doubt_after;
        const bool flat = !(before > doubt_before) || !(after > doubt_after);
        report_.flipped += flipped ? 1 : 0;
        report_.degenerate += flat && !flipped ? 1 : 0;
        report_.distortion.push_back(flat ? kNaN : mean_distortion(shape_));
        piece_area_.push_back(std::max(0.0, before));
        for (std::size_t i = 0; i < shape_.flat.size(); ++i) {
            add_corner(r_.first[at(p)] + static_cast<Index>(i), i, flat);
            corner_area_.push_back(piece_area_.back());
        }
    }

    void add_corner(Index c, std::size_t i, bool degenerate) {
        const std::size_t n = shape_.flat.size(), next = (i + 1) % n, previous = (i + n - 1) % n;
        const auto& x = shape_.flat;
        const Angle before =
            angle_between({x[next][0] - x[i][0], x[next][1] - x[i][1]},
                          {x[previous][0] - x[i][0], x[previous][1] - x[i][1]}, shape_.flat_error);
        const auto& y = shape_.image;
        const Isometry<double> to_origin = inverse(motion_to(metric_.kappa, y[i]));
        const auto ahead = seen_from(metric_.kappa, to_origin, y[i], y[next]),
                   back = seen_from(metric_.kappa, to_origin, y[i], y[previous]);
        const Angle after = angle_between({ahead[0], ahead[1]}, {back[0], back[1]}, shape_.image_error);
        const double doubt = before.error / before.value + after.error / after.value;
        const bool resolved = !degenerate && before.value > 0.0 && after.value > 0.0 && doubt < kResolution;
        const Index v = r_.vertex[at(c)];
        const bool at_vertex = v < r_.input_vertices;
        report_.pieces.ratio.push_back(resolved ? after.value / before.value : kNaN);
        report_.pieces.kind.push_back(!resolved                          ? CornerKind::unresolved
                                      : at_vertex && curved_[at(v)] != 0 ? CornerKind::curved
                                                                         : CornerKind::regular);
        if (!at_vertex || !std::isfinite(after.value)) return;
        Angle& sum = face_angle_[at(face_corner(r_, c))];
        sum.value += after.value;
        sum.error += std::min(after.error, std::numbers::pi);
    }

    void finish(const SurfaceMesh& mesh) {
        summarise(corner_area_, report_.pieces);
        const std::vector<double> area = face_areas(mesh);
        std::vector<double> weight;
        for (std::size_t h = 0; h < face_angle_.size(); ++h) {
            const Angle& sum = face_angle_[h];
            const bool resolved = sum.value > 0.0 && sum.error / sum.value < kResolution;
            report_.faces.ratio.push_back(resolved ? sum.value / input_angle_[h] : kNaN);
            report_.faces.kind.push_back(!resolved ? CornerKind::unresolved
                                         : curved_[at(mesh.connectivity.tail[h])] != 0 ? CornerKind::curved
                                                                                       : CornerKind::regular);
            weight.push_back(area[h / 3]);
        }
        summarise(weight, report_.faces);
        report_.distortion_by_area = distribution_of(report_.distortion, piece_area_);
        compare_areas(area);
    }

    void compare_areas(const std::vector<double>& area) {
        double total = 0.0, squares = 0.0;
        for (const double a : area) total += a;
        for (std::size_t f = 0; f < area.size(); ++f) {
            const double share = report_.image_area[f] / report_.total_image_area;
            const double value = share > 0.0 && area[f] > 0.0 ? std::log(share / (area[f] / total)) : kNaN;
            report_.log_area_ratio.push_back(value);
            if (!std::isnan(value)) squares += value * value;
        }
        report_.log_area = distribution_of(report_.log_area_ratio);
        if (report_.log_area.count > 0)
            report_.area_distortion = squares / static_cast<double>(report_.log_area.count);
    }

    const CommonRefinement& r_;
    const FinalMetric<double>& metric_;
    std::vector<double> input_angle_;  // 3F
    std::vector<std::uint8_t> curved_;
    std::vector<Angle> face_angle_;                 // 3F, of the image
    std::vector<double> piece_area_, corner_area_;  // P, C, of the input
    PieceShape shape_;
    ConformalityReport report_;
};

}  // namespace

ConformalityReport measure_conformality(const SurfaceMesh& mesh, const CommonRefinement& refinement,
                                        const FinalMetric<double>& metric) {
    return Measurement(mesh, refinement, metric).take();
}

}  // namespace ricci
