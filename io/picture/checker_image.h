// The checkerboard as an image, for programs that draw textures.
#pragma once

#include <string>

namespace ricci {

/// The bytes of a PNG image of squares x squares black and white squares of 16 pixels each. Its first row is
/// the top; counted from the lower left corner, square (i, j) is black where i + j is even.
std::string checker_png(int squares);

}  // namespace ricci
