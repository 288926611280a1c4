// The passes over lanes against long double, and what lanes must not do to each other.
#include "kernels/lanes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "kernels/delaunay.h"
#include "kernels/lane_kernels.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::Random;

constexpr double kUnit = 0x1p-53;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<InstructionSet> available_sets() {
    std::vector<InstructionSet> sets;
    for (const auto set : {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512})
        if (set <= best_instruction_set()) sets.push_back(set);
    return sets;
}

/// Faces that share nothing: face f has the rows 3f, 3f+1, 3f+2.
struct LooseFaces {
    Connectivity connectivity;
    std::vector<long double> log_chord;
    LaneFaces faces;
    std::vector<LaneMask> owned;

    void add(const std::array<long double, 3>& chord) {
        for (const long double l : chord) {
            connectivity.tail.push_back(static_cast<Index>(connectivity.tail.size()));
            log_chord.push_back(std::log(l));
        }
    }
    void finish() {
        std::vector<Index> row(connectivity.tail.size());
        for (std::size_t v = 0; v < row.size(); ++v) row[v] = static_cast<Index>(v);
        faces = make_lane_faces(connectivity, log_chord, row);
        owned.assign(row.size() / 3, 0);
    }
    [[nodiscard]] std::size_t rows() const { return log_chord.size(); }
};

/// Angles between about 20 and 140 degrees.
LooseFaces random_faces(std::size_t count, Random& random) {
    LooseFaces loose;
    while (loose.rows() < 3 * count) {
        const double a = random.uniform(0.5, 1.5), b = random.uniform(0.5, 1.5), c = random.uniform(0.5, 1.5);
        if (std::max({a, b, c}) < 0.45 * (a + b + c)) loose.add({a, b, c});
    }
    loose.finish();
    return loose;
}

LaneArray<double> random_lanes(std::size_t rows, double low, double high, Random& random) {
    LaneArray<double> values(rows);
    for (auto& row : values)
        for (double& x : row.lane) x = random.uniform(low, high);
    return values;
}

struct Reference {
    std::array<long double, 3> change{};  // at the tails of the halfedges
    long double thinnest = 0;             // least sine of both shapes; 0: no triangle
};

/// Angles of the face with halfedges h, h+1, h+2 by their definition, squares times `shrink` at the tails.
Reference reference(const LooseFaces& loose, std::size_t h, const std::array<double, 3>& shrink) {
    std::array<long double, 3> angle[2];
    Reference result;
    result.thinnest = 1;
    for (const int moved : {0, 1}) {
        long double chord[3];  // opposite the tail of halfedge k
        for (std::size_t k = 0; k < 3; ++k)
            chord[k] = std::exp(loose.log_chord[h + (k + 1) % 3]) *
                       (moved == 1 ? std::sqrt(static_cast<long double>(shrink[k])) : 1);
        for (std::size_t k = 0; k < 3; ++k) {
            const long double a = chord[k], b = chord[(k + 1) % 3], c = chord[(k + 2) % 3];
            const long double half = (a + b + c) / 2;
            const long double area = half * (half - a) * (half - b) * (half - c);
            if (!(area > 0)) return {};
            angle[moved][k] = std::atan2(4 * std::sqrt(area), b * b + c * c - a * a);
            result.thinnest = std::min(result.thinnest, std::sin(angle[moved][k]));
        }
    }
    for (std::size_t k = 0; k < 3; ++k) result.change[k] = angle[1][k] - angle[0][k];
    return result;
}

std::array<double, 3> corners(const LaneArray<double>& rows, std::size_t h, std::size_t lane) {
    return {rows[h].lane[lane], rows[h + 1].lane[lane], rows[h + 2].lane[lane]};
}

/// Largest of error(reference, largest change, error) over all faces and lanes that are triangles.
template <class Measure>
double worst(const LooseFaces& loose, const LaneArray<double>& shrink, InstructionSet set,
             Measure&& measure) {
    LaneArray<double> change(loose.rows());
    detail::add_angle_changes(set, loose.faces, shrink, loose.owned, change);
    double largest = 0.0;
    for (std::size_t h = 0; h < loose.rows(); h += 3)
        for (std::size_t l = 0; l < kLanes; ++l) {
            const Reference expected = reference(loose, h, corners(shrink, h, l));
            if (!(expected.thinnest > 0)) continue;
            const auto found = corners(change, h, l);
            long double error = 0, size = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                error = std::max(error, std::abs(expected.change[k] - found[k]));
                size = std::max(size, std::abs(expected.change[k]));
            }
            largest = std::max(largest, static_cast<double>(measure(error, size, expected.thinnest)));
        }
    return largest;
}

TEST(LaneAngles, AreThoseOfTheDefinition) {
    Random random(1);
    const LooseFaces loose = random_faces(400, random);
    for (const InstructionSet set : available_sets())
        for (const double spread : {0.01, 0.3, 0.8, 3.0}) {
            LaneArray<double> shrink;
            detail::lane_exponentials(set, random_lanes(loose.rows(), -spread, spread, random), shrink);
            // An angle theta of given squares has the condition 1/sin^2(theta) at worst (near pi).
            EXPECT_LT(worst(loose, shrink, set,
                            [](long double error, long double, long double thinnest) {
                                return error * thinnest * thinnest / kUnit;
                            }),
                      8.0)
                << name_of(set) << " " << spread;
        }
}

TEST(LaneAngles, AreRelativelyExactForSmallChanges) {
    Random random(2);
    const LooseFaces loose = random_faces(200, random);
    for (const InstructionSet set : available_sets())
        for (const double spread : {1e-9, 1e-6, 1e-3}) {
            LaneArray<double> shrink;
            detail::lane_exponentials(set, random_lanes(loose.rows(), 0.7 - spread, 0.7 + spread, random),
                                      shrink);
            // The reference itself cancels: it is known to a few 2^-63. Differences of angles in double would
            // be wrong by 2^-53, a thousand times as much.
            EXPECT_LT(worst(loose, shrink, set,
                            [](long double error, long double size, long double) {
                                return error / (64 * 0x1p-63L + 64 * kUnit * size);
                            }),
                      1.0)
                << name_of(set) << " " << spread;
        }
}

TEST(LaneAngles, DoNotChangeWhereTheFactorIsConstant) {
    Random random(3);
    LooseFaces loose = random_faces(100, random);
    loose.add({1.0L, 1e-7L, 1.0L});
    loose.finish();
    for (const InstructionSet set : available_sets())
        for (const double value : {0.0, 1e-5, -3.7, 40.0, 130.0}) {
            LaneArray<double> shrink, change(loose.rows());
            detail::lane_exponentials(set, random_lanes(loose.rows(), value, value, random), shrink);
            EXPECT_EQ(detail::add_angle_changes(set, loose.faces, shrink, loose.owned, change), 0);
            for (const auto& row : change)
                for (const double x : row.lane) ASSERT_EQ(x, 0.0) << name_of(set) << " " << value;
        }
}

TEST(LaneAngles, StayExactInNeedles) {
    Random random(4);
    for (const double width : {1e-2, 1e-5, 1e-8}) {
        LooseFaces loose;
        for (int turn = 0; turn < 90; ++turn) {
            const long double long_side = 1.0L + random.uniform(-0.5, 0.5) * width;
            std::array<long double, 3> chord = {1.0L, width, long_side};
            std::rotate(chord.begin(), chord.begin() + turn % 3, chord.end());
            loose.add(chord);
        }
        loose.finish();
        // The ends of the short side must keep alike, the third corner is free within reason.
        LaneArray<double> u(loose.rows());
        for (std::size_t f = 0; f < 90; ++f)
            for (std::size_t l = 0; l < kLanes; ++l) {
                const double base = random.uniform(-1, 1);
                // The tail of the short side's halfedge and the one behind it are its ends.
                const std::size_t first = (1 + 3 - f % 3) % 3;
                u[3 * f + first].lane[l] = base + random.uniform(-0.2, 0.2) * width;
                u[3 * f + (first + 1) % 3].lane[l] = base;
                u[3 * f + (first + 2) % 3].lane[l] = base + random.uniform(-0.5, 0.5);
            }
        for (const InstructionSet set : available_sets()) {
            LaneArray<double> shrink;
            detail::lane_exponentials(set, u, shrink);
            // Long double squares round at 2^-64 of the long sides: 2^-64 / width for the angles.
            EXPECT_LT(
                worst(loose, shrink, set, [](long double error, long double, long double) { return error; }),
                32 * kUnit + 64 * 0x1p-64 / width)
                << name_of(set) << " " << width;
        }
    }
}

TEST(LaneAngles, LeaveOwnedFacesOut) {
    Random random(5);
    LooseFaces loose = random_faces(50, random);
    LaneArray<double> shrink = random_lanes(loose.rows(), 0.86, 1.15, random);
    for (std::size_t f = 0; f < 50; f += 3) {
        loose.owned[f] = static_cast<LaneMask>(1U << (f % kLanes) | 0x8000U);
        shrink[3 * f + 1].lane[15] = kNaN;
        shrink[3 * f + 2].lane[f % kLanes] = f % 2 == 0 ? kNaN : 1e9;  // no triangle
    }
    const std::vector<LaneMask> nobody(50, 0);
    for (const InstructionSet set : available_sets()) {
        LaneArray<double> change(loose.rows()), all(loose.rows());
        EXPECT_EQ(detail::add_angle_changes(set, loose.faces, shrink, loose.owned, change), 0);
        EXPECT_NE(detail::add_angle_changes(set, loose.faces, shrink, nobody, all), 0);
        for (std::size_t f = 0; f < 50; ++f)
            for (std::size_t l = 0; l < kLanes; ++l)
                for (std::size_t h = 3 * f; h < 3 * f + 3; ++h) {
                    const bool own = (loose.owned[f] >> l & 1) != 0;
                    ASSERT_EQ(change[h].lane[l], own ? 0.0 : all[h].lane[l]) << f << " " << l;
                }
    }
}

TEST(LaneAngles, ReportFacesThatAreNoTriangles) {
    LooseFaces loose;
    loose.add({1.0L, 1.1L, 1.2L});
    loose.finish();
    for (const InstructionSet set : available_sets()) {
        LaneArray<double> shrink(3), change(3);
        for (auto& row : shrink)
            for (double& x : row.lane) x = 1.0;
        shrink[0].lane[2] = 100.0;  // the side opposite the first vertex grows tenfold
        shrink[1].lane[9] = 100.0;
        shrink[2].lane[15] = kNaN;
        EXPECT_EQ(detail::add_angle_changes(set, loose.faces, shrink, loose.owned, change),
                  1U << 2 | 1U << 9 | 1U << 15);
        for (std::size_t c = 0; c < 3; ++c) {
            const auto vertex = at(loose.faces.row[c]);
            const double start = loose.faces.angle[c];
            EXPECT_NEAR(change[vertex].lane[2], (vertex == 0 ? std::numbers::pi : 0.0) - start, 8 * kUnit);
            EXPECT_NEAR(change[vertex].lane[9], (vertex == 1 ? std::numbers::pi : 0.0) - start, 8 * kUnit);
            EXPECT_EQ(change[vertex].lane[3], 0.0);
        }
    }
}

TEST(LaneAngles, AddUpAtRowsThatRepeat) {
    const auto t = testing::one_vertex_torus<long double>(1.0L, 1.1L, 0.9L);
    const std::vector<Index> same = {0};
    const LaneFaces torus = make_lane_faces(t.connectivity, t.log_chord, same);
    // Two corners at one row.
    LooseFaces loose;
    loose.add({1.0L, 1.1L, 0.9L});
    const LaneFaces pair = make_lane_faces(loose.connectivity, loose.log_chord, std::vector<Index>{0, 1, 0});
    loose.finish();
    for (const InstructionSet set : available_sets()) {
        LaneArray<double> shrink(1), change(1);
        for (std::size_t l = 0; l < kLanes; ++l) {
            shrink[0].lane[l] = 0.1 + static_cast<double>(l);
            change[0].lane[l] = 5.0;
        }
        EXPECT_EQ(detail::add_angle_changes(set, torus, shrink, std::vector<LaneMask>(2, 0), change), 0);
        for (const double x : change[0].lane) EXPECT_EQ(x, 5.0);

        LaneArray<double> two(2), sums(2), three(3), parts(3);
        for (std::size_t l = 0; l < kLanes; ++l) {
            two[0].lane[l] = three[0].lane[l] = three[2].lane[l] = 1.0;
            two[1].lane[l] = three[1].lane[l] = 0.7 + 0.05 * static_cast<double>(l);
        }
        detail::add_angle_changes(set, pair, two, loose.owned, sums);
        detail::add_angle_changes(set, loose.faces, three, loose.owned, parts);
        for (std::size_t l = 0; l < kLanes; ++l) {
            EXPECT_EQ(sums[1].lane[l], parts[1].lane[l]);
            EXPECT_NEAR(sums[0].lane[l], parts[0].lane[l] + parts[2].lane[l], 2 * kUnit);
        }
    }
}

std::uint64_t bits(double x) {
    return std::bit_cast<std::uint64_t>(x);
}

/// Lane `from` of `values` among others, put at position `to`.
void put(const LaneArray<double>& values, std::size_t from, LaneArray<double>& others, std::size_t to) {
    for (std::size_t r = 0; r < values.size(); ++r) others[r].lane[to] = values[r].lane[from];
}

TEST(Lanes, HaveTheSameBitsAtEveryPositionAndBesideAnything) {
    Random random(6);
    const auto mesh = testing::bumpy_torus(9, 7);
    const auto t = intrinsic_triangulation<long double>(mesh);
    std::vector<Index> row(63);
    for (std::size_t v = 0; v < 63; ++v) row[v] = static_cast<Index>(v);
    const LaneFaces faces = make_lane_faces(t.connectivity, t.log_chord, row);
    const LaneEdges edges = make_lane_edges(t.connectivity, t.log_chord, row);
    const std::vector<LaneMask> owned(at(faces.face_count()), 0);
    // Lanes of every kind: no face far, some, many, broken ones.
    LaneArray<double> u = random_lanes(63, -0.05, 0.05, random);
    for (auto& r : u)
        for (std::size_t l = 0; l < kLanes; ++l) r.lane[l] *= static_cast<double>(1 + 3 * l);
    for (const InstructionSet set : available_sets()) {
        LaneArray<double> shrink, change(63);
        detail::lane_exponentials(set, u, shrink);
        const LaneMask broken = detail::add_angle_changes(set, faces, shrink, owned, change);
        EXPECT_NE(broken, 0);
        EXPECT_NE(broken, 0xffff);
        std::vector<LaneFlip> flips;
        detail::find_lane_flips(set, edges, shrink, owned, flips);
        for (std::size_t to = 0; to < kLanes; ++to)
            for (const std::size_t from : {std::size_t{0}, std::size_t{4}, std::size_t{15}}) {
                // Quiet neighbours leave every face near, loud ones make most faces far for somebody.
                const double spread = to % 2 == 0 ? 0.02 : 2.0;
                LaneArray<double> other_u = random_lanes(63, -spread, spread, random);
                if (to % 4 != 0)
                    for (auto& r : other_u) r.lane[(to + 5) % kLanes] = kNaN;
                put(u, from, other_u, to);
                LaneArray<double> other_shrink, other_change(63);
                detail::lane_exponentials(set, other_u, other_shrink);
                const LaneMask lost =
                    detail::add_angle_changes(set, faces, other_shrink, owned, other_change);
                EXPECT_EQ(lost >> to & 1, broken >> from & 1);
                for (std::size_t r = 0; r < 63; ++r) {
                    ASSERT_EQ(bits(other_shrink[r].lane[to]), bits(shrink[r].lane[from]));
                    ASSERT_EQ(bits(other_change[r].lane[to]), bits(change[r].lane[from]))
                        << name_of(set) << " lane " << from << " at " << to;
                }
                std::vector<LaneFlip> other_flips;
                detail::find_lane_flips(set, edges, other_shrink, owned, other_flips);
                std::vector<Index> expected, found;
                for (const LaneFlip& flip : flips)
                    if ((flip.lanes >> from & 1) != 0) expected.push_back(flip.edge);
                for (const LaneFlip& flip : other_flips) {
                    if (to % 4 != 0) {
                        EXPECT_EQ(flip.lanes >> (to + 5) % kLanes & 1, 0);
                    }
                    if ((flip.lanes >> to & 1) != 0) found.push_back(flip.edge);
                }
                EXPECT_EQ(found, expected);
            }
    }
}

TEST(Lanes, AgreeBetweenInstructionSets) {
    Random random(7);
    const LooseFaces loose = random_faces(300, random);
    const LaneArray<double> u = random_lanes(loose.rows(), -0.09, 0.09, random);
    LaneArray<double> shrink, change(loose.rows());
    detail::lane_exponentials(InstructionSet::baseline, u, shrink);
    const LaneMask broken =
        detail::add_angle_changes(InstructionSet::baseline, loose.faces, shrink, loose.owned, change);
    EXPECT_EQ(broken, 0);
    for (const InstructionSet set : available_sets()) {
        LaneArray<double> other_shrink, other_change(loose.rows());
        detail::lane_exponentials(set, u, other_shrink);
        EXPECT_EQ(detail::add_angle_changes(set, loose.faces, other_shrink, loose.owned, other_change), 0);
        for (std::size_t r = 0; r < loose.rows(); ++r)
            for (std::size_t l = 0; l < kLanes; ++l) {
                ASSERT_NEAR(other_shrink[r].lane[l], shrink[r].lane[l], 1e-15);
                ASSERT_NEAR(other_change[r].lane[l], change[r].lane[l], 1e-13) << name_of(set);
            }
    }
}

TEST(LaneExponentials, AreThoseOfLongDouble) {
    Random random(8);
    const LaneArray<double> u = random_lanes(500, -100.0, 100.0, random);
    for (const InstructionSet set : available_sets()) {
        LaneArray<double> shrink;
        detail::lane_exponentials(set, u, shrink);
        ASSERT_EQ(shrink.size(), 500U);
        for (std::size_t r = 0; r < 500; ++r)
            for (std::size_t l = 0; l < kLanes; ++l) {
                const long double expected = std::exp(-static_cast<long double>(u[r].lane[l]));
                ASSERT_NEAR(static_cast<double>(shrink[r].lane[l] / expected), 1.0, 4 * 0x1p-52);  // libmvec
            }
    }
}

/// The long double cosines' sum at halfedge h and its twin, in the metric u, over the sum of a/b + b/a.
long double delaunay_ratio(const IntrinsicTriangulation<long double>& t, const std::vector<double>& u,
                           Index h) {
    long double cosines = 0, ratios = 0;
    for (const Index side : {h, t.connectivity.twin[at(h)]}) {
        long double chord[3];
        Index g = side;
        for (long double& c : chord) {
            c = std::exp(t.log_chord[at(g)] + (u[at(t.connectivity.tail[at(g)])] +
                                               static_cast<long double>(u[at(t.connectivity.head(g))])) /
                                                  2);
            g = next_halfedge(g);
        }
        cosines += (chord[1] * chord[1] + chord[2] * chord[2] - chord[0] * chord[0]) / (chord[1] * chord[2]);
        ratios += chord[1] / chord[2] + chord[2] / chord[1];
    }
    return cosines / ratios;
}

TEST(LaneFlips, AreTheEdgesThatAreNotDelaunay) {
    Random random(9);
    for (const SurfaceMesh& mesh : {testing::bumpy_torus(8, 6), testing::wavy_square(6, 0.2)}) {
        const auto t = intrinsic_triangulation<long double>(mesh);
        const auto vertices = at(mesh.connectivity.vertex_count);
        // Rows in another order than vertices.
        const std::vector<Index> row = random.permutation(mesh.connectivity.vertex_count);
        const LaneEdges edges = make_lane_edges(t.connectivity, t.log_chord, row);
        std::vector<LaneMask> owned(at(mesh.connectivity.face_count()), 0);
        owned[3] = 0xf0f0;
        const LaneArray<double> u = random_lanes(vertices, -0.6, 0.6, random);
        for (const InstructionSet set : available_sets()) {
            LaneArray<double> shrink;
            detail::lane_exponentials(set, u, shrink);
            std::vector<LaneFlip> flips = {{77, 1}};
            detail::find_lane_flips(set, edges, shrink, owned, flips);
            EXPECT_TRUE(std::is_sorted(flips.begin(), flips.end(),
                                       [](const auto& a, const auto& b) { return a.edge < b.edge; }));
            std::vector<LaneMask> found(at(edges.edge_count()), 0);
            for (const LaneFlip& flip : flips) {
                ASSERT_NE(flip.lanes, 0);
                found[at(flip.edge)] = flip.lanes;
            }
            for (std::size_t l = 0; l < kLanes; ++l) {
                std::vector<double> own_u(vertices);
                for (std::size_t v = 0; v < vertices; ++v) own_u[v] = u[at(row[v])].lane[l];
                std::int64_t failing = 0;
                for (std::size_t e = 0; e < found.size(); ++e) {
                    const bool fails = delaunay_ratio(t, own_u, edges.halfedge[e]) < 0;
                    const bool own =
                        ((owned[at(edges.face[2 * e])] | owned[at(edges.face[2 * e + 1])]) >> l & 1) != 0;
                    EXPECT_EQ((found[e] >> l & 1) != 0, fails && !own) << e << " " << l;
                    failing += fails ? 1 : 0;
                }
                EXPECT_EQ(failing, count_non_delaunay<long double>(t, own_u));
                EXPECT_GT(failing, 0);
            }
        }
    }
}

TEST(LaneFlips, LeaveTiesAloneWithinTheirTolerance) {
    // Rectangles, cut along a diagonal whose angles sum to pi; then one end of the diagonal is moved a
    // little.
    for (const long double height : {1.0L, 0.1L, 1e-3L}) {
        IntrinsicTriangulation<long double> t;
        t.connectivity =
            connectivity_from_gluing({0, 1, 2, 2, 3, 0}, {kNoTwin, kNoTwin, 5, kNoTwin, kNoTwin, 2}, 4);
        const long double diagonal = std::log(1 + height * height) / 2, up = std::log(height);
        t.log_chord = {0, up, diagonal, 0, up, diagonal};
        const LaneEdges edges = make_lane_edges(t.connectivity, t.log_chord, std::vector<Index>{0, 1, 2, 3});
        ASSERT_EQ(edges.edge_count(), 1);
        for (const InstructionSet set : available_sets()) {
            LaneArray<double> shrink(4);
            for (auto& r : shrink)
                for (double& x : r.lane) x = 1.0;
            for (std::size_t l = 0; l < kLanes; ++l) {
                // Equal factors at the ends scale the left side of the inequality alone.
                shrink[0].lane[l] = shrink[2].lane[l] = 1.0 - 1e-13 * static_cast<double>(l);
            }
            std::vector<LaneFlip> flips;
            detail::find_lane_flips(set, edges, shrink, std::vector<LaneMask>(2, 0), flips);
            ASSERT_EQ(flips.size(), 1U);
            EXPECT_EQ(flips[0].lanes & 0xffdf, 0xffc0) << static_cast<double>(height);  // lane 5 is the limit
        }
    }
}

TEST(LaneFaces, TurnTheCornerNearestARightAngleLast) {
    LooseFaces loose;
    loose.add({3.0L, 4.0L, 5.0L});
    loose.add({5.0L, 3.0L, 4.0L});
    loose.add({4.0L, 5.0L, 3.0L});
    loose.finish();
    // Behind the right angle comes the end of the side 4, whose angle lies opposite 3.
    for (std::size_t f = 0; f < 3; ++f) {
        EXPECT_NEAR(loose.faces.angle[3 * f + 2], std::numbers::pi / 2, 2 * kUnit);
        EXPECT_NEAR(loose.faces.square[3 * f + 2], 25.0 / 24.0, 4 * kUnit);
        EXPECT_NEAR(loose.faces.cot[2 * f], 4.0 / 3.0, 4 * kUnit);
        EXPECT_NEAR(loose.faces.cot[2 * f + 1], 0.75, kUnit);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_EQ(loose.faces.row[3 * f + c], loose.faces.corner[3 * f + c]);
    }
    loose.add({1.0L, 1.0L, 2.5L});
    EXPECT_THROW(loose.finish(), std::invalid_argument);
}

TEST(InstructionSets, AreLoweredByName) {
    for (const InstructionSet set :
         {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512}) {
        EXPECT_EQ(lowered(InstructionSet::avx512, name_of(set)), set);
        EXPECT_EQ(lowered(InstructionSet::baseline, name_of(set)), InstructionSet::baseline);
    }
    EXPECT_LE(instruction_set(), best_instruction_set());
    try {
        static_cast<void>(lowered(InstructionSet::avx2, "avx3"));
        FAIL();
    } catch (const std::invalid_argument& error) {
        for (const char* word : {"RICCI_INSTRUCTION_SET", "avx3", "baseline", "avx2", "avx512"})
            EXPECT_NE(std::string_view(error.what()).find(word), std::string_view::npos) << word;
    }
}

}  // namespace
}  // namespace ricci
