#include "engine/layout/surface_group.h"

#include <cmath>

#include "engine/layout/polished_scales.h"
#include "engine/layout/transport.inl"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Fills in elements, relator error and reach.
template <class Real>
void evaluate(const Holonomy<Real>& holonomy, int kappa, const CanonicalBasis& canonical,
              SurfaceGroup& group) {
    using std::log10;
    Real reach(1);
    Isometry<Real> relator;
    const auto multiply = [&](const Isometry<Real>& x) {
        relator = compose(kappa, relator, x);
        const Real size = squared(relator.a) + squared(relator.b);
        if (size > reach) reach = size;
    };
    group.letters.clear();
    for (const Isometry<Real>& letter : holonomy.letters()) group.letters.push_back(rounded(letter));
    for (std::size_t i = 0; i < canonical.a.size(); ++i) {
        const Isometry<Real> a = holonomy.of(canonical.a[i], &reach), b = holonomy.of(canonical.b[i], &reach);
        group.generators[2 * i].element = rounded(a);
        group.generators[2 * i + 1].element = rounded(b);
        multiply(a);
        multiply(b);
        multiply(inverse(a));
        multiply(inverse(b));
    }
    for (std::size_t k = 0; k < canonical.punctures.size(); ++k) {
        const Isometry<Real> c = holonomy.of(canonical.punctures[k], &reach);
        group.generators[2 * canonical.a.size() + k].element = rounded(c);
        multiply(c);
    }
    group.relator_error = static_cast<double>(distance_to_identity(relator));
    group.reach = static_cast<double>(log10(reach));
}

}  // namespace

SurfaceGroup make_surface_group(int kappa, const CommonRefinement& refinement, const Connectivity& input,
                                const HomotopyBasis& basis, const CanonicalBasis& canonical,
                                const GroupOptions& options) {
    SurfaceGroup group;
    group.kappa = kappa;
    const std::vector<std::string> names = canonical.names(), letters = basis.letter_names();
    for (std::size_t i = 0; i < canonical.a.size(); ++i) {
        group.generators.push_back({names[2 * i], canonical.a[i], {}});
        group.generators.push_back({names[2 * i + 1], canonical.b[i], {}});
    }
    for (std::size_t k = 0; k < canonical.punctures.size(); ++k)
        group.generators.push_back(
            {letters[at(generator_of(canonical.puncture_letter(static_cast<Index>(k))))],
             canonical.punctures[k],
             {}});
    const FinalMetric<double> metric = make_final_metric(kappa, refinement);
    evaluate(Holonomy<double>(metric, refinement, input, basis), kappa, canonical, group);
    if (kappa >= 0 || group.relator_error <= options.goal) return group;
    PolishedScales own, &scales = options.scales ? *options.scales : own;
    climb_precision(options.max_digits, [&]<class Real>(int digits, Real) {
        const PolishedMetric<Real> polished = scales.solve<Real>(refinement);
        evaluate(Holonomy<Real>(polished.metric, refinement, input, basis), kappa, canonical, group);
        group.digits = digits;
        group.metric_residual = polished.residual;
        return !(group.relator_error <= options.goal);
    });
    return group;
}

std::array<double, 4> half_plane_matrix(const Isometry<double>& x) {
    return {x.a.re + x.b.re, x.a.im - x.b.im, -x.a.im - x.b.im, x.a.re - x.b.re};
}

std::array<double, 9> plane_matrix(const Isometry<double>& x) {
    const Complex<double> rotation = x.a * x.a, shift = x.a * x.b;
    return {rotation.re, -rotation.im, 2 * shift.re, rotation.im, rotation.re, 2 * shift.im, 0, 0, 1};
}

std::array<double, 9> projective_matrix(int kappa, const Isometry<double>& x) {
    std::array<double, 9> m{};
    for (std::size_t column = 0; column < 3; ++column) {
        std::array<double, 3> unit{};
        unit[column] = 1;
        const std::array<double, 3> image = apply(kappa, x, unit);
        for (std::size_t row = 0; row < 3; ++row) m[3 * row + column] = image[row];
    }
    return m;
}

}  // namespace ricci
