// The binary part of a glTF file: buffer views and accessors.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

namespace ricci {

/// Arrays one after another, each aligned to four bytes, with the JSON that describes them.
class GltfBuffer {
  public:
    enum class Target : int { none = 0, vertices = 34962, indices = 34963 };

    /// Rows of `components` numbers (1: SCALAR, 2 to 4: VEC2 to VEC4); the accessor's number. With `bounds`
    /// least and greatest are told, as positions need it.
    std::size_t add_floats(std::span<const float> values, std::size_t components, bool bounds);
    /// Fractions of 65535.
    std::size_t add_fractions(std::span<const std::uint16_t> values, std::size_t components);
    /// In the smallest type that holds all with room for the restart value.
    std::size_t add_indices(std::span<const std::uint32_t> values, std::size_t points);
    /// Bytes without an accessor; the view's number.
    std::size_t add_bytes(const std::string& bytes);

    [[nodiscard]] const std::string& bytes() const { return bytes_; }
    [[nodiscard]] const nlohmann::json& views() const { return views_; }
    [[nodiscard]] const nlohmann::json& accessors() const { return accessors_; }

  private:
    std::size_t add_view(const void* data, std::size_t size, Target target);
    std::size_t add_accessor(std::size_t view, int component_type, std::size_t count, std::size_t components);

    std::string bytes_;
    nlohmann::json views_ = nlohmann::json::array(), accessors_ = nlohmann::json::array();
};

}  // namespace ricci
