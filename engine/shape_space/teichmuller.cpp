#include "engine/shape_space/teichmuller.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "engine/shape_space/dual_curves.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// The pants of a handle cut along a, p1 p2 = `around`, which is [a,b] or its inverse.
std::array<Isometry<Exact>, 2> torus_pants(const MarkedHandle& h, const Isometry<Exact>& around) {
    const Isometry<Exact> first[2] = {h.a, conjugated(h.a, h.b)};
    const Isometry<Exact> second[2] = {conjugated(inverse(h.a), h.b), inverse(h.a)};
    for (std::size_t k = 0; k < 2; ++k)
        if (same_normal(axis_normal(product(first[k], second[k])), axis_normal(around)))
            return {first[k], second[k]};
    throw std::runtime_error("a handle of the marking does not fit its boundary");
}

class CoordinateBuilder {
  public:
    CoordinateBuilder(const ExactSurface& surface, const Marking& marking)
        : exact_(surface), s_(surface.coarse()), m_(marking) {}

    TeichmullerCoordinates build() {
        c_.choices = m_.choices;
        c_.smallest_gap = m_.smallest_gap;
        for (std::size_t i = 0; i < m_.handles.size(); ++i) add_handle(i);
        const std::vector<Index> loops = boundary_halfedges(s_);
        if (s_.genus != 1 || s_.boundaries != 1)
            for (std::size_t j = 0; j < m_.boundaries.size(); ++j)
                add("c" + std::to_string(j + 1), boundary_curve(exact_, loops[at(m_.boundaries[j])]));
        for (std::size_t k = 0; k + 1 < m_.links.size(); ++k)
            add("x" + std::to_string(k + 2), {m_.links[k].vertex, m_.links[k].outer});
        add_separating();
        return std::move(c_);
    }

  private:
    void add(const std::string& name, const BasedCurve& curve) {
        const double length = translation_length(curve.element);
        if (!(length > 0)) throw std::runtime_error("the curve " + name + " has no geodesic");
        c_.lengths.push_back({name, curve, length});
    }
    void add_handle(std::size_t i) {
        const std::string number = std::to_string(i + 1);
        const MarkedHandle& h = m_.handles[i];
        add("a" + number, {h.vertex, h.a});
        const double length = c_.lengths.back().length;
        add("b" + number, {h.vertex, h.b});
        add("a" + number + "b" + number, {h.vertex, product(h.a, h.b)});
        c_.pants.push_back({"a" + number, length, torus_twist(h.a, h.b)});
    }

    /// Around handles e1, e2, ..., then x2, x3, ...
    void add_separating() {
        const std::size_t holes = m_.links.size() + 2;
        if (s_.genus == 1 && s_.boundaries == 1) return;
        Index handle = 1;
        if (s_.genus > 0) {
            if (m_.links.empty()) {
                const Isometry<Exact>& x = m_.first.element;
                const auto p = torus_pants(m_.first_torus, x), q = torus_pants(m_.last_torus, inverse(x));
                add_dual("e1", m_.first.vertex, {p[0], p[1], q[0], q[1]});
                return;
            }
            const ChainLink& l = m_.links[0];
            const Isometry<Exact> way = inverse(l.to_previous);
            const MarkedHandle torus{l.vertex, conjugated(m_.first_torus.a, way),
                                     conjugated(m_.first_torus.b, way)};
            const auto p = torus_pants(torus, l.inner);
            add_dual("e" + std::to_string(handle++), l.vertex, {p[0], p[1], l.added, inverse(l.outer)});
        }
        for (const ChainLink& l : m_.links) {
            if (l.handle < 0) continue;
            const auto p = torus_pants(l.torus, l.added);
            add_dual("e" + std::to_string(handle++), l.vertex, {p[0], p[1], inverse(l.outer), l.inner});
        }
        if (s_.boundaries == 0) {
            const ChainLink& l = m_.links.back();
            const auto p = torus_pants(m_.last_torus, inverse(l.outer));
            add_dual("e" + std::to_string(handle), l.vertex, {p[0], p[1], l.inner, l.added});
        }
        for (std::size_t k = 0; k + 3 < holes; ++k) {
            const ChainLink &before = m_.links[k], &l = m_.links[k + 1];
            const Isometry<Exact> way = inverse(l.to_previous);
            add_dual(
                "x" + std::to_string(k + 2), l.vertex,
                {conjugated(before.inner, way), conjugated(before.added, way), l.added, inverse(l.outer)});
        }
    }

    void add_dual(const std::string& name, Index vertex, const FourHoledSphere& sphere) {
        const DualCurves d = dual_curves(sphere);
        const bool first = !any_dual_;
        any_dual_ = true;
        const bool genus_two = s_.genus == 2 && s_.boundaries == 0;
        if (first && !genus_two) add("y(" + name + ")", {vertex, d.y});
        add("z(" + name + ")", {vertex, d.z});
        const double length = translation_length(product(sphere.p1, sphere.p2));
        c_.pants.push_back({name, length, d.twist});
        c_.choices.push_back({"twist of y(" + name + ")", d.gap});
        c_.smallest_gap = std::min(c_.smallest_gap, d.gap);
    }

    const ExactSurface& exact_;
    const CoarseSurface& s_;
    const Marking& m_;
    TeichmullerCoordinates c_;
    bool any_dual_ = false;
};

}  // namespace

TeichmullerCoordinates teichmuller_coordinates(const ExactSurface& surface, const Marking& marking) {
    return CoordinateBuilder(surface, marking).build();
}

TeichmullerCoordinates teichmuller_coordinates(const CoarseSurface& surface, const Marking& marking) {
    return teichmuller_coordinates(ExactSurface(surface), marking);
}

std::array<double, 3> hexagon_seams(const std::array<double, 3>& length) {
    std::array<double, 3> seams{};
    for (std::size_t k = 0; k < 3; ++k) {
        const double a = length[k] / 2, b = length[(k + 1) % 3] / 2, c = length[(k + 2) % 3] / 2;
        seams[k] = std::acosh((std::cosh(b) * std::cosh(c) + std::cosh(a)) / (std::sinh(b) * std::sinh(c)));
    }
    return seams;
}

}  // namespace ricci
