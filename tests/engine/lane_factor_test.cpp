// The shared single-precision factor against the double solver and dense arithmetic.
#include "engine/linear/lane_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/flow/hessian.h"
#include "engine/flow/metric.h"
#include "engine/surfaces/generate.h"
#include "tests/support/dense_metric.h"
#include "tests/support/random.h"
#include "tests/support/small_surfaces.h"

namespace ricci {
namespace {

using testing::at;
using testing::Random;

std::vector<InstructionSet> sets() {
    std::vector<InstructionSet> all;
    for (const InstructionSet set : {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512})
        if (set <= best_instruction_set()) all.push_back(set);
    return all;
}

/// The supernodes of a dense L: columns [first[s], first[s+1]), with all rows below them.
SupernodalFactor dense_factor(const Eigen::MatrixXd& l, const std::vector<Index>& first) {
    SupernodalFactor f;
    const auto n = static_cast<Index>(l.rows());
    f.first_column = first;
    for (std::size_t s = 0; s + 1 < first.size(); ++s) {
        f.row_begin.push_back(static_cast<std::int64_t>(f.row.size()));
        f.value_begin.push_back(static_cast<std::int64_t>(f.value.size()));
        for (Index i = first[s]; i < n; ++i) f.row.push_back(i);
        // What lies above the diagonal is not to be read.
        for (Index j = first[s]; j < first[s + 1]; ++j)
            for (Index i = first[s]; i < n; ++i) f.value.push_back(i < j ? std::nan("") : l(i, j));
    }
    f.row_begin.push_back(static_cast<std::int64_t>(f.row.size()));
    f.value_begin.push_back(static_cast<std::int64_t>(f.value.size()));
    f.permutation.resize(at(n));
    std::iota(f.permutation.begin(), f.permutation.end(), Index{0});
    return f;
}

LaneArray<float> random_block(Index rows, Random& random) {
    LaneArray<float> block(at(rows));
    for (auto& row : block)
        for (float& x : row.lane) x = static_cast<float>(random.uniform(-1, 1));
    return block;
}

Eigen::VectorXd lane_of(const LaneArray<float>& block, int lane) {
    Eigen::VectorXd x(static_cast<Eigen::Index>(block.size()));
    for (std::size_t i = 0; i < block.size(); ++i) x[static_cast<Eigen::Index>(i)] = block[i].lane[lane];
    return x;
}

/// A grounded Laplacian (one vertex pinned) of a generated surface.
struct Laplacian {
    SymmetricPattern pattern;
    std::vector<double> values;
    std::unique_ptr<SymmetricSolver> solver = make_symmetric_solver(Definiteness::positive);

    Laplacian(const std::string& name, Index faces, Ordering ordering) {
        GenerateOptions options;
        options.faces = faces;
        options.jitter = 0.3;
        const FlowSurface surface = make_flow_surface(generate(name, options), false, true);
        ScaledMetric<double> metric(surface, Geometry::euclidean, false);
        const std::vector<double> u(at(surface.vertex_count()), 0.0);
        EXPECT_TRUE(metric.move_to(u) && metric.evaluate(true));
        std::vector<Index> unknown(u.size());
        std::iota(unknown.begin(), unknown.end(), Index{0});
        HessianAssembler assembler;
        assembler.build(metric.connectivity(), unknown, surface.vertex_count());
        assembler.assemble(metric.connectivity(), metric.off(), metric.diagonal(), 0, values);
        pattern = assembler.pattern();
        solver->choose_ordering(pattern, ordering);
        EXPECT_TRUE(solver->factorize(values));
    }

    /// b - A x
    [[nodiscard]] std::vector<double> residual(std::vector<double> b, const std::vector<double>& x) const {
        for (Index j = 0; j < pattern.size(); ++j)
            for (Index p = pattern.column_begin[at(j)]; p < pattern.column_begin[at(j) + 1]; ++p) {
                const Index i = pattern.row[at(p)];
                b[at(i)] -= values[at(p)] * x[at(j)];
                if (i != j) b[at(j)] -= values[at(p)] * x[at(i)];
            }
        return b;
    }
};

double norm(const std::vector<double>& x) {
    return std::sqrt(std::inner_product(x.begin(), x.end(), x.begin(), 0.0));
}

/// A source at one unknown, a sink of the same strength spread over all.
std::vector<double> source(Index n, int lane) {
    std::vector<double> b(at(n), -1.0 / n);
    b[at(n * (lane + 1) / (kLanes + 2))] += 1.0;
    return b;
}

TEST(LaneFactor, SmallPowersOfTwoAreExact) {
    for (const InstructionSet set : sets()) {
        LaneArray<float> one(1);
        for (int l = 0; l < kLanes; ++l) one[0].lane[l] = static_cast<float>(8 * l);
        LaneFactor(dense_factor(Eigen::MatrixXd::Constant(1, 1, 2.0), {0, 1}), set).solve(one);
        for (int l = 0; l < kLanes; ++l) EXPECT_EQ(one[0].lane[l], 2 * l);

        // A = (4 2; 2 2), A (l, 1) = (4 l + 2, 2 l + 2): as one supernode and as two.
        const Eigen::MatrixXd root{{2.0, 0.0}, {1.0, 1.0}};
        for (const std::vector<Index>& first : {std::vector<Index>{0, 2}, std::vector<Index>{0, 1, 2}}) {
            LaneArray<float> two(2);
            for (int l = 0; l < kLanes; ++l) {
                two[0].lane[l] = static_cast<float>(4 * l + 2);
                two[1].lane[l] = static_cast<float>(2 * l + 2);
            }
            const LaneFactor factor(dense_factor(root, first), set);
            EXPECT_EQ(factor.entries(), 3);
            EXPECT_GT(factor.bytes(), 0);
            factor.solve(two);
            for (int l = 0; l < kLanes; ++l) {
                EXPECT_EQ(two[0].lane[l], l);
                EXPECT_EQ(two[1].lane[l], 1);
            }
        }
    }
}

TEST(LaneFactor, EveryWidthAndHeightAgreesWithDenseArithmetic) {
    Random random(1);
    for (const InstructionSet set : sets())
        for (Index width = 1; width <= 35; ++width)
            for (Index height = 0; height <= 6; ++height) {
                const Index n = width + height;
                Eigen::MatrixXd l = Eigen::MatrixXd::Zero(n, n);
                for (Index j = 0; j < n; ++j) {
                    l(j, j) = random.uniform(1, 2);
                    // A quarter are zeros that supernodes store.
                    for (Index i = j + 1; i < n; ++i)
                        l(i, j) = random.uniform(0, 1) < 0.25 ? 0.0 : random.uniform(-1, 1) / n;
                }
                std::vector<Index> first = {0, width};
                for (Index j = width + 1; j <= n; ++j) first.push_back(j);  // one column each
                const LaneFactor factor(dense_factor(l, first), set);
                EXPECT_EQ(factor.entries(), n * (n + 1) / 2);
                const LaneArray<float> b = random_block(n + 2, random);
                LaneArray<float> x = b;
                factor.solve(x);
                for (int lane = 0; lane < kLanes; ++lane) {
                    const Eigen::VectorXd expected =
                        (l * l.transpose()).fullPivLu().solve(lane_of(b, lane).head(n));
                    // Condition below 100: that times n roundings of 2^-24, at their random walk.
                    EXPECT_LT((lane_of(x, lane).head(n) - expected).norm(), 1e-5 * expected.norm())
                        << name_of(set) << " " << width << " " << height;
                }
                EXPECT_EQ(lane_of(x, 7).tail(2), lane_of(b, 7).tail(2)) << "rows beyond n";
            }
}

TEST(LaneFactor, AgreesWithTheDoubleSolver) {
    for (const Ordering ordering : {Ordering::minimum_degree, Ordering::nested_dissection})
        for (const std::string name : {"torus", "eight", "sphere"}) {
            const Laplacian a(name, 3000, ordering);
            const Index n = a.pattern.size();
            for (const InstructionSet set : sets()) {
                const LaneFactor factor(a.solver->supernodal_factor(), set);
                ASSERT_EQ(factor.size(), n);
                const auto order = factor.elimination_order();
                LaneArray<float> block(at(n));
                for (int l = 0; l < kLanes; ++l) {
                    const auto b = source(n, l);
                    for (std::size_t i = 0; i < order.size(); ++i)
                        block[i].lane[l] = static_cast<float>(b[at(order[i])]);
                }
                factor.solve(block);
                std::vector<double> expected(at(n)), error(at(n));
                for (int l = 0; l < kLanes; ++l) {
                    a.solver->solve(source(n, l), expected);
                    for (std::size_t i = 0; i < order.size(); ++i)
                        error[i] = block[i].lane[l] - expected[at(order[i])];
                    EXPECT_LT(norm(error), 1e-5 * norm(expected)) << name << " " << name_of(set);
                }
            }
        }
}

TEST(LaneFactor, RefinementGainsThreeDigitsPerStep) {
    const Laplacian a("eight", 6000, Ordering::nested_dissection);
    const Index n = a.pattern.size();
    for (const InstructionSet set : sets()) {
        const LaneFactor factor(a.solver->supernodal_factor(), set);
        const auto order = factor.elimination_order();
        std::vector<double> exact(at(n)), x(at(n), 0.0);
        const auto b = source(n, 5);
        a.solver->solve(b, exact);
        const auto error = [&] {
            std::vector<double> difference(at(n));
            for (std::size_t i = 0; i < at(n); ++i) difference[i] = x[i] - exact[i];
            return norm(difference) / norm(exact);
        };
        double before = 1.0;
        for (int step = 1; step <= 4; ++step) {
            const auto r = a.residual(b, x);
            // Scaled to the range of float, as the residuals themselves leave its precision untouched.
            const double scale = norm(r);
            LaneArray<float> block(at(n));
            for (std::size_t i = 0; i < order.size(); ++i)
                block[i].lane[9] = static_cast<float>(r[at(order[i])] / scale);
            factor.solve(block);
            for (std::size_t i = 0; i < order.size(); ++i) x[at(order[i])] += scale * block[i].lane[9];
            const double now = error();
            // The double solution is itself exact to about 1e-13 only.
            EXPECT_LT(now, std::max(1e-3 * before, 1e-12)) << name_of(set) << ", step " << step;
            before = now;
        }
        EXPECT_LT(before, 1e-12);
    }
}

TEST(LaneFactor, LanesDependNeitherOnNeighboursNorOnPosition) {
    const Laplacian a("eight", 2500, Ordering::nested_dissection);
    const SupernodalFactor shared = a.solver->supernodal_factor();
    for (const InstructionSet set : sets()) {
        Random random(2);
        const LaneFactor factor(shared, set);
        const LaneArray<float> b = random_block(factor.size(), random);
        LaneArray<float> alone = b;
        factor.solve(alone);
        for (int shift = 0; shift < kLanes; ++shift) {
            // Lane 4 moves along among neighbours that are not finite, or tiny.
            LaneArray<float> moved(b.size());
            for (std::size_t i = 0; i < b.size(); ++i)
                for (int l = 0; l < kLanes; ++l)
                    moved[i].lane[l] = l == shift             ? b[i].lane[4]
                                       : (l + shift) % 3 == 0 ? std::numeric_limits<float>::quiet_NaN()
                                       : (l + shift) % 3 == 1 ? std::numeric_limits<float>::infinity()
                                                              : 1e-40F;
            factor.solve(moved);
            for (std::size_t i = 0; i < b.size(); ++i)
                ASSERT_EQ(std::bit_cast<std::uint32_t>(moved[i].lane[shift]),
                          std::bit_cast<std::uint32_t>(alone[i].lane[4]))
                    << name_of(set) << " " << shift;
        }
    }
}

TEST(LaneFactor, LeavesTheArithmeticOfTheThreadAlone) {
    const LaneFactor factor(dense_factor(Eigen::MatrixXd::Constant(1, 1, 2.0), {0, 1}));
    LaneArray<float> block(1);
    factor.solve(block);
    volatile float tiny = 1e-38F;
    EXPECT_GT(tiny / 16.0F, 0.0F);
}

TEST(LaneFactor, RefusesWhatIsNoFactor) {
    const SupernodalFactor good = dense_factor(Eigen::MatrixXd::Identity(3, 3), {0, 1, 3});
    const auto refuses = [&](auto&& spoil) {
        SupernodalFactor bad = good;
        spoil(bad);
        EXPECT_THROW(LaneFactor{bad}, std::invalid_argument);
    };
    EXPECT_NO_THROW(LaneFactor{good});
    EXPECT_EQ(LaneFactor{dense_factor(Eigen::MatrixXd(0, 0), {0})}.size(), 0);
    refuses([](SupernodalFactor& f) { f.row[1] = 7; });
    refuses([](SupernodalFactor& f) { f.row[2] = f.row[1]; });
    refuses([](SupernodalFactor& f) { f.permutation.pop_back(); });
    refuses([](SupernodalFactor& f) { f.value.pop_back(); });
    refuses([](SupernodalFactor& f) { f.value_begin.pop_back(); });
    refuses([](SupernodalFactor& f) { f.value.front() = 0.0; });
    refuses([](SupernodalFactor& f) { f.value.front() = std::nan(""); });
}

TEST(SymmetricSolver, SharesItsFactor) {
    const Laplacian a("torus", 300, Ordering::minimum_degree);
    const Index n = a.pattern.size();
    const Eigen::MatrixXd dense = testing::dense_of(a.pattern, a.values);
    for (const Definiteness kind : {Definiteness::positive, Definiteness::indefinite})
        for (const Ordering ordering : {Ordering::minimum_degree, Ordering::nested_dissection}) {
            const auto solver = make_symmetric_solver(kind);
            EXPECT_THROW(static_cast<void>(solver->supernodal_factor()), std::logic_error);
            solver->choose_ordering(a.pattern, ordering);
            EXPECT_THROW(static_cast<void>(solver->supernodal_factor()), std::logic_error);
            ASSERT_TRUE(solver->factorize(a.values));
            const SupernodalFactor f = solver->supernodal_factor();
            Eigen::MatrixXd l = Eigen::MatrixXd::Zero(n, n), permuted(n, n);
            for (std::size_t s = 0; s + 1 < f.first_column.size(); ++s) {
                const auto rows = f.row_begin[s + 1] - f.row_begin[s];
                for (Index c = 0; c < f.first_column[s + 1] - f.first_column[s]; ++c)
                    for (std::int64_t r = c; r < rows; ++r)
                        l(f.row[static_cast<std::size_t>(f.row_begin[s] + r)], f.first_column[s] + c) =
                            f.value[static_cast<std::size_t>(f.value_begin[s] + c * rows + r)];
            }
            for (Index i = 0; i < n; ++i)
                for (Index j = 0; j < n; ++j)
                    permuted(i, j) = dense(f.permutation[at(i)], f.permutation[at(j)]);
            // Entries of order 10, some dozens of roundings each.
            EXPECT_LT((l * l.transpose() - permuted).cwiseAbs().maxCoeff(), 1e-12);

            std::vector<double> indefinite = a.values;
            for (double& value : indefinite) value = -value;
            EXPECT_EQ(solver->factorize(indefinite), kind == Definiteness::indefinite);
            EXPECT_THROW(static_cast<void>(solver->supernodal_factor()), std::logic_error);
        }
}

}  // namespace
}  // namespace ricci
