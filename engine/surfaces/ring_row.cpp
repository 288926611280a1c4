#include "engine/surfaces/ring_row.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/surfaces/block_lattice.h"
#include "engine/surfaces/pattern_size.h"
#include "engine/surfaces/ring_row_field.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// The lattice's skin being drawn onto the smooth surface.
class RowShape {
  public:
    RowShape(const BlockLattice& lattice, Index genus) : lattice_(lattice), field_(genus) {
        mirror_.reserve(lattice.vertices.size());
        for (const LatticePoint& v : lattice.vertices) {
            mirror_.push_back(lattice.vertex_at({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}));
        }
    }

    /// Starts at the blocks themselves; a coarse cell has the side 1, as the rings have radius 1.
    void start_from_blocks() {
        points_.clear();
        const double unit = 0.5 / lattice_.repeats;
        for (const LatticePoint& v : lattice_.vertices)
            points_.push_back({v[0] * unit, v[1] * unit, v[2] * unit});
        project(12);
    }

    /// Starts from a finished coarser shape, bilinearly within its quads.
    void start_from(const RowShape& coarse);

    /// Moves every vertex half way to the mean of its neighbours along the quads' sides, then back to the
    /// surface.
    void relax(int rounds);

    /// Newton steps to the surface.
    void project(int steps);

    [[nodiscard]] const std::vector<Point>& points() const { return points_; }

  private:
    /// Positions of mirror images become mirror images to the last bit: those with non-negative lattice
    /// coordinates decide.
    void symmetrise();

    const BlockLattice& lattice_;
    RingRowField field_;
    std::vector<Index> mirror_;  // V, image of the vertex with non-negative lattice coordinates
    std::vector<Point> points_;  // V
};

void RowShape::symmetrise() {
    for (std::size_t v = 0; v < points_.size(); ++v) {
        const Point image = points_[at(mirror_[v])];
        for (std::size_t k = 0; k < 3; ++k) {
            const Index side = lattice_.vertices[v][k];
            points_[v][k] = side > 0 ? image[k] : (side < 0 ? -image[k] : 0.0);
        }
    }
}

void RowShape::project(int steps) {
    for (Point& p : points_) {
        for (int k = 0; k < steps; ++k) p = field_.step_to_surface(p);
    }
    symmetrise();
}

void RowShape::relax(int rounds) {
    std::vector<Point> sum(points_.size());
    std::vector<double> count(points_.size());
    for (int round = 0; round < rounds; ++round) {
        std::fill(sum.begin(), sum.end(), Point{0.0, 0.0, 0.0});
        std::fill(count.begin(), count.end(), 0.0);
        for (const Quad& quad : lattice_.quads) {
            for (std::size_t c = 0; c < 4; ++c) {  // every side is met from both its quads
                for (const std::size_t d : {(c + 1) % 4, (c + 3) % 4}) {
                    for (std::size_t k = 0; k < 3; ++k) sum[at(quad[c])][k] += points_[at(quad[d])][k];
                    count[at(quad[c])] += 1.0;
                }
            }
        }
        for (std::size_t v = 0; v < points_.size(); ++v) {
            for (std::size_t k = 0; k < 3; ++k) points_[v][k] = 0.5 * (points_[v][k] + sum[v][k] / count[v]);
        }
        project(1);
    }
}

void RowShape::start_from(const RowShape& coarse) {
    const Index n = lattice_.repeats, m = coarse.lattice_.repeats;
    points_.resize(lattice_.vertices.size());
    const auto position = [](const BlockSquare& square, Index i, Index j) {
        LatticePoint p = square.corner;
        for (std::size_t k = 0; k < 3; ++k) p[k] += i * square.first_step[k] + j * square.second_step[k];
        return p;
    };
    for (std::size_t s = 0; s < lattice_.squares.size(); ++s) {
        for (Index i = 0; i <= n; ++i) {
            for (Index j = 0; j <= n; ++j) {
                const double x = static_cast<double>(i) * m / n, y = static_cast<double>(j) * m / n;
                const Index a = std::min(static_cast<Index>(x), m - 1),
                            b = std::min(static_cast<Index>(y), m - 1);
                Point p = {0.0, 0.0, 0.0};
                for (const auto& [di, dj] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
                    const double weight = (di ? x - a : 1.0 - (x - a)) * (dj ? y - b : 1.0 - (y - b));
                    const LatticePoint corner = position(coarse.lattice_.squares[s], a + di, b + dj);
                    const Point& q = coarse.points_[at(coarse.lattice_.vertex_at(corner))];
                    for (std::size_t k = 0; k < 3; ++k) p[k] += weight * q[k];
                }
                points_[at(lattice_.vertex_at(position(lattice_.squares[s], i, j)))] = p;
            }
        }
    }
    project(3);
}

/// The whole surface as quads: relaxed at four quads per coarse side, then drawn finer.
std::vector<Point> shape_points(const BlockLattice& lattice, Index genus) {
    constexpr Index kCoarse = 4;
    constexpr int kCoarseRounds = 150, kFineRounds = 40;
    RowShape shape(lattice, genus);
    if (lattice.repeats <= kCoarse) {
        shape.start_from_blocks();
        shape.relax(kCoarseRounds);
    } else {
        const BlockLattice coarse_lattice = make_block_lattice(genus, kCoarse);
        RowShape coarse(coarse_lattice, genus);
        coarse.start_from_blocks();
        coarse.relax(kCoarseRounds);
        shape.start_from(coarse);
        shape.relax(kFineRounds);
    }
    shape.project(4);
    return shape.points();
}

double squared_distance(const Point& a, const Point& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

/// Cuts quads into triangles so that mirror images are cut alike.
class QuadCutter {
  public:
    QuadCutter(const BlockLattice& lattice, std::vector<Point> points, const RingRowField& field)
        : lattice_(lattice), points_(std::move(points)), field_(field) {}

    void cut(const Quad& quad, bool always_at_centre) {
        const int choice = always_at_centre ? 0 : diagonal(quad);
        if (choice == 0) {
            const Index centre = add_centre(quad);
            for (std::size_t c = 0; c < 4; ++c) triangles_.push_back({quad[c], quad[(c + 1) % 4], centre});
        } else if (choice == 1) {
            triangles_.push_back({quad[0], quad[1], quad[2]});
            triangles_.push_back({quad[0], quad[2], quad[3]});
        } else {
            triangles_.push_back({quad[1], quad[2], quad[3]});
            triangles_.push_back({quad[1], quad[3], quad[0]});
        }
    }

    [[nodiscard]] const std::vector<Point>& points() const { return points_; }
    [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }

  private:
    /// 1: from corner 0 to 2; 2: from 1 to 3; 0: neither, since the quad is its own mirror image. The shorter
    /// one; where they tie, the one that points away from the origin's planes.
    [[nodiscard]] int diagonal(const Quad& quad) const {
        std::array<const LatticePoint*, 4> corner{};
        for (std::size_t c = 0; c < 4; ++c) corner[c] = &lattice_.vertices[at(quad[c])];
        Index side = 1;   // sign of the product of the centre's coordinates along the two sides
        Index slope = 1;  // sign of the product of the steps from corner 0 to 2 along the two sides
        for (std::size_t k = 0; k < 3; ++k) {
            const Index step = (*corner[2])[k] - (*corner[0])[k];
            if (step == 0) continue;
            const Index centre = (*corner[2])[k] + (*corner[0])[k];
            if (centre == 0) return 0;
            side *= centre > 0 ? 1 : -1;
            slope *= step > 0 ? 1 : -1;
        }
        const double first = squared_distance(points_[at(quad[0])], points_[at(quad[2])]);
        const double second = squared_distance(points_[at(quad[1])], points_[at(quad[3])]);
        if (first != second) return first < second ? 1 : 2;
        return side == slope ? 1 : 2;
    }

    Index add_centre(const Quad& quad) {
        Point p;
        for (std::size_t k = 0; k < 3; ++k) {
            // Opposite corners first: a sum that mirror images do in the same order, up to commuting.
            p[k] = 0.25 * ((points_[at(quad[0])][k] + points_[at(quad[2])][k]) +
                           (points_[at(quad[1])][k] + points_[at(quad[3])][k]));
        }
        for (int step = 0; step < 4; ++step) p = field_.step_to_surface(p);
        points_.push_back(p);
        return static_cast<Index>(points_.size()) - 1;
    }

    const BlockLattice& lattice_;
    std::vector<Point> points_;
    const RingRowField& field_;
    std::vector<Triangle> triangles_;
};

/// The pattern size nearest to the wanted number of faces: quads per coarse side, and whether quads are cut
/// at their centre (four triangles) or along a diagonal (two).
struct RowPattern {
    Index repeats;
    bool at_centre;
};

double pattern_faces(const RowPattern& pattern, Index genus, RowPart part) {
    const BlockQuadCount quads = count_block_quads(genus, pattern.repeats);
    const double faces = pattern.at_centre ? 4.0 * quads.all : 2.0 * (quads.all + quads.self_mirrored);
    return part == RowPart::whole ? faces : 0.5 * faces;
}

RowPattern choose_pattern(Index faces, Index genus, RowPart part) {
    check_face_count(faces);
    // One quad per coarse side is too coarse for the rings. A mirror plane must run along sides of quads for
    // a half to be cut off.
    const Index fewest = 2, step = part == RowPart::whole ? 1 : 2;
    RowPattern best{fewest, false};
    double best_error = std::numeric_limits<double>::infinity();
    for (const bool at_centre : {false, true}) {
        const double unit = pattern_faces({2, at_centre}, genus, part) / 4.0;
        const auto near = static_cast<Index>(std::sqrt(faces / unit)) / step * step;
        for (Index repeats = std::max(fewest, near - step); repeats <= std::max(fewest, near + step);
             repeats += step) {
            const RowPattern pattern{repeats, at_centre};
            const double error = std::abs(std::log(pattern_faces(pattern, genus, part) / faces));
            if (error < best_error) {
                best_error = error;
                best = pattern;
            }
        }
    }
    check_face_count(pattern_faces(best, genus, RowPart::whole));
    return best;
}

bool keeps(RowPart part, const BlockLattice& lattice, const Quad& quad) {
    if (part == RowPart::whole) return true;
    const std::size_t axis = part == RowPart::upper ? 2 : 0;
    return std::all_of(quad.begin(), quad.end(), [&](Index v) { return lattice.vertices[at(v)][axis] >= 0; });
}

/// Surface of the vertices that triangles use, numbered in the order of the points.
SurfaceMesh compact_surface(const std::vector<Point>& points, std::vector<Triangle> triangles) {
    std::vector<Index> number(points.size(), -1);
    for (const Triangle& t : triangles) {
        for (const Index v : t) number[at(v)] = 0;
    }
    std::vector<Point> used;
    for (std::size_t v = 0; v < points.size(); ++v) {
        if (number[v] < 0) continue;
        number[v] = static_cast<Index>(used.size());
        used.push_back(points[v]);
    }
    for (Triangle& t : triangles) {
        for (Index& v : t) v = number[at(v)];
    }
    return make_surface_mesh(std::move(used), triangles);
}

}  // namespace

SurfaceMesh make_ring_row(Index faces, Index genus, RowPart part) {
    constexpr Index kLargestGenus = 10000;
    if (genus < 1 || genus > kLargestGenus) {
        throw std::invalid_argument("generate: a row of rings has a genus from 1 to " +
                                    std::to_string(kLargestGenus));
    }
    const RowPattern pattern = choose_pattern(faces, genus, part);
    const BlockLattice lattice = make_block_lattice(genus, pattern.repeats);
    const RingRowField field(genus);
    QuadCutter cutter(lattice, shape_points(lattice, genus), field);
    for (const Quad& quad : lattice.quads) {
        if (keeps(part, lattice, quad)) cutter.cut(quad, pattern.at_centre);
    }
    return compact_surface(cutter.points(), cutter.triangles());
}

}  // namespace ricci
