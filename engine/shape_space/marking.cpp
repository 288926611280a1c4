#include "engine/shape_space/marking.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>

#include "engine/shape_space/dual_curves.h"
#include "engine/shape_space/handle_search.h"
#include "engine/shape_space/unfolding.h"
#include "engine/topology/boundary_loops.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// A hole of the sphere that is left without the handles, its curve with the sphere on the left.
struct Hole {
    Index handle = -1, boundary = -1;
    BasedGeodesic curve;
    MarkedHandle torus;  // in the frame of curve.passes[0]
    bool used = false;
};

MarkedHandle carried(const MarkedHandle& h, const Isometry<Exact>& t, Index vertex) {
    return {vertex, conjugated(h.a, t), conjugated(h.b, t)};
}

/// A lift of a hole's curve that faces x along a common perpendicular.
struct Facing {
    std::size_t hole = 0, hole_pass = 0;
    std::size_t pass = 0;                    // of x
    Isometry<double> lift;                   // from the frame of the hole's pass to that of x's
    double distance = 0.0, parameter = 0.0;  // along the perpendicular, and where it leaves x
};

class ChainBuilder {
  public:
    ChainBuilder(const ExactSurface& surface, const MarkingOptions& options)
        : exact_(surface), s_(surface.coarse()), options_(options), budget_(options.budget) {}

    Marking build() {
        make_holes();
        begin();
        const std::size_t count = holes_.size();
        for (std::size_t k = 2; k < count; ++k) add_link();
        finish();
        m_.smallest_gap = options_.near_tie;
        for (const MarkingChoice& c : m_.choices) m_.smallest_gap = std::min(m_.smallest_gap, c.gap);
        return std::move(m_);
    }

  private:
    void make_holes() {
        for (const HandleGeodesics& g : find_handles(s_, options_, budget_, m_.choices)) {
            const std::optional<Meeting> meeting = nearest_meeting(g.a, g.b);
            if (!meeting) throw std::runtime_error("the curves of a handle do not meet");
            MarkedHandle torus{meeting->vertex,
                               exact_.exact(meeting->vertex, translation_along(meeting->first, g.a.length)),
                               exact_.exact(meeting->vertex, translation_along(meeting->second, g.b.length))};
            const Minkowski &n = meeting->first, &m = meeting->second, &x = meeting->point;
            const double frame = n[0] * (m[1] * x[2] - m[2] * x[1]) + n[1] * (m[2] * x[0] - m[0] * x[2]) +
                                 n[2] * (m[0] * x[1] - m[1] * x[0]);
            if (frame < 0) torus.b = inverse(torus.b);
            turn(torus, g.a.length);
            // The crossing lies inside the handle: outside is the other side of [a, b].
            BasedCurve curve{torus.vertex, product(torus.a, torus.b, inverse(torus.a), inverse(torus.b))};
            if (minkowski(axis_normal(curve.element), x) > 0) curve.element = inverse(curve.element);
            Isometry<Exact> way;
            Hole hole;
            hole.handle = static_cast<Index>(m_.handles.size());
            hole.curve = follow_curve(exact_, moved_to_axis(exact_, curve, &way));
            hole.torus = carried(torus, inverse(way), hole.curve.geodesic.passes[0].vertex);
            holes_.push_back(std::move(hole));
            m_.handles.push_back(torus);
        }
        const std::vector<Index> loops = boundary_halfedges(s_);
        for (std::size_t j = 0; j < loops.size(); ++j) {
            Hole hole;
            hole.boundary = static_cast<Index>(j);
            hole.curve = follow_curve(exact_, boundary_curve(exact_, loops[j]));
            holes_.push_back(std::move(hole));
        }
    }

    /// Turns b along a until its twist lies in [-l/4, 3l/4).
    void turn(MarkedHandle& torus, double length) {
        const double twist = torus_twist(torus.a, torus.b);
        const double turns = std::floor(twist / length + 0.25);
        for (double k = 0; k < std::abs(turns); ++k)
            torus.b = product(turns > 0 ? inverse(torus.a) : torus.a, torus.b);
        const double inside = twist / length - turns;
        m_.choices.push_back({"twist of b" + std::to_string(m_.handles.size() + 1),
                              std::min({options_.near_tie, inside + 0.25, 0.75 - inside})});
    }

    void begin() {
        std::size_t first = 0;
        if (s_.genus == 0) {
            std::vector<double> lengths;
            for (std::size_t k = 0; k < holes_.size(); ++k) {
                lengths.push_back(holes_[k].curve.geodesic.length);
                if (lengths[k] < lengths[first]) first = k;
            }
            std::sort(lengths.begin(), lengths.end());
            note("c1", lengths[0], lengths[1]);
        }
        take(holes_[first]);
        x_ = holes_[first].curve;
        m_.first = {x_.geodesic.passes[0].vertex, x_.element};
        m_.first_torus = holes_[first].torus;
    }

    void take(Hole& hole) {
        hole.used = true;
        if (hole.handle >= 0) order_.push_back(hole.handle);
        if (hole.boundary >= 0) m_.boundaries.push_back(hole.boundary);
    }
    void note(const std::string& name, double best, double second) {
        m_.choices.push_back({name, std::min(options_.near_tie, (second - best) / best)});
    }

    /// Joins the nearest hole to x.
    void add_link() {
        const Facing f = nearest_hole();
        Hole& hole = holes_[f.hole];
        ChainLink link;
        link.vertex = x_.geodesic.passes[f.pass].vertex;
        link.to_previous = product(from_first_pass_, x_.frames[f.pass]);
        const Isometry<Exact> lift = exact_lift(f);
        link.inner = x_.at_pass(f.pass);
        link.added = conjugated(hole.curve.element, lift);
        link.outer = product(link.inner, link.added);
        link.handle = hole.handle;
        link.boundary = hole.boundary;
        if (hole.handle >= 0) link.torus = carried(hole.torus, lift, link.vertex);
        take(hole);
        x_ = follow_curve(exact_, moved_to_axis(exact_, {link.vertex, link.outer}, &from_first_pass_));
        m_.links.push_back(std::move(link));
    }

    void finish() {
        for (std::size_t k = 0; k < holes_.size(); ++k) {
            Hole& hole = holes_[k];
            if (hole.used) continue;
            if (hole.handle < 0) {
                take(hole);
                continue;
            }
            // The last hole's curve is x itself, the other way round.
            const Facing f = same_line(k);
            const Isometry<Exact> way = product(from_first_pass_, x_.frames[f.pass], exact_lift(f));
            m_.last_torus =
                carried(hole.torus, way, m_.links.empty() ? m_.first.vertex : m_.links.back().vertex);
            take(hole);
        }
        std::vector<MarkedHandle> handles;
        for (const Index i : order_) handles.push_back(m_.handles[at(i)]);
        m_.handles = std::move(handles);
    }

    /// From the frame of the hole's passes[0] to that of x's pass.
    Isometry<Exact> exact_lift(const Facing& f) const {
        return product(exact_.exact(x_.geodesic.passes[f.pass].vertex, f.lift),
                       inverse(holes_[f.hole].curve.frames[f.hole_pass]));
    }

    /// Calls visit(pass, hole, pass of the hole, lift of its vertex) for what lies within `distance` of a
    /// vertex of x.
    template <class Visit>
    void look_around(double distance, Visit&& visit) {
        std::multimap<Index, std::pair<std::size_t, std::size_t>> by_vertex;
        for (std::size_t k = 0; k < holes_.size(); ++k)
            for (std::size_t i = 0; i < holes_[k].curve.geodesic.passes.size(); ++i)
                if (!holes_[k].used) by_vertex.insert({holes_[k].curve.geodesic.passes[i].vertex, {k, i}});
        const double widest = *std::max_element(s_.radius.begin(), s_.radius.end());
        Unfolding unfolding(s_);
        for (std::size_t p = 0; p < x_.geodesic.passes.size(); ++p) {
            const Index v = x_.geodesic.passes[p].vertex;
            const auto meet = [&](Index w, const Isometry<double>& lift) {
                const auto [begin, end] = by_vertex.equal_range(w);
                for (auto it = begin; it != end; ++it) visit(p, it->second.first, it->second.second, lift);
            };
            meet(v, Isometry<double>{});
            if (!unfolding.visit(v, s_.radius[at(v)] + distance + widest, budget_, meet))
                throw std::runtime_error("the search for a marking used up its budget");
        }
        budget_ -= unfolding.crossed();
    }

    /// The nearest hole that faces x: handles as long as there are any.
    Facing nearest_hole() {
        const bool handles =
            std::any_of(holes_.begin(), holes_.end(), [](const Hole& h) { return !h.used && h.handle >= 0; });
        std::optional<Facing> best;
        double second = 0;
        const auto search = [&](double distance) {
            best.reset();
            std::vector<Facing> found;
            look_around(
                distance, [&](std::size_t p, std::size_t k, std::size_t i, const Isometry<double>& lift) {
                    if ((holes_[k].handle >= 0) != handles) return;
                    const GeodesicPass &x = x_.geodesic.passes[p], &h = holes_[k].curve.geodesic.passes[i];
                    const Minkowski n = apply(-1, lift, h.normal);
                    const double cosine = -minkowski(x.normal, n);
                    if (cosine < 1 + 1e-12) return;
                    Minkowski foot;
                    for (std::size_t c = 0; c < 3; ++c)
                        foot[c] = (n[c] + cosine * x.normal[c]) / std::sqrt((cosine - 1) * (cosine + 1));
                    if (foot[2] < 0)
                        for (double& c : foot) c = -c;
                    const double parameter = x.offset + foot_parameter(x.normal, foot);
                    found.push_back({k, i, p, lift, std::acosh(cosine), parameter});
                });
            std::stable_sort(found.begin(), found.end(),
                             [](const Facing& a, const Facing& b) { return a.distance < b.distance; });
            if (found.empty() || found[0].distance > distance) return false;
            best = found[0];
            second = distance;
            for (const Facing& f : found)
                if (f.hole != best->hole ||
                    std::abs(std::remainder(f.parameter - best->parameter, x_.geodesic.length)) > 1e-5) {
                    second = std::min(second, f.distance);
                    break;
                }
            return true;
        };
        double distance = 1.0;
        while (!search(distance)) distance += 1.0;
        const double settled = best->distance * (1 + options_.near_tie);
        if (second >= distance && distance < settled) search(settled);
        note("x" + std::to_string(m_.links.size() + 2), best->distance, std::max(second, best->distance));
        return *best;
    }

    Facing same_line(std::size_t hole) {
        std::optional<Facing> found;
        look_around(1e-3, [&](std::size_t p, std::size_t k, std::size_t i, const Isometry<double>& lift) {
            if (k != hole || found) return;
            const GeodesicPass& h = holes_[k].curve.geodesic.passes[i];
            Minkowski n = apply(-1, lift, h.normal);
            for (double& c : n) c = -c;
            if (same_normal(n, x_.geodesic.passes[p].normal)) found = Facing{k, i, p, lift, 0, 0};
        });
        if (!found) throw std::runtime_error("the chain of the marking does not close");
        return *found;
    }

    const ExactSurface& exact_;
    const CoarseSurface& s_;
    const MarkingOptions& options_;
    std::int64_t budget_;
    Marking m_;
    std::vector<Hole> holes_;
    std::vector<Index> order_;
    BasedGeodesic x_;  // the chain's curve so far
    Isometry<Exact>
        from_first_pass_;  // from the frame of x's passes[0] to that of the last link, or of `first`
};

}  // namespace

std::string near_ties(const std::vector<MarkingChoice>& choices) {
    std::ostringstream ties;
    ties.precision(2);
    for (const MarkingChoice& c : choices)
        if (c.gap < 0.01)
            ties << (ties.tellp() > 0 ? ", " : "near-ties in the marking: ") << c.name << " (" << c.gap
                 << ")";
    return ties.str();
}

std::vector<Index> boundary_halfedges(const CoarseSurface& s) {
    std::vector<Index> first;
    for (const std::vector<Index>& loop : boundary_loops(s.connectivity)) first.push_back(loop.front());
    return first;
}

BasedCurve boundary_curve(const ExactSurface& surface, Index halfedge) {
    const CoarseSurface& s = surface.coarse();
    CoarsePath path;
    Index h = halfedge;
    do {
        path.push_back(h);
        h = s.outgoing[at(s.connectivity.head(h))];
    } while (h != halfedge);
    return {s.connectivity.tail[at(halfedge)], surface.along(path)};
}

Marking make_marking(const ExactSurface& surface, const MarkingOptions& options) {
    return ChainBuilder(surface, options).build();
}

Marking make_marking(const CoarseSurface& surface, const MarkingOptions& options) {
    return make_marking(ExactSurface(surface), options);
}

}  // namespace ricci
