// All closed geodesics up to a length, each once: against other ways to find them.
#include "engine/shape_space/closed_geodesics.h"

#include "tests/engine/shape_space/dirichlet_domain.h"
#include "tests/engine/shape_space/spectrum_checks.h"

namespace ricci {
namespace {

using testing::at;
using testing::generated;
using testing::NamedMesh;
using testing::thinned;

std::vector<NamedMesh> surfaces() {
    return {{"eight", generated("eight", 400, 0.4)},
            {"genus 3", generated("genus-g", 600, 0.4, 3)},
            {"pants", generated("pants", 300, 0.4)},
            {"genus 2, one boundary", generated("genus-g-one-boundary", 500, 0.3)},
            {"bolza", make_bolza()},
            {"klein quartic", testing::scrambled(make_klein_quartic(), 300, 4)}};
}

/// The spectrum of a closed surface by its Dirichlet domain, from the group of its layout, compared with
/// ours.
void expect_complete(const SurfaceMesh& mesh, double max_length, std::size_t at_least) {
    StructureOptions options;
    options.flow.tolerance = 1e-12;
    const SurfaceStructure structure = testing::structure_of(mesh, options);
    const testing::DirichletDomain domain(structure.group.letters, topology_of(mesh.connectivity).genus);
    const std::vector<double> expected = domain.lengths(max_length);
    const std::vector<double> found = testing::lengths_up_to(mesh, max_length, options.flow);
    EXPECT_GE(expected.size(), at_least);
    // Products of side pairings lose e^d in both lengths and normals: d is at most 15 here.
    testing::expect_same_lengths(found, expected, 1e-8);
}

TEST(ClosedGeodesics, AreThoseOfTheDirichletDomain) {
    expect_complete(generated("eight", 500, 0.3), 6.0, 40);
    expect_complete(generated("genus-g", 600, 0.2, 3), 4.0, 8);
}

TEST(ClosedGeodesics, AreThoseOfTheDirichletDomainOfBolza) {
    expect_complete(testing::scrambled(make_bolza(), 40, 2), 6.2, 60);
}

TEST(ClosedGeodesics, AreThoseOfTheDirichletDomainOfTheSmallEight) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g2/eight_173v.off");
    expect_complete(testing::load_component(path), 5.5, 28);
}

TEST(ClosedGeodesics, DoNotDependOnTheVerticesThatStay) {
    for (const NamedMesh& item : surfaces()) {
        SCOPED_TRACE(item.name);
        const std::vector<double> plain =
            testing::lengths_of(testing::spectrum_up_to(thinned(item.mesh, 0.9), 5.0));
        for (const double spacing : {0.5, 1.3, 2.5}) {
            const CoarseSurface s = thinned(item.mesh, spacing);
            testing::expect_same_lengths(testing::lengths_of(testing::spectrum_up_to(s, 5.0)), plain, 1e-9);
        }
    }
}

TEST(ClosedGeodesics, FollowingFindsNoPassThatEnumerationMissed) {
    for (const NamedMesh& item : surfaces())
        for (const double spacing : {0.5, 0.9, 1.3}) {
            SCOPED_TRACE(item.name);
            const ClosedGeodesics found = find_closed_geodesics(thinned(item.mesh, spacing), 5.5);
            EXPECT_EQ(found.missed, 0);
            EXPECT_EQ(found.complete_up_to, 5.5);
            EXPECT_FALSE(found.primitive.empty());
            for (std::size_t k = 1; k < found.primitive.size(); ++k)
                EXPECT_LE(found.primitive[k - 1].length, found.primitive[k].length);
        }
}

/// Passes of a geodesic lie within the radii of their vertices, their offsets go once around it, and every
/// stretch of it is within the radius of some vertex.
void expect_whole(const CoarseSurface& s, const ClosedGeodesic& g) {
    struct Reach {
        double begin, end;
    };
    std::vector<Reach> covered;
    for (const GeodesicPass& p : g.passes) {
        ASSERT_NEAR(minkowski(p.normal, p.normal), 1.0, 1e-8);
        ASSERT_GE(p.offset, 0.0);
        ASSERT_LE(p.offset, g.length);
        // cosh r = cosh(distance) cosh(half of the chord).
        const double away = std::sqrt(1 + p.normal[2] * p.normal[2]),
                     half = std::acosh(std::max(1.0, std::cosh(s.radius[at(p.vertex)]) / away));
        ASSERT_LE(std::abs(p.normal[2]), std::sinh(s.radius[at(p.vertex)]) * (1 + 1e-6));
        for (const double turn : {-g.length, 0.0, g.length})
            covered.push_back({p.offset + turn - half, p.offset + turn + half});
        // The translation along the line is the geodesic's own length.
        const Isometry<double> x = translation_along(p.normal, g.length);
        ASSERT_NEAR(translation_length(x), g.length, 1e-9 * (1 + g.length));
        const Minkowski n = axis_normal(x);
        for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(n[k], p.normal[k], 1e-6);
    }
    std::sort(covered.begin(), covered.end(),
              [](const Reach& x, const Reach& y) { return x.begin < y.begin; });
    double upto = 0;
    for (const Reach& r : covered)
        if (r.begin <= upto + 1e-6) upto = std::max(upto, r.end);
    ASSERT_GE(upto, g.length - 1e-6);
}

TEST(ClosedGeodesics, PassesCoverTheWholeGeodesic) {
    for (const NamedMesh& item : surfaces()) {
        SCOPED_TRACE(item.name);
        const CoarseSurface s = thinned(item.mesh);
        for (const ClosedGeodesic& g : find_closed_geodesics(s, 5.5).primitive) expect_whole(s, g);
    }
}

TEST(ClosedGeodesics, AxesAtAVertexAreItsPasses) {
    for (const NamedMesh& item : surfaces()) {
        SCOPED_TRACE(item.name);
        const CoarseSurface s = thinned(item.mesh);
        const ClosedGeodesics all = find_closed_geodesics(s, 5.0);
        std::vector<Index> passes(at(s.connectivity.vertex_count), 0);
        for (const ClosedGeodesic& g : all.primitive)
            for (const GeodesicPass& p : g.passes) ++passes[at(p.vertex)];
        for (Index v = 0; v < s.connectivity.vertex_count; ++v) {
            std::int64_t budget = 1000000000;
            const std::vector<AxisAt> axes = axes_at(s, v, 5.0, budget);
            EXPECT_GE(budget, 0);
            // On the most symmetric surfaces axes lie at the radius exactly, here or there by rounding.
            if (!item.mesh.intrinsic()) {
                EXPECT_EQ(static_cast<Index>(axes.size()), passes[at(v)]);
            }
            for (std::size_t k = 0; k < axes.size(); ++k) {
                EXPECT_GE(axes[k].length, axes[k == 0 ? 0 : k - 1].length);
                ASSERT_NEAR(translation_length(axes[k].element), axes[k].length, 1e-12);
                const ClosedGeodesic g = follow_geodesic(s, v, axes[k].normal, axes[k].length);
                const bool known =
                    std::any_of(all.primitive.begin(), all.primitive.end(), [&](const auto& x) {
                        return x.passes.size() == g.passes.size() && std::abs(x.length - g.length) < 1e-9;
                    });
                EXPECT_TRUE(known || item.mesh.intrinsic());
            }
        }
    }
}

TEST(ClosedGeodesics, BudgetIsHonest) {
    const CoarseSurface s = thinned(generated("eight", 400, 0.4));
    const ClosedGeodesics whole = find_closed_geodesics(s, 5.0);
    EXPECT_GT(whole.crossed, 100);
    const ClosedGeodesics enough = find_closed_geodesics(s, 5.0, whole.crossed);
    EXPECT_EQ(enough.complete_up_to, 5.0);
    EXPECT_EQ(enough.primitive.size(), whole.primitive.size());
    const ClosedGeodesics cut = find_closed_geodesics(s, 5.0, whole.crossed - 1);
    EXPECT_EQ(cut.complete_up_to, 0.0);
    EXPECT_TRUE(cut.primitive.empty());
}

TEST(ClosedGeodesics, GrowAsThePrimeGeodesicTheoremSays) {
    // On a closed surface Ei(L) oriented primitive ones are no longer than L, up to the small eigenvalues'
    // share: exp(s L) / (s L) with s < 1, which makes for the allowance.
    const double length = 8.0;
    double expected = std::numbers::egamma + std::log(length), term = 1;  // Ei
    for (int k = 1; k < 60; ++k) {
        term *= length / k;
        expected += term / k;
    }
    for (const SurfaceMesh& mesh : {generated("eight", 400, 0.2), make_bolza()}) {
        const ClosedGeodesics found = find_closed_geodesics(thinned(mesh), length);
        EXPECT_EQ(found.missed, 0);
        EXPECT_GT(found.primitive.size(), 100U);
        EXPECT_NEAR(2.0 * static_cast<double>(found.primitive.size()), expected, 0.35 * expected);
    }
}

}  // namespace
}  // namespace ricci
