// PLY: the elements vertex (x, y, z) and face (vertex_indices); whatever else is declared is skipped.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstring>
#include <string>

#include "io/mesh/formats/element_defects.h"
#include "io/mesh/formats/formats.h"
#include "io/mesh/formats/ply_header.h"
#include "io/mesh/formats/text_lines.h"

namespace ricci {
namespace {

/// A body of either kind gives values one after the other, between begin() and end() of each element.
class AsciiBody {
  public:
    AsciiBody(std::string_view bytes, const PlyHeader& header)
        : lines_(bytes.substr(header.body)), header_lines_(header.header_lines), line_("", 0) {}

    void begin(const PlyElement& element, std::int64_t i) {
        if (!lines_.next_filled()) {
            throw ContentError("truncated", line(),
                               "the file ends after line " + std::to_string(line()) + ", before " +
                                   element.name + " " + std::to_string(i) + " of " +
                                   std::to_string(element.count));
        }
        line_ = Tokens(lines_.line(), line());
    }
    /// VCGLIB declares red, green, blue (and alpha) for faces with a colour per corner, but writes a list:
    /// the rest of the line is then one list, and longer than what is declared.
    bool skip_corner_colours(std::size_t declared) {
        Tokens ahead = line_;
        std::int64_t length = 0;
        if (!parse_integer(ahead.next(), length)) return false;
        if (ahead.count_numbers("a colour of a corner") != length) return false;
        if (length < 0 || static_cast<std::size_t>(length) + 1 <= declared) return false;
        line_ = Tokens("", line());
        return true;
    }
    double number(PlyType, const char* what) { return line_.number(what); }
    std::int64_t integer(PlyType, const char* what) { return line_.integer(what); }
    void end(const PlyElement& element) {
        if (!line_.done())
            line_.fail("the line holds more numbers than the header declares for a " + element.name);
    }
    void finish() {
        if (!lines_.next_filled()) return;
        line_ = Tokens(lines_.line(), line());
        line_.fail("more data than the header declares");
    }
    [[nodiscard]] std::int64_t line() const { return header_lines_ + lines_.number(); }
    [[noreturn]] void fail(const std::string& message) const { line_.fail(message); }

  private:
    TextLines lines_;
    std::int64_t header_lines_;
    Tokens line_;
};

class BinaryBody {
  public:
    BinaryBody(std::string_view bytes, const PlyHeader& header)
        : bytes_(bytes),
          position_(header.body),
          swap_((header.encoding == PlyEncoding::kBigEndian) != (std::endian::native == std::endian::big)) {}

    void begin(const PlyElement& element, std::int64_t i) {
        element_ = &element;
        index_ = i;
    }
    static bool skip_corner_colours(std::size_t) { return false; }
    double number(PlyType type, const char*) {
        if (type == PlyType::kFloat64) return value<double>();
        if (type == PlyType::kFloat32) return static_cast<double>(value<float>());
        return static_cast<double>(integer(type, ""));
    }
    std::int64_t integer(PlyType type, const char*) {
        switch (type) {
            case PlyType::kInt8:
                return value<std::int8_t>();
            case PlyType::kUint8:
                return value<std::uint8_t>();
            case PlyType::kInt16:
                return value<std::int16_t>();
            case PlyType::kUint16:
                return value<std::uint16_t>();
            case PlyType::kInt32:
                return value<std::int32_t>();
            default:
                return value<std::uint32_t>();
        }
    }
    void end(const PlyElement&) {}
    void finish() {
        const std::string_view rest = bytes_.substr(position_);
        if (rest.find_first_not_of(std::string_view(" \t\r\n\0", 5)) == std::string_view::npos) return;
        throw ContentError("syntax", 0,
                           std::to_string(rest.size()) +
                               " bytes follow the last element that the PLY "
                               "header declares");
    }
    [[nodiscard]] static std::int64_t line() { return 0; }
    [[noreturn]] void fail(const std::string& message) const {
        throw ContentError("syntax", 0, element_->name + " " + std::to_string(index_) + ": " + message);
    }

  private:
    template <class T>
    T value() {
        if (bytes_.size() - position_ < sizeof(T)) {
            throw ContentError("truncated", 0,
                               "the file ends within " + element_->name + " " + std::to_string(index_) +
                                   " of " + std::to_string(element_->count));
        }
        std::array<char, sizeof(T)> raw{};
        std::memcpy(raw.data(), bytes_.data() + position_, sizeof(T));
        position_ += sizeof(T);
        if (swap_) std::reverse(raw.begin(), raw.end());
        return std::bit_cast<T>(raw);
    }

    std::string_view bytes_;
    std::size_t position_;
    bool swap_;
    const PlyElement* element_ = nullptr;
    std::int64_t index_ = 0;
};

/// Which coordinate a vertex property gives, or -1.
int coordinate_of(const PlyProperty& property) {
    if (property.count_type || property.name.size() != 1) return -1;
    return property.name[0] >= 'x' && property.name[0] <= 'z' ? property.name[0] - 'x' : -1;
}

bool is_corner_list(const PlyProperty& property) {
    return property.name == "vertex_indices" || property.name == "vertex_index";
}

template <class Body>
class PlyBodyParser {
  public:
    PlyBodyParser(const PlyHeader& header, Body body) : header_(header), body_(body) {}

    ParsedFile parse() {
        for (const PlyElement& element : header_.elements) {
            // Elements without properties take no bytes; a header could promise any number of them.
            if (element.properties.empty()) continue;
            for (std::int64_t i = 0; i < element.count; ++i) {
                body_.begin(element, i);
                if (element.name == "vertex") {
                    vertex(element);
                } else if (element.name == "face") {
                    face(element);
                } else {
                    for (const PlyProperty& property : element.properties) skip(property);
                }
                body_.end(element);
            }
        }
        body_.finish();
        if (corner_colours_ > 0) {
            file_.notes.add(
                "undeclared_list", "file", -1,
                std::to_string(corner_colours_) +
                    " faces carry a list of corner colours where the header declares red, green, blue (an "
                    "error of VCGLIB); skipped");
        }
        return std::move(file_);
    }

  private:
    void vertex(const PlyElement& element) {
        Point point{};
        for (const PlyProperty& property : element.properties) {
            const int k = coordinate_of(property);
            if (k < 0) {
                skip(property);
            } else {
                point[static_cast<std::size_t>(k)] = body_.number(property.type, "a coordinate of a vertex");
            }
        }
        add_point(file_, point, body_.line());
    }

    void face(const PlyElement& element) {
        bool have_corners = false;
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const PlyProperty& property = element.properties[p];
            if (have_corners && property.name == "red" && !property.count_type &&
                body_.skip_corner_colours(element.properties.size() - p)) {
                ++corner_colours_;
                break;
            }
            if (!is_corner_list(property)) {
                skip(property);
                continue;
            }
            have_corners = true;
            const std::int64_t corners = length(property);
            for (std::int64_t k = 0; k < corners; ++k) {
                file_.soup.corners.push_back(body_.integer(property.type, "the vertex of a corner"));
            }
        }
        end_face_of_line(file_, body_.line());
    }

    std::int64_t length(const PlyProperty& property) {
        const std::int64_t count = body_.integer(*property.count_type, "the length of a list");
        if (count < 0) body_.fail("the length of the list " + shown(property.name) + " is negative");
        return count;
    }

    /// Values are read even where they are of no use: a wrong one means that the header does not fit the
    /// data.
    void skip(const PlyProperty& property) {
        const std::int64_t count = property.count_type ? length(property) : 1;
        for (std::int64_t k = 0; k < count; ++k) body_.number(property.type, property.name.c_str());
    }

    const PlyHeader& header_;
    Body body_;
    ParsedFile file_;
    std::int64_t corner_colours_ = 0;
};

const PlyElement* find_element(const PlyHeader& header, std::string_view name) {
    const PlyElement* found = nullptr;
    for (const PlyElement& element : header.elements) {
        if (element.name != name) continue;
        if (found != nullptr) {
            throw ContentError("syntax", element.line,
                               "line " + std::to_string(element.line) + ": the element " + shown(name) +
                                   " is declared twice");
        }
        found = &element;
    }
    return found;
}

void check_vertex(const PlyElement& vertex) {
    const auto count = std::count_if(vertex.properties.begin(), vertex.properties.end(),
                                     [](const PlyProperty& p) { return coordinate_of(p) >= 0; });
    if (count == 3) return;
    throw ContentError("syntax", vertex.line,
                       "line " + std::to_string(vertex.line) +
                           ": the element vertex does not declare the properties x, y and z");
}

void check_face(const PlyElement& face) {
    const std::string at = "line " + std::to_string(face.line) + ": the element face ";
    std::int64_t lists = 0;
    for (const PlyProperty& property : face.properties) {
        if (!is_corner_list(property)) continue;
        ++lists;
        if (!property.count_type || !ply_is_integer(property.type)) {
            throw ContentError("syntax", face.line,
                               at + "declares " + property.name + ", but not as a list of integers");
        }
    }
    if (lists == 1) return;
    throw ContentError("syntax", face.line, at + "must declare one list vertex_indices or vertex_index");
}

void check_elements(const PlyHeader& header) {
    const PlyElement* vertex = find_element(header, "vertex");
    const PlyElement* face = find_element(header, "face");
    const PlyElement* strips = find_element(header, "tristrips");
    if (strips != nullptr && strips->count > 0) {
        throw ContentError(
            "unsupported_format", strips->line,
            "line " + std::to_string(strips->line) +
                ": triangle strips (element tristrips) are not supported; convert them to faces first");
    }
    if (vertex == nullptr || face == nullptr) {
        throw ContentError(
            "no_faces", 0,
            std::string("the PLY header declares no element ") + (vertex == nullptr ? "vertex" : "face"));
    }
    check_vertex(*vertex);
    if (face->count > 0) check_face(*face);
}

}  // namespace

ParsedFile parse_ply(std::string_view bytes) {
    const PlyHeader header = parse_ply_header(bytes);
    check_elements(header);
    if (header.encoding == PlyEncoding::kAscii) {
        return PlyBodyParser<AsciiBody>(header, AsciiBody(bytes, header)).parse();
    }
    return PlyBodyParser<BinaryBody>(header, BinaryBody(bytes, header)).parse();
}

}  // namespace ricci
