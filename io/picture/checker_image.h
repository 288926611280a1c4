// The checkerboard as an image, for programs that draw textures.
#pragma once

#include <cstdint>
#include <string>

namespace ricci {

/// The bytes of a PNG image of squares x squares dark and white squares of 16 pixels each. Its first row is
/// the top; counted from the lower left corner, square (i, j) is dark where i + j is even. Dark is black, or
/// the grey given.
std::string checker_png(int squares, std::uint8_t dark = 0);

}  // namespace ricci
