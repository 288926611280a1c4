// The assembled Jacobian dK/du: against differences, its definiteness, and how it follows flips.
#include "engine/flow/hessian.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numeric>
#include <string>
#include <vector>

#include "engine/flow/metric.h"
#include "tests/support/dense_metric.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::Random;
constexpr std::array kGeometries = {Geometry::euclidean, Geometry::hyperbolic, Geometry::spherical};
constexpr std::array kPackings = {Scheme::inversive_distance, Scheme::thurston, Scheme::tangential,
                                  Scheme::virtual_radius};

std::vector<Index> identity(Index count) {
    std::vector<Index> unknown(at(count));
    std::iota(unknown.begin(), unknown.end(), Index{0});
    return unknown;
}

/// dK/du of all vertices of an input surface, assembled by the engine (times `side`, which folds a double).
Eigen::MatrixXd assembled(Metric& metric) {
    const FlowSurface& surface = metric.surface();
    HessianAssembler assembler;
    assembler.build(metric.connectivity(), surface.orbit, surface.vertex_count());
    std::vector<double> values;
    assembler.assemble(metric.connectivity(), metric.off(), metric.diagonal(), -1, values);
    return surface.side * testing::dense_of(assembler.pattern(), values);
}

/// A mesh of radius about `size`, small enough for the sphere.
SurfaceMesh scaled(SurfaceMesh mesh, double size) {
    for (Point& p : mesh.points)
        for (double& x : p) x *= size;
    for (double& l : mesh.edge_length) l *= size;
    return mesh;
}

void expect_matches_differences(Metric& metric, const std::vector<double>& u, const std::string& what) {
    ASSERT_TRUE(metric.move_to(u)) << what;
    ASSERT_TRUE(metric.evaluate(true)) << what;
    const Eigen::MatrixXd exact = assembled(metric);
    const double step = 1e-5;
    const Eigen::MatrixXd differences = testing::difference_jacobian(metric, u, step);
    // step^2 times third derivatives of up to 1e3, and 1e-14/step.
    EXPECT_LT((exact - differences).cwiseAbs().maxCoeff(), 3e-7 * (1 + exact.cwiseAbs().maxCoeff())) << what;
    EXPECT_LT((differences - differences.transpose()).cwiseAbs().maxCoeff(),
              3e-7 * (1 + exact.cwiseAbs().maxCoeff()))
        << what << ": the differences themselves are symmetric";
}

TEST(Hessian, VertexScalingAgreesWithDifferences) {
    Random random(1);
    for (const Geometry geometry : kGeometries)
        for (const bool doubled : {false, true}) {
            for (const SurfaceMesh& mesh :
                 {scaled(testing::bumpy_torus(6, 5), 0.1), scaled(testing::wavy_square(4, 0.2), 0.5)}) {
                const FlowSurface surface = make_flow_surface(mesh, doubled, true);
                ScaledMetric<double> metric(surface, geometry, false);
                const auto u = random.uniforms(at(surface.vertex_count()), -0.3, 0.3);
                expect_matches_differences(metric, u,
                                           std::string(name_of(geometry)) + (doubled ? ", doubled" : ""));
            }
        }
}

TEST(Hessian, CirclePackingsAgreeWithDifferences) {
    Random random(2);
    for (const Geometry geometry : kGeometries)
        for (const Scheme scheme : kPackings)
            for (const SurfaceMesh& mesh :
                 {scaled(testing::bumpy_torus(6, 5), 0.1), scaled(testing::wavy_square(4), 0.5)}) {
                const FlowSurface surface = make_flow_surface(mesh, false, false);
                const CirclePacking packing =
                    initial_circle_packing(mesh.connectivity, mesh.edge_length, geometry, scheme);
                PackedMetric metric(surface, packing, geometry, false);
                std::vector<double> u = packing.u;
                for (double& x : u) x += random.uniform(-0.02, 0.02);
                expect_matches_differences(
                    metric, u, std::string(name_of(geometry)) + " " + std::string(name_of(scheme)));
            }
}

TEST(Hessian, IsSemidefiniteInThePlaneWithConstantsAsKernel) {
    Random random(3);
    const SurfaceMesh mesh = testing::bumpy_torus(7, 6);
    const auto check = [](Metric& metric) {
        const Eigen::MatrixXd h = assembled(metric);
        const Eigen::VectorXd values = h.selfadjointView<Eigen::Lower>().eigenvalues();
        // Entries of order 10 rounded to 1e-15: the zero eigenvalue to 1e-12; the next is of order 4 pi^2/42
        // at least.
        EXPECT_NEAR(values(0), 0.0, 1e-12);
        EXPECT_GT(values(1), 0.01);
        EXPECT_LT((h * Eigen::VectorXd::Ones(h.rows())).cwiseAbs().maxCoeff(), 1e-12);
    };
    const FlowSurface surface = make_flow_surface(mesh, false, true);
    ScaledMetric<double> metric(surface, Geometry::euclidean, false);
    ASSERT_TRUE(metric.move_to(random.uniforms(42, -1, 1)));
    ASSERT_TRUE(metric.evaluate(true));
    check(metric);
    const FlowSurface plain = make_flow_surface(mesh, false, false);
    for (const Scheme scheme : {Scheme::tangential, Scheme::thurston}) {
        // eta in [0, 1]: never broken (Thurston), for any radii.
        const CirclePacking packing =
            initial_circle_packing(mesh.connectivity, mesh.edge_length, Geometry::euclidean, scheme);
        PackedMetric packed(plain, packing, Geometry::euclidean, false);
        ASSERT_TRUE(packed.move_to(random.uniforms(42, -1, 1)));
        ASSERT_TRUE(packed.evaluate(true)) << name_of(scheme);
        check(packed);
    }
}

TEST(Hessian, IsPositiveDefiniteInTheHyperbolicPlane) {
    Random random(4);
    const SurfaceMesh mesh = testing::bumpy_torus(7, 6);
    const auto smallest = [](Metric& metric) {
        return assembled(metric).selfadjointView<Eigen::Lower>().eigenvalues().minCoeff();
    };
    const FlowSurface surface = make_flow_surface(mesh, false, true);
    ScaledMetric<double> metric(surface, Geometry::hyperbolic, false);
    for (int trial = 0; trial < 5; ++trial) {
        ASSERT_TRUE(metric.move_to(random.uniforms(42, -1, 1)));
        ASSERT_TRUE(metric.evaluate(true));
        EXPECT_GT(smallest(metric), 1e-3);
    }
    const FlowSurface plain = make_flow_surface(mesh, false, false);
    for (const Scheme scheme : {Scheme::tangential, Scheme::thurston})
        for (int trial = 0; trial < 5; ++trial) {
            const CirclePacking packing =
                initial_circle_packing(mesh.connectivity, mesh.edge_length, Geometry::hyperbolic, scheme);
            PackedMetric packed(plain, packing, Geometry::hyperbolic, false);
            ASSERT_TRUE(packed.move_to(random.uniforms(42, -2.5, -0.5)));
            ASSERT_TRUE(packed.evaluate(true)) << name_of(scheme);
            EXPECT_GT(smallest(packed), 1e-3);
        }
    // The sphere is another matter: scaling up lowers curvature.
    const FlowSurface round = make_flow_surface(scaled(testing::icosahedron(0.1), 0.3), false, true);
    ScaledMetric<double> spherical(round, Geometry::spherical, false);
    ASSERT_TRUE(spherical.move_to(std::vector<double>(12, 0.0)));
    ASSERT_TRUE(spherical.evaluate(true));
    EXPECT_LT(smallest(spherical), -1e-3);
}

/// Random flips, any that are possible; the faces touched.
std::vector<Index> flip_some(IntrinsicTriangulation<double>& t, int count, Random& random) {
    std::vector<Index> touched;
    for (int k = 0; k < count; ++k) {
        const auto h = random.below(t.connectivity.halfedge_count());
        if (!flippable(t.connectivity, h)) continue;
        touched.push_back(face_of(h));
        touched.push_back(face_of(t.connectivity.twin[at(h)]));
        flip_edge<double>(t.connectivity, t.log_chord, h, random.uniform(-1, 1));
    }
    return touched;
}

/// The matrix straight from its definition: sums over corners, unknown by unknown.
Eigen::MatrixXd by_definition(const Connectivity& c, const std::vector<Index>& unknown, Index count,
                              const std::vector<double>& off, const std::vector<double>& diagonal) {
    Eigen::MatrixXd m = Eigen::MatrixXd::Zero(count, count);
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index i = unknown[at(c.tail[at(h)])], j = unknown[at(c.head(h))];
        if (i >= 0) m(i, i) -= diagonal[at(h)];
        if (i < 0 || j < 0) continue;
        m(i, j) -= off[at(h)];  // d theta_i / d u_j
        m(j, i) -= off[at(h)];  // d theta_j / d u_i
    }
    return m;
}

TEST(Hessian, FollowsFlipsLikeAFreshBuild) {
    Random random(5);
    const std::vector<IntrinsicTriangulation<double>> starts = {
        intrinsic_triangulation<double>(testing::octahedron()),
        intrinsic_triangulation<double>(testing::bumpy_torus(5, 4)),
        intrinsic_triangulation<double>(testing::wavy_square(4)),
        testing::one_vertex_torus<double>(1, 1.1, 1.2), testing::folded_square<double>(1)};
    int same_pattern = 0, new_pattern = 0, loops = 0;
    for (const auto& start : starts)
        for (int trial = 0; trial < 12; ++trial) {
            auto t = start;
            const Index vertices = t.connectivity.vertex_count;
            // Thirds of the trials: all vertices; some fixed; some folded onto others.
            std::vector<Index> unknown = identity(vertices);
            Index count = vertices;
            if (trial % 3 == 1 && vertices > 2) {
                count = 0;
                for (Index& i : unknown) i = random.uniform(0, 1) < 0.3 && count > 0 ? -1 : count++;
            } else if (trial % 3 == 2) {
                count = (vertices + 1) / 2;
                for (Index& i : unknown) i = i % count;
            }
            HessianAssembler followed;
            followed.build(t.connectivity, unknown, count);
            for (int round = 0; round < 6; ++round) {
                const auto touched = flip_some(t, round < 3 ? 1 : 20, random);
                (followed.follow_flips(t.connectivity, touched) ? new_pattern : same_pattern) += 1;
                const auto off = random.uniforms(t.log_chord.size(), -1, 1),
                           diagonal = random.uniforms(t.log_chord.size(), -1, 1);
                for (Index h = 0; h < t.connectivity.halfedge_count(); ++h)
                    loops += t.connectivity.tail[at(h)] == t.connectivity.head(h) ? 1 : 0;
                std::vector<double> values;
                followed.assemble(t.connectivity, off, diagonal, -1, values);
                HessianAssembler fresh;
                fresh.build(t.connectivity, unknown, count);
                std::vector<double> fresh_values;
                fresh.assemble(t.connectivity, off, diagonal, -1, fresh_values);
                const Eigen::MatrixXd a = testing::dense_of(followed.pattern(), values),
                                      b = testing::dense_of(fresh.pattern(), fresh_values),
                                      c = by_definition(t.connectivity, unknown, count, off, diagonal);
                // The same numbers added in the same order; against the definition in another one.
                EXPECT_EQ((a - b).cwiseAbs().maxCoeff(), 0.0);
                EXPECT_LT((a - c).cwiseAbs().maxCoeff(), 1e-12);
            }
        }
    EXPECT_GT(same_pattern, 10);
    EXPECT_GT(new_pattern, 10);
    EXPECT_GT(loops, 10);
}

TEST(Hessian, PatternIsSortedAndUnique) {
    Random random(6);
    auto t = intrinsic_triangulation<double>(testing::bumpy_torus(5, 4));
    flip_some(t, 200, random);
    HessianAssembler assembler;
    assembler.build(t.connectivity, identity(20), 20);
    const SymmetricPattern& p = assembler.pattern();
    ASSERT_EQ(p.size(), 20);
    for (std::size_t j = 0; j < 20; ++j) {
        EXPECT_EQ(p.row[at(p.column_begin[j])], static_cast<Index>(j)) << "the diagonal comes first";
        EXPECT_EQ(assembler.diagonal_positions()[j], p.column_begin[j]);
        for (Index q = p.column_begin[j] + 1; q < p.column_begin[j + 1]; ++q)
            EXPECT_LT(p.row[at(q) - 1], p.row[at(q)]);
    }
}

TEST(Hessian, PinningMakesOneRowTheIdentity) {
    const SurfaceMesh mesh = testing::icosahedron(0.1);
    const FlowSurface surface = make_flow_surface(mesh, false, true);
    ScaledMetric<double> metric(surface, Geometry::euclidean, false);
    ASSERT_TRUE(metric.move_to(std::vector<double>(12, 0.0)));
    ASSERT_TRUE(metric.evaluate(true));
    HessianAssembler assembler;
    assembler.build(metric.connectivity(), identity(12), 12);
    std::vector<double> free_values, pinned_values;
    assembler.assemble(metric.connectivity(), metric.off(), metric.diagonal(), -1, free_values);
    assembler.assemble(metric.connectivity(), metric.off(), metric.diagonal(), 5, pinned_values);
    Eigen::MatrixXd expected = testing::dense_of(assembler.pattern(), free_values);
    expected.row(5).setZero();
    expected.col(5).setZero();
    expected(5, 5) = 1;
    EXPECT_EQ(testing::dense_of(assembler.pattern(), pinned_values), expected);
    EXPECT_GT(expected.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.01);
}

}  // namespace
}  // namespace ricci
