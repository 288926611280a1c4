#include "engine/shape_space/principal_components.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace ricci {

std::vector<double> PrincipalComponents::project(std::span<const double> point, std::size_t count) const {
    if (point.size() != mean.size()) throw std::invalid_argument("a point of another dimension");
    std::vector<double> result;
    for (std::size_t k = 0; k < std::min(count, axes.size()); ++k) {
        double sum = 0.0;
        for (std::size_t i = 0; i < point.size(); ++i) sum += axes[k][i] * (point[i] - mean[i]);
        result.push_back(sum);
    }
    return result;
}

double PrincipalComponents::share(std::size_t axis) const {
    const double whole = std::accumulate(variance.begin(), variance.end(), 0.0);
    return axis < variance.size() && whole > 0.0 ? variance[axis] / whole : 0.0;
}

PrincipalComponents principal_components(std::span<const std::vector<double>> points) {
    if (points.empty() || points.front().empty()) throw std::invalid_argument("no points to analyse");
    const auto rows = static_cast<Eigen::Index>(points.size()),
               columns = static_cast<Eigen::Index>(points.front().size());
    Eigen::MatrixXd x(rows, columns);
    for (Eigen::Index i = 0; i < rows; ++i) {
        const std::vector<double>& p = points[static_cast<std::size_t>(i)];
        if (static_cast<Eigen::Index>(p.size()) != columns)
            throw std::invalid_argument("points of different dimensions");
        x.row(i) = Eigen::Map<const Eigen::RowVectorXd>(p.data(), columns);
    }
    const Eigen::RowVectorXd mean = x.colwise().mean();
    x.rowwise() -= mean;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver((x.transpose() * x) /
                                                                static_cast<double>(rows));
    PrincipalComponents result;
    result.mean.assign(mean.data(), mean.data() + columns);
    for (Eigen::Index k = columns - 1; k >= 0; --k) {
        Eigen::VectorXd axis = solver.eigenvectors().col(k);
        Eigen::Index largest = 0;
        for (Eigen::Index i = 1; i < columns; ++i)
            if (std::abs(axis(i)) > std::abs(axis(largest)) * (1 + 1e-9)) largest = i;
        if (axis(largest) < 0) axis = -axis;
        result.variance.push_back(std::max(0.0, solver.eigenvalues()(k)));
        result.axes.emplace_back(axis.data(), axis.data() + columns);
    }
    return result;
}

}  // namespace ricci
