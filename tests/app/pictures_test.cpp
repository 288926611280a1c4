// Pictures of layouts: geodesics, outlines, what hides what, and the files themselves.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/app/console.h"
#include "engine/app/pictures/copy_colours.h"
#include "engine/app/pictures/depth_image.h"
#include "engine/app/pictures/label_places.h"
#include "engine/app/pictures/laid_out_domain.h"
#include "engine/app/pictures/layout_pictures.h"
#include "engine/app/pictures/side_style.h"
#include "engine/app/pictures/surface_view.h"
#include "engine/structure/surface_structure.h"
#include "engine/surfaces/generate.h"
#include "io/mesh/mesh_file.h"
#include "tests/io/svg_reading.h"
#include "tests/support/small_surfaces.h"
#include "tests/support/test_data.h"

namespace ricci::app {
namespace {

using ricci::testing::at;
using ricci::testing::bumpy_torus;
using ricci::testing::Random;

SurfaceMesh surface(const std::string& name, Index faces) {
    GenerateOptions options;
    options.faces = faces;
    return generate(name, options);
}

StoredLayout layout_of(const SurfaceMesh& mesh, std::size_t copies = 0) {
    const SurfaceStructure s = make_surface_structure(mesh, {});
    EXPECT_EQ(s.flow.outcome.status, Status::converged);
    StoredLayout stored{*s.refinement, s.layout, s.cut, {}, {}};
    if (copies > 0) stored.copies = tessellate(s.layout, copies, 11.0);
    return stored;
}

double area_of(const std::vector<PlanePoint>& polygon) {
    double twice = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const PlanePoint &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        twice += p[0] * q[1] - p[1] * q[0];
    }
    return 0.5 * twice;
}

/// A position at most `reach` from the origin.
std::array<double, 3> random_position(int kappa, Random& random, double reach) {
    const double r = random.uniform(0.0, reach), phi = random.uniform(-std::numbers::pi, std::numbers::pi);
    const double s = kappa == 0 ? r : (kappa < 0 ? std::sinh(r) : std::sin(r));
    const double t = kappa == 0 ? 1.0 : (kappa < 0 ? std::cosh(r) : std::cos(r));
    return {s * std::cos(phi), s * std::sin(phi), t};
}

/// Signed curvature of the circle through three points, in this order (Menger).
double circle_curvature(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
    const double cross = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    return 2.0 * cross / std::hypot(b[0] - a[0], b[1] - a[1]) / std::hypot(c[0] - b[0], c[1] - b[1]) /
           std::hypot(c[0] - a[0], c[1] - a[1]);
}

// The midpoint of a geodesic is the sum of its ends as vectors, scaled back: no formula of circles in it.
TEST(ModelGeometry, GeodesicsPassThroughTheirMidpoints) {
    Random random(1);
    for (const int kappa : {-1, 0, 1})
        for (const LayoutModel model :
             {LayoutModel::conformal, LayoutModel::klein, LayoutModel::half_plane}) {
            if (model == LayoutModel::half_plane && kappa >= 0) continue;
            const ModelGeometry geometry(model, kappa);
            for (int i = 0; i < 200; ++i) {
                const auto p = random_position(kappa, random, 1.2), q = random_position(kappa, random, 1.2);
                std::array<double, 3> m{p[0] + q[0], p[1] + q[1], p[2] + q[2]};
                const double square = kappa * (m[0] * m[0] + m[1] * m[1]) + m[2] * m[2];
                for (double& x : m) x /= kappa == 0 ? m[2] : std::sqrt(square);
                const PlanePoint a = geometry.point(p), b = geometry.point(q), middle = geometry.point(m);
                // Curvatures through points 1e-2 apart or more lose at most four digits.
                if (std::hypot(a[0] - b[0], a[1] - b[1]) < 1e-2) continue;
                EXPECT_NEAR(geometry.geodesic(a, b).curvature, circle_curvature(a, middle, b), 1e-9);
            }
        }
}

TEST(ModelGeometry, SampledGeodesicsStayWithinTheTolerance) {
    Random random(2);
    const ModelGeometry geometry(LayoutModel::half_plane, -1);
    for (int i = 0; i < 100; ++i) {
        const PlanePoint p{random.uniform(-1, 1), random.uniform(0.1, 1)},
            q{random.uniform(-1, 1), random.uniform(0.1, 1)};
        std::vector<PlanePoint> points;
        geometry.append_geodesic(points, p, q, 1e-3);
        points.push_back(q);
        const CircularArc arc = geometry.geodesic(p, q);
        for (std::size_t k = 0; k + 1 < points.size(); ++k) {
            const PlanePoint on_arc =
                point_on(arc, (static_cast<double>(k) + 0.5) / static_cast<double>(points.size() - 1));
            const double gap = std::hypot(on_arc[0] - 0.5 * (points[k][0] + points[k + 1][0]),
                                          on_arc[1] - 0.5 * (points[k][1] + points[k + 1][1]));
            // chord^2/8 is the height of shallow arcs; that of a half circle is half its chord, and its n-th
            // part is at most pi^2/4 times what the square law says.
            EXPECT_LT(gap, 2.5e-3);
        }
    }
}

TEST(EdgeChains, RunFromTailToHeadWithNothingLeftOut) {
    std::size_t longest = 0;
    for (const SurfaceMesh& mesh : {bumpy_torus(40, 5, 0.2), surface("genus-g", 600)}) {
        const StoredLayout stored = layout_of(mesh);
        const CommonRefinement& r = stored.refinement;
        const EdgeChains chains(r);
        ASSERT_EQ(chains.halfedge_count(), mesh.connectivity.halfedge_count());
        std::size_t sides = 0;
        for (Index h = 0; h < chains.halfedge_count(); ++h) {
            const std::span<const Index> chain = chains.of(h);
            ASSERT_FALSE(chain.empty());
            EXPECT_EQ(r.vertex[at(chain.front())], mesh.connectivity.tail[at(h)]);
            EXPECT_EQ(r.vertex[at(r.next(chain.back()))], mesh.connectivity.head(h));
            for (std::size_t i = 0; i + 1 < chain.size(); ++i)
                EXPECT_EQ(r.vertex[at(r.next(chain[i]))], r.vertex[at(chain[i + 1])]);
            for (const Index c : chain) EXPECT_EQ(r.input_halfedge[at(c)], h);
            sides += chain.size();
            longest = std::max(longest, chain.size());
        }
        EXPECT_EQ(sides,
                  static_cast<std::size_t>(std::count_if(r.input_halfedge.begin(), r.input_halfedge.end(),
                                                         [](Index h) { return h >= 0; })));
    }
    EXPECT_GT(longest, 3U) << "short chains come right by the order of their vertices";
}

// A torus is scaled to area 1; its outline and its faces' outlines have that area together.
TEST(LaidOutDomain, OutlinesOfATorusHaveItsArea) {
    const StoredLayout stored = layout_of(bumpy_torus(14, 9, 0.1));
    const LaidOutDomain domain(stored, LayoutModel::conformal);
    double faces = 0.0;
    for (Index f = 0; f < domain.face_count(); ++f) faces += area_of(domain.face_outline(f, 1e-3));
    // Rounding, and the flow's residual of 1e-10.
    EXPECT_NEAR(area_of(domain.outline(1e-3)), 1.0, 1e-8);
    EXPECT_NEAR(faces, 1.0, 1e-8);
}

TEST(LaidOutDomain, SidesOfAPairAreImagesOfOneAnother) {
    const StoredLayout stored = layout_of(surface("genus-g", 600));
    const LaidOutDomain domain(stored, LayoutModel::conformal);
    ASSERT_FALSE(stored.layout.pairings.empty());
    for (const SidePairing& pairing : stored.layout.pairings) {
        const CutSide& side = stored.cut.sides[at(pairing.side)];
        const std::vector<Index> here = domain.side_vertices(side),
                                 there = domain.side_vertices(stored.cut.sides[at(side.partner)]);
        ASSERT_EQ(here.size(), there.size());
        for (std::size_t i = 0; i < here.size(); ++i) {
            const auto moved =
                apply(-1, pairing.element, stored.layout.position[at(there[here.size() - 1 - i])]);
            const PlanePoint p = domain.geometry().point(moved),
                             q = domain.geometry().point(stored.layout.position[at(here[i])]);
            // The layout closes to 1e-10 in frames; e^R, R < 6, of it shows in the disk.
            EXPECT_NEAR(p[0], q[0], 1e-7);
            EXPECT_NEAR(p[1], q[1], 1e-7);
        }
    }
}

TEST(Simplified, KeepsEndsAndTolerance) {
    Random random(3);
    std::vector<PlanePoint> walk{{0.0, 0.0}};
    for (int i = 0; i < 500; ++i)
        walk.push_back({walk.back()[0] + random.uniform(0, 1), walk.back()[1] + random.uniform(-1, 1)});
    const std::vector<PlanePoint> few = simplified(walk, 2.0);
    EXPECT_EQ(few.front(), walk.front());
    EXPECT_EQ(few.back(), walk.back());
    EXPECT_LT(few.size(), walk.size() / 3);
    for (const PlanePoint& p : walk) {
        double least = HUGE_VAL;
        for (std::size_t i = 0; i + 1 < few.size(); ++i) {
            const double dx = few[i + 1][0] - few[i][0], dy = few[i + 1][1] - few[i][1];
            const double t = std::clamp(
                ((p[0] - few[i][0]) * dx + (p[1] - few[i][1]) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
            least = std::min(least, std::hypot(p[0] - few[i][0] - t * dx, p[1] - few[i][1] - t * dy));
        }
        EXPECT_LE(least, 2.0 + 1e-12);
    }
}

TEST(SideStyle, PartnersShareANumberAndBoundariesHaveNone) {
    CutGraph cut;
    cut.sides = {
        {"s1", 3, -1, {}}, {"c1", -1, 0, {}}, {"s2", 4, -1, {}}, {"s1^-1", 0, -1, {}}, {"s2^-1", 2, -1, {}}};
    EXPECT_EQ(pair_numbers(cut), (std::vector<int>{0, -1, 1, 0, 1}));
    EXPECT_EQ(set_name("s1^-1"), "s1\u207b\u00b9");
    EXPECT_EQ(set_name("s1"), "s1");
    for (std::size_t i = 0; i < 21; ++i)
        for (std::size_t j = 0; j < i; ++j)
            EXPECT_FALSE(pair_paint(i, 2.0).stroke == pair_paint(j, 2.0).stroke &&
                         pair_paint(i, 2.0).dashes == pair_paint(j, 2.0).dashes)
                << i << " " << j;
}

TEST(LabelPlaces, NamesDoNotOverlap) {
    LabelPlaces places(make_frame({0.0, 0.0, 10.0, 10.0}, 400.0, 20.0, false));
    const std::vector<PlanePoint> line{{1.0, 5.0}, {9.0, 5.0}};
    places.avoid(line);
    std::vector<PlanePoint> centres;
    for (int i = 0; i < 5; ++i) centres.push_back(*places.place(line, 40.0, 13.0));
    const double scale = 36.0;  // 360 pixels for 10 units
    for (std::size_t i = 0; i < centres.size(); ++i) {
        EXPECT_LE(centres[i][1], 5.0 - 6.5 / scale) << "on the left of the line, or on it";
        for (std::size_t j = 0; j < i; ++j)
            EXPECT_TRUE(std::abs(centres[i][0] - centres[j][0]) * scale >= 40.0 - 1e-9 ||
                        std::abs(centres[i][1] - centres[j][1]) * scale >= 13.0 - 1e-9);
    }
    EXPECT_FALSE(places.place(std::vector<PlanePoint>{{1.0, 1.0}, {1.1, 1.0}}, 40.0, 13.0));
}

TEST(CopyColours, NeighboursOfATorusDiffer) {
    const StoredLayout stored = layout_of(bumpy_torus(12, 8), 60);
    ASSERT_EQ(stored.copies.size(), 60U);
    const auto neighbours = neighbours_of_copies(stored.layout, stored.copies);
    // Every pairing of the first copy leads to a copy of the list.
    EXPECT_GE(neighbours[0].size(), 4U);
    const std::vector<std::size_t> colour = copy_colours(neighbours, 7);
    for (std::size_t i = 0; i < neighbours.size(); ++i)
        for (const std::size_t j : neighbours[i]) {
            EXPECT_TRUE(std::binary_search(neighbours[j].begin(), neighbours[j].end(), i));
            EXPECT_NE(colour[i], colour[j]);  // at most six neighbours, seven colours
        }
}

TEST(DepthImage, TellsWhatIsHidden) {
    DepthImage image({0.0, 0.0, 10.0, 10.0}, 100, 2.0);
    const SeenTriangle front{{{{1, 1}, {6, 1}, {1, 6}}}, {1, 1, 1}};
    const SeenTriangle behind{{{{1.5, 1.5}, {3, 1.5}, {1.5, 3}}}, {0, 0, 0}};
    const SeenTriangle beside{{{{1, 1}, {9, 1}, {1, 9}}}, {0.5, 0.5, 0.5}};
    const SeenTriangle speck{{{{1.51, 1.51}, {1.52, 1.51}, {1.51, 1.52}}}, {0, 0, 0}};
    for (const SeenTriangle& t : {front, behind, beside, speck}) image.add(t);
    EXPECT_EQ(image.visibility(front), Visibility::whole);
    EXPECT_EQ(image.visibility(behind), Visibility::hidden);
    EXPECT_EQ(image.visibility(beside), Visibility::partial);
    EXPECT_EQ(image.visibility(speck), Visibility::hidden);
    EXPECT_TRUE(image.shows({2, 2}, 1.0));
    EXPECT_FALSE(image.shows({2, 2}, 0.5));
    EXPECT_TRUE(image.shows({6, 2}, 0.5));
}

TEST(SurfaceView, LooksAlongTheShortestAxisAtTheSideAsked) {
    GenerateOptions options;
    options.faces = 500;
    options.semi_axes = {1.0, 2.0, 0.4};
    const SurfaceMesh mesh = generate("ellipsoid", options);
    const std::vector<Triangle> faces = triangles_of(mesh.connectivity);
    for (const double side : {1.0, -1.0}) {
        const Eigen::Matrix3d axes = view_axes(mesh.points, faces, {{0.1, 0.1, side}});
        EXPECT_NEAR((axes * axes.transpose() - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-12);
        EXPECT_NEAR(axes.determinant(), 1.0, 1e-12);
        // Moved aside by 0.35 and 0.4 radians; the mesh is symmetric to within a face of its 500.
        EXPECT_NEAR(axes(2, 2), side * std::cos(0.35) * std::cos(0.4), 0.02);
        EXPECT_GT(axes(1, 1), 0.9) << "the longest axis, y, is upright";
    }
}

/// Well-formed, the same bytes twice, no more than so many bytes.
template <class Draw>
std::string checked_document(Draw draw, std::size_t limit) {
    const std::string document = draw().document();
    EXPECT_EQ(svg_reading::malformed(document), "");
    EXPECT_EQ(document, draw().document());
    EXPECT_LT(document.size(), limit);
    EXPECT_EQ(document.find("nan"), std::string::npos);
    return document;
}

std::size_t count(const std::string& text, const std::string& word) {
    std::size_t found = 0;
    for (std::size_t i = text.find(word); i != std::string::npos; i = text.find(word, i + 1)) ++found;
    return found;
}

TEST(DrawDomain, EveryModelShowsEverySide) {
    for (const SurfaceMesh& mesh :
         {bumpy_torus(12, 8), surface("genus-g", 600), surface("annulus-planar", 400)}) {
        const StoredLayout stored = layout_of(mesh);
        for (const LayoutModel model :
             {LayoutModel::conformal, LayoutModel::klein, LayoutModel::half_plane}) {
            DomainPicture options;
            options.model = model;
            const std::string document =
                checked_document([&] { return draw_domain(stored, options); }, 600'000);
            for (const CutSide& side : stored.cut.sides)
                EXPECT_EQ(count(document, "<title>" + side.name + "</title>"), 1U) << side.name;
            EXPECT_GE(count(document, "</text>"), 2U);
        }
    }
}

TEST(DrawDomain, ColoursAreThoseOfTheFaces) {
    const SurfaceMesh mesh = bumpy_torus(12, 8);
    const StoredLayout stored = layout_of(mesh);
    std::vector<double> value(at(mesh.connectivity.face_count()), 0.0);
    for (std::size_t f = 0; f < value.size(); f += 2) value[f] = 1.0;
    DomainPicture options;
    options.colours = sequential_colours(value, "value");
    const std::string document = checked_document([&] { return draw_domain(stored, options); }, 300'000);
    const std::string low = hexadecimal(colour_at(ColourMap::sequential, 0.0)),
                      high = hexadecimal(colour_at(ColourMap::sequential, 1.0));
    EXPECT_GE(count(document, "fill=\"" + low + "\" stroke=\"" + low), 1U);
    EXPECT_GE(count(document, "fill=\"" + high + "\" stroke=\"" + high), 1U);
}

// The middle of every second cell of the plane is dark: half of a domain that is many cells wide.
TEST(DrawDomain, HalfOfACheckerboardIsDark) {
    const StoredLayout stored = layout_of(bumpy_torus(12, 8));
    DomainPicture options;
    options.checker = 0.05;
    const std::string document = checked_document([&] { return draw_domain(stored, options); }, 400'000);
    EXPECT_EQ(count(document, "<clipPath"), 1U);
    const LaidOutDomain domain(stored, LayoutModel::conformal);
    const ViewBox box = domain.bounds();
    const double cells = box.width / 0.05 * box.height / 0.05;
    std::size_t squares = 0;
    for (const std::string& data : svg_reading::paths(document))
        squares = std::max(squares, count(data, "z"));
    // Cells cut by the rim or by the diagonal of the box add some: at most its perimeter and diagonal.
    EXPECT_GT(static_cast<double>(squares), 0.5 * cells - 1.0);
    EXPECT_LT(static_cast<double>(squares), 0.5 * cells + 3.0 * (box.width + box.height) / 0.05);
}

/// Copies of which two vertices are a pixel apart, along x or y, in a disk 696 pixels wide.
std::size_t copies_of_a_pixel(const StoredLayout& stored, LayoutModel model) {
    const LaidOutDomain domain(stored, model);
    std::size_t seen = 0;
    for (const Isometry<double>& copy : stored.copies) {
        std::vector<PlanePoint> points;
        for (const CutSide& side : stored.cut.sides)
            for (const Index v : domain.side_vertices(side))
                points.push_back(domain.geometry().point(apply(-1, copy, stored.layout.position[at(v)])));
        const ViewBox box = box_of(points);
        if (std::max(box.width, box.height) * 348.0 >= 1.0) ++seen;
    }
    return seen;
}

TEST(DrawTessellation, LeavesOutWhatIsTooSmallToSee) {
    const StoredLayout torus = layout_of(bumpy_torus(12, 8), 200);
    checked_document([&] { return draw_tessellation(torus, LayoutModel::conformal); }, 300'000);
    StoredLayout stored = layout_of(surface("genus-g", 400), 2000);
    ASSERT_EQ(stored.copies.size(), 2000U);
    for (const LayoutModel model : {LayoutModel::conformal, LayoutModel::klein}) {
        const std::string document =
            checked_document([&] { return draw_tessellation(stored, model); }, 1'000'000);
        std::size_t outlines = 0;
        for (const std::string& data : svg_reading::paths(document)) outlines += count(data, "z");
        const std::size_t seen = copies_of_a_pixel(stored, model);
        EXPECT_GT(seen, 20U);
        EXPECT_LT(seen, 1500U);
        // The circle of the clip and that of the frame, and outlines that fewer than three points are left
        // of.
        EXPECT_LE(outlines, seen + 2);
        EXPECT_GE(outlines, seen / 2);
    }
    stored.copies.clear();
    EXPECT_THROW(draw_tessellation(stored, LayoutModel::conformal), UsageError);
}

TEST(DrawSurface, PaintsWhatIsSeenAndDashesWhatIsHidden) {
    const SurfaceMesh mesh = surface("torus", 1500);
    const StoredLayout stored = layout_of(mesh);
    SurfacePicture options;
    std::vector<Index> around;  // the faces' first corners in order are a path all over the torus
    for (const Triangle& t : triangles_of(mesh.connectivity)) around.push_back(t[0]);
    options.loops = {around};
    options.loop_names = {"a1"};
    const std::string plain = checked_document([&] { return draw_surface(stored, options); }, 400'000);
    EXPECT_EQ(count(plain, ">a1</text>"), 1U);
    EXPECT_GE(count(plain, "stroke-dasharray=\"3 3\""), 1U);
    std::size_t polygons = 0;
    for (const std::string& data : svg_reading::paths(plain)) polygons += count(data, "z");
    const auto faces = static_cast<std::size_t>(mesh.connectivity.face_count());
    // A torus seen from the side shows about half of its faces.
    EXPECT_GT(polygons, faces / 3);
    EXPECT_LT(polygons, 3 * faces / 4);
    options.checker = 0.05;
    const std::string checked = checked_document([&] { return draw_surface(stored, options); }, 800'000);
    std::size_t with_squares = 0;
    for (const std::string& data : svg_reading::paths(checked)) with_squares += count(data, "z");
    EXPECT_GT(with_squares, polygons + polygons / 3);
}

TEST(DrawSurface, IntrinsicSurfacesHaveALayoutButNoPlaceInSpace) {
    const StoredLayout stored = layout_of(surface("bolza", 100), 50);
    EXPECT_THROW(draw_surface(stored, {}), UsageError);
    checked_document([&] { return draw_domain(stored, {}); }, 200'000);
    checked_document([&] { return draw_tessellation(stored, LayoutModel::conformal); }, 200'000);
}

TEST(DrawDomain, ASphereWithoutSides) {
    const StoredLayout stored = layout_of(surface("ellipsoid", 500));
    ASSERT_TRUE(stored.cut.sides.empty());
    const std::string document = checked_document([&] { return draw_domain(stored, {}); }, 200'000);
    std::size_t polygons = 0;
    for (const std::string& data : svg_reading::paths(document)) polygons += count(data, "z");
    // All but those near the far pole: |z| > 3 is a tenth of the sphere, and faces across its rim.
    EXPECT_GT(polygons, 350U);
    EXPECT_LT(polygons, 500U);
    EXPECT_THROW(draw_tessellation(stored, LayoutModel::conformal), UsageError);
}

// A face with squares of a few pixels is painted in one colour between theirs.
TEST(DrawSurface, SquaresBelowAPixelAreNotDrawn) {
    const StoredLayout stored = layout_of(surface("ellipsoid", 500));
    SurfacePicture options;
    options.checker = 1e-5;
    const std::string document = checked_document([&] { return draw_surface(stored, options); }, 60'000);
    EXPECT_GE(count(document, "<path"), 5U);
}

// Where coordinates have lost all their digits the rest is drawn.
TEST(DrawDomain, PositionsOutsideTheModelAreLeftOut) {
    StoredLayout stored = layout_of(surface("genus-g", 400));
    const std::size_t whole = draw_domain(stored, {}).document().size();
    stored.layout.position[7] = {1e9, 0.0, 9e8};
    stored.layout.position[8] = {HUGE_VAL, 0.0, HUGE_VAL};
    for (const LayoutModel model : {LayoutModel::conformal, LayoutModel::klein, LayoutModel::half_plane}) {
        DomainPicture options;
        options.model = model;
        EXPECT_GT(checked_document([&] { return draw_domain(stored, options); }, 600'000).size(), whole / 2);
    }
}

TEST(DrawSurface, TheKittensFilesStaySmall) {
    RICCI_DATA_FILE_OR_SKIP(file, "meshes/closed_g1/kitten.obj");
    const StoredLayout stored = layout_of(load_mesh(file).components.at(0), 100);
    checked_document([&] { return draw_domain(stored, {}); }, 1'000'000);
    checked_document([&] { return draw_tessellation(stored, LayoutModel::conformal); }, 300'000);
    SurfacePicture texture;
    texture.checker = 0.05;
    checked_document([&] { return draw_surface(stored, texture); }, 1'500'000);
}

}  // namespace
}  // namespace ricci::app
