// Places for names beside lines, clear of one another and of what is drawn.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/app/pictures/picture_frame.h"

namespace ricci::app {

/// Looks for places one by one, in the order asked; the same calls find the same places.
class LabelPlaces {
  public:
    explicit LabelPlaces(const PictureFrame& frame) : frame_(frame) {}

    /// What names should not cover: a line through points, in user units.
    void avoid(std::span<const PlanePoint> line);
    /// Centre of a box of so many pixels on the right-hand side of the line, near its middle; none for a line
    /// of less than six pixels.
    std::optional<PlanePoint> place(std::span<const PlanePoint> line, double width, double height);

  private:
    struct Box {
        PlanePoint low, high;  // pixels
    };
    [[nodiscard]] double cost(const Box& box) const;
    [[nodiscard]] std::vector<PlanePoint> pixels(std::span<const PlanePoint> line) const;

    PictureFrame frame_;
    std::vector<PlanePoint> obstacles_;  // pixels
    std::vector<Box> taken_;
};

/// Writes a name, in the colour of the paint, beside a line.
void write_name(SvgPicture& picture, LabelPlaces& places, std::span<const PlanePoint> line,
                const std::string& name, const Paint& paint);

}  // namespace ricci::app
