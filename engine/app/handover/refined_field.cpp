#include "engine/app/handover/refined_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/app/pictures/laid_out_domain.h"
#include "io/mesh/mesh_file.h"

namespace ricci::app {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

RefinedField::RefinedField(const CommonRefinement& r, std::span<const Triangle> triangles,
                           std::size_t vertices) {
    if (at(r.vertex_count) > vertices + 4 * r.vertex.size())
        throw FileError("layout/refinement: numbers of vertices beyond all that there can be");
    place_.resize(std::max(at(r.vertex_count), vertices));
    for (std::size_t v = 0; v < vertices; ++v)
        place_[v] = {static_cast<Index>(v), static_cast<Index>(v), 0.0};
    const EdgeChains chains(r);
    std::vector<double> along;
    for (Index h = 0; h < chains.halfedge_count() && at(h) < 3 * triangles.size(); ++h) {
        const std::span<const Index> chain = chains.of(h);
        if (chain.size() < 2) continue;
        along.assign(1, 0.0);
        for (const Index c : chain) {
            const auto &p = r.flat[at(c)], &q = r.flat[at(r.next(c))];
            along.push_back(along.back() + std::hypot(q[0] - p[0], q[1] - p[1]));
        }
        const Triangle& triangle = triangles[at(h / 3)];
        const Index from = triangle[at(h % 3)], to = triangle[at((h + 1) % 3)];
        for (std::size_t i = 1; i < chain.size(); ++i) {
            const Index v = r.vertex[at(chain[i])];
            if (at(v) >= vertices && place_[at(v)].from < 0)
                place_[at(v)] = {from, to, along.back() > 0.0 ? along[i] / along.back() : 0.5};
        }
    }
}

std::vector<double> RefinedField::on_refinement(std::span<const double> values) const {
    std::vector<double> result;
    result.reserve(place_.size());
    for (const Place& p : place_) {
        if (p.from < 0)
            result.push_back(std::numeric_limits<double>::quiet_NaN());
        else if (p.from == p.to)
            result.push_back(values[at(p.from)]);  // the very number
        else
            result.push_back((1.0 - p.fraction) * values[at(p.from)] + p.fraction * values[at(p.to)]);
    }
    return result;
}

}  // namespace ricci::app
