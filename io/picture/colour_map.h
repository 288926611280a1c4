// Colours for values, and the bar that explains them.
#pragma once

#include <cstdint>
#include <string>

#include "io/picture/axis.h"
#include "io/picture/svg.h"

namespace ricci {

/// Maps made from few colours by interpolation in CIE L*a*b*, so that equal steps look equal. Both can be
/// read with any of the usual colour deficiencies: lightness alone orders the first, and the two sides of the
/// second are blue and orange.
enum class ColourMap : std::uint8_t {
    sequential,  // dark violet to yellow, lightness ascending (matplotlib's viridis, public domain, in 10
                 // colours)
    diverging    // blue over near white to orange-brown, lightness symmetric about the middle
};

/// The colour at t, cut to [0, 1], out of a table of 255; grey of NaN.
Colour colour_at(ColourMap map, double t);

/// Colours of the values of a range. Values beyond it have the colours of its ends, NaN is grey.
struct ColourScale {
    Axis axis;
    ColourMap map = ColourMap::sequential;

    [[nodiscard]] Colour colour_of(double value) const { return colour_at(map, axis.fraction_of(value)); }
};

/// Draws an upright bar of the scale's colours that fills `box` (user units), with ticks and numbers on its
/// right and a title above.
void draw_colour_bar(SvgPicture& picture, const ColourScale& scale, const ViewBox& box,
                     const std::string& title, double text_size = 12.0);

}  // namespace ricci
