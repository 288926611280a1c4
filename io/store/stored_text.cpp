#include "io/store/stored_text.h"

#include <fmt/format.h>

#include <string_view>

namespace ricci::hdf5 {
namespace {

// Length of the valid UTF-8 sequence at the start of `text`, 0 when there is none (RFC 3629).
std::size_t sequence_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned first = byte(0);
    if (first < 0x80) return 1;
    const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
    if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xC0U) != 0x80U) return 0;
    const unsigned second = byte(1);
    const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
    const bool outside = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);
    return overlong || outside ? 0 : length;
}

}  // namespace

std::string stored_text(const std::string& text) {
    std::string stored;
    for (std::string_view rest = text; !rest.empty();) {
        const std::size_t length = rest.front() == '\0' ? 0 : sequence_length(rest);
        if (length == 0) stored += fmt::format("\\x{:02x}", static_cast<unsigned char>(rest.front()));
        stored += rest.substr(0, length);
        rest.remove_prefix(length == 0 ? 1 : length);
    }
    return stored;
}

}  // namespace ricci::hdf5
