// Many polygons in few elements.
#pragma once

#include <map>
#include <span>
#include <string>

#include "io/picture/svg.h"

namespace ricci {

/// Polygons gathered by colour: a picture gets one <path> per colour, ascending by colour, so those of
/// different colours should not overlap. Corners may run either way round; overlapping ones of a colour add
/// up.
class PolygonBatch {
  public:
    void add(const Colour& colour, std::span<const PlanePoint> corners);

    /// Draws all of them with an outline of their own colour of `seam` pixels, which hides the background
    /// that shines through between neighbours where edges are smoothed; 0: none.
    void draw(SvgPicture& picture, double seam = 0.4) const;

    [[nodiscard]] bool empty() const { return paths_.empty(); }

  private:
    std::map<Colour, SvgPath> paths_;
};

}  // namespace ricci
