// Pictures of deformation paths (thesis Figure 35).
#pragma once

#include <string>
#include <vector>

#include "io/picture/svg.h"

namespace ricci::app {

struct DrawnFrame {
    std::string name;
    std::vector<double> coordinates;  // empty: a failure, passed over
    bool anew = false;                // its coordinates are of another marking than those of the frame before
};
struct DrawnSequence {
    std::vector<DrawnFrame> frames;
};

/// Left the sequences as curves with equal scales along both axes: the first two principal components of all
/// coordinates, or the coordinates themselves where there are no more than two. Dots are coloured by time and
/// numbered by frame, the first and the last one named; what leads to a frame with another marking is dashed.
/// Right every coordinate over the frames, the twelve that vary most where there are more. Throws
/// std::invalid_argument for frames without one value per name, and where no frame has any.
SvgPicture draw_path(const std::vector<DrawnSequence>& sequences, const std::vector<std::string>& names,
                     const std::string& title);

}  // namespace ricci::app
