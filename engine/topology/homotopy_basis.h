// Generators of the fundamental group at a base point, and the homotopy class of any closed edge path.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/topology/contour.h"
#include "engine/topology/edge_path.h"
#include "engine/topology/words.h"

namespace ricci {

struct HomotopyOptions {
    Index base = -1;           // base vertex; -1: choose_base(), never a cone
    std::vector<Index> cones;  // interior vertices that paths must not be drawn across
};

/// Generators of the fundamental group of a connected surface of genus g with b boundary components, less its
/// cone vertices. Every vertex v has the tree path base -> v, so every edge path is a loop at the base and
/// every halfedge has a word. Letters, in this order:
///   0 ... 2g-1   handles: the edge h_k left over by tree and cotree, along its halfedge;
///   2g ...       boundaries: component j once around, the surface on its left (the hole is circled
///                clockwise), from and to the head of its entrance;
///   2g + b ...   cones: tree path to the cone, a small counterclockwise circle around it, and back.
///
/// relator() is the counterclockwise boundary of the disk that is left after cutting along the tree and the
/// edges h_k; it is 1. It has each handle letter once with either sign, each boundary letter once, positive,
/// each cone letter once, negative.
///
///     x       y         The cone v and its tree edge t = p->v. Directions at v are counted counterclockwise
///       \    /          from t, through one full turn: a path that comes along t turns counterclockwise to
///   z --- v             the edge it leaves by, one that leaves along t turns clockwise to it, and none ever
///         |             crosses t. The corner at v in face_of(t), between t and z = next(t), spans the end
///    left | right       of that turn: there a boundary read corner by corner crosses t. So the letter sits
///         p             on the left of t: the boundary of face_of(t) reads
///                       word(t) C^-1 word(next t) word(prev t) = 1, with word(t) = 1, and all other
///                       corners at v are free of it.
/// For numbers: a frame at v is carried along t, then counterclockwise from t to where it is wanted.
/// A path through a cone passes it on the side away from the tree edge.
class HomotopyBasis {
  public:
    [[nodiscard]] Index base() const { return trees_.tree.root; }
    [[nodiscard]] Index loops() const { return static_cast<Index>(trees_.loop_halfedges.size()); }  // 2g
    [[nodiscard]] Index genus() const { return loops() / 2; }
    [[nodiscard]] Index boundaries() const { return static_cast<Index>(trees_.boundary.size()); }
    [[nodiscard]] const std::vector<Index>& cones() const { return cones_; }
    [[nodiscard]] Index punctures() const { return boundaries() + static_cast<Index>(cones_.size()); }
    [[nodiscard]] Index letters() const { return loops() + punctures(); }
    /// "x1" ... for handles, "c1" ... for boundaries, "p1" ... for cones.
    [[nodiscard]] std::vector<std::string> letter_names() const;

    [[nodiscard]] const Word& relator() const { return contour_.word; }
    /// Halfedge h_k of a handle letter.
    [[nodiscard]] Index loop_halfedge(Index k) const;
    /// Distances (in the unit of the lengths) and tree steps from the base.
    [[nodiscard]] const ShortestPaths& tree() const { return trees_.tree; }
    /// What each edge is: tree, dual tree, or one of the 2g loops. // E
    [[nodiscard]] const std::vector<EdgeRole>& roles() const { return trees_.role; }
    /// Component j as the cycle of its halfedges, ending with its entrance: the walk of letter 2g + j.
    [[nodiscard]] std::vector<Index> boundary_walk(Index j) const;
    /// Tree halfedge into cone i; the letter sits on its left.
    [[nodiscard]] Index cone_halfedge(Index i) const;

    /// Class of the loop base -> tail, step, head -> base. Costs the length of the answer, which is reduced.
    [[nodiscard]] Word word_of(Step step) const;
    /// Reduced word of a closed path, joined to the base by the tree path to its start (thesis, Algorithm 1,
    /// step 2). On a closed surface words are equal up to the relator only. Throws std::invalid_argument
    /// where the path is not connected or not closed.
    [[nodiscard]] Word word_of_path(std::span<const Step> path) const;

    /// Steps from the base to v along the tree.
    [[nodiscard]] EdgePath tree_path(Index v) const;
    /// Loop of letter k at the base: tree path, h_k or boundary walk, tree path back; for a cone the tree
    /// path there and back. Both tree paths may share a stretch; see walk().
    [[nodiscard]] EdgePath loop_path(Index k) const;
    /// Loop of a word at the base: the word is reduced, its loops joined, backtracking removed, but for turns
    /// at a cone that stand for its circle.
    [[nodiscard]] EdgePath walk(std::span<const Index> word) const;

  private:
    friend HomotopyBasis make_homotopy_basis(const Connectivity&, std::span<const double>,
                                             const HomotopyOptions&);
    explicit HomotopyBasis(const Connectivity& connectivity) : connectivity_(&connectivity) {}
    void append_loop(EdgePath& path, Index letter) const;

    const Connectivity* connectivity_;
    TreeCotree trees_;
    Contour contour_;
    std::vector<Index> cones_;
};

/// `length`: 3F, positive, equal on twins, in any unit. The result refers to `connectivity`, which must
/// outlive it unchanged. Deterministic. The loops are the shortest system in the graph of edges
/// (tree_cotree.h). Throws std::invalid_argument for a surface without faces or not connected, lengths that
/// are not 3F positive numbers, a base that is out of range, unused or a cone, cones that are repeated, out
/// of range, unused or on the boundary, and where every vertex is a cone.
HomotopyBasis make_homotopy_basis(const Connectivity& connectivity, std::span<const double> length,
                                  const HomotopyOptions& options = {});
HomotopyBasis make_homotopy_basis(Connectivity&&, std::span<const double>, const HomotopyOptions&) = delete;

}  // namespace ricci
