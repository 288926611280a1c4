#include "engine/flow/scheme.h"

#include <algorithm>
#include <cmath>

#include "kernels/face_kernels.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

std::vector<double> average_radii(const Connectivity& c, std::span<const double> length) {
    std::vector<double> sum(at(c.vertex_count), 0.0), count(at(c.vertex_count), 0.0);
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const double radius =
            0.5 * (length[at(h)] + length[at(prev_halfedge(h))] - length[at(next_halfedge(h))]);
        sum[at(c.tail[at(h)])] += radius;
        count[at(c.tail[at(h)])] += 1.0;
    }
    for (std::size_t v = 0; v < sum.size(); ++v) sum[v] = count[v] > 0.0 ? sum[v] / count[v] : 1.0;
    return sum;
}

/// eps and eta enter as l of the packing; solve the length formula for the inversive distance of two circles.
double inversive(Geometry geometry, double l, double ri, double rj) {
    switch (geometry) {
        case Geometry::hyperbolic:
            return (std::cosh(l) - std::cosh(ri) * std::cosh(rj)) / (std::sinh(ri) * std::sinh(rj));
        case Geometry::spherical:
            return (std::cos(ri) * std::cos(rj) - std::cos(l)) / (std::sin(ri) * std::sin(rj));
        case Geometry::euclidean:
            break;
    }
    return (l * l - ri * ri - rj * rj) / (2.0 * ri * rj);
}

double conformal_radius(Geometry geometry, double radius) {
    switch (geometry) {
        case Geometry::hyperbolic:
            return std::log(std::tanh(radius / 2.0));
        case Geometry::spherical:
            return std::log(std::tan(radius / 2.0));
        case Geometry::euclidean:
            break;
    }
    return std::log(radius);
}

/// The eta that reproduces the length l for any eps and u: the length formula of face_kernels.h solved for
/// eta.
double eta_of_length(Geometry geometry, double l, double eps, double ui, double uj) {
    const double kappa = curvature_sign(geometry);
    const double chord =
        geometry == Geometry::euclidean
            ? l
            : (geometry == Geometry::hyperbolic ? 2.0 * std::sinh(l / 2.0) : 2.0 * std::sin(l / 2.0));
    const double q = geometry == Geometry::euclidean ? 1.0 : 4.0;
    const double ei = eps * std::exp(2.0 * ui), ej = eps * std::exp(2.0 * uj);
    return (chord * chord * (1.0 + kappa * ei) * (1.0 + kappa * ej) / q - ei - ej) /
           (2.0 * std::exp(ui + uj));
}

}  // namespace

std::string_view name_of(Scheme scheme) {
    switch (scheme) {
        case Scheme::inversive_distance:
            return "inversive-distance";
        case Scheme::thurston:
            return "thurston";
        case Scheme::tangential:
            return "tangential";
        case Scheme::virtual_radius:
            return "virtual-radius";
        case Scheme::vertex_scaling:
            break;
    }
    return "vertex-scaling";
}

CirclePacking initial_circle_packing(const Connectivity& c, std::span<const double> length, Geometry geometry,
                                     Scheme scheme) {
    const std::vector<double> radius = average_radii(c, length);
    CirclePacking packing;
    packing.eps.assign(at(c.vertex_count), scheme == Scheme::virtual_radius ? -1.0 : 1.0);
    packing.u.resize(at(c.vertex_count));
    for (std::size_t v = 0; v < packing.u.size(); ++v) packing.u[v] = conformal_radius(geometry, radius[v]);
    packing.eta.resize(length.size());
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const auto i = at(c.tail[at(h)]), j = at(c.head(h));
        double& eta = packing.eta[at(h)];
        switch (scheme) {
            case Scheme::tangential:
                eta = 1.0;
                break;
            case Scheme::thurston: {
                const double cosine = inversive(geometry, length[at(h)], radius[i], radius[j]);
                eta = std::clamp(cosine, 0.0, 1.0);
                const Index t = c.twin[at(h)];
                if (eta != cosine && (t == kNoTwin || t > h)) ++packing.clipped_edges;
                break;
            }
            case Scheme::inversive_distance:
                eta = inversive(geometry, length[at(h)], radius[i], radius[j]);
                break;
            case Scheme::virtual_radius:
            case Scheme::vertex_scaling:
                eta = eta_of_length(geometry, length[at(h)], packing.eps[i], packing.u[i], packing.u[j]);
                break;
        }
    }
    std::vector<double> made(length.size());
    packed_edge_lengths(geometry, {c.tail, packing.eta, packing.eps, packing.u}, made);
    for (std::size_t h = 0; h < made.size(); ++h) {
        const double error = std::abs(made[h] - length[h]) / length[h];
        packing.max_length_error = std::max(packing.max_length_error, error);
        packing.mean_length_error += error / static_cast<double>(made.size());
    }
    return packing;
}

}  // namespace ricci
