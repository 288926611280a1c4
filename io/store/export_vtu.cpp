#include <fmt/format.h>

#include <array>
#include <cstring>
#include <span>
#include <string_view>

#include "io/store/durable.h"
#include "io/store/export_fields.h"
#include "io/store/hdf5_file.h"
#include "io/store/run_store.h"

namespace ricci {
namespace {

constexpr std::uint8_t kVtkTriangle = 5;

// RFC 4648.
std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        unsigned group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8U | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[group >> (6 * (3 - k)) & 63U] : '=';
    }
    return text;
}

// An inline binary array: its length in bytes as UInt64, then the values.
template <class T>
std::string packed(std::span<const T> values) {
    const std::uint64_t length = values.size_bytes();
    std::string bytes(sizeof length + length, '\0');
    std::memcpy(bytes.data(), &length, sizeof length);
    if (length > 0) std::memcpy(bytes.data() + sizeof length, values.data(), length);
    return base64(bytes);
}

std::string escaped(const std::string& name) {
    std::string text;
    for (const char c : hdf5::stored_text(name)) {
        switch (c) {
            case '&':
                text += "&amp;";
                break;
            case '<':
                text += "&lt;";
                break;
            case '>':  // legal XML, but VTK takes it for the end of the tag
                text += "&gt;";
                break;
            case '"':
                text += "&quot;";
                break;
            default:
                text += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        }
    }
    return text;
}

template <class T>
std::string data_array(const char* type, const std::string& name, int components, std::span<const T> values) {
    return fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\">\n{}\n</DataArray>\n",
        type, escaped(name), components, packed(values));
}

std::string cells(const ItemRecord& item) {
    const std::size_t faces = item.triangles.size();
    std::vector<std::int64_t> offsets(faces);
    for (std::size_t f = 0; f < faces; ++f) offsets[f] = static_cast<std::int64_t>(3 * (f + 1));
    const std::vector<std::uint8_t> types(faces, kVtkTriangle);
    const std::span<const Index> corners(faces == 0 ? nullptr : item.triangles.front().data(), 3 * faces);
    return "<Cells>\n" + data_array<Index>("Int32", "connectivity", 1, corners) +
           data_array<std::int64_t>("Int64", "offsets", 1, offsets) +
           data_array<std::uint8_t>("UInt8", "types", 1, types) + "</Cells>\n";
}

}  // namespace

void export_vtu(const std::string& path, const ItemRecord& item, const std::vector<PointField>& fields) {
    require_exportable(item, fields);
    std::string text =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n"
        "<UnstructuredGrid>\n";
    text += fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n", item.points.size(),
                        item.triangles.size());
    const std::span<const double> coordinates(item.points.front().data(), 3 * item.points.size());
    text += data_array<double>("Float64", "Points", 3, coordinates) + "</Points>\n" + cells(item);
    text += "<PointData>\n";
    for (const PointField& field : fields) text += data_array<double>("Float64", field.name, 1, field.values);
    text += "</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    write_text_durably(path, text);
}

}  // namespace ricci
