// The sparse solver against Eigen's dense one.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstring>
#include <vector>

#include "engine/linear/symmetric_solver.h"
#include "tests/support/dense_metric.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::Random;

/// Graph Laplacian pattern of a mesh with random values; `shift` on the diagonal decides the definiteness.
struct SparseMatrix {
    SymmetricPattern pattern;
    std::vector<double> values;
};
SparseMatrix laplacian(const SurfaceMesh& mesh, double shift, Random& random) {
    const Connectivity& c = mesh.connectivity;
    const auto n = at(c.vertex_count);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(c.vertex_count, c.vertex_count);
    for (Index h = 0; h < c.halfedge_count(); ++h) {
        const Index i = c.tail[at(h)], j = c.head(h);
        if (i > j) continue;
        const double weight = random.uniform(0.1, 2.0);
        dense(j, i) -= weight;
        dense(i, i) += weight;
        dense(j, j) += weight;
    }
    SparseMatrix m;
    m.pattern.column_begin.push_back(0);
    for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t i = j; i < n; ++i) {
            const double value = dense(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
            if (i != j && value == 0.0) continue;
            m.pattern.row.push_back(static_cast<Index>(i));
            m.values.push_back(i == j ? value + shift : value);
        }
        m.pattern.column_begin.push_back(static_cast<Index>(m.pattern.row.size()));
    }
    return m;
}

double relative_error(const SparseMatrix& m, const std::vector<double>& rhs,
                      const std::vector<double>& solution) {
    const Eigen::MatrixXd dense = testing::dense_of(m.pattern, m.values);
    const Eigen::Map<const Eigen::VectorXd> b(rhs.data(), dense.rows()), x(solution.data(), dense.rows());
    const Eigen::VectorXd expected = dense.fullPivLu().solve(b);
    return (x - expected).norm() / expected.norm();
}

TEST(SymmetricSolver, SolvesPositiveDefiniteSystems) {
    Random random(1);
    for (const Ordering ordering : {Ordering::minimum_degree, Ordering::nested_dissection}) {
        const SparseMatrix m = laplacian(testing::bumpy_torus(9, 8), 0.5, random);
        const auto solver = make_symmetric_solver(Definiteness::positive);
        solver->choose_ordering(m.pattern, ordering);
        EXPECT_GT(solver->factor_bytes(), static_cast<std::int64_t>(8 * m.pattern.row.size()));
        ASSERT_TRUE(solver->factorize(m.values));
        std::vector<double> rhs = random.uniforms(72, -1, 1), solution(72);
        solver->solve(rhs, solution);
        // Condition below 30/0.5 = 60; eps times that times a small growth.
        EXPECT_LT(relative_error(m, rhs, solution), 1e-13);
        const std::vector<double> copy = rhs;
        solver->solve(rhs, rhs);  // the same span
        EXPECT_EQ(rhs, solution);
        EXPECT_LT(relative_error(m, copy, rhs), 1e-13);
    }
}

TEST(SymmetricSolver, RefusesWhatIsNotPositiveDefinite) {
    Random random(2);
    const SparseMatrix m = laplacian(testing::bumpy_torus(6, 5), -1.0, random);
    const auto positive = make_symmetric_solver(Definiteness::positive);
    positive->choose_ordering(m.pattern, Ordering::minimum_degree);
    EXPECT_FALSE(positive->factorize(m.values));
    // The same solver recovers with another matrix of the pattern.
    SparseMatrix good = m;
    for (Index j = 0; j < m.pattern.size(); ++j) good.values[at(m.pattern.column_begin[at(j)])] += 2.0;
    EXPECT_TRUE(positive->factorize(good.values));
    std::vector<double> rhs = random.uniforms(30, -1, 1), solution(30);
    positive->solve(rhs, solution);
    EXPECT_LT(relative_error(good, rhs, solution), 1e-13);
}

TEST(SymmetricSolver, SolvesIndefiniteSystems) {
    Random random(3);
    const SparseMatrix m = laplacian(testing::bumpy_torus(6, 5), -1.0, random);
    const auto solver = make_symmetric_solver(Definiteness::indefinite);
    solver->choose_ordering(m.pattern, Ordering::minimum_degree);
    ASSERT_TRUE(solver->factorize(m.values));
    std::vector<double> rhs = random.uniforms(30, -1, 1), solution(30);
    solver->solve(rhs, solution);
    // No pivoting: growth is possible; this matrix shows none beyond 1e4.
    EXPECT_LT(relative_error(m, rhs, solution), 1e-11);
    const Eigen::VectorXd eigenvalues =
        testing::dense_of(m.pattern, m.values).selfadjointView<Eigen::Lower>().eigenvalues();
    ASSERT_LT(eigenvalues.minCoeff(), -0.1);
    ASSERT_GT(eigenvalues.maxCoeff(), 0.1);
}

TEST(SymmetricSolver, RepeatedAnalysisReproducesEveryBit) {
    Random random(4);
    const SparseMatrix m = laplacian(testing::bumpy_torus(12, 11), 0.01, random);
    // Another pattern of the same size: one more edge.
    SparseMatrix other = m;
    const auto last = static_cast<Index>(m.pattern.size() - 1);
    auto& begin = other.pattern.column_begin;
    const auto end_of_first = begin[1];
    const auto inserted = std::find(other.pattern.row.begin(), other.pattern.row.begin() + end_of_first,
                                    last) == other.pattern.row.begin() + end_of_first;
    const Index row = inserted ? last : last / 2;
    auto position =
        std::lower_bound(other.pattern.row.begin(), other.pattern.row.begin() + end_of_first, row);
    ASSERT_NE(*position, row);
    other.values.insert(other.values.begin() + (position - other.pattern.row.begin()), -0.001);
    other.pattern.row.insert(position, row);
    for (std::size_t j = 1; j < begin.size(); ++j) ++begin[j];

    for (const Definiteness kind : {Definiteness::positive, Definiteness::indefinite})
        for (const Ordering ordering : {Ordering::minimum_degree, Ordering::nested_dissection}) {
            const auto solver = make_symmetric_solver(kind);
            solver->choose_ordering(m.pattern, ordering);
            const std::vector<double> rhs = random.uniforms(132, -1, 1);
            std::vector<double> first(132), second(132), detour(132), fresh(132);
            ASSERT_TRUE(solver->factorize(m.values));
            solver->solve(rhs, first);
            solver->analyze(other.pattern);
            ASSERT_TRUE(solver->factorize(other.values));
            solver->solve(rhs, detour);
            EXPECT_LT(relative_error(other, rhs, detour), 1e-10);
            EXPECT_NE(detour, first);
            solver->analyze(m.pattern);
            ASSERT_TRUE(solver->factorize(m.values));
            solver->solve(rhs, second);
            EXPECT_EQ(first, second);
            const auto anew = make_symmetric_solver(kind);
            anew->choose_ordering(m.pattern, ordering);
            ASSERT_TRUE(anew->factorize(m.values));
            anew->solve(rhs, fresh);
            EXPECT_EQ(first, fresh);
        }
}

}  // namespace
}  // namespace ricci
