// Curvature and its Jacobian the slow and plain way, to compare the engine with.
#pragma once

#include <Eigen/Dense>
#include <numbers>
#include <vector>

#include "engine/flow/metric.h"
#include "engine/linear/symmetric_solver.h"
#include "tests/support/small_surfaces.h"

namespace ricci::testing {

/// K(u) of a metric at u; asserts nothing, returns an empty vector where the metric is broken there.
inline std::vector<double> curvature_at(Metric& metric, const std::vector<double>& u) {
    if (!metric.move_to(u) || !metric.evaluate(false)) return {};
    return {metric.curvature().begin(), metric.curvature().end()};
}

/// dK/du by central differences. // V x V, a column per u
inline Eigen::MatrixXd difference_jacobian(Metric& metric, std::vector<double> u, double step) {
    const auto n = static_cast<Eigen::Index>(metric.curvature().size());
    Eigen::MatrixXd jacobian(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        double& value = u[static_cast<std::size_t>(j)];
        const double middle = value;
        value = middle + step;
        const std::vector<double> up = curvature_at(metric, u);
        value = middle - step;
        const std::vector<double> down = curvature_at(metric, u);
        value = middle;
        for (Eigen::Index i = 0; i < n; ++i)
            jacobian(i, j) =
                (up[static_cast<std::size_t>(i)] - down[static_cast<std::size_t>(i)]) / (2 * step);
    }
    return jacobian;
}

/// Full symmetric matrix from the lower triangle by columns.
inline Eigen::MatrixXd dense_of(const SymmetricPattern& pattern, const std::vector<double>& values) {
    const auto n = static_cast<Eigen::Index>(pattern.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index j = 0; j < n; ++j)
        for (Index p = pattern.column_begin[static_cast<std::size_t>(j)];
             p < pattern.column_begin[static_cast<std::size_t>(j) + 1]; ++p) {
            const auto i = static_cast<Eigen::Index>(pattern.row[at(p)]);
            matrix(i, j) += values[at(p)];
            if (i != j) matrix(j, i) += values[at(p)];
        }
    return matrix;
}

}  // namespace ricci::testing
