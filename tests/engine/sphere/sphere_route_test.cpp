// The two routes to the sphere through solve_flow.
#include <Eigen/Dense>
#include <numbers>

#include "engine/flow/flow.h"
#include "io/mesh/mesh_file.h"
#include "tests/engine/sphere/sphere_checks.h"
#include "tests/support/test_data.h"

namespace ricci {
namespace {

using std::numbers::pi;

FlowResult flow(const SurfaceMesh& mesh, SphereRoute route) {
    FlowOptions options;
    options.sphere_route = route;
    return solve_flow(mesh, options);
}

TEST(SphereRoute, AreaIsThatOfTheSphere) {
    for (const bool closed : {true, false}) {
        const FlowResult r = flow(testing::jittered(closed ? "ellipsoid" : "disk", 500), SphereRoute::robust);
        EXPECT_EQ(r.outcome.status, Status::converged) << r.message;
        EXPECT_EQ(r.geometry, Geometry::spherical);
        EXPECT_LE(r.outcome.residual_max, 1e-10);
        // The sum of up to 250 curvatures, each below 1e-12 where u is exact to double.
        EXPECT_NEAR(r.area, (closed ? 4.0 : 2.0) * pi, 1e-10);
        EXPECT_LT(r.gauss_bonnet_error, 1e-11);
        EXPECT_EQ(r.doubled, !closed);
    }
}

TEST(SphereRoute, AgreesWithTheDirectFlowUpToMoebius) {
    // Two metrics of the sphere in one class: e^{u_robust - u_direct} = cosh t - sinh t <a, p>, p the points.
    for (const std::uint64_t seed : {1, 2, 3}) {
        const SurfaceMesh mesh = testing::jittered("sphere", 320, seed);
        const FlowResult direct = flow(mesh, SphereRoute::direct), robust = flow(mesh, SphereRoute::robust);
        ASSERT_EQ(direct.outcome.status, Status::converged) << direct.message;
        ASSERT_EQ(robust.outcome.status, Status::converged) << robust.message;
        const SphereResult placed = solve_sphere(make_flow_surface(mesh, false, true), {});
        const auto n = static_cast<Eigen::Index>(mesh.points.size());
        Eigen::MatrixXd columns(n, 4);
        Eigen::VectorXd ratio(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const auto v = static_cast<std::size_t>(i);
            for (Eigen::Index x = 0; x < 3; ++x)
                columns(i, x) = placed.position[v][static_cast<std::size_t>(x)];
            columns(i, 3) = 1.0;
            ratio(i) = std::exp(placed.u[v] - direct.conformal_factor[v]);
        }
        const Eigen::Vector4d fit = columns.colPivHouseholderQr().solve(ratio);
        // The direct flow stops at curvatures of 1e-10, over eigenvalues of some 1e-2.
        EXPECT_LT((columns * fit - ratio).cwiseAbs().maxCoeff(), 1e-8);
        EXPECT_NEAR(fit(3) * fit(3) - fit.head<3>().squaredNorm(), 1.0, 1e-8);
    }
}

TEST(SphereRoute, TargetsAndConesStayWithTheDirectFlow) {
    // A spindle over opposite vertices of an icosahedron: the robust route would make it round.
    FlowOptions options;
    options.geometry = Geometry::spherical;
    options.cones = {{0, 0.1}, {3, 0.1}};
    const FlowResult r = solve_flow(testing::icosahedron(), options);
    ASSERT_EQ(r.outcome.status, Status::converged) << r.message;
    EXPECT_NEAR(r.curvature[0], 0.1, 1e-10);
    EXPECT_NEAR(r.area, 4.0 * pi - 0.2, 1e-9);  // twelve residuals
}

TEST(SphereRoute, DirectFailsOnTheBunnyRobustDoesNot) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g0/bunny.obj");
    const SurfaceMesh mesh = load_mesh(path).components.at(0);
    EXPECT_NE(flow(mesh, SphereRoute::direct).outcome.status, Status::converged);
    const FlowResult robust = flow(mesh, SphereRoute::robust);
    EXPECT_EQ(robust.outcome.status, Status::converged) << robust.message;
    EXPECT_NEAR(robust.area, 4.0 * pi, 1e-10);
}

TEST(SphereRoute, NamesAreThoseOfTheCommandLine) {
    EXPECT_EQ(name_of(SphereRoute::robust), "robust");
    EXPECT_EQ(name_of(SphereRoute::direct), "direct");
}

}  // namespace
}  // namespace ricci
