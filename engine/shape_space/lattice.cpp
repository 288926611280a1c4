#include "engine/shape_space/lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace ricci {
namespace {

using Vector = std::complex<long double>;

constexpr double kMostClasses = 2e7;

Vector combination(const LatticeCoefficients& c, const Vector& a, const Vector& b) {
    return static_cast<long double>(c[0]) * a + static_cast<long double>(c[1]) * b;
}

LatticeCoefficients sum(const LatticeCoefficients& x, std::int64_t k, const LatticeCoefficients& y) {
    return {x[0] + k * y[0], x[1] + k * y[1]};
}

LatticeCoefficients negative(const LatticeCoefficients& x) {
    return {-x[0], -x[1]};
}

bool leads_with_minus(const LatticeCoefficients& x) {
    return x[0] < 0 || (x[0] == 0 && x[1] < 0);
}

/// A basis by its coefficients; vectors are always summed anew, so that nothing accumulates.
struct Basis {
    Vector a, b;  // the generators
    LatticeCoefficients first{1, 0}, second{0, 1};

    [[nodiscard]] Vector first_vector() const { return combination(first, a, b); }
    [[nodiscard]] Vector second_vector() const { return combination(second, a, b); }
    [[nodiscard]] Vector modulus() const { return second_vector() / first_vector(); }

    /// Lagrange's algorithm: Euclid's on the plane. Each round but the last shortens a vector.
    void shorten() {
        for (;;) {
            if (std::norm(second_vector()) < std::norm(first_vector())) std::swap(first, second);
            const long double k = std::round(modulus().real());
            const LatticeCoefficients candidate = sum(second, -static_cast<std::int64_t>(k), first);
            if (!(std::norm(combination(candidate, a, b)) < std::norm(second_vector()))) return;
            second = candidate;
        }
    }

    /// Orientation, and the rule for ties (Lattice::modulus).
    void settle() {
        if (modulus().imag() < 0.0L) second = negative(second);
        if (modulus().real() < -0.5L + kLatticeTie) second = sum(second, 1, first);
        if (std::abs(modulus()) <= 1.0L + kLatticeTie && modulus().real() < 0.0L) {
            std::swap(first, second);
            second = negative(second);
        }
        if (leads_with_minus(first)) {
            first = negative(first);
            second = negative(second);
        }
    }
};

/// Puts a modulus that lies within kLatticeTie of the domain's boundary on it.
std::complex<double> on_boundary(const Vector& tau) {
    long double re = tau.real(), im = tau.imag();
    if (re >= 0.5L - kLatticeTie) re = 0.5L;
    if (std::abs(tau) <= 1.0L + kLatticeTie) im = std::sqrt((1.0L - re) * (1.0L + re));
    return {static_cast<double>(re), static_cast<double>(im)};
}

/// Exponent sums of a word in two letters.
LatticeCoefficients exponents(std::span<const Index> word) {
    LatticeCoefficients result{0, 0};
    for (const Index letter : word)
        result[static_cast<std::size_t>(generator_of(letter))] += letter > 0 ? 1 : -1;
    return result;
}

/// All classes of length at most `bound`, in no order.
std::vector<LatticeLength> classes_up_to(const Lattice& lattice, double bound) {
    const double x = lattice.modulus.real(), y = lattice.modulus.imag();
    std::vector<LatticeLength> result;
    const auto rows = static_cast<std::int64_t>(bound / y);
    for (std::int64_t n = 0; n <= rows; ++n) {
        const double shift = static_cast<double>(n) * x, height = static_cast<double>(n) * y;
        const double half = std::sqrt(std::max(0.0, (bound - height) * (bound + height)));
        // One more on either side than rounding allows; each is measured.
        const auto begin = n == 0 ? 1 : static_cast<std::int64_t>(std::floor(-shift - half));
        const auto end = static_cast<std::int64_t>(std::ceil(-shift + half));
        for (std::int64_t m = begin; m <= end; ++m) {
            const double length = std::hypot(static_cast<double>(m) + shift, height);
            if (length > bound) continue;
            LatticeLength entry;
            entry.length = length;
            entry.power = std::gcd(m, n);
            entry.coefficients = sum({m * lattice.first_coefficients[0], m * lattice.first_coefficients[1]},
                                     n, lattice.second_coefficients);
            if (leads_with_minus(entry.coefficients)) entry.coefficients = negative(entry.coefficients);
            result.push_back(entry);
        }
    }
    return result;
}

/// Gauss's estimate with its boundary term: what is above the true number.
double most_classes(const Lattice& lattice, double bound) {
    const double y = lattice.modulus.imag();
    return (bound / y + 1.0) * (2.0 * bound + 3.0);
}

std::vector<LatticeLength> sorted_classes(const Lattice& lattice, double bound) {
    if (!(most_classes(lattice, bound) <= 4.0 * kMostClasses))
        throw std::invalid_argument("lattice_spectrum: more than 20 million lengths are asked for");
    std::vector<LatticeLength> result = classes_up_to(lattice, bound);
    std::sort(result.begin(), result.end(), [](const LatticeLength& p, const LatticeLength& q) {
        return std::pair(p.length, p.coefficients) < std::pair(q.length, q.coefficients);
    });
    return result;
}

/// Where the multiplet that holds entry `begin` ends.
std::size_t multiplet_end(const std::vector<LatticeLength>& lengths, std::size_t begin) {
    std::size_t end = begin + 1;
    while (end < lengths.size() && lengths[end].length <= lengths[end - 1].length * (1.0 + kLatticeTie))
        ++end;
    return end;
}

void count_multiplets(std::vector<LatticeLength>& lengths) {
    for (std::size_t begin = 0; begin < lengths.size();) {
        const std::size_t end = multiplet_end(lengths, begin);
        for (std::size_t k = begin; k < end; ++k)
            lengths[k].multiplicity = static_cast<std::int64_t>(end - begin);
        begin = end;
    }
}

}  // namespace

Lattice reduce_lattice(std::complex<double> a, std::complex<double> b) {
    Basis basis{Vector(a), Vector(b)};
    const long double area = std::abs((std::conj(basis.a) * basis.b).imag()),
                      size = std::abs(basis.a) * std::abs(basis.b);
    constexpr long double kRounding = 4.0L * std::numeric_limits<double>::epsilon();
    if (!std::isfinite(size) || !(area > kRounding * size))
        throw std::invalid_argument("reduce_lattice: the translations are parallel or not finite");
    basis.shorten();
    basis.settle();
    Lattice lattice;
    lattice.first = std::complex<double>(basis.first_vector());
    lattice.second = std::complex<double>(basis.second_vector());
    lattice.first_coefficients = basis.first;
    lattice.second_coefficients = basis.second;
    lattice.modulus = on_boundary(basis.modulus());
    lattice.length_ratio = std::abs(lattice.modulus);
    lattice.angle = std::arg(lattice.modulus);
    return lattice;
}

std::complex<double> translation_of(const Isometry<double>& element) {
    const std::array<double, 3> image = image_of_origin(0, element);
    return {image[0], image[1]};
}

Lattice torus_lattice(const SurfaceGroup& group) {
    if (group.kappa != 0 || group.letters.size() != 2 || group.generators.size() != 2)
        throw std::invalid_argument("torus_lattice: not the group of a flat torus without cones");
    Lattice lattice = reduce_lattice(translation_of(group.letters[0]), translation_of(group.letters[1]));
    // x = A p + B q in letters p, q; a1 = m00 p + m01 q, b1 = m10 p + m11 q, determinant +-1.
    const LatticeCoefficients a = exponents(group.generators[0].word),
                              b = exponents(group.generators[1].word);
    const std::int64_t determinant = a[0] * b[1] - a[1] * b[0];
    if (determinant != 1 && determinant != -1)
        throw std::invalid_argument("torus_lattice: a1 and b1 do not generate the group");
    const auto in_generators = [&](const LatticeCoefficients& x) -> LatticeCoefficients {
        return {determinant * (x[0] * b[1] - x[1] * b[0]), determinant * (x[1] * a[0] - x[0] * a[1])};
    };
    lattice.first_coefficients = in_generators(lattice.first_coefficients);
    lattice.second_coefficients = in_generators(lattice.second_coefficients);
    if (leads_with_minus(lattice.first_coefficients)) {
        lattice.first = -lattice.first;
        lattice.second = -lattice.second;
        lattice.first_coefficients = negative(lattice.first_coefficients);
        lattice.second_coefficients = negative(lattice.second_coefficients);
    }
    return lattice;
}

LatticeSpectrum lattice_spectrum(const Lattice& lattice, double max_length, std::int64_t count) {
    if (count < 0 || (count == 0 && !(max_length > 0.0 && std::isfinite(max_length))))
        throw std::invalid_argument("lattice_spectrum: needs a positive length or a positive count");
    LatticeSpectrum spectrum;
    if (count == 0) {
        spectrum.lengths = sorted_classes(lattice, max_length * (1.0 + kLatticeTie));
        spectrum.complete_up_to = max_length;
    } else {
        // The multiples of the shortest alone are `count` lengths up to `count`.
        const auto wanted = static_cast<double>(count);
        double bound =
            std::min(wanted, 1.0 + std::sqrt(2.0 * wanted * lattice.modulus.imag() / std::numbers::pi));
        spectrum.lengths = sorted_classes(lattice, bound * (1.0 + kLatticeTie));
        while (spectrum.lengths.size() < static_cast<std::size_t>(count)) {
            bound = std::min(wanted, 1.5 * bound);
            spectrum.lengths = sorted_classes(lattice, bound * (1.0 + kLatticeTie));
        }
        // A multiplet that the bound cuts is completed from a little further out.
        const double last = spectrum.lengths[static_cast<std::size_t>(count) - 1].length;
        spectrum.lengths = sorted_classes(lattice, last * (1.0 + 1e3 * kLatticeTie));
        spectrum.lengths.resize(multiplet_end(spectrum.lengths, static_cast<std::size_t>(count) - 1));
        spectrum.complete_up_to = spectrum.lengths.back().length;
    }
    count_multiplets(spectrum.lengths);
    return spectrum;
}

Word lattice_word(const LatticeCoefficients& coefficients) {
    Word word;
    for (std::size_t k = 0; k < 2; ++k) {
        const Index letter = static_cast<Index>(coefficients[k] > 0 ? k + 1 : 0) -
                             static_cast<Index>(coefficients[k] < 0 ? k + 1 : 0);
        word.insert(word.end(), static_cast<std::size_t>(std::abs(coefficients[k])), letter);
    }
    return word;
}

}  // namespace ricci
