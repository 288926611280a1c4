#include "engine/shape_space/handle_search.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "engine/shape_space/closed_geodesics.h"
#include "engine/shape_space/handle_cocycles.h"
#include "engine/shape_space/line_table.h"

namespace ricci {
namespace {

void require(std::int64_t budget) {
    if (budget < 0) throw std::runtime_error("the search for a marking used up its budget");
}

class HandleSearch {
  public:
    HandleSearch(const CoarseSurface& surface, const MarkingOptions& options, std::int64_t& budget)
        : s_(surface), options_(options), budget_(budget), cocycles_(handle_cocycles(surface)) {}

    std::vector<HandleGeodesics> find(std::vector<MarkingChoice>& choices) {
        std::vector<HandleGeodesics> handles;
        for (Index i = 1; i <= s_.genus; ++i) {
            HandleGeodesics handle;
            handle.a =
                choose("a" + std::to_string(i), choices, 2.5, [&](double length) { return loops(length); });
            const double collar = 2 * std::asinh(1 / std::sinh(handle.a.length / 2));
            handle.b = choose("b" + std::to_string(i), choices, std::max(2.5, collar + 0.5),
                              [&](double length) { return partners(handle.a, length); });
            taken_.push_back(handle.a);
            taken_.push_back(handle.b);
            handles.push_back(std::move(handle));
        }
        return handles;
    }

  private:
    /// The shortest of what candidates(L) lists up to growing lengths L: all it has, or as many as settle the
    /// gap.
    template <class Candidates>
    ClosedGeodesic choose(const std::string& name, std::vector<MarkingChoice>& choices, double length,
                          Candidates&& candidates) {
        partner_ = nullptr;
        std::vector<ClosedGeodesic> found = candidates(length);
        while (found.empty()) found = candidates(length += length < 6 ? 1.0 : 0.7);
        const double settled = found[0].length * (1 + options_.near_tie);
        if (length < settled) found = candidates(settled);
        double gap = options_.near_tie;
        for (std::size_t k = 1; k < found.size(); ++k)
            if (!same_handle(found[0], found[k])) gap = std::min(gap, found[k].length / found[0].length - 1);
        choices.push_back({name, gap});
        return found[0];
    }

    /// Whether two partners of a make the same handle with it, differing by turns along a: its boundary is as
    /// long. (Where symmetry makes another one as long, taking that changes nothing.)
    [[nodiscard]] bool same_handle(const ClosedGeodesic& x, const ClosedGeodesic& y) const {
        if (!partner_) return false;
        const double first = boundary_trace(x), second = boundary_trace(y);
        return std::abs(first - second) < 1e-7 * std::abs(first);
    }
    /// Trace of [a, b], from those of a, b, ab.
    [[nodiscard]] double boundary_trace(const ClosedGeodesic& b) const {
        const std::optional<Meeting> m = nearest_meeting(*partner_, b);
        if (!m) return 0;
        const Isometry<double> ab = compose(-1, translation_along(m->first, partner_->length),
                                            translation_along(m->second, b.length));
        const double x = 2 * std::cosh(partner_->length / 2), y = 2 * std::cosh(b.length / 2),
                     z = 2 * ab.a.re;
        return x * x + y * y + z * z - x * y * z - 2;
    }

    /// Following and crossing tests cost too, some ten times a crossing of the universal cover per pass.
    void charge(const ClosedGeodesic& g) {
        budget_ -= static_cast<std::int64_t>(g.passes.size() * (10 + taken_.size()));
        require(budget_);
    }
    [[nodiscard]] bool free_of_handles(const ClosedGeodesic& g) const {
        return std::all_of(taken_.begin(), taken_.end(),
                           [&](const ClosedGeodesic& t) { return crossings(g, t, s_) == 0; });
    }

    /// The two shortest simple geodesics that do not separate, disjoint from the handles so far.
    std::vector<ClosedGeodesic> loops(double length) {
        if (all_.complete_up_to < length) grow(length);
        std::vector<ClosedGeodesic> found;
        for (std::size_t k = 0; k < eligible_.size() && found.size() < 2; ++k) {
            const ClosedGeodesic& g = all_.primitive[eligible_[k]];
            charge(g);
            if (g.length <= length && free_of_handles(g)) found.push_back(g);
        }
        return found;
    }
    void grow(double length) {
        all_ = find_closed_geodesics(s_, length, budget_, cocycles_);
        budget_ = all_.complete_up_to > 0 ? budget_ - all_.crossed : -1;
        require(budget_);
        eligible_.clear();
        for (std::size_t k = 0; k < all_.primitive.size(); ++k) {
            const ClosedGeodesic& g = all_.primitive[k];
            if (std::any_of(g.periods.begin(), g.periods.end(), [](Index p) { return p != 0; }) &&
                self_crossings(g, s_) == 0)
                eligible_.push_back(k);
        }
    }

    /// The shortest simple geodesics that meet `a` once, disjoint from the handles so far. They cross it
    /// within the radius of a vertex that it passes.
    std::vector<ClosedGeodesic> partners(const ClosedGeodesic& a, double length) {
        partner_ = &a;
        struct Axis {
            double length;
            Index vertex;
            Minkowski normal;
        };
        std::map<Index, std::vector<AxisAt>> at_vertex;
        for (const GeodesicPass& p : a.passes)
            if (at_vertex.find(p.vertex) == at_vertex.end()) {
                at_vertex[p.vertex] = axes_at(s_, p.vertex, length, budget_);
                require(budget_);
            }
        std::vector<Axis> axes;
        for (const GeodesicPass& p : a.passes) {
            const double reach = std::cosh(s_.radius[static_cast<std::size_t>(p.vertex)]) * (1 + 1e-7);
            for (const AxisAt& x : at_vertex[p.vertex])
                if (lines_cross(p.normal, x.normal) && line_crossing(-1, p.normal, x.normal)[2] <= reach)
                    axes.push_back({x.length, p.vertex, x.normal});
        }
        std::stable_sort(axes.begin(), axes.end(),
                         [](const Axis& x, const Axis& y) { return x.length < y.length; });
        LineTable seen;
        std::vector<ClosedGeodesic> found;
        for (const Axis& x : axes) {
            if (!found.empty() && x.length > found[0].length * (1 + options_.near_tie)) break;
            if (seen.find(x.vertex, x.normal) >= 0) continue;
            ClosedGeodesic g = follow_geodesic(s_, x.vertex, x.normal, x.length);
            charge(g);
            for (const GeodesicPass& p : g.passes) seen.insert(p.vertex, p.normal, 0);
            if (crossings(g, a, s_) == 1 && self_crossings(g, s_) == 0 && free_of_handles(g))
                found.push_back(std::move(g));
        }
        return found;
    }

    const CoarseSurface& s_;
    const MarkingOptions& options_;
    std::int64_t& budget_;
    std::vector<Cocycle> cocycles_;
    ClosedGeodesics all_;
    std::vector<std::size_t> eligible_;  // of all_: simple, not separating
    std::vector<ClosedGeodesic> taken_;
    const ClosedGeodesic* partner_ = nullptr;  // a, while its b is chosen
};

}  // namespace

std::vector<HandleGeodesics> find_handles(const CoarseSurface& surface, const MarkingOptions& options,
                                          std::int64_t& budget, std::vector<MarkingChoice>& choices) {
    return HandleSearch(surface, options, budget).find(choices);
}

}  // namespace ricci
