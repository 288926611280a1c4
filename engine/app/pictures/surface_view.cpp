#include "engine/app/pictures/surface_view.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "engine/app/console.h"

namespace ricci::app {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

Eigen::Vector3d vector_of(const Point& p) {
    return {p[0], p[1], p[2]};
}

/// Distribution of the surface's area, by the faces' own centres.
struct Moments {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Identity();  // about the centre
};

Moments moments_of(const std::vector<Point>& points, const std::vector<std::array<Index, 3>>& faces) {
    double total = 0.0;
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    for (const std::array<Index, 3>& f : faces) {
        if (f[0] < 0) continue;
        const Eigen::Vector3d a = vector_of(points[at(f[0])]), b = vector_of(points[at(f[1])]),
                              c = vector_of(points[at(f[2])]), centre = (a + b + c) / 3.0;
        const double area = (b - a).cross(c - a).norm();
        total += area;
        first += area * centre;
        second += area * centre * centre.transpose();
    }
    if (!(total > 0.0)) return {};
    first /= total;
    return {first, second / total - first * first.transpose()};
}

Eigen::Vector3d with_positive(const Eigen::Vector3d& axis, Eigen::Index coordinate) {
    return axis[coordinate] < 0.0 ? Eigen::Vector3d(-axis) : axis;
}

Eigen::Index largest_coordinate(const Eigen::Vector3d& axis) {
    Eigen::Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    return largest;
}

/// The direction, at right angles to the view, that is upright in the picture.
Eigen::Vector3d upright(const Eigen::Vector3d& towards, const Eigen::Matrix3d& principal) {
    constexpr double kAlong = 0.8, kNear = 0.966;  // cosines: 37 and 15 degrees
    const Eigen::Index vertical = std::abs(towards[1]) > kAlong ? 2 : 1;
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(vertical);
    Eigen::Vector3d seen = (axis - axis.dot(towards) * towards).normalized();
    for (const Eigen::Index k : {Eigen::Index{2}, Eigen::Index{1}}) {
        Eigen::Vector3d candidate = with_positive(principal.col(k), vertical);
        if (candidate.dot(seen) > kNear) return candidate;
    }
    return seen;
}

}  // namespace

Eigen::Matrix3d view_axes(const std::vector<Point>& points, const std::vector<std::array<Index, 3>>& faces,
                          const std::vector<Point>& front) {
    const Moments moments = moments_of(points, faces);
    const Eigen::Matrix3d principal =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments.second).eigenvectors();
    Eigen::Vector3d towards = with_positive(principal.col(0), largest_coordinate(principal.col(0)));
    double ahead = 0.0;
    for (const Point& p : front) ahead += towards.dot(vector_of(p) - moments.centre);
    if (ahead < 0.0) towards = -towards;
    const Eigen::Vector3d up = upright(towards, principal);
    Eigen::Matrix3d axes;
    axes.row(0) = up.cross(towards);
    axes.row(1) = up;
    axes.row(2) = towards;
    constexpr double kSideways = -0.35, kDown = 0.4;  // radians
    const Eigen::Matrix3d tilt = (Eigen::AngleAxisd(kDown, Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(kSideways, Eigen::Vector3d::UnitY()))
                                     .toRotationMatrix();
    return tilt * axes;
}

SurfaceView::SurfaceView(const CommonRefinement& r, const EdgeChains& chains,
                         const std::vector<std::vector<Index>>& front) {
    if (r.points.empty()) throw UsageError("an intrinsic surface has no points in space to draw");
    face_.assign(at(chains.halfedge_count() / 3), {-1, -1, -1});
    for (Index f = 0; f < face_count(); ++f) {
        std::array<Index, 3> corners{};
        bool whole = true;
        for (Index k = 0; k < 3; ++k) {
            const std::span<const Index> chain = chains.of(3 * f + k);
            whole = whole && !chain.empty();
            if (whole) corners[at(k)] = r.vertex[at(chain.front())];
        }
        if (whole) face_[at(f)] = corners;
    }
    std::vector<Point> wanted;
    for (const std::vector<Index>& vertices : front)
        for (const Index v : vertices) wanted.push_back(r.points[at(v)]);
    const Eigen::Matrix3d axes = view_axes(r.points, face_, wanted);
    for (const Point& p : r.points) seen_.push_back(axes * vector_of(p));
    std::vector<PlanePoint> corners;
    nearest_ = -HUGE_VAL;
    farthest_ = HUGE_VAL;
    for (const Index v : r.vertex) {
        corners.push_back(seen(v));
        nearest_ = std::max(nearest_, depth(v));
        farthest_ = std::min(farthest_, depth(v));
    }
    bounds_ = box_of(corners);
}

PlanePoint SurfaceView::seen(Index vertex) const {
    return {seen_[at(vertex)][0], seen_[at(vertex)][1]};
}

SeenTriangle SurfaceView::triangle(Index face) const {
    SeenTriangle result{};
    for (std::size_t k = 0; k < 3; ++k) {
        result.corner[k] = seen(face_[at(face)][k]);
        result.depth[k] = depth(face_[at(face)][k]);
    }
    return result;
}

/// Twice the area long, in the frame of the picture.
Eigen::Vector3d SurfaceView::normal(Index face) const {
    const Eigen::Vector3d &a = seen_[at(face_[at(face)][0])], &b = seen_[at(face_[at(face)][1])],
                          &c = seen_[at(face_[at(face)][2])];
    return (b - a).cross(c - a);
}

double SurfaceView::area(Index face) const {
    return 0.5 * normal(face).norm();
}

double SurfaceView::light(Index face) const {
    Eigen::Vector3d unit = normal(face);
    const double length = unit.norm();
    if (!(length > 0.0)) return 0.0;
    unit /= unit[2] < 0.0 ? -length : length;
    return std::max(0.0, unit.dot(Eigen::Vector3d(-0.35, 0.45, 0.82).normalized()));
}

}  // namespace ricci::app
