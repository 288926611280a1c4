// Colours of pictures.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <tuple>

namespace ricci {

/// An sRGB colour.
struct Colour {
    std::uint8_t red = 0, green = 0, blue = 0;
    bool operator==(const Colour&) const = default;
    bool operator<(const Colour& other) const {  // any order, for maps
        return std::tie(red, green, blue) < std::tie(other.red, other.green, other.blue);
    }
};

inline constexpr Colour kBlack{0, 0, 0}, kWhite{255, 255, 255}, kGrey{128, 128, 128};

/// "#rrggbb", or "#rgb" where that says the same.
std::string hexadecimal(const Colour& colour);

/// CIE L*a*b* under the white point D65, in which equal distances look about equally different. L is 0 to
/// 100.
struct LabColour {
    double lightness = 0.0, a = 0.0, b = 0.0;
};
LabColour lab_of(const Colour& colour);
/// The nearest sRGB colour, each channel cut to its range.
Colour colour_of(const LabColour& lab);

/// Colours for what has no order, which deficient eyes tell apart too (Okabe, Ito 2008), without the yellow,
/// which is faint on white.
inline constexpr std::array<Colour, 7> kCategoryColours = {{{0, 114, 178},
                                                            {213, 94, 0},
                                                            {0, 158, 115},
                                                            {204, 121, 167},
                                                            {86, 180, 233},
                                                            {230, 159, 0},
                                                            {110, 90, 70}}};

}  // namespace ricci
