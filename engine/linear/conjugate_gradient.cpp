#include "engine/linear/conjugate_gradient.h"

#include <algorithm>
#include <cmath>

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

double dot(std::span<const double> a, std::span<const double> b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

/// A solution this accurate is still worth a step when the iterations run out.
constexpr double kGoodEnough = 1e-2;

/// y = A x from the lower triangle.
void multiply(const SymmetricPattern& a, std::span<const double> values, std::span<const double> x,
              std::span<double> y) {
    std::fill(y.begin(), y.end(), 0.0);
    for (Index j = 0; j < a.size(); ++j) {
        const double xj = x[at(j)];
        double sum = 0.0;
        for (Index p = a.column_begin[at(j)]; p < a.column_begin[at(j) + 1]; ++p) {
            const auto i = at(a.row[at(p)]);
            if (i == at(j)) {
                sum += values[at(p)] * xj;
            } else {
                y[i] += values[at(p)] * xj;
                sum += values[at(p)] * x[i];
            }
        }
        y[at(j)] += sum;
    }
}

}  // namespace

bool ConjugateGradient::solve(const SymmetricPattern& pattern, std::span<const double> values,
                              SymmetricSolver& nearby, std::span<const double> rhs, double relative_tolerance,
                              int max_iterations, std::span<double> solution) {
    iterations_ = 0;
    const std::size_t n = rhs.size();
    residual_.assign(rhs.begin(), rhs.end());
    preconditioned_.resize(n);
    image_.resize(n);
    std::fill(solution.begin(), solution.end(), 0.0);
    const double goal = relative_tolerance * std::sqrt(dot(rhs, rhs));
    if (goal == 0.0) return true;
    double product = 0.0;
    for (;;) {
        nearby.solve(residual_, preconditioned_);
        ++iterations_;
        const double next = dot(residual_, preconditioned_);
        if (!(next > 0.0)) return false;
        if (iterations_ == 1) {
            direction_.assign(preconditioned_.begin(), preconditioned_.end());
        } else {
            const double beta = next / product;
            for (std::size_t i = 0; i < n; ++i) direction_[i] = preconditioned_[i] + beta * direction_[i];
        }
        product = next;
        multiply(pattern, values, direction_, image_);
        const double curvature = dot(direction_, image_);
        if (!(curvature > 0.0)) return false;
        const double alpha = product / curvature;
        for (std::size_t i = 0; i < n; ++i) solution[i] += alpha * direction_[i];
        for (std::size_t i = 0; i < n; ++i) residual_[i] -= alpha * image_[i];
        const double norm = std::sqrt(dot(residual_, residual_));
        if (norm <= goal) return true;
        if (!std::isfinite(norm)) return false;
        if (iterations_ >= max_iterations) return norm <= kGoodEnough * goal / relative_tolerance;
        // Give up early where the pace so far will not do: log(norm/|b|) is about proportional to the
        // iterations.
        const double start = goal / relative_tolerance;
        if (iterations_ >= 3 &&
            std::log(norm / start) * max_iterations > std::log(relative_tolerance) * iterations_)
            return false;
    }
}

}  // namespace ricci
