// The header of a PLY file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ricci {

enum class PlyType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
enum class PlyEncoding : std::uint8_t { kAscii, kLittleEndian, kBigEndian };

/// Bytes of a value in a binary file.
std::size_t ply_size(PlyType type);
inline bool ply_is_integer(PlyType type) {
    return type < PlyType::kFloat32;
}

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::kFloat32;
    std::optional<PlyType> count_type;  // set for a list
};

struct PlyElement {
    std::string name;
    std::int64_t count = 0;  // what the header says; not to be trusted
    std::int64_t line = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::kAscii;
    std::vector<PlyElement> elements;
    std::size_t body = 0;  // offset of the first byte behind the header
    std::int64_t header_lines = 0;
};

/// Reads the header. Throws ContentError (syntax, truncated) with the line.
PlyHeader parse_ply_header(std::string_view bytes);

}  // namespace ricci
