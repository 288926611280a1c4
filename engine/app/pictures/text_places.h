// Places for short texts beside points, clear of one another.
#pragma once

#include <string>
#include <vector>

#include "io/picture/svg.h"

namespace ricci::app {

/// User units are pixels. Looks for places one by one, in the order asked; the same calls find the same
/// places.
class TextPlaces {
  public:
    explicit TextPlaces(const ViewBox& bounds) : bounds_(bounds) {}

    /// What texts should not cover.
    void avoid(const ViewBox& box) { taken_.push_back(box); }
    void avoid(const PlanePoint& from, const PlanePoint& to);
    /// Writes a text beside a point: in the first of eight directions, near or a little farther, where it
    /// covers and leaves the bounds the least. One that is not bold is left out where no near place is free.
    void write(SvgPicture& picture, const PlanePoint& point, const std::string& text, const Colour& colour,
               double size, bool bold);

  private:
    [[nodiscard]] double covered(const ViewBox& box) const;
    ViewBox bounds_;
    std::vector<ViewBox> taken_;
};

/// Heights (ascending) moved as little as needs be so that neighbours are at least `distance` apart: each
/// cluster stays centred on the mean of its own.
std::vector<double> spread_out(const std::vector<double>& heights, double distance);

}  // namespace ricci::app
