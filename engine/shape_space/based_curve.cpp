#include "engine/shape_space/based_curve.h"

#include <cmath>
#include <stdexcept>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Foot of the perpendicular from the origin.
Minkowski foot_of(const Minkowski& n) {
    const double size = std::sqrt(1 + n[2] * n[2]);
    return {n[2] * n[0] / size, n[2] * n[1] / size, size};
}

}  // namespace

double translation_length(const Isometry<Exact>& x) {
    const Exact square = squared(x.b) - x.a.im * x.a.im;
    return square > Exact(0) ? 2 * std::asinh(static_cast<double>(sqrt(square))) : 0.0;
}

Minkowski axis_normal(const Isometry<Exact>& x) {
    Exact sine = sqrt(squared(x.b) - x.a.im * x.a.im);
    if (x.a.re < Exact(0)) sine = -sine;
    return {static_cast<double>(-x.b.im / sine), static_cast<double>(x.b.re / sine),
            static_cast<double>(x.a.im / sine)};
}

BasedCurve moved_to_axis(const ExactSurface& surface, const BasedCurve& curve, Isometry<Exact>* carried) {
    BasedCurve here = curve;
    Isometry<Exact> way;
    for (int steps = 0; steps < 10000; ++steps) {
        const Minkowski normal = axis_normal(here.element);
        if (std::abs(normal[2]) <= std::sinh(surface.coarse().radius[at(here.vertex)])) break;
        const Minkowski foot = foot_of(normal);
        double nearest = foot[2];
        Index to = -1;
        CoarseStep taken = 0;
        for_neighbours(surface.coarse(), here.vertex, [&](CoarseStep step, Index w) {
            const double distance = -minkowski(image_of_origin(-1, surface.coarse().along(step)), foot);
            if (distance >= nearest) return;
            nearest = distance;
            to = w;
            taken = step;
        });
        if (to < 0) break;
        const Isometry<Exact> step = surface.along(taken);
        here = {to, conjugated(here.element, inverse(step))};
        way = product(way, step);
    }
    if (carried) *carried = way;
    return here;
}

BasedGeodesic follow_curve(const ExactSurface& surface, const BasedCurve& curve) {
    const CoarseSurface& s = surface.coarse();
    BasedGeodesic g;
    g.element = curve.element;
    g.frames.emplace_back();
    ClosedGeodesic& out = g.geodesic;
    out.length = translation_length(curve.element);
    if (!(out.length > 0)) throw std::runtime_error("a curve of the marking has no geodesic");
    out.passes.push_back({curve.vertex, axis_normal(curve.element), 0.0});
    for (std::size_t k = 0; k < out.passes.size(); ++k) {
        const GeodesicPass from = out.passes[k];
        for_neighbours(s, from.vertex, [&](CoarseStep step, Index w) {
            // One step from an exact line: near enough to see whether it passes and is known.
            const Isometry<double> move = s.along(step);
            const Minkowski n = apply(-1, inverse(move), from.normal);
            if (std::abs(n[2]) > std::sinh(s.radius[at(w)]) * (1 + 1e-9)) return;
            for (const GeodesicPass& p : out.passes)
                if (p.vertex == w && same_normal(p.normal, n)) return;
            const double offset = from.offset + foot_parameter(from.normal, image_of_origin(-1, move));
            g.frames.push_back(product(g.frames[k], surface.along(step)));
            const Minkowski exact = axis_normal(g.at_pass(g.frames.size() - 1));
            out.passes.push_back({w, exact, offset - out.length * std::floor(offset / out.length)});
        });
        if (out.passes.size() > 100000) throw std::runtime_error("a curve of the marking does not close");
    }
    return g;
}

ClosedGeodesic geodesic_of(const CoarseSurface& surface, const BasedCurve& curve) {
    const ExactSurface exact(surface);
    return follow_curve(exact, moved_to_axis(exact, curve)).geodesic;
}

}  // namespace ricci
