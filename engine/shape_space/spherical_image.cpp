#include "engine/shape_space/spherical_image.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <stdexcept>
#include <utility>

#include "engine/layout/final_metric.inl"

namespace ricci {
namespace {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

using Lorentz = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

constexpr double kWidest = 0.1;    // of a sample's triangle or piece of edge
constexpr double kNothing = 1e-7;  // width times share of the area
constexpr int kDeepest = 40;       // times that an edge is halved

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

Vector vector_of(const Point& p) {
    return {p[0], p[1], p[2]};
}

Point point_of(const Vector& v) {
    return {v[0], v[1], v[2]};
}

void check_flow(const FlowResult& flow, const Topology& t) {
    const bool disk =
        t.genus == 0 && t.boundaries == 1 && flow.doubled && flow.boundary == Boundary::geodesic;
    const bool sphere = t.genus == 0 && t.boundaries == 0;
    if (t.components != 1 || !(disk || sphere) || flow.geometry != Geometry::spherical ||
        flow.outcome.status != Status::converged)
        throw std::invalid_argument(
            "make_spherical_image: needs a converged spherical flow of a closed surface of genus 0 or a "
            "disk");
}

/// Faces of the final triangulation from the largest edge outwards, always across the longest edge there is:
/// needles, whose frames are the least exact, come last and carry nothing. Positions of the first V vertices.
void lay_out(const FlowResult& flow, SphericalImage& image) {
    const Connectivity& c = flow.triangulation;
    std::vector<double> half_chord;
    for (const double length : flow.edge_length) half_chord.push_back(std::sin(0.5 * length));
    const FinalMetric<double> metric = make_final_metric<double>(1, std::move(half_chord));
    std::vector<Isometry<double>> frame(at(c.face_count()));
    std::vector<std::uint8_t> placed(at(c.face_count()), 0), known(image.position.size(), 0);
    std::priority_queue<std::pair<double, Index>> queue;  // edge length, halfedge from a placed face
    const auto place = [&](Index face) {
        placed[at(face)] = 1;
        normalise(1, frame[at(face)]);
        const auto corners = metric.corners(face);
        for (Index k = 0; k < 3; ++k) {
            const Index h = 3 * face + k, v = c.tail[at(h)];
            if (c.twin[at(h)] != kNoTwin) queue.push({flow.edge_length[at(h)], h});
            if (at(v) >= known.size()) continue;
            const Point p = apply(1, frame[at(face)], corners[at(k)]);
            if (!std::exchange(known[at(v)], std::uint8_t{1})) image.position[at(v)] = p;
            const double error = (vector_of(p) - vector_of(image.position[at(v)])).norm();
            image.closing_error = std::max(image.closing_error, error);
        }
    };
    const auto longest = std::max_element(flow.edge_length.begin(), flow.edge_length.end());
    place(face_of(static_cast<Index>(longest - flow.edge_length.begin())));
    while (!queue.empty()) {
        const Index h = queue.top().second, to = face_of(c.twin[at(h)]);
        queue.pop();
        if (placed[at(to)]) continue;
        frame[at(to)] = compose(1, frame[at(face_of(h))], metric.crossing(c, h));
        place(to);
    }
    for (Point& p : image.position) {
        const double norm = vector_of(p).norm();
        if (norm > 0.0) p = point_of(vector_of(p) / norm);
    }
}

/// e^-u; of circle packings the mean of log(length / chord) over the edges at the vertex.
std::vector<double> scales_of(const SurfaceMesh& mesh, const FlowResult& flow, const SphericalImage& image) {
    const Connectivity& c = mesh.connectivity;
    std::vector<double> scale(image.position.size(), 1.0), edges(image.position.size(), 0.0);
    if (!flow.packing) {
        for (std::size_t v = 0; v < scale.size(); ++v) scale[v] = std::exp(-flow.conformal_factor[v]);
        return scale;
    }
    std::fill(scale.begin(), scale.end(), 0.0);
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const std::size_t i = at(c.tail[at(h)]), j = at(c.head(h));
        const double chord = (vector_of(image.position[i]) - vector_of(image.position[j])).norm();
        for (const std::size_t v : {i, j}) {
            scale[v] += std::log(mesh.edge_length[at(h)] / std::max(chord, 1e-300));
            edges[v] += 1.0;
        }
    }
    for (std::size_t v = 0; v < scale.size(); ++v) scale[v] = std::exp(scale[v] / std::max(edges[v], 1.0));
    return scale;
}

/// Turns a disk so that its boundary lies on the equator.
void straighten(const SurfaceMesh& mesh, SphericalImage& image) {
    const std::vector<std::uint8_t> boundary = boundary_vertices(mesh.connectivity);
    Matrix moment = Matrix::Zero();
    Vector inside = Vector::Zero();
    for (std::size_t v = 0; v < boundary.size(); ++v) {
        const Vector p = vector_of(image.position[v]);
        inside += p;  // the boundary's own sum has no part along the axis
        if (boundary[v]) moment += p * p.transpose();
    }
    Vector axis = Eigen::SelfAdjointEigenSolver<Matrix>(moment).eigenvectors().col(0);
    if (axis.dot(inside) < 0.0) axis = -axis;
    const Matrix turn = Eigen::Quaterniond::FromTwoVectors(axis, Vector::UnitZ()).toRotationMatrix();
    for (std::size_t v = 0; v < boundary.size(); ++v) {
        image.position[v] = point_of(turn * vector_of(image.position[v]));
        if (boundary[v]) image.equator_error = std::max(image.equator_error, std::abs(image.position[v][2]));
    }
}

/// The boost along v with rapidity |v|, on (x, t).
Lorentz boost_along(const Vector& v) {
    const double rapidity = v.norm();
    Lorentz boost = Lorentz::Identity();
    if (rapidity == 0.0) return boost;
    const Vector n = v / rapidity;
    boost.block<3, 3>(0, 0) += (std::cosh(rapidity) - 1.0) * n * n.transpose();
    boost.block<3, 1>(0, 3) = boost.block<1, 3>(3, 0).transpose() = std::sinh(rapidity) * n;
    boost(3, 3) = std::cosh(rapidity);
    return boost;
}

/// Where a point of the sphere goes, and by what factor its light-like vector (p, 1) grows.
std::pair<Vector, double> moved(const Lorentz& boost, const Vector& p) {
    const Eigen::Vector4d x = boost * p.homogeneous();
    return {x.head<3>().normalized(), x[3]};
}

struct Balance {
    Vector centre = Vector::Zero();
    Matrix derivative = Matrix::Zero();  // of the centre by a small boost v: x -> x + v - x (x.v)
};

Balance balance_of(const std::vector<SphereSample>& masses, const Lorentz& boost, bool hemisphere) {
    Balance b;
    double total = 0.0;
    for (const SphereSample& s : masses) {
        const Vector x = moved(boost, vector_of(s.position)).first;
        b.centre += s.weight * x;
        b.derivative += s.weight * (Matrix::Identity() - x * x.transpose());
        total += s.weight;
    }
    b.centre /= total;
    b.derivative /= total;
    if (hemisphere) {  // with the mirror image
        b.centre[2] = 0.0;
        b.derivative.block<2, 1>(0, 2).setZero();
        b.derivative.block<1, 2>(2, 0).setZero();
    }
    return b;
}

/// The boost after which the masses have their centre in the centre; `imbalance`: how far it stays away.
Lorentz balancing_boost(const std::vector<SphereSample>& masses, bool hemisphere, double& imbalance) {
    constexpr double kCentred = 1e-14;
    Lorentz boost = Lorentz::Identity();
    Balance balance = balance_of(masses, boost, hemisphere);
    for (int step = 0; step < 50 && balance.centre.norm() > kCentred; ++step) {
        Vector v = -balance.derivative.ldlt().solve(balance.centre);
        if (!v.allFinite()) break;
        v *= std::min(1.0, 1.5 / v.norm());
        bool better = false;
        for (int halving = 0; halving < 20 && !better; ++halving, v *= 0.5) {
            const Lorentz next = boost_along(v) * boost;
            const Balance trial = balance_of(masses, next, hemisphere);
            better = trial.centre.norm() < balance.centre.norm();
            if (!better) continue;
            boost = next;
            balance = trial;
        }
        if (!better) break;
    }
    imbalance = balance.centre.norm();
    return boost;
}

void move_vertices(const Lorentz& boost, SphericalImage& image) {
    for (std::size_t v = 0; v < image.position.size(); ++v) {
        if (image.position[v] == Point{}) continue;
        const auto [p, growth] = moved(boost, vector_of(image.position[v]));
        image.position[v] = point_of(p);
        image.scale[v] *= growth;
    }
}

/// One third of the faces around each vertex.
std::vector<SphereSample> vertex_masses(const SurfaceMesh& mesh, const SphericalImage& image) {
    const std::vector<double> area = face_areas(mesh);
    std::vector<SphereSample> masses(image.position.size());
    for (std::size_t v = 0; v < masses.size(); ++v) masses[v].position = image.position[v];
    for (std::size_t h = 0; h < mesh.connectivity.tail.size(); ++h)
        masses[at(mesh.connectivity.tail[h])].weight += area[h / 3] / 3.0;
    return masses;
}

/// First the vertices are brought to balance, then the area as the map made there spreads it.
void centre_area(const SurfaceMesh& mesh, SphericalImage& image) {
    const std::vector<SphereSample> masses = vertex_masses(mesh, image);
    move_vertices(balancing_boost(masses, image.hemisphere, image.imbalance), image);
    for (std::size_t v = 0; v < masses.size(); ++v)
        image.corner.push_back(point_of(image.scale[v] * vector_of(image.position[v])));
    Eigen::Map<Lorentz> boost(image.boost.data());
    boost.setIdentity();
    const Lorentz found = balancing_boost(area_samples(mesh, image), image.hemisphere, image.imbalance);
    boost = found;
    move_vertices(found, image);
}

/// Scales reach 1e260: no squares before a division.
Vector direction(const Vector& v) {
    return v.stableNormalized();
}

/// Collects samples in the place where the map is made, moved by the boost.
class Sampler {
  public:
    Sampler(const SphericalImage& image, double total_area)
        : boost_(Eigen::Map<const Lorentz>(image.boost.data())), total_area_(total_area) {}

    std::vector<SphereSample> samples;

    /// A triangle of vectors scale_i position_i, cut into four until it is narrow.
    void add_triangle(const Vector& a, const Vector& b, const Vector& c, double area) {
        const Vector pa = direction(a), pb = direction(b), pc = direction(c);
        const double width = std::max({(pa - pb).norm(), (pb - pc).norm(), (pc - pa).norm()});
        const Vector ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
        if (width <= kWidest || width * area <= kNothing * total_area_) {
            for (const Vector& middle : {ab, bc, ca}) add(middle, area / 3.0);
            return;
        }
        add_triangle(a, ab, ca, 0.25 * area);
        add_triangle(b, bc, ab, 0.25 * area);
        add_triangle(c, ca, bc, 0.25 * area);
        add_triangle(ab, bc, ca, 0.25 * area);
    }

    void add_edge(const Vector& a, const Vector& b, double weight, int depth = 0) {
        const Vector middle = 0.5 * (a + b);
        if ((direction(a) - direction(b)).norm() > kWidest && depth < kDeepest) {
            add_edge(a, middle, 0.5 * weight, depth + 1);
            add_edge(middle, b, 0.5 * weight, depth + 1);
            return;
        }
        const double offset = 0.5 / std::sqrt(3.0);
        for (const double t : {0.5 - offset, 0.5 + offset}) add((1.0 - t) * a + t * b, 0.5 * weight);
    }

  private:
    void add(const Vector& v, double weight) {
        samples.push_back({point_of(moved(boost_, direction(v)).first), weight});
    }

    Lorentz boost_;
    double total_area_;
};

Vector face_normal(const SurfaceMesh& mesh, Index face) {
    const auto corner = [&](Index k) {
        return vector_of(mesh.points[at(mesh.connectivity.tail[at(3 * face + k)])]);
    };
    return (corner(1) - corner(0)).cross(corner(2) - corner(0));
}

/// Half of length times exterior dihedral angle, of one halfedge of every inner edge; 0 elsewhere. // 3F
std::vector<double> edge_curvature(const SurfaceMesh& mesh) {
    const Connectivity& c = mesh.connectivity;
    std::vector<double> result(c.tail.size(), 0.0);
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index t = c.twin[at(h)];
        if (t < h) continue;  // also where there is none
        const Vector left = face_normal(mesh, face_of(h)), right = face_normal(mesh, face_of(t)),
                     edge =
                         (vector_of(mesh.points[at(c.head(h))]) - vector_of(mesh.points[at(c.tail[at(h)])]))
                             .normalized();
        const double angle = std::atan2(edge.dot(left.cross(right)), left.dot(right));
        result[at(h)] = 0.5 * angle * mesh.edge_length[at(h)];
    }
    return result;
}

/// Mean curvature at boundary vertices (0 at others): third of the faces around them times the density of
/// their inner neighbours; their own, incomplete, where they have none. // V
std::vector<double> boundary_curvature(const SurfaceMesh& mesh, const std::vector<double>& edge,
                                       const std::vector<std::uint8_t>& boundary) {
    const Connectivity& c = mesh.connectivity;
    const std::vector<double> face = face_areas(mesh);
    std::vector<double> own(boundary.size(), 0.0), area(boundary.size(), 0.0), inner(boundary.size(), 0.0),
        inner_area(boundary.size(), 0.0), result(boundary.size(), 0.0);
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        area[at(c.tail[at(h)])] += face[at(face_of(h))] / 3.0;
        for (const Index v : {c.tail[at(h)], c.head(h)}) own[at(v)] += 0.5 * edge[at(h)];
    }
    for (Index h = 0; h < c.halfedge_count(); ++h)
        for (const auto& [v, w] :
             {std::pair(c.tail[at(h)], c.head(h)), std::pair(c.head(h), c.tail[at(h)])}) {
            if (boundary[at(w)]) continue;
            inner[at(v)] += own[at(w)];
            inner_area[at(v)] += area[at(w)];
        }
    for (std::size_t v = 0; v < boundary.size(); ++v)
        if (boundary[v]) result[v] = inner_area[v] > 0.0 ? area[v] * inner[v] / inner_area[v] : own[v];
    return result;
}

}  // namespace

SphericalImage make_spherical_image(const SurfaceMesh& mesh, const FlowResult& flow) {
    const Topology topology = topology_of(mesh.connectivity);
    check_flow(flow, topology);
    SphericalImage image;
    image.hemisphere = topology.boundaries == 1;
    image.position.assign(at(mesh.connectivity.vertex_count), Point{});
    lay_out(flow, image);
    image.scale = scales_of(mesh, flow, image);
    if (image.hemisphere) straighten(mesh, image);
    centre_area(mesh, image);
    return image;
}

std::vector<SphereSample> area_samples(const SurfaceMesh& mesh, const SphericalImage& image) {
    const std::vector<double> area = face_areas(mesh);
    Sampler sampler(image, std::accumulate(area.begin(), area.end(), 0.0));
    sampler.samples.reserve(3 * area.size());
    for (std::size_t f = 0; f < area.size(); ++f) {
        const Index* tail = &mesh.connectivity.tail[3 * f];
        const auto corner = [&](std::size_t k) { return vector_of(image.corner[at(tail[k])]); };
        sampler.add_triangle(corner(0), corner(1), corner(2), area[f]);
    }
    return std::move(sampler.samples);
}

std::vector<SphereSample> mean_curvature_samples(const SurfaceMesh& mesh, const SphericalImage& image) {
    if (mesh.intrinsic()) throw std::invalid_argument("mean_curvature_samples: the surface is not embedded");
    const Connectivity& c = mesh.connectivity;
    const std::vector<std::uint8_t> boundary = boundary_vertices(c);
    const std::vector<double> edge = edge_curvature(mesh), rim = boundary_curvature(mesh, edge, boundary);
    Sampler sampler(image, 0.0);
    sampler.samples.reserve(c.tail.size());
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const auto i = at(c.tail[at(h)]), j = at(c.head(h));
        const double share = 1.0 - 0.5 * boundary[i] - 0.5 * boundary[j];
        if (share * edge[at(h)] != 0.0)
            sampler.add_edge(vector_of(image.corner[i]), vector_of(image.corner[j]), share * edge[at(h)]);
    }
    for (std::size_t v = 0; v < boundary.size(); ++v)
        if (boundary[v]) sampler.samples.push_back({image.position[v], rim[v]});
    return std::move(sampler.samples);
}

}  // namespace ricci
