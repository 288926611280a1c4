// Numbers and text of SVG files.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>

namespace ricci {

inline constexpr double kSvgUnits = 100.0;  // coordinates are whole multiples of 1/100 pixel

/// A number of hundredths as the shortest decimal: 1250 is "12.5", -5 is "-.05".
std::string svg_decimal(std::int64_t hundredths);

/// A number rounded to hundredths, the same way. Throws std::invalid_argument when it is not finite.
std::string svg_number(double number);

/// Appends a path command ('\0': only its numbers) with numbers in hundredths, separated where SVG needs it.
void append_svg_numbers(std::string& data, char command, std::initializer_list<std::int64_t> hundredths);

/// Text for XML content and attribute values: & < > " escaped, control characters as U+FFFD (XML 1.0 has no
/// way to hold them), bytes that are not UTF-8 as \xNN.
std::string xml_text(const std::string& text);

}  // namespace ricci
