#include "io/picture/svg_text.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <string_view>

#include "io/store/stored_text.h"

namespace ricci {
namespace {

void append_decimal(std::string& text, std::int64_t hundredths) {
    const std::int64_t size = std::abs(hundredths);
    const std::int64_t whole = size / 100, rest = size % 100;
    if (hundredths < 0) text += '-';
    if (whole > 0 || rest == 0) fmt::format_to(std::back_inserter(text), "{}", whole);
    if (rest == 0) return;
    text += '.';
    text += static_cast<char>('0' + rest / 10);
    if (rest % 10 != 0) text += static_cast<char>('0' + rest % 10);
}

}  // namespace

std::string svg_decimal(std::int64_t hundredths) {
    std::string text;
    append_decimal(text, hundredths);
    return text;
}

std::string svg_number(double number) {
    if (!(std::abs(number) < 1e15)) throw std::invalid_argument("a number of a picture is out of range");
    return svg_decimal(std::llround(kSvgUnits * number));
}

void append_svg_numbers(std::string& data, char command, std::initializer_list<std::int64_t> hundredths) {
    bool first = true;
    if (command != '\0') data += command;
    for (const std::int64_t number : hundredths) {
        if (!first && number >= 0) data += ' ';  // a sign separates as well
        append_decimal(data, number);
        first = false;
    }
}

std::string xml_text(const std::string& text) {
    std::string escaped;
    for (const char c : hdf5::stored_text(text)) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '&')
            escaped += "&amp;";
        else if (c == '<')
            escaped += "&lt;";
        else if (c == '>')
            escaped += "&gt;";
        else if (c == '"')
            escaped += "&quot;";
        else if (byte < 0x20 && c != '\n' && c != '\t')
            escaped += "\xEF\xBF\xBD";
        else
            escaped += c;
    }
    return escaped;
}

}  // namespace ricci
