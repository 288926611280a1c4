#include "io/exchange/gltf_buffer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string_view>
#include <vector>

namespace ricci {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

constexpr std::array<std::string_view, 5> kTypes = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;

}  // namespace

std::size_t GltfBuffer::add_view(const void* data, std::size_t size, Target target) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0');
    nlohmann::json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", size}};
    if (target != Target::none) view["target"] = static_cast<int>(target);
    bytes_.append(static_cast<const char*>(data), size);
    views_.push_back(std::move(view));
    return views_.size() - 1;
}

std::size_t GltfBuffer::add_accessor(std::size_t view, int component_type, std::size_t count,
                                     std::size_t components) {
    accessors_.push_back({{"bufferView", view},
                          {"componentType", component_type},
                          {"count", count},
                          {"type", kTypes.at(components)}});
    return accessors_.size() - 1;
}

std::size_t GltfBuffer::add_floats(std::span<const float> values, std::size_t components, bool bounds) {
    const std::size_t view = add_view(values.data(), values.size_bytes(), Target::vertices);
    const std::size_t accessor = add_accessor(view, kFloat, values.size() / components, components);
    if (!bounds || values.empty()) return accessor;
    std::vector<float> low(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(components));
    std::vector<float> high = low;
    for (std::size_t i = 0; i < values.size(); ++i) {
        low[i % components] = std::min(low[i % components], values[i]);
        high[i % components] = std::max(high[i % components], values[i]);
    }
    accessors_[accessor]["min"] = low;  // as doubles: exactly these numbers
    accessors_[accessor]["max"] = high;
    return accessor;
}

std::size_t GltfBuffer::add_fractions(std::span<const std::uint16_t> values, std::size_t components) {
    const std::size_t view = add_view(values.data(), values.size_bytes(), Target::vertices);
    const std::size_t accessor = add_accessor(view, kUnsignedShort, values.size() / components, components);
    accessors_[accessor]["normalized"] = true;
    return accessor;
}

std::size_t GltfBuffer::add_indices(std::span<const std::uint32_t> values, std::size_t points) {
    constexpr std::size_t kRestart = 65535;  // not a point's number
    if (points > kRestart) {
        const std::size_t view = add_view(values.data(), values.size_bytes(), Target::indices);
        return add_accessor(view, kUnsignedInt, values.size(), 1);
    }
    std::vector<std::uint16_t> narrow;
    narrow.reserve(values.size());
    for (const std::uint32_t v : values) narrow.push_back(static_cast<std::uint16_t>(v));
    const std::size_t view = add_view(narrow.data(), narrow.size() * sizeof(std::uint16_t), Target::indices);
    return add_accessor(view, kUnsignedShort, narrow.size(), 1);
}

std::size_t GltfBuffer::add_bytes(const std::string& bytes) {
    return add_view(bytes.data(), bytes.size(), Target::none);
}

}  // namespace ricci
