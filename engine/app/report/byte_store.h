// Arrays of numbers as they travel inside a page: one run of bytes, packed, in base64.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

namespace ricci::app {

/// Collects arrays; each is named by what add() returns: {"t": type, "o": first byte, "n": numbers}.
/// Types: f8, f4, i4, u4, u2 (little endian, each at a multiple of eight bytes).
class ByteStore {
  public:
    nlohmann::json add(std::span<const double> values);
    nlohmann::json add(std::span<const float> values);
    nlohmann::json add(std::span<const std::int32_t> values);
    nlohmann::json add(std::span<const std::uint32_t> values);
    nlohmann::json add(std::span<const std::uint16_t> values);

    /// Bytes so far, before packing.
    [[nodiscard]] std::size_t size() const { return bytes_.size(); }
    /// All bytes as a zlib stream in base64.
    [[nodiscard]] std::string packed() const;

  private:
    template <class T>
    nlohmann::json append(const char* type, std::span<const T> values);
    std::string bytes_;
};

/// RFC 4648, with padding.
std::string base64_text(std::string_view bytes);

}  // namespace ricci::app
