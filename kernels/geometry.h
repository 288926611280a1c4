// Background geometries as policies. A geometry enters the kernels through one number only, its constant
// curvature kappa: Euclidean 0, hyperbolic -1, spherical +1 (mathematics of section 3 of the thesis, in
// chords).
//
// The chord of a length l is lambda = l, 2 sinh(l/2), 2 sin(l/2). With the chords a, b, c of a triangle, the
// angle opposite a is
//     theta_a = atan2( sqrt(16 A^2 - kappa (abc)^2),  b^2 + c^2 - a^2 - kappa b^2 c^2 / 2 ),
// where 16 A^2 = (a+b+c)(b+c-a)(c+a-b)(a+b-c) is Heron's product of the chords: expand the Gram determinant
// 1 + 2xyz - x^2 - y^2 - z^2 with x = 1 - kappa a^2/2 and so on. No transcendental function but one atan2.
#pragma once

#include <concepts>
#include <cstdint>
#include <string_view>

namespace ricci {

enum class Geometry : std::uint8_t { euclidean, hyperbolic, spherical };

struct EuclideanGeometry {
    static constexpr int kappa = 0;
};
struct HyperbolicGeometry {
    static constexpr int kappa = -1;
};
struct SphericalGeometry {
    static constexpr int kappa = 1;
};

template <class T>
concept GeometryPolicy = requires {
    { T::kappa } -> std::convertible_to<int>;
};

constexpr int curvature_sign(Geometry geometry) {
    return geometry == Geometry::euclidean ? 0 : (geometry == Geometry::hyperbolic ? -1 : 1);
}
std::string_view name_of(Geometry geometry);

/// Calls `f` with the policy of `geometry`: the only switch on geometry.
template <class F>
decltype(auto) with_geometry(Geometry geometry, F&& f) {
    switch (geometry) {
        case Geometry::hyperbolic:
            return f(HyperbolicGeometry{});
        case Geometry::spherical:
            return f(SphericalGeometry{});
        case Geometry::euclidean:
            break;
    }
    return f(EuclideanGeometry{});
}

}  // namespace ricci
