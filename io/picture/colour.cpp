#include "io/picture/colour.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace ricci {
namespace {

using Triple = std::array<double, 3>;

// sRGB (IEC 61966-2-1): the curve between a stored channel and light, both in [0, 1].
double light_of(std::uint8_t channel) {
    const double c = channel / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
std::uint8_t channel_of(double light) {
    const double c = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(c, 0.0, 1.0)));
}

// XYZ relative to the white point D65, so that white is (1, 1, 1).
Triple xyz_of(const Triple& light) {
    return {(0.4124564 * light[0] + 0.3575761 * light[1] + 0.1804375 * light[2]) / 0.95047,
            0.2126729 * light[0] + 0.7151522 * light[1] + 0.0721750 * light[2],
            (0.0193339 * light[0] + 0.1191920 * light[1] + 0.9503041 * light[2]) / 1.08883};
}
Triple light_of_xyz(const Triple& relative) {
    const double x = 0.95047 * relative[0], y = relative[1], z = 1.08883 * relative[2];
    return {3.2404542 * x - 1.5371385 * y - 0.4985314 * z, -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
            0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
}

// CIE 15: the cube root with a straight piece near zero.
double compressed(double t) {
    return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0;
}
double expanded(double f) {
    const double cube = f * f * f;
    return cube > 216.0 / 24389.0 ? cube : (116.0 * f - 16.0) * 27.0 / 24389.0;
}

}  // namespace

std::string hexadecimal(const Colour& colour) {
    const auto doubled = [](std::uint8_t channel) { return channel % 17 == 0; };  // two equal digits
    if (doubled(colour.red) && doubled(colour.green) && doubled(colour.blue))
        return fmt::format("#{:x}{:x}{:x}", colour.red / 17, colour.green / 17, colour.blue / 17);
    return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

LabColour lab_of(const Colour& colour) {
    const Triple xyz = xyz_of({light_of(colour.red), light_of(colour.green), light_of(colour.blue)});
    const double x = compressed(xyz[0]), y = compressed(xyz[1]), z = compressed(xyz[2]);
    return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

Colour colour_of(const LabColour& lab) {
    const double y = (lab.lightness + 16.0) / 116.0;
    const Triple light =
        light_of_xyz({expanded(y + lab.a / 500.0), expanded(y), expanded(y - lab.b / 200.0)});
    return {channel_of(light[0]), channel_of(light[1]), channel_of(light[2])};
}

}  // namespace ricci
