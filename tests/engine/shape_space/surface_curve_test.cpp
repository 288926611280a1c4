#include "engine/shape_space/surface_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/shape_space/line_walk.h"
#include "engine/topology/closed_path.h"
#include "tests/engine/layout/layout_checks.h"

namespace ricci {
namespace {

using testing::at;
using testing::generated;
using testing::load_component;
using testing::structure_of;

/// A surface's structure with what walks need.
struct Traced {
    explicit Traced(const SurfaceMesh& surface)
        : mesh(surface),
          structure(structure_of(mesh)),
          holonomy(*structure.metric, *structure.refinement, mesh.connectivity, *structure.basis),
          walks(*structure.refinement, mesh.connectivity, *structure.basis),
          base(walks.home(structure.basis->base())) {}
    Traced(const Traced&) = delete;
    Traced& operator=(const Traced&) = delete;

    GeodesicStart start(const Isometry<double>& element) const {
        return start_on_axis(*structure.refinement, *structure.metric, base, element);
    }
    SurfaceCurve trace(const GeodesicStart& s) const {
        return trace_geodesic(*structure.refinement, *structure.metric, mesh.connectivity, s);
    }
    [[nodiscard]] Word word_of(const SurfaceCurve& curve) const {
        return structure.basis->word_of_path(curve.path);
    }

    SurfaceMesh mesh;
    SurfaceStructure structure;
    Holonomy<double> holonomy;
    PieceWalks walks;
    Index base;
};

double distance(const Point& p, const Point& q) {
    return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

/// How far `p` is from face f, by areas: 0 in its inside or on its boundary.
double distance_from_face(const SurfaceMesh& mesh, Index f, const Point& p) {
    std::array<Point, 3> d{};
    for (std::size_t k = 0; k < 3; ++k) {
        const Point& corner = mesh.points[at(mesh.connectivity.tail[3 * at(f) + k])];
        for (std::size_t i = 0; i < 3; ++i) d[k][i] = corner[i] - p[i];
    }
    const auto area = [&](std::size_t i, std::size_t j) {
        const Point c{d[i][1] * d[j][2] - d[i][2] * d[j][1], d[i][2] * d[j][0] - d[i][0] * d[j][2],
                      d[i][0] * d[j][1] - d[i][1] * d[j][0]};
        return 0.5 * std::hypot(c[0], c[1], c[2]);
    };
    const double whole = face_areas(mesh)[at(f)];
    return (area(0, 1) + area(1, 2) + area(2, 0) - whole) / std::sqrt(whole);
}

/// The exponent sum of every handle letter: the homology class on the closed surface.
std::vector<Index> homology(const HomotopyBasis& basis, const Word& word) {
    std::vector<Index> sum(at(basis.loops()), 0);
    for (const Index letter : word)
        if (generator_of(letter) < basis.loops()) sum[at(generator_of(letter))] += letter > 0 ? 1 : -1;
    return sum;
}

void expect_on_surface(const SurfaceMesh& mesh, const SurfaceCurve& curve) {
    ASSERT_EQ(curve.points.size(), curve.face.size() + 1);
    EXPECT_EQ(curve.points.front(), curve.points.back());
    double worst = 0.0;
    for (std::size_t i = 0; i < curve.face.size(); ++i)
        for (const std::size_t end : {i, i + 1})
            worst = std::max(worst, distance_from_face(mesh, curve.face[i], curve.points[end]));
    EXPECT_LE(worst, 1e-6) << "the rounding of an area enters by its root";
}

void expect_closed(const Connectivity& c, const EdgePath& path) {
    ASSERT_FALSE(path.empty());
    for (std::size_t i = 0; i < path.size(); ++i)
        EXPECT_EQ(step_head(c, path[i]), step_tail(c, path[(i + 1) % path.size()]));
}

/// The curve of `word` is as long as its element, and homotopic to it.
void expect_geodesic(const Traced& t, const Word& word, double tolerance) {
    const int kappa = t.structure.kappa;
    const Isometry<double> element = t.holonomy.of(word);
    const double length = translation_length(kappa, element);
    const SurfaceCurve curve = t.trace(t.start(element));
    EXPECT_LE(curve.closing_error, tolerance);
    EXPECT_NEAR(curve.length, length, tolerance);
    expect_on_surface(t.mesh, curve);
    expect_closed(t.mesh.connectivity, curve.path);
    const Word back = t.word_of(curve);
    EXPECT_EQ(homology(*t.structure.basis, back), homology(*t.structure.basis, word));
    EXPECT_NEAR(translation_length(kappa, t.holonomy.of(back)), length, 100 * tolerance);
    const Word canonical = in_canonical_generators(t.structure.canonical, back);
    EXPECT_LE(canonical.size(), std::max<std::size_t>(4, 4 * word.size()));
    Isometry<double> x;
    for (const Index letter : canonical) {
        const Isometry<double>& g = t.structure.group.generators[at(generator_of(letter))].element;
        x = compose(kappa, x, letter > 0 ? g : inverse(g));
    }
    EXPECT_NEAR(translation_length(kappa, x), length, 100 * tolerance);
    // The element of the curve's own path has an axis of which the same curve is drawn.
    const SurfaceCurve again = t.trace(t.start(t.holonomy.of(back)));
    if (kappa == 0) return;  // parallel geodesics
    ASSERT_EQ(again.points.size(), curve.points.size());
    double nearest = 1.0;
    for (const Point& p : again.points) nearest = std::min(nearest, distance(p, curve.points.front()));
    EXPECT_LE(nearest, 1e-7);
}

void expect_geodesics(const SurfaceMesh& mesh, double tolerance) {
    const Traced t(mesh);
    const auto& generators = t.structure.group.generators;
    for (std::size_t k = 0; k < generators.size(); ++k) {
        if (at(t.structure.basis->loops()) <= k) break;  // boundaries are geodesics already
        SCOPED_TRACE(generators[k].name);
        expect_geodesic(t, generators[k].word, tolerance);
        const Word twice = product(generators[k].word, generators[(k + 1) % 2].word);
        if (k > 1) expect_geodesic(t, twice, tolerance);
    }
}

TEST(SurfaceCurve, TheEightHasTheGeodesicsOfItsGroup) {
    RICCI_DATA_FILE_OR_SKIP(path, "meshes/closed_g2/eight.off");
    expect_geodesics(load_component(path), 1e-9);
}

TEST(SurfaceCurve, SoHaveACoarseEightAndThreeHoles) {
    RICCI_DATA_FILE_OR_SKIP(coarse, "meshes/closed_g2/eight_173v.off");
    RICCI_DATA_FILE_OR_SKIP(holes, "meshes/closed_g3/3holes.off");
    expect_geodesics(load_component(coarse), 1e-9);
    expect_geodesics(load_component(holes), 1e-9);
}

TEST(SurfaceCurve, SoHaveATorusAndIrregularSurfaces) {
    expect_geodesics(generated("torus", 800, 0.3), 1e-11);
    expect_geodesics(generated("genus-g", 1500, 0.4, 2), 1e-9);
    expect_geodesics(generated("genus-g-one-boundary", 1500, 0.4, 2), 1e-9);
}

TEST(SurfaceCurve, PassesVerticesAndRunsAlongEdgesOfSymmetricSurfaces) {
    // Systoles of Bolza's surface are edges of its triangulation, and there are no points in space.
    for (const Index faces : {16, 400}) {
        const Traced t(generated("bolza", faces));
        for (const auto& generator : t.structure.group.generators) {
            const SurfaceCurve curve = t.trace(t.start(t.holonomy.of(generator.word)));
            EXPECT_TRUE(curve.points.empty());
            EXPECT_LE(curve.closing_error, 1e-9);
            EXPECT_NEAR(curve.length, 2 * std::acosh(1 + std::sqrt(2.0)), 1e-9);
            EXPECT_EQ(homology(*t.structure.basis, t.word_of(curve)),
                      homology(*t.structure.basis, generator.word));
        }
    }
}

/// Distance of a point from the nearest boundary edge.
double distance_from_boundary(const SurfaceMesh& mesh, const Point& p) {
    double nearest = HUGE_VAL;
    for (Index h = 0; h < mesh.connectivity.halfedge_count(); ++h) {
        if (mesh.connectivity.twin[at(h)] != kNoTwin) continue;
        const Point &a = mesh.points[at(mesh.connectivity.tail[at(h)])],
                    &b = mesh.points[at(mesh.connectivity.head(h))];
        double along = 0, whole = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            along += (p[i] - a[i]) * (b[i] - a[i]);
            whole += (b[i] - a[i]) * (b[i] - a[i]);
        }
        const double s = std::clamp(along / whole, 0.0, 1.0);
        Point foot{};
        for (std::size_t i = 0; i < 3; ++i) foot[i] = (1 - s) * a[i] + s * b[i];
        nearest = std::min(nearest, distance(p, foot));
    }
    return nearest;
}

TEST(SurfaceCurve, BoundaryGeodesicsRunAlongTheBoundary) {
    const Traced t(generated("pants", 1500, 0.3));
    for (const auto& generator : t.structure.group.generators)
        for (const int sign : {1, -1}) {
            const Word word = sign > 0 ? generator.word : inverse(generator.word);
            const Isometry<double> element = t.holonomy.of(word);
            const SurfaceCurve curve = t.trace(t.start(element));
            EXPECT_NEAR(curve.length, translation_length(-1, element), 1e-9);
            expect_on_surface(t.mesh, curve);
            for (const Point& p : curve.points) EXPECT_LE(distance_from_boundary(t.mesh, p), 1e-6);
            EXPECT_NEAR(translation_length(-1, t.holonomy.of(t.word_of(curve))), curve.length, 1e-8);
        }
    // Twice around one leg and once around another: inside.
    const auto& generators = t.structure.group.generators;
    const Word word = product(product(generators[0].word, generators[0].word), inverse(generators[1].word));
    expect_geodesic(t, word, 1e-9);
}

TEST(SurfaceCurve, IsTheSameOnARelabelledSurface) {
    const SurfaceMesh mesh = generated("genus-g", 1200, 0.3, 2);
    testing::Random random(11);
    const std::vector<Index> number = random.permutation(mesh.connectivity.vertex_count);
    const Traced t(mesh), other(relabelled(mesh, number, random));
    for (const auto& generator : t.structure.group.generators) {
        const SurfaceCurve curve = t.trace(t.start(t.holonomy.of(generator.word)));
        std::vector<Index> vertices;
        for (const Step step : curve.path) vertices.push_back(number[at(step_tail(mesh.connectivity, step))]);
        const Word word = other.structure.basis->word_of_path(closed_path(other.mesh.connectivity, vertices));
        const SurfaceCurve again = other.trace(other.start(other.holonomy.of(word)));
        EXPECT_NEAR(again.length, curve.length, 1e-8);
        double worst = 0;
        for (const Point& p : curve.points) {
            double nearest = HUGE_VAL;
            for (const Point& q : again.points) nearest = std::min(nearest, distance(p, q));
            worst = std::max(worst, nearest);
        }
        EXPECT_LE(worst, 1e-6);
    }
}

TEST(SurfaceCurve, ForgetsTheRoundingOfItsStart) {
    const Traced t(generated("genus-g", 800, 0.3, 2));
    const Word word = product(t.structure.group.generators[0].word, t.structure.group.generators[2].word);
    GeodesicStart start = t.start(t.holonomy.of(word));
    const SurfaceCurve exact = t.trace(start);
    start.normal[0] += 3e-8;
    start.normal[1] -= 2e-8;
    start.normal[2] += 1e-8;
    start.length += 1e-7;
    const SurfaceCurve rough = t.trace(start);
    EXPECT_NEAR(rough.length, exact.length, 1e-11);
    EXPECT_LE(rough.closing_error, 1e-9);
    EXPECT_EQ(rough.face.size(), exact.face.size());
}

TEST(SurfaceCurve, IsTheSameFromWhereverItsLineIsSeen) {
    for (const char* name : {"genus-g", "torus"}) {
        const Traced t(generated(name, 600, 0.3, 2));
        const CommonRefinement& r = *t.structure.refinement;
        const FinalMetric<double>& metric = *t.structure.metric;
        const GeodesicStart start = t.start(t.holonomy.of(t.structure.group.generators[1].word));
        EXPECT_NEAR(line_side(metric.kappa, start.normal, start.point), 0, 1e-13);
        const SurfaceCurve curve = t.trace(start);
        // From a neighbour of the face that it starts in, and from a neighbour of that.
        LineNormal line = start.normal;
        Index face = start.final_face;
        for (const Index k : {0, 1, 2, 2, 1}) {
            const Isometry<double> back =
                inverse(metric.crossing(r.final_triangulation.connectivity, 3 * face + k));
            line = moved_line(metric.kappa, back, line);
            face = face_of(r.final_triangulation.connectivity.twin[at(3 * face + k)]);
            const auto found = std::ranges::find(r.final_face, face);
            ASSERT_NE(found, r.final_face.end());
            const GeodesicStart there = start_on_line(
                r, metric, static_cast<Index>(found - r.final_face.begin()), line, start.length);
            const SurfaceCurve again = t.trace(there);
            ASSERT_EQ(again.face.size(), curve.face.size());
            double nearest = HUGE_VAL;
            for (const Point& p : again.points)
                nearest = std::min(nearest, distance(p, curve.points.front()));
            EXPECT_LE(nearest, 1e-9);
        }
    }
}

TEST(SurfaceCurve, LongOnesCloseUpToTheRoundingOfHalfTheirLength) {
    const Traced t(generated("genus-g", 800, 0.3, 2));
    Word word;
    for (const Index k : {0, 2, 1, 3, 0, 0, 2})
        append_reduced(word, t.structure.group.generators[at(k)].word);
    const Isometry<double> element = t.holonomy.of(word);
    const SurfaceCurve curve = t.trace(t.start(element));
    EXPECT_GT(curve.length, 12);
    EXPECT_NEAR(curve.length, translation_length(-1, element), 1e-9);
    EXPECT_LE(curve.closing_error, 1e-14 * std::exp(curve.length / 2));
}

TEST(SurfaceCurve, RefusesWhatIsNoClosedGeodesicOfTheSurface) {
    const Traced t(generated("pants", 800, 0.2));
    GeodesicStart start = t.start(t.holonomy.of(
        product(t.structure.group.generators[0].word, inverse(t.structure.group.generators[1].word))));
    EXPECT_NO_THROW(t.trace(start));
    GeodesicStart wrong = start;
    wrong.length = 1.1 * start.length;
    EXPECT_THROW(t.trace(wrong), std::runtime_error) << "does not close there";
    wrong = start;
    wrong.length = 0;
    EXPECT_THROW(t.trace(wrong), std::invalid_argument);
    wrong = start;
    wrong.final_face = static_cast<Index>(t.structure.metric->half_chord.size() / 3);
    EXPECT_THROW(t.trace(wrong), std::invalid_argument);
    wrong = start;
    wrong.normal = line_across(-1, start.normal, start.point);
    wrong.length = 40;
    try {
        t.trace(wrong);
        ADD_FAILURE() << "a line across that is no closed geodesic";
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("boundary edge between vertices"), std::string::npos)
            << error.what();
    }
    EXPECT_THROW(t.start(Isometry<double>{{0.0, 1.0}, {}}), std::invalid_argument) << "a rotation";
    EXPECT_THROW(t.start(Isometry<double>{}), std::invalid_argument);
}

}  // namespace
}  // namespace ricci
