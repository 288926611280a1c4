#include "io/picture/checker_image.h"

#include <zlib.h>

#include <cstdint>
#include <new>
#include <string_view>

namespace ricci {
namespace {

void append_number(std::string& bytes, std::uint32_t number) {
    for (const unsigned shift : {24U, 16U, 8U, 0U}) bytes += static_cast<char>((number >> shift) & 0xFFU);
}

// PNG (ISO/IEC 15948), section 5.3: length, type, data, CRC of type and data.
void append_chunk(std::string& png, std::string_view type, std::string_view data) {
    append_number(png, static_cast<std::uint32_t>(data.size()));
    std::string body(type);
    body += data;
    png += body;
    append_number(png, static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(body.data()),
                                                        static_cast<uInt>(body.size()))));
}

std::string packed(const std::string& bytes) {
    uLongf size = compressBound(static_cast<uLong>(bytes.size()));
    std::string result(size, '\0');
    if (compress(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                 static_cast<uLong>(bytes.size())) != Z_OK)
        throw std::bad_alloc();  // the only failure left with a buffer that is large enough
    result.resize(size);
    return result;
}

// Rows of one bit per pixel, each after its filter type 0. A square is two bytes wide.
std::string rows_of(int squares) {
    std::string rows;
    for (int row = 0; row < 16 * squares; ++row) {
        rows += '\0';
        const int j = squares - 1 - row / 16;
        for (int i = 0; i < squares; ++i) rows.append(2, (i + j) % 2 == 0 ? '\0' : '\xFF');
    }
    return rows;
}

}  // namespace

std::string checker_png(int squares, std::uint8_t dark) {
    std::string header;
    append_number(header, static_cast<std::uint32_t>(16 * squares));
    append_number(header, static_cast<std::uint32_t>(16 * squares));
    const char kind = dark == 0 ? '\0' : '\3';  // grey, or a palette
    header.append({1, kind, 0, 0, 0});          // one bit; deflate, no filter, not interlaced
    std::string png = "\x89PNG\r\n\x1A\n";
    append_chunk(png, "IHDR", header);
    if (dark != 0)
        append_chunk(png, "PLTE", std::string(3, static_cast<char>(dark)) + std::string(3, '\xFF'));
    append_chunk(png, "IDAT", packed(rows_of(squares)));
    append_chunk(png, "IEND", "");
    return png;
}

}  // namespace ricci
