#include "engine/shape_space/sphere_descriptor.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "engine/shape_space/spherical_harmonics.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

const double kSphereArea = 4.0 * std::numbers::pi;

/// Coefficients of one field, index as of harmonic_index; empty: not there.
struct Field {
    std::string name;
    int lowest_degree = 0;
    std::vector<double> coefficient;
};

std::vector<double> moments(int degree, const std::vector<SphereSample>& samples) {
    std::vector<double> sum(harmonic_count(degree), 0.0), value(sum.size());
    for (const SphereSample& s : samples) {
        spherical_harmonics(degree, s.position, value);
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += s.weight * value[k];
    }
    return sum;
}

/// Multiplies every coefficient by factor(l).
template <class Factor>
void scale_degrees(int degree, std::vector<double>& coefficient, const Factor& factor) {
    for (int l = 0; l <= degree; ++l)
        for (int m = -l; m <= l; ++m) coefficient[harmonic_index(l, m)] *= factor(l);
}

/// Angle opposite to side a, from lengths.
double angle_opposite(double a, double b, double c) {
    const double s = 0.5 * (a + b + c);
    return 2.0 *
           std::atan2(std::sqrt(std::max(0.0, (s - b) * (s - c))), std::sqrt(std::max(0.0, s * (s - a))));
}

/// Angle defects (on the boundary from pi) where the vertices lie.
std::vector<SphereSample> curvature_samples(const SurfaceMesh& mesh, const SphericalImage& image) {
    const std::vector<std::uint8_t> boundary = boundary_vertices(mesh.connectivity),
                                    used = used_vertices(mesh.connectivity);
    std::vector<SphereSample> samples(boundary.size());
    for (std::size_t v = 0; v < samples.size(); ++v)
        samples[v] = {image.position[v], used[v] ? (boundary[v] ? 1.0 : 2.0) * std::numbers::pi : 0.0};
    for (Index h = 0; h < mesh.connectivity.halfedge_count(); ++h)
        samples[at(mesh.connectivity.tail[at(h)])].weight -=
            angle_opposite(mesh.edge_length[at(next_halfedge(h))], mesh.edge_length[at(h)],
                           mesh.edge_length[at(prev_halfedge(h))]);
    return samples;
}

/// Area of a spherical triangle by Oosterom and Strackee, signed.
double spherical_area(const Point& p, const Point& q, const Point& r) {
    const auto dot = [](const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    const double volume = p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) +
                          p[2] * (q[0] * r[1] - q[1] * r[0]);
    return 2.0 * std::atan2(volume, 1.0 + dot(p, q) + dot(q, r) + dot(r, p));
}

/// Mean over the (half) sphere of the log of the scale.
double mean_log_scale(const SurfaceMesh& mesh, const SphericalImage& image) {
    double sum = 0.0, area = 0.0;
    for (Index f = 0; f < mesh.connectivity.face_count(); ++f) {
        const Index* v = &mesh.connectivity.tail[3 * at(f)];
        const double share =
            spherical_area(image.position[at(v[0])], image.position[at(v[1])], image.position[at(v[2])]);
        for (std::size_t k = 0; k < 3; ++k) sum += share / 3.0 * std::log(image.scale[at(v[k])]);
        area += share;
    }
    return sum / area;
}

/// Six times the signed volume.
double volume_of(const SurfaceMesh& mesh) {
    double sum = 0.0;
    const Point& o = mesh.points[at(mesh.connectivity.tail[0])];
    for (Index f = 0; f < mesh.connectivity.face_count(); ++f) {
        std::array<Point, 3> p;
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t i = 0; i < 3; ++i)
                p[k][i] = mesh.points[at(mesh.connectivity.tail[3 * at(f) + k])][i] - o[i];
        sum += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
               p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
               p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
    }
    return sum;
}

/// The fields on the sphere, scaled as documented. A disk's are those of its double: of harmonics that are
/// even under the mirror the integral over both halves is twice that over one.
std::vector<Field> expand(const SurfaceMesh& mesh, const SphericalImage& image, int degree) {
    const double copies = image.hemisphere ? 2.0 : 1.0;
    const std::vector<double> face_area = face_areas(mesh);
    const double area = copies * std::accumulate(face_area.begin(), face_area.end(), 0.0);
    const auto legendre = [](int l) { return std::sqrt(kSphereArea / (2.0 * l + 1.0)); };
    std::vector<Field> fields{{"area", 2, moments(degree, area_samples(mesh, image))},
                              {"factor", 0, moments(degree, curvature_samples(mesh, image))}};
    scale_degrees(degree, fields[0].coefficient, [&](int l) { return copies / area * legendre(l); });
    scale_degrees(degree, fields[1].coefficient,
                  [&](int l) { return copies / (l * (l + 1.0)) / std::sqrt(kSphereArea); });
    fields[1].coefficient[0] = mean_log_scale(mesh, image) + 0.5 * std::log(kSphereArea / area);
    if (mesh.intrinsic()) return fields;
    fields.push_back({"mean_curvature", 0, moments(degree, mean_curvature_samples(mesh, image))});
    const double sign = !image.hemisphere && volume_of(mesh) < 0.0 ? -1.0 : 1.0;
    scale_degrees(degree, fields[2].coefficient,
                  [&](int l) { return sign * copies / std::sqrt(area * kSphereArea) * legendre(l); });
    return fields;
}

/// Appends what no orthogonal map of the block's harmonics changes.
void append_block(const std::vector<Field>& fields, int degree, const std::vector<std::size_t>& block,
                  const std::string& suffix, SphereDescriptor& result) {
    const auto append = [&](const std::string& name, double value) {
        result.values.push_back(value);
        result.names.push_back(name + suffix);
    };
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const Field& x = fields[i];
        if (degree < x.lowest_degree) continue;
        double norm = 0.0;
        for (const std::size_t k : block) norm += x.coefficient[k] * x.coefficient[k];
        append(x.name, block.size() == 1 ? x.coefficient[block[0]] : std::sqrt(norm));
        for (std::size_t j = i + 1; j < fields.size() && block.size() > 1; ++j) {
            const Field& y = fields[j];
            double sum = 0.0;
            for (const std::size_t k : block) sum += std::pow(x.coefficient[k] + y.coefficient[k], 2);
            append(x.name + "+" + y.name, std::sqrt(0.5 * sum));
        }
    }
}

}  // namespace

SphereDescriptor make_sphere_descriptor(const SurfaceMesh& mesh, const FlowResult& flow,
                                        const SphereDescriptorOptions& options) {
    if (options.max_degree < 0 || options.max_degree > 100)
        throw std::invalid_argument("make_sphere_descriptor: the degree must lie between 0 and 100");
    const SphericalImage image = make_spherical_image(mesh, flow);
    const int degree =
        options.max_degree > 0 ? options.max_degree : (image.hemisphere ? kDiskDegree : kSphereDegree);
    const std::vector<Field> fields = expand(mesh, image, degree);
    SphereDescriptor result;
    for (int l = 0; l <= degree; ++l) {
        if (!image.hemisphere) {
            std::vector<std::size_t> block;
            for (int m = -l; m <= l; ++m) block.push_back(harmonic_index(l, m));
            append_block(fields, l, block, fmt::format("_{}", l), result);
            continue;
        }
        for (int m = l % 2; m <= l; m += 2) {
            std::vector<std::size_t> block{harmonic_index(l, m)};
            if (m > 0) block.push_back(harmonic_index(l, -m));
            append_block(fields, l, block, fmt::format("_{}_{}", l, m), result);
        }
    }
    result.embedded = !mesh.intrinsic();
    result.imbalance = image.imbalance;
    if (mesh.intrinsic()) result.message = "intrinsic surface: no mean curvature, conformal factor only";
    constexpr double kBalanced = 1e-9;
    if (image.imbalance > kBalanced)
        result.message += fmt::format("{}the centre of area stays {:.3g} from the centre of the sphere",
                                      result.message.empty() ? "" : "; ", image.imbalance);
    return result;
}

}  // namespace ricci
