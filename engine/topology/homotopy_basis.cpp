#include "engine/topology/homotopy_basis.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

void check_lengths(const Connectivity& c, std::span<const double> length) {
    if (c.face_count() == 0) throw std::invalid_argument("homotopy basis: the surface has no faces");
    if (length.size() != c.tail.size())
        throw std::invalid_argument("homotopy basis: there must be one length per halfedge");
    for (std::size_t h = 0; h < length.size(); ++h) {
        if (!(length[h] > 0) || !std::isfinite(length[h]))
            throw std::invalid_argument("homotopy basis: the length of halfedge " + std::to_string(h) +
                                        " is not positive");
    }
}

/// 1 where a vertex is a cone. // V
std::vector<std::uint8_t> checked_cones(const Connectivity& c, std::span<const Index> cones) {
    const std::vector<std::uint8_t> used = used_vertices(c), boundary = boundary_vertices(c);
    std::vector<std::uint8_t> is_cone(at(c.vertex_count), 0);
    for (const Index v : cones) {
        const std::string name = "homotopy basis: the cone " + std::to_string(v);
        if (v < 0 || v >= c.vertex_count) throw std::invalid_argument(name + " is out of range");
        if (used[at(v)] == 0) throw std::invalid_argument(name + " is not used by any face");
        if (boundary[at(v)] != 0) throw std::invalid_argument(name + " lies on the boundary");
        if (is_cone[at(v)]++ != 0) throw std::invalid_argument(name + " is named twice");
    }
    return is_cone;
}

Index checked_base(const Connectivity& c, std::span<const double> length, Index base,
                   std::span<const std::uint8_t> is_cone) {
    if (base == -1) {
        base = choose_base(c, length, is_cone);
        if (base == -1) throw std::invalid_argument("homotopy basis: every vertex is a cone");
        return base;
    }
    const std::string name = "homotopy basis: the base " + std::to_string(base);
    if (base < 0 || base >= c.vertex_count) throw std::invalid_argument(name + " is out of range");
    if (used_vertices(c)[at(base)] == 0) throw std::invalid_argument(name + " is not used by any face");
    if (is_cone[at(base)] != 0) throw std::invalid_argument(name + " is a cone");
    return base;
}

/// Appends a step to a path, or takes back the last one if the step undoes it.
void append_step(const Connectivity& c, EdgePath& path, Step step) {
    if (!path.empty() && path.back() != kNoStep && reversed_step(c, path.back()) == step) {
        path.pop_back();
    } else {
        path.push_back(step);
    }
}

}  // namespace

HomotopyBasis make_homotopy_basis(const Connectivity& connectivity, std::span<const double> length,
                                  const HomotopyOptions& options) {
    check_lengths(connectivity, length);
    const std::vector<std::uint8_t> is_cone = checked_cones(connectivity, options.cones);
    const Index base = checked_base(connectivity, length, options.base, is_cone);
    HomotopyBasis basis(connectivity);
    basis.cones_ = options.cones;
    basis.trees_ = tree_cotree(connectivity, length, base, is_cone);
    basis.contour_ = trace_contour(connectivity, basis.trees_, basis.cones_);
    return basis;
}

std::vector<std::string> HomotopyBasis::letter_names() const {
    std::vector<std::string> names;
    for (Index k = 1; k <= loops(); ++k) names.push_back("x" + std::to_string(k));
    for (Index j = 1; j <= boundaries(); ++j) names.push_back("c" + std::to_string(j));
    for (std::size_t i = 1; i <= cones_.size(); ++i) names.push_back("p" + std::to_string(i));
    return names;
}

Index HomotopyBasis::loop_halfedge(Index k) const {
    return trees_.loop_halfedges[at(k)];
}

std::vector<Index> HomotopyBasis::boundary_walk(Index j) const {
    std::vector<Index> walk = trees_.boundary[at(j)];
    const auto entrance = std::find(walk.begin(), walk.end(), contour_.entrance[at(j)]);
    std::rotate(walk.begin(), entrance + 1, walk.end());
    return walk;
}

Index HomotopyBasis::cone_halfedge(Index i) const {
    return trees_.tree.arriving[at(cones_[at(i)])];
}

Word HomotopyBasis::word_of(Step step) const {
    const Index h = halfedge_of(step);
    const Index e = connectivity_->edge[at(h)];
    const std::span<const Index> stretch =
        std::span(contour_.word)
            .subspan(at(contour_.begin[at(e)]), at(contour_.end[at(e)] - contour_.begin[at(e)]));
    const bool inverted = (contour_.inverse[at(h)] != 0) != (step < 0);
    return inverted ? inverse(stretch) : Word(stretch.begin(), stretch.end());
}

Word HomotopyBasis::word_of_path(std::span<const Step> path) const {
    Word word;
    for (std::size_t i = 0; i < path.size(); ++i) {
        const Step following = path[(i + 1) % path.size()];
        if (step_head(*connectivity_, path[i]) != step_tail(*connectivity_, following))
            throw std::invalid_argument("word_of_path: step " + std::to_string(i) +
                                        " does not end where the next one starts");
        append_reduced(word, word_of(path[i]));
    }
    return word;
}

EdgePath HomotopyBasis::tree_path(Index v) const {
    return trees_.tree.path_to(*connectivity_, v);
}

/// The loop of a letter with kNoStep in the place of a cone's circle.
void HomotopyBasis::append_loop(EdgePath& path, Index letter) const {
    const Index k = generator_of(letter);
    EdgePath middle;
    if (k < loops()) {
        middle = {loop_halfedge(k)};
    } else if (k < loops() + boundaries()) {
        middle = boundary_walk(k - loops());
    }
    const bool circle = middle.empty();
    const Index from =
        circle ? cones_[at(k - loops() - boundaries())] : step_tail(*connectivity_, middle.front());
    const Index to = circle ? from : step_head(*connectivity_, middle.back());
    if (letter < 0) middle = reversed_path(*connectivity_, middle);
    if (circle) middle = {kNoStep};
    const EdgePath out = tree_path(letter > 0 ? from : to), back = tree_path(letter > 0 ? to : from);
    path.insert(path.end(), out.begin(), out.end());
    path.insert(path.end(), middle.begin(), middle.end());
    const EdgePath home = reversed_path(*connectivity_, back);
    path.insert(path.end(), home.begin(), home.end());
}

EdgePath HomotopyBasis::loop_path(Index k) const {
    EdgePath path;
    append_loop(path, k + 1);
    std::erase(path, kNoStep);
    return path;
}

EdgePath HomotopyBasis::walk(std::span<const Index> word) const {
    EdgePath path, loop;
    for (const Index letter : reduced(word)) {
        loop.clear();
        append_loop(loop, letter);
        for (const Step step : loop) append_step(*connectivity_, path, step);
    }
    std::erase(path, kNoStep);
    return path;
}

}  // namespace ricci
