// Removal of vertices from a smooth hyperbolic triangulation by flips, and the insertion of others.
#pragma once

#include <vector>

#include "engine/shape_space/hyperbolic_triangulation.h"

namespace ricci {

/// A hyperbolic triangulation under change. Faces that go are marked and stay in the arrays.
class Thinning {
  public:
    explicit Thinning(const HyperbolicTriangulation& fine);

    /// Flips every edge that is not Delaunay.
    void make_delaunay();
    /// Removes a vertex and restores Delaunay; false where it must stay: the only one of its boundary, or
    /// flips that would free it are too near to degenerate.
    bool remove(Index vertex);
    /// Puts a vertex in the middle of the edge of h, and restores Delaunay.
    void split(Index h);
    /// Every point of the face has a corner within this distance, and no less will do.
    [[nodiscard]] double covering_radius(Index face) const;
    /// Splits edges until covering radii are not larger, but for faces too narrow to put a vertex in.
    void limit_radius(double largest);

    [[nodiscard]] const Connectivity& connectivity() const { return c_; }
    [[nodiscard]] double half_chord(Index h) const { return half_chord_[static_cast<std::size_t>(h)]; }
    /// Radians counterclockwise from the first halfedge that the vertex had at the start, reference(v); of a
    /// vertex from a split, from one half of the edge.
    [[nodiscard]] double direction(Index h) const { return direction_[static_cast<std::size_t>(h)]; }
    /// cos and sin of the angle at the tail of h, in its face.
    [[nodiscard]] const Complex<double>& angle(Index h) const { return angle_[static_cast<std::size_t>(h)]; }
    [[nodiscard]] bool alive(Index face) const { return alive_[static_cast<std::size_t>(face)] != 0; }
    /// kNoTwin for a vertex from a split.
    [[nodiscard]] Index reference(Index v) const { return reference_[static_cast<std::size_t>(v)]; }
    /// A halfedge from v; on the boundary that of the boundary. kNoTwin: removed, or unused.
    [[nodiscard]] Index outgoing(Index v) const { return outgoing_[static_cast<std::size_t>(v)]; }

  private:
    void set_directions();
    void update_angles(Index face);
    void flip(Index h);
    [[nodiscard]] double new_half_chord(Index h) const;
    [[nodiscard]] bool delaunay(Index h) const;
    [[nodiscard]] double convexity(Index h) const;
    [[nodiscard]] Index turned(Index h) const;
    [[nodiscard]] std::vector<Index> star(Index v) const;
    bool flip_best(Index v, const std::vector<Index>& star);
    void drop(const std::vector<Index>& star, bool inner);
    void restore();
    void set_half_chord(Index h, double chord);
    Index new_face();
    [[nodiscard]] Index longest_side(Index face) const;
    [[nodiscard]] double median(Index h) const;

    Connectivity c_;
    std::vector<double> half_chord_, half_cosine_, direction_;
    std::vector<Complex<double>> angle_;
    std::vector<std::uint8_t> alive_;
    std::vector<Index> outgoing_, reference_, pending_;
};

}  // namespace ricci
