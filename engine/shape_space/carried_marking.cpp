#include "engine/shape_space/carried_marking.h"

#include <algorithm>
#include <stdexcept>

#include "engine/shape_space/drawn_geodesic.h"

namespace ricci {

DrawnMarking draw_marking(const SurfaceStructure& structure, const Connectivity& input,
                          const ExactSurface& surface, const TeichmullerCoordinates& coordinates) {
    DrawnMarking marking;
    for (const LengthCoordinate& c : coordinates.lengths) {
        marking.names.push_back(c.name);
        const ClosedGeodesic geodesic = follow_curve(surface, moved_to_axis(surface, c.curve)).geodesic;
        marking.curves.push_back(draw_geodesic(structure, input, surface.coarse(), geodesic).path);
    }
    return marking;
}

std::vector<double> carried_lengths(const DrawnMarking& marking, const SurfaceStructure& structure,
                                    const Connectivity& input, double& spread) {
    const PathHolonomy holonomy(structure, input);
    std::vector<double> lengths;
    spread = 0.0;
    for (std::size_t k = 0; k < marking.curves.size(); ++k) {
        const PathLength l = holonomy.length_of(marking.curves[k]);
        if (!(l.length > 0)) throw std::runtime_error("the curve " + marking.names[k] + " has no geodesic");
        lengths.push_back(l.length);
        spread = std::max(spread, l.spread);
    }
    return lengths;
}

}  // namespace ricci
