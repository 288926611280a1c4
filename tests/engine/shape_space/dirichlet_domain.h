// All closed geodesics of a closed hyperbolic surface by another way: Dirichlet domain and words in its
// sides.
#pragma once

#include <numeric>

#include "tests/engine/shape_space/spectrum_checks.h"

namespace ricci::testing {

/// The points that are no nearer to any other lift of the base p than to p itself (p: the origin). It is
/// found as an intersection of half planes; that of some elements of a group only is larger than that of all,
/// so it is the right one exactly where its area is that of the surface. Then its sides pair by generators,
/// and any element g is a word in them: the domains along a segment from p to gp, none of whose centres is
/// farther from p than d(p, gp) plus the domain's radius.
class DirichletDomain {
  public:
    /// `letters` generate the group of a surface of this genus. Throws std::runtime_error where the area is
    /// not met.
    DirichletDomain(const std::vector<Isometry<double>>& letters, Index genus) {
        const double area = 4 * std::numbers::pi * (genus - 1);
        std::vector<Isometry<double>> elements = with_products(letters);
        for (int round = 0; round < 8; ++round) {
            cut(elements);
            if (bounded_ && std::abs(area_ - area) < 1e-8) return;
            elements = with_products(sides_.size() > 2 ? sides_ : elements);
            for (const Isometry<double>& x : letters) elements.push_back(x);
        }
        throw std::runtime_error("no Dirichlet domain: area " + std::to_string(area_));
    }

    [[nodiscard]] const std::vector<Isometry<double>>& sides() const { return sides_; }
    /// Distance of the farthest corner.
    [[nodiscard]] double radius() const { return radius_; }

    /// Lengths of all conjugacy classes up to inversion, powers included, ascending. A class of length L has
    /// an element whose axis meets the domain, so that it moves p by at most 2 asinh(cosh(radius) sinh(L/2));
    /// from one such element to all others of its class conjugation by sides leads, along the axis.
    [[nodiscard]] std::vector<double> lengths(double max_length) const {
        const double farthest = 2 * std::asinh(std::cosh(radius_) * std::sinh(max_length / 2)) + 1e-6;
        IsometrySet walked, near;
        walked.insert({});
        for (std::size_t k = 0; k < walked.elements().size(); ++k) {
            const Isometry<double> x = walked.elements()[k];
            if (is_near(x, farthest, max_length)) near.insert(x);
            for (const Isometry<double>& s : sides_) {
                const Isometry<double> y = compose(-1, x, s);
                if (displacement_cosh(y) <= std::cosh(farthest + radius_)) walked.insert(y);
            }
        }
        return classes(near);
    }

  private:
    static double length_of(const Isometry<double>& x) {
        return 2 * std::acosh(std::max(1.0, std::abs(x.a.re)));
    }
    [[nodiscard]] bool is_near(const Isometry<double>& x, double farthest, double max_length) const {
        const double length = length_of(x);
        if (length < 1e-6 || length > max_length) return false;
        if (displacement_cosh(x) > std::cosh(farthest)) return false;
        // sinh(d/2) = cosh(distance of the axis) sinh(L/2), sinh^2(d/2) = |b|^2.
        return std::sqrt(squared(x.b)) <= std::cosh(radius_ + 1e-6) * std::sinh(length / 2);
    }
    [[nodiscard]] std::vector<double> classes(const IsometrySet& near) const {
        std::vector<Index> parent(near.elements().size());
        std::iota(parent.begin(), parent.end(), 0);
        const auto root = [&](Index k) {
            while (parent[at(k)] != k) k = parent[at(k)] = parent[at(parent[at(k)])];
            return k;
        };
        for (std::size_t k = 0; k < parent.size(); ++k) {
            const Isometry<double>& x = near.elements()[k];
            const auto join = [&](const Isometry<double>& y) {
                if (const Index m = near.find(y); m >= 0) parent[at(root(m))] = root(static_cast<Index>(k));
            };
            join(inverse(x));
            for (const Isometry<double>& s : sides_) join(compose(-1, compose(-1, inverse(s), x), s));
        }
        std::vector<double> found;
        for (std::size_t k = 0; k < parent.size(); ++k)
            if (parent[k] == static_cast<Index>(k)) found.push_back(length_of(near.elements()[k]));
        std::sort(found.begin(), found.end());
        return found;
    }

    static std::vector<Isometry<double>> with_products(const std::vector<Isometry<double>>& letters) {
        std::vector<Isometry<double>> both;
        for (const Isometry<double>& x : letters) {
            both.push_back(x);
            both.push_back(inverse(x));
        }
        IsometrySet all;
        all.insert({});
        for (const Isometry<double>& x : both) all.insert(x);
        for (const Isometry<double>& x : both)
            for (const Isometry<double>& y : both) all.insert(compose(-1, x, y));
        return {all.elements().begin() + 1, all.elements().end()};
    }

    /// Points of Klein's disk; `side`: the element whose bisector runs from here to the next corner.
    struct Corner {
        double x, y;
        Index side;
    };
    /// Points no nearer to q than to the origin: x q_x + y q_y <= q_t - 1 in Klein's disk.
    void cut(std::vector<Isometry<double>> elements) {
        std::sort(elements.begin(), elements.end(), [](const Isometry<double>& x, const Isometry<double>& y) {
            return displacement_cosh(x) < displacement_cosh(y);
        });
        std::vector<Corner> polygon{{-2, -2, -1}, {2, -2, -1}, {2, 2, -1}, {-2, 2, -1}};
        for (std::size_t k = 0; k < elements.size(); ++k) {
            const auto q = image_of_origin(-1, elements[k]);
            const auto beyond = [&](const Corner& p) { return p.x * q[0] + p.y * q[1] - (q[2] - 1); };
            std::vector<Corner> kept;
            for (std::size_t i = 0; i < polygon.size(); ++i) {
                const Corner &p = polygon[i], &r = polygon[(i + 1) % polygon.size()];
                const double here = beyond(p), there = beyond(r), f = here / (here - there);
                const Corner cross{p.x + f * (r.x - p.x), p.y + f * (r.y - p.y), p.side};
                if (here <= 0) kept.push_back(p);
                if (here <= 0 && there > 0) kept.push_back({cross.x, cross.y, static_cast<Index>(k)});
                if (here > 0 && there <= 0) kept.push_back(cross);
            }
            polygon = std::move(kept);
        }
        measure(polygon, elements);
    }
    void measure(const std::vector<Corner>& polygon, const std::vector<Isometry<double>>& elements) {
        sides_.clear();
        radius_ = 0;
        area_ = -2 * std::numbers::pi;
        bounded_ = true;
        const std::size_t n = polygon.size();
        for (std::size_t i = 0; i < n; ++i) {
            const Corner &p = polygon[i], &before = polygon[(i + n - 1) % n];
            const double r2 = p.x * p.x + p.y * p.y;
            if (p.side < 0 || before.side < 0 || r2 >= 1) {
                bounded_ = false;
                if (p.side >= 0) sides_.push_back(elements[at(p.side)]);
                continue;
            }
            sides_.push_back(elements[at(p.side)]);
            radius_ = std::max(radius_, std::atanh(std::sqrt(r2)));
            // The exterior angle is that of the normals q - p of both sides.
            const auto q = image_of_origin(-1, elements[at(p.side)]),
                       o = image_of_origin(-1, elements[at(before.side)]);
            const auto dot = [](const auto& u, const auto& v) {
                return u[0] * v[0] + u[1] * v[1] - (u[2] - 1) * (v[2] - 1);
            };
            area_ += std::acos(std::clamp(dot(q, o) / std::sqrt(dot(q, q) * dot(o, o)), -1.0, 1.0));
        }
    }

    std::vector<Isometry<double>> sides_;
    double radius_ = 0, area_ = 0;
    bool bounded_ = false;
};

}  // namespace ricci::testing
