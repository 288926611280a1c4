#include "engine/surfaces/generate.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "engine/surfaces/ring_row_field.h"
#include "tests/engine/surface_checks.h"

namespace ricci {
namespace {

using testing::min_angle_degrees;

constexpr double kPi = std::numbers::pi;

GenerateOptions with_faces(Index faces, Index genus = 2) {
    GenerateOptions options;
    options.faces = faces;
    options.genus = genus;
    return options;
}

struct Expected {
    std::string name;
    Index option_genus;       // --genus
    Index genus, boundaries;  // of the surface
    double tolerance;         // of the number of faces, as the header documents it
};

const std::vector<Expected>& expectations() {
    static const std::vector<Expected> all = {
        {"sphere", 2, 0, 0, 0.2},          {"ellipsoid", 2, 0, 0, 0.2},
        {"torus", 2, 1, 0, 0.02},          {"eight", 2, 2, 0, 0.2},
        {"genus-g", 0, 0, 0, 0.2},         {"genus-g", 1, 1, 0, 0.2},
        {"genus-g", 3, 3, 0, 0.2},         {"genus-g", 7, 7, 0, 0.2},
        {"pants", 2, 0, 3, 0.4},           {"annulus", 2, 0, 2, 0.02},
        {"annulus-planar", 2, 0, 2, 0.02}, {"disk", 2, 0, 1, 0.2},
        {"punctured-torus", 2, 1, 1, 0.4}, {"genus-g-one-boundary", 2, 2, 1, 0.4},
        {"klein-quartic", 2, 3, 0, 1.0},   {"bolza", 2, 2, 0, 1.0}};
    return all;
}

TEST(Generate, KnowsExactlyTheNamesItLists) {
    std::set<std::string> listed, tested;
    for (const GeneratorInfo& info : generators()) {
        EXPECT_FALSE(info.description.empty()) << info.name;
        EXPECT_TRUE(listed.insert(info.name).second) << info.name << " twice";
    }
    for (const Expected& expected : expectations()) tested.insert(expected.name);
    EXPECT_EQ(listed, tested);
}

TEST(Generate, TopologyQualityAndSizeAreAsDocumented) {
    for (const Expected& expected : expectations()) {
        for (const Index faces : {1, 600, 2000, 6000}) {
            SCOPED_TRACE(expected.name + " " + std::to_string(faces));
            const SurfaceMesh mesh = generate(expected.name, with_faces(faces, expected.option_genus));
            ASSERT_STREQ(check_connectivity(mesh.connectivity), "");
            const Topology topology = topology_of(mesh.connectivity);
            EXPECT_EQ(topology.components, 1);
            EXPECT_EQ(topology.genus, expected.genus);
            EXPECT_EQ(topology.boundaries, expected.boundaries);
            EXPECT_EQ(topology.euler_characteristic, 2 - 2 * expected.genus - expected.boundaries);
            EXPECT_EQ(topology.vertices, mesh.connectivity.vertex_count) << "unused vertices";
            if (faces < 2000) continue;  // few faces: the smallest pattern decides
            EXPECT_GT(min_angle_degrees(mesh), 15.0);
            EXPECT_LE(std::abs(topology.faces / static_cast<double>(faces) - 1.0), expected.tolerance)
                << topology.faces;
        }
    }
}

TEST(Generate, SmallestPatternsOfHandlesAreSound) {
    for (const Index genus : {1, 2, 3, 10}) {
        EXPECT_GT(min_angle_degrees(generate("genus-g", with_faces(1, genus))), 15.0) << genus;
    }
}

TEST(Generate, SameOptionsSameBits) {
    for (const Expected& expected : expectations()) {
        GenerateOptions options = with_faces(800, expected.option_genus);
        if (!generate(expected.name, options).intrinsic()) {
            options.jitter = 0.3;
            options.seed = 5;
        }
        const SurfaceMesh first = generate(expected.name, options), second = generate(expected.name, options);
        EXPECT_EQ(first.points, second.points) << expected.name;
        EXPECT_EQ(first.connectivity.tail, second.connectivity.tail) << expected.name;
        EXPECT_EQ(first.edge_length, second.edge_length) << expected.name;
    }
}

TEST(Generate, ClosedSurfacesAreOrientedOutwards) {
    // Sphere: inscribed, hence a little less than 4 pi / 3. Others: any positive volume of the right size.
    EXPECT_NEAR(testing::signed_volume(generate("sphere", with_faces(20000))), 4.0 * kPi / 3.0, 0.005);
    EXPECT_NEAR(testing::signed_volume(generate("ellipsoid", with_faces(20000))), 4.0 * kPi / 3.0 * 1.125,
                0.005);
    EXPECT_NEAR(testing::signed_volume(generate("torus", with_faces(20000))), 2.0 * kPi * kPi * 2.5, 0.1);
    EXPECT_GT(testing::signed_volume(generate("eight", with_faces(5000))), 1.0);
}

TEST(Generate, FlatSurfacesAreOrientedUpwards) {
    for (const char* name : {"disk", "annulus-planar"}) {
        const SurfaceMesh mesh = generate(name, with_faces(1000));
        for (const Triangle& t : triangles_of(mesh.connectivity))
            ASSERT_GT(testing::shadow_area(mesh, t), 0.0);
    }
}

/// The reflection of one coordinate maps the surface to itself: points bit by bit, faces with reversed turn.
::testing::AssertionResult is_mirror_image_of_itself(const SurfaceMesh& mesh, std::size_t axis) {
    std::map<Point, Index> number;
    for (std::size_t v = 0; v < mesh.points.size(); ++v) number[mesh.points[v]] = static_cast<Index>(v);
    std::set<Triangle> faces;
    const auto rotated = [](Triangle t) {
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        return t;
    };
    for (const Triangle& t : triangles_of(mesh.connectivity)) faces.insert(rotated(t));
    for (const Triangle& t : triangles_of(mesh.connectivity)) {
        Triangle image{};
        for (std::size_t c = 0; c < 3; ++c) {
            Point p = mesh.points[static_cast<std::size_t>(t[2 - c])];
            if (p[axis] != 0.0) p[axis] = -p[axis];  // no negative zeros
            if (!number.contains(p))
                return ::testing::AssertionFailure() << "no image of vertex " << t[2 - c];
            image[c] = number[p];
        }
        if (!faces.contains(rotated(image))) return ::testing::AssertionFailure() << "no image of a face";
    }
    return ::testing::AssertionSuccess();
}

TEST(Generate, RowsOfRingsAreSymmetricToTheLastBit) {
    for (const Index genus : {1, 2, 3}) {
        for (const Index faces : {400, 900, 1150, 5000}) {  // both ways to cut quads, odd and even repeats
            const SurfaceMesh mesh = generate("genus-g", with_faces(faces, genus));
            for (std::size_t axis = 0; axis < 3; ++axis) {
                EXPECT_TRUE(is_mirror_image_of_itself(mesh, axis)) << genus << ' ' << faces << ' ' << axis;
            }
        }
    }
    EXPECT_FALSE(is_mirror_image_of_itself(generate("torus", with_faces(400)), 2))
        << "diagonals all lean one way";
}

TEST(Generate, RowsOfRingsLieOnTheirSmoothSurface) {
    for (const Index genus : {2, 5}) {
        const RingRowField field(genus);
        const SurfaceMesh mesh = generate("genus-g", with_faces(3000, genus));
        for (const Point& p : mesh.points) {
            // Newton's steps from a mesh width away leave far less than this.
            ASSERT_NEAR(field.value(p), RingRowField::kTubeRadius, 1e-9);
        }
    }
}

TEST(Generate, HalvesEndAtTheMirror) {
    for (const auto& [name, axis] :
         {std::pair{"pants", std::size_t{2}}, {"punctured-torus", std::size_t{0}}}) {
        const SurfaceMesh half = generate(name, with_faces(2000));
        const std::vector<std::uint8_t> on_boundary = boundary_vertices(half.connectivity);
        for (std::size_t v = 0; v < half.points.size(); ++v) {
            EXPECT_EQ(half.points[v][axis] == 0.0, on_boundary[v] != 0) << name;
            EXPECT_GE(half.points[v][axis], 0.0) << name;
        }
        const SurfaceMesh whole = generate("eight", with_faces(2 * half.connectivity.face_count()));
        ASSERT_EQ(whole.connectivity.face_count(), 2 * half.connectivity.face_count()) << name;
        // Sums of thousands of areas in another order.
        EXPECT_NEAR(2.0 * testing::total_area(half), testing::total_area(whole), 1e-10) << name;
    }
}

TEST(Generate, PantsHaveOneLongAndTwoEqualBoundaries) {
    const std::vector<double> lengths = testing::boundary_lengths(generate("pants", with_faces(2000)));
    ASSERT_EQ(lengths.size(), 3U);
    EXPECT_NEAR(lengths[0], lengths[1], 1e-12);
    EXPECT_GT(lengths[2], 2.0 * lengths[1]);
}

TEST(Generate, CylinderHasExactlyItsModulus) {
    GenerateOptions options = with_faces(500);
    options.height = 2.5;
    const SurfaceMesh mesh = generate("annulus", options);
    const std::vector<double> lengths = testing::boundary_lengths(mesh);
    ASSERT_EQ(lengths.size(), 2U);
    for (const double length : lengths) EXPECT_NEAR(length, 2.0 * kPi, 1e-12);
    EXPECT_NEAR(testing::total_area(mesh), 2.0 * kPi * options.height, 1e-11);
}

TEST(Generate, TorusAndPlaneAnnulusKeepTheirRadii) {
    GenerateOptions options = with_faces(900);
    options.major_radius = 3.0;
    options.minor_radius = 0.5;
    for (const Point& p : generate("torus", options).points) {
        EXPECT_NEAR(std::hypot(std::hypot(p[0], p[1]) - 3.0, p[2]), 0.5, 1e-14);
    }
    const SurfaceMesh annulus = generate("annulus-planar", options);
    const std::vector<std::uint8_t> on_boundary = boundary_vertices(annulus.connectivity);
    for (std::size_t v = 0; v < annulus.points.size(); ++v) {
        const double radius = std::hypot(annulus.points[v][0], annulus.points[v][1]);
        EXPECT_EQ(std::abs(radius - 3.0) < 1e-12 || std::abs(radius - 0.5) < 1e-12, on_boundary[v] != 0);
    }
}

/// Number of symmetries that carry halfedge 0 to some halfedge: those that keep the turn, or those that
/// reverse it.
Index count_symmetries(const Connectivity& c, bool reversing) {
    const auto size = static_cast<std::size_t>(c.halfedge_count());
    const auto image_next = [&](Index h) { return reversing ? prev_halfedge(h) : next_halfedge(h); };
    Index count = 0;
    for (Index start = 0; start < c.halfedge_count(); ++start) {
        std::vector<Index> image(size, -1), pending = {0};
        image[0] = start;
        bool consistent = true;
        while (!pending.empty() && consistent) {
            const Index h = pending.back();
            pending.pop_back();
            const Index to = image[static_cast<std::size_t>(h)];
            for (const auto& [from, goal] :
                 {std::pair{next_halfedge(h), image_next(to)},
                  {c.twin[static_cast<std::size_t>(h)], c.twin[static_cast<std::size_t>(to)]}}) {
                Index& known = image[static_cast<std::size_t>(from)];
                if (known == -1) {
                    known = goal;
                    pending.push_back(from);
                }
                consistent = consistent && known == goal;
            }
        }
        count += consistent ? 1 : 0;
    }
    return count;
}

struct RegularMap {
    const char* name;
    Index vertices, faces, genus, valence;
};

TEST(Generate, KleinAndBolzaAreTheRegularMapsOfTheirPattern) {
    for (const RegularMap& map : {RegularMap{"klein-quartic", 24, 56, 3, 7}, {"bolza", 6, 16, 2, 8}}) {
        SCOPED_TRACE(map.name);
        const SurfaceMesh mesh = generate(map.name, with_faces(map.faces));
        EXPECT_TRUE(mesh.intrinsic());
        ASSERT_STREQ(check_connectivity(mesh.connectivity), "");
        const Topology topology = topology_of(mesh.connectivity);
        EXPECT_EQ(topology.vertices, map.vertices);
        EXPECT_EQ(topology.faces, map.faces);
        EXPECT_EQ(topology.genus, map.genus);
        EXPECT_EQ(topology.boundaries, 0);
        std::vector<Index> valence(static_cast<std::size_t>(map.vertices), 0);
        for (const Index v : mesh.connectivity.tail) ++valence[static_cast<std::size_t>(v)];
        for (const Index n : valence) EXPECT_EQ(n, map.valence);
        for (const double length : mesh.edge_length) EXPECT_EQ(length, 1.0);
        // As symmetric as can be: 168 rotations for Klein (Hurwitz's bound 84 (g - 1)), 48 for Bolza, and as
        // many reflections.
        EXPECT_EQ(count_symmetries(mesh.connectivity, false), 3 * map.faces);
        EXPECT_EQ(count_symmetries(mesh.connectivity, true), 3 * map.faces);
    }
}

TEST(Generate, FinerKleinQuarticIsTheSameSurface) {
    const SurfaceMesh coarse = generate("klein-quartic", with_faces(56)),
                      fine = generate("klein-quartic", with_faces(900));
    EXPECT_EQ(fine.connectivity.face_count(), 56 * 16);
    for (const double length : fine.edge_length) EXPECT_EQ(length, 0.25);
    EXPECT_NEAR(testing::total_area(fine), testing::total_area(coarse), 1e-12);
    EXPECT_EQ(count_symmetries(fine.connectivity, false), 168);
}

TEST(Generate, JitterMovesInteriorVerticesOnly) {
    GenerateOptions options = with_faces(2000);
    const SurfaceMesh plain = generate("disk", options);
    options.jitter = 0.45;
    const SurfaceMesh jittered = generate("disk", options);
    options.seed = 1;
    EXPECT_NE(jittered.points, generate("disk", options).points);
    const std::vector<std::uint8_t> on_boundary = boundary_vertices(plain.connectivity);
    for (std::size_t v = 0; v < plain.points.size(); ++v) {
        EXPECT_EQ(plain.points[v] == jittered.points[v], on_boundary[v] != 0) << v;
        EXPECT_EQ(jittered.points[v][2], 0.0) << "left the tangent plane";
    }
    EXPECT_EQ(plain.connectivity.tail, jittered.connectivity.tail);
    for (const Triangle& t : triangles_of(jittered.connectivity)) {
        ASSERT_GT(testing::shadow_area(jittered, t), 0.0) << "a face turned over";
    }
}

TEST(Generate, ImpossibleOptionsAreErrors) {
    const auto fails = [](const std::string& name, const GenerateOptions& options) {
        try {
            generate(name, options);
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const std::string unknown = fails("klein-bottle", {});
    EXPECT_NE(unknown.find("klein-bottle"), std::string::npos);
    EXPECT_NE(unknown.find("punctured-torus"), std::string::npos) << "does not list the known names";
    for (const Expected& expected : expectations()) {
        EXPECT_NE(fails(expected.name, with_faces(0, expected.option_genus)), "") << expected.name;
        EXPECT_NE(fails(expected.name, with_faces(2000000000, expected.option_genus)), "") << expected.name;
        GenerateOptions options = with_faces(500, expected.option_genus);
        options.jitter = 0.5;
        EXPECT_NE(fails(expected.name, options), "") << expected.name;
    }
    GenerateOptions options = with_faces(500);
    options.minor_radius = 2.5;
    EXPECT_NE(fails("torus", options), "");
    EXPECT_NE(fails("annulus-planar", options), "");
    options = with_faces(500);
    options.height = 0.0;
    EXPECT_NE(fails("annulus", options), "");
    options.semi_axes = {1.0, -1.0, 1.0};
    EXPECT_NE(fails("ellipsoid", options), "");
    EXPECT_NE(fails("genus-g", with_faces(500, -1)), "");
    EXPECT_NE(fails("genus-g-one-boundary", with_faces(500, 0)), "");
}

}  // namespace
}  // namespace ricci
