#include "kernels/geometry.h"

namespace ricci {

std::string_view name_of(Geometry geometry) {
    switch (geometry) {
        case Geometry::hyperbolic:
            return "hyperbolic";
        case Geometry::spherical:
            return "spherical";
        case Geometry::euclidean:
            break;
    }
    return "euclidean";
}

}  // namespace ricci
