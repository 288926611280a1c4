#include "engine/shape_space/teichmuller.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <optional>

#include "tests/engine/shape_space/marked_surface.h"

namespace ricci {
namespace {

using testing::around;
using testing::at;
using testing::bent_row;
using testing::difference;
using testing::marked;
using testing::MarkedSurface;
using testing::RowType;
using testing::text_of;

double half(double length) {
    return 2 * std::cosh(length / 2);
}

/// 2 cosh of half the length of the curve around handle i, by the trace identity of the one-holed torus.
double around_handle(const MarkedSurface& m, int i) {
    const std::string n = std::to_string(i), a = "a" + n, b = "b" + n;
    const double x = m.trace(a), y = m.trace(b), z = m.trace(a + b);
    return x * y * z - x * x - y * y - z * z + 2;
}

/// Traces of the holes around a curve s, and which ones y and z go around.
struct Holes {
    double p1, p2, q1, q2;
    [[nodiscard]] double fx() const { return p1 * p2 + q1 * q2; }
    [[nodiscard]] double even() const { return p2 * q1 + p1 * q2; }
    [[nodiscard]] double odd() const { return p1 * q1 + p2 * q2; }
    [[nodiscard]] double constant() const {
        return p1 * p1 + p2 * p2 + q1 * q1 + q2 * q2 + p1 * p2 * q1 * q2 - 4;
    }
    /// Relative to xyz; y and z either way round.
    [[nodiscard]] double residual(double x, double y, double z) const {
        const auto miss = [&](double fy, double fz) {
            return std::abs(x * x + y * y + z * z - x * y * z + fx() * x + fy * y + fz * z + constant()) /
                   (x * y * z);
        };
        return std::min(miss(even(), odd()), miss(odd(), even()));
    }
    /// y and z from the length of s and the twist: largest relative difference.
    [[nodiscard]] double closed_form(double s, double twist, std::optional<double> y, double z) const {
        const double x = half(s);
        const auto miss = [&](double fy, double fz) {
            const double ymid = (2 * fy + x * fz) / (x * x - 4), zmid = (2 * fz + x * fy) / (x * x - 4);
            const double level = x * x + fx() * x + constant() + (fy * ymid + fz * zmid) / 2;
            const double twice_b = std::sqrt(level) / std::sinh(s / 2);
            const double of_z = std::abs((zmid + twice_b * std::cosh(twist + s / 2)) / z - 1);
            const double of_y = y ? std::abs((ymid + twice_b * std::cosh(twist)) / *y - 1) : 0.0;
            return std::max(of_y, of_z);
        };
        return std::min(miss(even(), odd()), miss(odd(), even()));
    }
};

/// The holes of the chain by name: e1 ..., then c1 ..., and the curves x1, x2, ...: x1 is the first hole,
/// the last one before the last hole is that hole.
class Chain {
  public:
    Chain(const MarkedSurface& m, Index genus, Index boundaries)
        : m_(m), genus_(genus), boundaries_(boundaries) {}

    [[nodiscard]] int holes() const { return genus_ + boundaries_; }
    [[nodiscard]] double hole(int k) const {
        return k <= genus_ ? around_handle(m_, k) : m_.trace("c" + std::to_string(k - genus_));
    }
    [[nodiscard]] double x(int k) const {
        if (k == 1) return hole(1);
        return k == holes() - 1 ? hole(holes()) : m_.trace("x" + std::to_string(k));
    }
    /// Around e(i), i <= genus.
    [[nodiscard]] Holes around_handle_curve(int i) const {
        const double a = m_.trace("a" + std::to_string(i));
        if (holes() == 2) {
            const double other = m_.trace("a" + std::to_string(3 - i));
            return {a, a, other, other};
        }
        // Its pants: x(i-1), e(i), x(i); of e1: e1, hole 2, x2; of the last: x(h-2), x(h-1) = the last hole.
        if (i == 1) return {a, a, hole(2), x(2)};
        if (i == holes()) return {a, a, x(i - 2), hole(i - 1)};
        return {a, a, x(i - 1), x(i)};
    }
    [[nodiscard]] Holes around_chain_curve(int k) const { return {x(k - 1), hole(k), hole(k + 1), x(k + 1)}; }

  private:
    const MarkedSurface& m_;
    int genus_, boundaries_;
};

std::vector<std::string> expected_names(Index g, Index r) {
    std::vector<std::string> names;
    const auto add = [&](const std::string& s, int k) { names.push_back(s + std::to_string(k)); };
    for (int i = 1; i <= g; ++i) {
        add("a", i);
        add("b", i);
        names.push_back("a" + std::to_string(i) + "b" + std::to_string(i));
    }
    if (g == 1 && r == 1) return names;
    for (int j = 1; j <= r; ++j) add("c", j);
    for (int k = 2; k <= g + r - 2; ++k) add("x", k);
    std::vector<std::string> separating;
    for (int i = 1; i <= (g == 2 && r == 0 ? 1 : g); ++i) separating.push_back("e" + std::to_string(i));
    for (int k = 2; k <= g + r - 2; ++k) separating.push_back("x" + std::to_string(k));
    for (std::size_t k = 0; k < separating.size(); ++k) {
        if (k == 0 && !(g == 2 && r == 0)) names.push_back("y(" + separating[k] + ")");
        names.push_back("z(" + separating[k] + ")");
    }
    return names;
}

class Rows : public ::testing::TestWithParam<RowType> {
  protected:
    void SetUp() override { m_ = marked(bent_row(GetParam().rings, GetParam().part)); }
    MarkedSurface m_;
};

TEST_P(Rows, NumbersAndNames) {
    const auto [g, r, rings, part] = GetParam();
    std::vector<std::string> names;
    for (const LengthCoordinate& c : m_.coordinates.lengths) names.push_back(c.name);
    EXPECT_EQ(names, expected_names(g, r));
    const Index count = g == 0 && r == 3 ? 3 : g == 1 && r == 1 ? 3 : 6 * g - 5 + 3 * r;
    EXPECT_EQ(static_cast<Index>(names.size()), count);
    EXPECT_EQ(static_cast<Index>(m_.coordinates.pants.size()), 3 * g - 3 + r);
    for (const LengthCoordinate& c : m_.coordinates.lengths)
        EXPECT_NEAR(c.length, translation_length(c.curve.element), 1e-12) << c.name;
}

/// The numbers are one more than the dimension: the relation among them.
TEST_P(Rows, KeepTheirRelation) {
    const auto [g, r, rings, part] = GetParam();
    if (g == 0 && r == 3) return;
    if (g == 2 && r == 0) {
        const double e1 = around_handle(m_, 1), e2 = around_handle(m_, 2);
        EXPECT_NEAR(e1 / e2, 1, 1e-9);
        return;
    }
    if (g == 1 && r == 1) {
        const double c =
            translation_length(boundary_curve(*m_.exact, boundary_halfedges(*m_.coarse)[0]).element);
        EXPECT_NEAR(around_handle(m_, 1) / half(c), 1, 1e-9);
        return;
    }
    const Chain chain(m_, g, r);
    if (g > 0)
        EXPECT_LT(chain.around_handle_curve(1).residual(chain.x(1), m_.trace("y(e1)"), m_.trace("z(e1)")),
                  1e-9);
    else
        EXPECT_LT(chain.around_chain_curve(2).residual(chain.x(2), m_.trace("y(x2)"), m_.trace("z(x2)")),
                  1e-9);
}

/// Everything else from the Fenchel-Nielsen lengths and twists, by closed formulas.
TEST_P(Rows, FollowFromFenchelNielsen) {
    const auto [g, r, rings, part] = GetParam();
    const Chain chain(m_, g, r);
    for (int i = 1; i <= g; ++i) {
        const std::string n = std::to_string(i);
        const FenchelNielsen& f = m_.pants_curve("a" + n);
        EXPECT_NEAR(f.length, m_.length("a" + n), 1e-12);
        const double e =
            g == 1 && r == 1
                ? translation_length(boundary_curve(*m_.exact, boundary_halfedges(*m_.coarse)[0]).element)
            : g == 2 && r == 0 ? m_.pants_curve("e1").length
                               : m_.pants_curve("e" + n).length;
        const double k = std::sqrt((std::cosh(f.length) + std::cosh(e / 2)) / 2) / std::sinh(f.length / 2);
        EXPECT_NEAR(m_.length("b" + n), 2 * std::acosh(k * std::cosh(f.twist / 2)), 1e-8);
        EXPECT_NEAR(m_.length("a" + n + "b" + n), 2 * std::acosh(k * std::cosh((f.twist + f.length) / 2)),
                    1e-8);
        EXPECT_GE(f.twist, -f.length / 4 - 1e-9);
        EXPECT_LT(f.twist, 3 * f.length / 4 + 1e-9);
    }
    for (const FenchelNielsen& f : m_.coordinates.pants) {
        if (f.name[0] == 'a') continue;
        const int k = std::stoi(f.name.substr(1));
        const bool handle = f.name[0] == 'e';
        EXPECT_NEAR(half(f.length) / (handle ? chain.hole(k) : chain.x(k)), 1, 1e-9) << f.name;
        const Holes holes = handle ? chain.around_handle_curve(k) : chain.around_chain_curve(k);
        const std::string y = "y(" + f.name + ")", z = "z(" + f.name + ")";
        EXPECT_LT(holes.closed_form(f.length, f.twist, m_.has(y) ? std::optional(m_.trace(y)) : std::nullopt,
                                    m_.trace(z)),
                  1e-8)
            << f.name;
        EXPECT_GE(f.twist, -f.length / 8 - 1e-9);
        EXPECT_LT(f.twist, 3 * f.length / 8 + 1e-9);
    }
}

/// y and z meet s twice, each other twice, are simple, and stay away from all the other pants curves.
TEST_P(Rows, DualCurvesMeetTheirCurveTwice) {
    const auto [g, r, rings, part] = GetParam();
    if (g + r > 5) return;
    std::map<std::string, ClosedGeodesic> pants;
    for (int i = 1; i <= g; ++i) {
        pants["a" + std::to_string(i)] = m_.geodesic(m_.curve("a" + std::to_string(i)));
        if (g != 2 || r != 0 || i == 1)
            pants["e" + std::to_string(i)] = m_.geodesic(around(m_.marking.handles[at(i - 1)]));
    }
    for (const LengthCoordinate& c : m_.coordinates.lengths)
        if (c.name[0] == 'x' || c.name[0] == 'c') pants[c.name] = m_.geodesic(c.curve);
    for (const LengthCoordinate& c : m_.coordinates.lengths) {
        if (c.name[0] != 'y' && c.name[0] != 'z') continue;
        const ClosedGeodesic dual = m_.geodesic(c.curve);
        EXPECT_EQ(self_crossings(dual, *m_.coarse), 0) << c.name;
        const std::string s = c.name.substr(2, c.name.size() - 3);
        for (const auto& [name, curve] : pants)
            EXPECT_EQ(crossings(dual, curve, *m_.coarse), name == s ? 2 : 0) << c.name << " and " << name;
        const std::string z = "z(" + s + ")";
        if (c.name[0] != 'y') continue;
        EXPECT_EQ(crossings(dual, m_.geodesic(m_.curve(z)), *m_.coarse), 2) << c.name << " and " << z;
    }
}

INSTANTIATE_TEST_SUITE_P(Types, Rows, ::testing::ValuesIn(testing::row_types()), [](const auto& row) {
    return "g" + std::to_string(row.param.genus) + "b" + std::to_string(row.param.boundaries);
});

/// The rank of the derivatives by many deformations of the surface is the dimension, 6g - 6 + 3r.
TEST(Teichmuller, RankOfTheJacobianIsTheDimension) {
    for (const RowType& t : {RowType{2, 0, 2, RowPart::whole}, RowType{3, 0, 3, RowPart::whole},
                             RowType{0, 3, 2, RowPart::upper}, RowType{0, 4, 3, RowPart::upper},
                             RowType{1, 1, 2, RowPart::right}, RowType{1, 2, 3, RowPart::right},
                             RowType{2, 1, 4, RowPart::right}}) {
        const SurfaceMesh mesh = bent_row(t.rings, t.part, 500, 0.2, 11);
        const MarkedSurface here = marked(mesh);
        ASSERT_GT(here.coordinates.smallest_gap, 2e-3) << text_of(t);
        const Index dimension = 6 * t.genus - 6 + 3 * t.boundaries;
        const Index directions = dimension + 4;
        Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(here.lengths().size()), directions);
        const double step = 1e-4;
        for (Index d = 0; d < directions; ++d) {
            SurfaceMesh up = mesh, down = mesh;
            testing::bend(up, step, 100 + static_cast<std::uint64_t>(d));
            testing::bend(down, -step, 100 + static_cast<std::uint64_t>(d));
            const std::vector<double> x = marked(up).lengths(), y = marked(down).lengths();
            for (std::size_t k = 0; k < x.size(); ++k)
                jacobian(static_cast<Eigen::Index>(k), d) = (x[k] - y[k]) / (2 * step);
        }
        const Eigen::VectorXd values = jacobian.jacobiSvd().singularValues();
        EXPECT_GT(values[dimension - 1], 1e-3 * values[0]) << text_of(t);
        for (Eigen::Index k = dimension; k < values.size(); ++k)
            EXPECT_LT(values[k], 1e-5 * values[0]) << text_of(t);
    }
}

/// The point at distance 1/|p - c|, seen from c.
SurfaceMesh inverted(const SurfaceMesh& mesh, const Point& c) {
    std::vector<Point> points;
    for (const Point& p : mesh.points) {
        const Point d{p[0] - c[0], p[1] - c[1], p[2] - c[2]};
        const double s = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        points.push_back({d[0] / s, d[1] / s, d[2] / s});
    }
    return make_surface_mesh(std::move(points), triangles_of(mesh.connectivity));
}

class Invariance : public ::testing::TestWithParam<RowType> {
  protected:
    void SetUp() override { mesh_ = bent_row(GetParam().rings, GetParam().part, 900, 0.2, 11); }
    void expect_same(const MarkedSurface& x, const MarkedSurface& y, double tolerance = 1e-8) const {
        EXPECT_LT(difference(x.lengths(), y.lengths()), tolerance);
        for (std::size_t k = 0; k < x.coordinates.pants.size(); ++k) {
            EXPECT_NEAR(x.coordinates.pants[k].length, y.coordinates.pants[k].length, 10 * tolerance);
            EXPECT_NEAR(x.coordinates.pants[k].twist, y.coordinates.pants[k].twist, 100 * tolerance);
        }
    }
    SurfaceMesh mesh_;
};

/// An inversion multiplies edge lengths by factors of their ends: it is conformal for the triangulation. (It
/// turns the surface over: seen from outside, faces run the other way, but the intrinsic surface is the
/// same.)
TEST_P(Invariance, MoebiusInversion) {
    const MarkedSurface x = marked(mesh_, false), y = marked(inverted(mesh_, {0.3, 0.2, 7.0}), false);
    expect_same(x, y);
}

TEST_P(Invariance, ScaleAndRelabelling) {
    const MarkedSurface x = marked(mesh_);
    SurfaceMesh larger = mesh_;
    for (Point& p : larger.points)
        for (double& c : p) c *= 37.5;
    expect_same(x, marked(make_surface_mesh(std::move(larger.points), triangles_of(mesh_.connectivity))));
    for (const std::uint64_t seed : {1, 2}) {
        testing::Random random(seed);
        const std::vector<Index> number = random.permutation(mesh_.connectivity.vertex_count);
        const MarkedSurface y = marked(testing::relabelled(mesh_, number, random));
        expect_same(x, y);
        EXPECT_NEAR(x.coordinates.smallest_gap, y.coordinates.smallest_gap, 1e-7);
    }
}

TEST_P(Invariance, SpacingOfTheCoarseSurface) {
    const FlowResult flow = solve_sharply(mesh_, {});
    ASSERT_EQ(flow.outcome.status, Status::converged);
    HyperbolicTriangulation fine;
    std::optional<CommonRefinement> refinement;
    std::optional<FinalMetric<double>> metric;
    if (!flow.doubled) {
        std::vector<double> half_chord;
        for (const double l : flow.edge_length) half_chord.push_back(std::sinh(l / 2));
        fine = closed_triangulation(flow.triangulation, half_chord);
    } else {
        StructureOptions options;
        options.flow.tolerance = 1e-12;
        SurfaceStructure s = make_surface_structure(mesh_, options);
        fine = half_triangulation(*s.refinement, *s.metric);
    }
    const MarkedSurface x = marked(mesh_);
    for (const double spacing : {0.5, 0.9, 1.3}) {
        const MarkedSurface y = marked(make_coarse_surface(fine, {spacing, std::max(1.1, spacing + 0.2)}));
        expect_same(x, y);
    }
}

/// The mirror image has the same lengths in the mirror marking: its own marking turns the other way.
TEST_P(Invariance, MirrorImage) {
    SurfaceMesh image = mesh_;
    for (Point& p : image.points) p[0] = -p[0];
    std::vector<Triangle> triangles = triangles_of(mesh_.connectivity);
    for (Triangle& t : triangles) std::swap(t[0], t[1]);
    const MarkedSurface x = marked(mesh_), y = marked(make_surface_mesh(std::move(image.points), triangles));
    for (const FenchelNielsen& f : x.coordinates.pants) {
        const FenchelNielsen& m = y.pants_curve(f.name);
        EXPECT_NEAR(f.length, m.length, 1e-8) << f.name;
        const double turn = f.name[0] == 'a' ? f.length : f.length / 2;
        EXPECT_NEAR(std::remainder(f.twist + m.twist, turn), 0, 1e-7) << f.name;
        if (f.name[0] != 'a' || std::abs(f.twist) > f.length / 4) continue;
        const std::string n = f.name.substr(1);
        EXPECT_NEAR(x.length("b" + n), y.length("b" + n), 1e-8);
        // a b of the mirror image is a^-1 b here: traces add up to those of a times b.
        EXPECT_NEAR(
            (x.trace("a" + n + "b" + n) + y.trace("a" + n + "b" + n)) / (x.trace("a" + n) * x.trace("b" + n)),
            1, 1e-8);
    }
}

INSTANTIATE_TEST_SUITE_P(Types, Invariance,
                         ::testing::Values(RowType{2, 0, 2, RowPart::whole}, RowType{0, 4, 3, RowPart::upper},
                                           RowType{1, 1, 2, RowPart::right},
                                           RowType{1, 2, 3, RowPart::right}),
                         [](const auto& row) {
                             return "g" + std::to_string(row.param.genus) + "b" +
                                    std::to_string(row.param.boundaries);
                         });

/// Right-angled hexagon: alternating sides A, B, C and seams a, b, c opposite them; the sine rule, the cosine
/// rule, and the polygon closes.
TEST(HexagonSeams, CloseTheHexagon) {
    for (const std::array<double, 3>& l : std::vector<std::array<double, 3>>{
             {2.0, 3.0, 4.0}, {0.2, 5.0, 1.0}, {1.0, 1.0, 1.0}, {8.0, 9.0, 0.7}}) {
        const std::array<double, 3> seam = hexagon_seams(l);
        const double sine = std::sinh(l[0] / 2) / std::sinh(seam[0]);
        for (std::size_t k = 1; k < 3; ++k)
            EXPECT_NEAR(std::sinh(l[k] / 2) / std::sinh(seam[k]), sine, 1e-9 * sine);
        // Walk around: side 0, its seam to side 1 (opposite 2), side 1, ... turning left by pi/2.
        const auto forward = [](double d) {
            return Isometry<double>{{std::cosh(d / 2), 0}, {std::sinh(d / 2), 0}};
        };
        const double q = std::sqrt(0.5);
        const Isometry<double> left{{q, q}, {}};
        Isometry<double> walk;
        for (std::size_t k = 0; k < 3; ++k) {
            for (const double d : {l[k] / 2, seam[(k + 2) % 3]}) {
                walk = compose(-1, walk, forward(d));
                walk = compose(-1, walk, left);
            }
        }
        EXPECT_LT(distance_to_identity(walk), 1e-9);
    }
}

/// The seams are the distances between boundary geodesics: cosh = -<n, m> over pairs of their lifts.
TEST(HexagonSeams, AreDistancesBetweenBoundaries) {
    const MarkedSurface m = marked(bent_row(2, RowPart::upper));
    const Marking& marking = m.marking;
    ASSERT_EQ(marking.links.size(), 1U);
    const ChainLink& l = marking.links[0];
    const std::array<double, 3> lengths{m.length("c1"), m.length("c2"), m.length("c3")};
    const std::array<double, 3> seams = hexagon_seams(lengths);
    const auto distance = [](const Isometry<Exact>& x, const Isometry<Exact>& y) {
        return std::acosh(std::abs(minkowski(axis_normal(x), axis_normal(y))));
    };
    EXPECT_NEAR(distance(l.inner, l.added), seams[2], 1e-9);
    EXPECT_NEAR(distance(l.added, l.outer), seams[0], 1e-9);
    EXPECT_NEAR(distance(l.inner, l.outer), seams[1], 1e-9);
    EXPECT_NEAR(translation_length(l.outer), lengths[2], 1e-9);
}

}  // namespace
}  // namespace ricci
