#include "engine/shape_space/exact_surface.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <stdexcept>

#include "engine/layout/final_metric.inl"
#include "kernels/triangle.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

class Polisher {
  public:
    explicit Polisher(const CoarseSurface& s) : s_(s), boundary_(boundary_vertices(s.connectivity)) {
        half_chord_.assign(s.half_chord.begin(), s.half_chord.end());
        for (Index h = 0; h < s.connectivity.halfedge_count(); ++h) {
            const Index t = s.connectivity.twin[at(h)];
            if (t != kNoTwin && t < h) half_chord_[at(h)] = half_chord_[at(t)];
        }
        angle_.resize(half_chord_.size());
        factorise();
    }

    std::vector<Isometry<Exact>> steps() {
        for (int round = 0;; ++round) {
            Exact largest(0);
            const Eigen::VectorXd excess = angle_excess(largest);
            if (largest < Exact(1e-45)) break;
            if (round == 40) throw std::runtime_error("the angle sums of the coarse surface do not converge");
            scale(hessian_.solve(excess));
        }
        return make_steps();
    }

  private:
    /// Of minus the derivatives of the angle sums by u, in double.
    void factorise() {
        std::vector<Eigen::Triplet<double>> entries;
        const Connectivity& c = s_.connectivity;
        for (std::size_t h = 0; h < c.tail.size(); h += 3) {
            const double l0 = 2 * s_.half_chord[h], l1 = 2 * s_.half_chord[h + 1],
                         l2 = 2 * s_.half_chord[h + 2];
            const auto d = scaling_derivatives<-1>(triangle_terms<-1>(l0, l1, l2), l0, l1, l2);
            for (std::size_t k = 0; k < 3; ++k) {
                const Index i = c.tail[h + k], j = c.tail[h + (k + 1) % 3];
                entries.emplace_back(i, j, -d.off[k]);
                entries.emplace_back(j, i, -d.off[k]);
                entries.emplace_back(i, i, -d.diagonal[k]);
            }
        }
        Eigen::SparseMatrix<double> matrix(c.vertex_count, c.vertex_count);
        matrix.setFromTriplets(entries.begin(), entries.end());
        hessian_.compute(matrix);
        if (hessian_.info() != Eigen::Success)
            throw std::runtime_error("the coarse surface has no regular Hessian");
    }

    /// Angle sums less 2 pi or pi, as the argument of the product of all e^(i theta). // V
    Eigen::VectorXd angle_excess(Exact& largest) {
        const Connectivity& c = s_.connectivity;
        std::vector<Complex<Exact>> turn(at(c.vertex_count), {Exact(1), Exact(0)});
        for (std::size_t h = 0; h < c.tail.size(); h += 3) {
            const auto raw = final_metric::angle_vectors<Exact>(
                -1, Exact(2) * half_chord_[h], Exact(2) * half_chord_[h + 1], Exact(2) * half_chord_[h + 2]);
            for (std::size_t k = 0; k < 3; ++k) {
                const Exact norm = sqrt(squared(raw[k]));
                angle_[h + k] = {raw[k].re / norm, raw[k].im / norm};
                Complex<Exact>& product = turn[at(c.tail[h + k])];
                product = product * angle_[h + k];
            }
        }
        Eigen::VectorXd excess(c.vertex_count);
        for (Index v = 0; v < c.vertex_count; ++v) {
            Exact e = turn[at(v)].im / turn[at(v)].re;
            if ((turn[at(v)].re < Exact(0)) != (boundary_[at(v)] != 0))
                throw std::runtime_error("an angle sum of the coarse surface is not near its target");
            excess[v] = static_cast<double>(e);
            if (e < Exact(0)) e = -e;
            if (e > largest) largest = e;
        }
        return excess;
    }

    void scale(const Eigen::VectorXd& u) {
        const Connectivity& c = s_.connectivity;
        std::vector<Exact> factor;
        for (Index v = 0; v < c.vertex_count; ++v) factor.push_back(exp(Exact(u[v]) / Exact(2)));
        for (Index h = 0; h < c.halfedge_count(); ++h) {
            half_chord_[at(h)] *= factor[at(c.tail[at(h)])] * factor[at(c.head(h))];
            const Index t = c.twin[at(h)];
            if (t != kNoTwin && t < h) half_chord_[at(h)] = half_chord_[at(t)];
        }
    }

    /// As CoarseSurface::step is made; half the direction as a complex number.
    std::vector<Isometry<Exact>> make_steps() const {
        const Connectivity& c = s_.connectivity;
        std::vector<Complex<Exact>> half(c.tail.size()), last(at(c.vertex_count));
        for (Index v = 0; v < c.vertex_count; ++v) {
            const Index first = s_.outgoing[at(v)];
            const double start = s_.direction[at(first)] / 2;
            Complex<Exact> turn{Exact(std::cos(start)), Exact(std::sin(start))};
            const Exact norm = sqrt(squared(turn));
            turn = {turn.re / norm, turn.im / norm};
            for (Index h = first; h != kNoTwin;) {
                half[at(h)] = turn;
                turn = turn * half_angle(angle_[at(h)]);
                h = s_.turned(h);
                if (h == first) break;
            }
            last[at(v)] = turn;
        }
        std::vector<Isometry<Exact>> steps;
        for (Index h = 0; h < c.halfedge_count(); ++h) {
            const Index t = c.twin[at(h)];
            const Complex<Exact>& back = t != kNoTwin ? half[at(t)] : last[at(c.head(h))];
            const Exact& s = half_chord_[at(h)];
            const Isometry<Exact> move = translation_and_turn<Exact>(s, sqrt(Exact(1) + s * s));
            steps.push_back(compose(-1, compose(-1, Isometry<Exact>{half[at(h)], {}}, move),
                                    Isometry<Exact>{conjugate(back), {}}));
        }
        return steps;
    }

    const CoarseSurface& s_;
    std::vector<std::uint8_t> boundary_;
    std::vector<Exact> half_chord_;
    std::vector<Complex<Exact>> angle_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> hessian_;
};

}  // namespace

ExactSurface::ExactSurface(const CoarseSurface& surface)
    : surface_(&surface), step_(Polisher(surface).steps()) {}

Isometry<Exact> ExactSurface::along(const CoarsePath& path) const {
    Isometry<Exact> product;
    for (const CoarseStep step : path) product = compose(-1, product, along(step));
    return product;
}

Isometry<Exact> ExactSurface::exact(Index from, const Isometry<double>& target) const {
    return along(path_towards(*surface_, from, target));
}

CoarsePath path_towards(const CoarseSurface& s, Index from, const Isometry<double>& target) {
    CoarsePath path;
    Isometry<double> rest = target;
    Index here = from;
    for (;;) {
        const std::array<double, 3> goal = image_of_origin(-1, rest);
        double nearest = goal[2];
        if (nearest < 1 + 1e-7) return path;
        Index best = 0, to = here;
        bool found = false;
        Isometry<double> taken;
        for_neighbours(s, here, [&](CoarseStep step, Index w) {
            const Isometry<double> move = s.along(step);
            const std::array<double, 3> p = image_of_origin(-1, move);
            const double distance = p[2] * goal[2] - p[0] * goal[0] - p[1] * goal[1];
            if (distance >= nearest) return;
            nearest = distance;
            found = true;
            best = step;
            to = w;
            taken = move;
        });
        if (!found) throw std::runtime_error("no edge leads on towards a lift");
        path.push_back(best);
        rest = compose(-1, inverse(taken), rest);
        here = to;
    }
}

}  // namespace ricci
