// The initial circle packings of a surface.
#include "engine/flow/scheme.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "kernels/face_kernels.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using testing::at;
constexpr std::array kGeometries = {Geometry::euclidean, Geometry::hyperbolic, Geometry::spherical};

std::vector<double> scaled_lengths(const SurfaceMesh& mesh, double factor) {
    std::vector<double> length = mesh.edge_length;
    for (double& l : length) l *= factor;
    return length;
}

TEST(CirclePacking, ExactSchemesReproduceTheLengths) {
    const SurfaceMesh mesh = testing::bumpy_torus(8, 7);
    const auto length = scaled_lengths(mesh, 0.2);
    for (const Geometry geometry : kGeometries)
        for (const Scheme scheme : {Scheme::inversive_distance, Scheme::virtual_radius}) {
            const CirclePacking p = initial_circle_packing(mesh.connectivity, length, geometry, scheme);
            std::vector<double> made(length.size());
            packed_edge_lengths(geometry, {mesh.connectivity.tail, p.eta, p.eps, p.u}, made);
            // cosh l - cosh r cosh r' cancels: l^2 of 0.01 against 1, so 100 eps and the square root's half
            // of it back.
            for (std::size_t h = 0; h < made.size(); ++h)
                EXPECT_NEAR(made[h] / length[h], 1.0, 1e-12) << name_of(geometry);
            EXPECT_LT(p.max_length_error, 1e-12);
            EXPECT_LE(p.mean_length_error, p.max_length_error);
            EXPECT_EQ(p.clipped_edges, 0);
        }
}

TEST(CirclePacking, RadiiAreAveragesOverCorners) {
    // In the octahedron every corner radius is half an edge.
    const SurfaceMesh mesh = testing::octahedron();
    const CirclePacking p =
        initial_circle_packing(mesh.connectivity, mesh.edge_length, Geometry::euclidean, Scheme::tangential);
    for (const double u : p.u) EXPECT_NEAR(u, std::log(std::sqrt(2.0) / 2), 1e-15);
    EXPECT_LT(p.max_length_error, 1e-15);
    for (const double e : p.eta) EXPECT_EQ(e, 1.0);
    // Tangential packings of an uneven mesh miss its lengths, and say so.
    const SurfaceMesh uneven = testing::bumpy_torus(8, 7);
    const CirclePacking q = initial_circle_packing(uneven.connectivity, uneven.edge_length,
                                                   Geometry::euclidean, Scheme::tangential);
    EXPECT_GT(q.max_length_error, 0.05);
    EXPECT_GT(q.mean_length_error, 0.01);
    EXPECT_LT(q.mean_length_error, q.max_length_error);
}

TEST(CirclePacking, ThurstonClipsExactlyTheEdgesOutsideItsRange) {
    const SurfaceMesh mesh = testing::bumpy_torus(8, 7);
    const Connectivity& c = mesh.connectivity;
    for (const Geometry geometry : kGeometries) {
        const auto length = scaled_lengths(mesh, 0.2);
        const CirclePacking exact = initial_circle_packing(c, length, geometry, Scheme::inversive_distance);
        const CirclePacking p = initial_circle_packing(c, length, geometry, Scheme::thurston);
        EXPECT_EQ(p.u, exact.u);
        std::vector<int> clipped(at(c.edge_count), 0);
        for (std::size_t h = 0; h < p.eta.size(); ++h) {
            EXPECT_GE(p.eta[h], 0.0);
            EXPECT_LE(p.eta[h], 1.0);
            if (exact.eta[h] >= 0.0 && exact.eta[h] <= 1.0) {
                EXPECT_EQ(p.eta[h], exact.eta[h]);
            } else {
                clipped[at(c.edge[h])] = 1;
            }
        }
        std::int64_t count = 0;
        for (const int k : clipped) count += k;
        EXPECT_GT(count, 0);
        EXPECT_EQ(p.clipped_edges, count);
    }
}

TEST(CirclePacking, EtaIsEqualOnTwins) {
    const SurfaceMesh mesh = testing::bumpy_torus(5, 6);
    for (const Scheme scheme :
         {Scheme::inversive_distance, Scheme::thurston, Scheme::tangential, Scheme::virtual_radius}) {
        const CirclePacking p =
            initial_circle_packing(mesh.connectivity, mesh.edge_length, Geometry::euclidean, scheme);
        for (Index h = 0; h < mesh.connectivity.halfedge_count(); ++h)
            // The two ends enter symmetrically, but for the order of a product.
            EXPECT_NEAR(p.eta[at(h)], p.eta[at(mesh.connectivity.twin[at(h)])],
                        1e-14 * (1 + std::abs(p.eta[at(h)])));
    }
}

}  // namespace
}  // namespace ricci
