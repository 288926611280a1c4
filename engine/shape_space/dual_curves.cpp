#include "engine/shape_space/dual_curves.h"

#include <cmath>
#include <stdexcept>

namespace ricci {
namespace {

Exact half_trace(const Isometry<Exact>& x) {
    return x.a.re < Exact(0) ? Exact(-x.a.re) : x.a.re;
}

}  // namespace

DualCurves dual_curves(const FourHoledSphere& f) {
    struct Turned {
        Isometry<Exact> p1, p2, curve;
    };
    const auto curve = [&](const Isometry<Exact>& p1, const Isometry<Exact>& p2) {
        return Turned{p1, p2, product(p2, f.q1)};
    };
    const auto forward = [&](const Turned& t) { return curve(t.p2, conjugated(t.p1, inverse(t.p2))); };
    const auto backward = [&](const Turned& t) { return curve(conjugated(t.p2, t.p1), t.p1); };
    Turned here = curve(f.p1, f.p2);
    Turned next = forward(here), before = backward(here);
    for (int k = 0;; ++k) {
        if (k > 100000) throw std::runtime_error("no shortest dual curve");
        if (half_trace(next.curve) < half_trace(here.curve)) {
            before = here;
            here = next;
            next = forward(here);
        } else if (half_trace(before.curve) < half_trace(here.curve)) {
            next = here;
            here = before;
            before = backward(here);
        } else {
            break;
        }
    }
    // A + B cosh(t + m l/2) at m = -2, 0, 2.
    const double length = translation_length(product(f.p1, f.p2));
    const Exact zero = half_trace(here.curve), plus = half_trace(forward(next).curve),
                minus = half_trace(backward(before).curve);
    const double half_sine = std::sinh(length / 2);
    const double sine = static_cast<double>(plus - minus) / (2 * std::sinh(length)),
                 cosine = static_cast<double>((plus - zero) + (minus - zero)) / (4 * half_sine * half_sine);
    DualCurves d;
    d.twist = std::atanh(sine / cosine);
    for (; d.twist < -length / 8; d.twist += length / 2) {
        here = next;
        next = forward(here);
    }
    for (; d.twist >= 3 * length / 8; d.twist -= length / 2) {
        next = here;
        here = backward(here);
    }
    d.y = here.curve;
    d.z = next.curve;
    d.gap = std::min(d.twist / length + 0.125, 0.375 - d.twist / length);
    return d;
}

double torus_twist(const Isometry<Exact>& a, const Isometry<Exact>& b) {
    const double length = translation_length(a);
    const double ratio = static_cast<double>(half_trace(product(a, b)) / half_trace(b));
    return 2 * std::atanh((ratio - std::cosh(length / 2)) / std::sinh(length / 2));
}

}  // namespace ricci
