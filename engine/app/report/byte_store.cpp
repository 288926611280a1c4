#include "engine/app/report/byte_store.h"

#include <zlib.h>

#include <bit>
#include <stdexcept>
#include <vector>

namespace ricci::app {

static_assert(std::endian::native == std::endian::little, "arrays in a page are little endian");

template <class T>
nlohmann::json ByteStore::append(const char* type, std::span<const T> values) {
    bytes_.resize((bytes_.size() + 7) / 8 * 8, '\0');
    const std::size_t first = bytes_.size();
    const std::span<const std::byte> raw = std::as_bytes(values);
    bytes_.append(reinterpret_cast<const char*>(raw.data()), raw.size());
    return {{"t", type}, {"o", first}, {"n", values.size()}};
}

nlohmann::json ByteStore::add(std::span<const double> values) {
    return append("f8", values);
}
nlohmann::json ByteStore::add(std::span<const float> values) {
    return append("f4", values);
}
nlohmann::json ByteStore::add(std::span<const std::int32_t> values) {
    return append("i4", values);
}
nlohmann::json ByteStore::add(std::span<const std::uint32_t> values) {
    return append("u4", values);
}
nlohmann::json ByteStore::add(std::span<const std::uint16_t> values) {
    return append("u2", values);
}

std::string ByteStore::packed() const {
    uLongf size = compressBound(static_cast<uLong>(bytes_.size()));
    std::string packed(size, '\0');
    const int result =
        compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                  reinterpret_cast<const Bytef*>(bytes_.data()), static_cast<uLong>(bytes_.size()), 9);
    if (result != Z_OK) throw std::bad_alloc();
    packed.resize(size);
    return base64_text(packed);
}

std::string base64_text(std::string_view bytes) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
    }
    return text;
}

}  // namespace ricci::app
