// The curves that cross a separating curve twice, and the twist along it.
#pragma once

#include "engine/shape_space/based_curve.h"

namespace ricci {

/// Two pairs of pants side by side, in one frame: p1 p2 = s on its right, q1 q2 = s^-1 on its left.
struct FourHoledSphere {
    Isometry<Exact> p1, p2, q1, q2;
};

/// The simple closed curves that meet s twice are D(m) = h^m(p2) q1, m an integer, h: (p1, p2) -> (p2, p2^-1
/// p1 p2) the half twist; neighbours cross twice. 2 cosh of half their lengths is A + B cosh(t + m l/2), l
/// the length of s, A alike for m of one parity.
struct DualCurves {
    Isometry<Exact> y,
        z;  // the D(m) whose twist t + m l/2 lies in [-l/8, 3l/8), and D(m+1). Shapes with a mirror
            // symmetry, whose twists are 0 or l/4, lie well inside; z grows strictly with the twist
    double twist = 0.0;  // of y: distance along s by which it is turned from where it would be shortest
    double gap = 0.0;    // how far inside the range, in units of l
};
DualCurves dual_curves(const FourHoledSphere& sphere);

/// The twist along a of a one-holed torus, from b: cosh(l_b(k)/2) = K cosh((t + k l_a)/2) for b(k) = a^k b.
double torus_twist(const Isometry<Exact>& a, const Isometry<Exact>& b);

}  // namespace ricci
