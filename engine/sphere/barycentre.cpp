#include "engine/sphere/barycentre.h"

#include <Eigen/Dense>
#include <cmath>
#include <vector>

namespace ricci {
namespace {

using Complex = std::complex<long double>;
using Vector = Eigen::Matrix<long double, 3, 1>;
using Matrix = Eigen::Matrix<long double, 3, 3>;

constexpr int kSteps = 500;
constexpr long double kResolved = 1e-15L;  // four digits above the rounding of positions

struct Mass {
    Vector point;
    long double mass;
};

std::vector<Mass> project(std::span<const Complex> z, std::span<const long double> mass,
                          long double mass_at_infinity, const PlaneSimilarity& map) {
    std::vector<Mass> result{{{0.0L, 0.0L, 1.0L}, mass_at_infinity}};
    for (std::size_t i = 0; i < z.size(); ++i) {
        if (mass[i] == 0.0L) continue;
        const Complex w = (z[i] - map.centre) / map.scale;
        const long double square = std::norm(w), unit = 1.0L / (1.0L + square);
        result.push_back({{2.0L * w.real() * unit, 2.0L * w.imag() * unit, (square - 1.0L) * unit}, mass[i]});
    }
    return result;
}

/// Change of the convex function from the origin of the ball to x.
long double rise(std::span<const Mass> masses, const Vector& x) {
    const long double square = x.squaredNorm();
    long double sum = 0.0L;
    for (const Mass& m : masses)
        sum += m.mass * (std::log1p(square - 2.0L * x.dot(m.point)) - std::log1p(-square));
    return sum;
}

/// The map that brings x of the ball to the origin, up to rotation: x goes to the upper half-space by the
/// inversion at the north pole that extends the stereographic projection.
PlaneSimilarity moved(const PlaneSimilarity& map, const Vector& x) {
    const Vector from_pole = x - Vector(0.0L, 0.0L, 1.0L);
    const long double ratio = 2.0L / from_pole.squaredNorm();
    const Complex shift(ratio * from_pole.x(), ratio * from_pole.y());
    const long double height = (1.0L - x.squaredNorm()) / from_pole.squaredNorm();
    return {map.centre + map.scale * shift, map.scale * height, map.imbalance};
}

}  // namespace

PlaneSimilarity balance(std::span<const Complex> z, std::span<const long double> mass,
                        long double mass_at_infinity, const PlaneSimilarity& start) {
    long double total = mass_at_infinity;
    for (const long double m : mass) total += m;
    PlaneSimilarity map = start, best = start;
    best.imbalance = 2.0L;
    constexpr long double kClose = 1e-6L;  // imbalance from where Newton's step is good as it is
    for (int iteration = 0, worse = 0; iteration < kSteps && worse < 3; ++iteration) {
        const std::vector<Mass> masses = project(z, mass, mass_at_infinity, map);
        Vector mean = Vector::Zero();
        Matrix spread = Matrix::Zero();
        for (const Mass& m : masses) {
            mean += m.mass / total * m.point;
            spread += m.mass / total * m.point * m.point.transpose();
        }
        map.imbalance = mean.norm();
        // On the way to a small cluster the imbalance stays the same for long; near the end it only falls.
        const bool better = map.imbalance < best.imbalance || map.imbalance > kClose;
        worse = better ? 0 : worse + 1;
        if (better) best = map;
        if (map.imbalance < 1e-18L || map.scale < kResolved * std::abs(map.centre)) break;
        Vector step = 0.5L * (Matrix::Identity() - spread).ldlt().solve(mean);
        constexpr long double kLongest = 0.9L;
        if (!step.allFinite()) step = 0.5L * mean;
        if (step.norm() > kLongest) step *= kLongest / step.norm();
        for (int halving = 0; halving < 40 && map.imbalance > kClose && rise(masses, step) > 0.0L; ++halving)
            step *= 0.5L;
        map = moved(map, step);
    }
    return best;
}

}  // namespace ricci
