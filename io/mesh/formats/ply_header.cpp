#include "io/mesh/formats/ply_header.h"

#include <array>
#include <set>
#include <utility>

#include "io/mesh/formats/polygon_soup.h"
#include "io/mesh/formats/text_lines.h"

namespace ricci {
namespace {

PlyType parse_type(Tokens& tokens) {
    constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes = {
        {{"char", PlyType::kInt8},
         {"int8", PlyType::kInt8},
         {"uchar", PlyType::kUint8},
         {"uint8", PlyType::kUint8},
         {"short", PlyType::kInt16},
         {"int16", PlyType::kInt16},
         {"ushort", PlyType::kUint16},
         {"uint16", PlyType::kUint16},
         {"int", PlyType::kInt32},
         {"int32", PlyType::kInt32},
         {"uint", PlyType::kUint32},
         {"uint32", PlyType::kUint32},
         {"float", PlyType::kFloat32},
         {"float32", PlyType::kFloat32},
         {"double", PlyType::kFloat64},
         {"float64", PlyType::kFloat64}}};
    const std::string_view word = tokens.next();
    for (const auto& [name, type] : kTypes) {
        if (name == word) return type;
    }
    tokens.fail(shown(word) + " is not a PLY type");
}

PlyEncoding parse_encoding(Tokens& tokens) {
    const std::string_view word = tokens.next();
    const std::string_view version = tokens.next();
    if (version != "1.0") tokens.fail("PLY version " + shown(version) + " is not 1.0");
    if (word == "ascii") return PlyEncoding::kAscii;
    if (word == "binary_little_endian") return PlyEncoding::kLittleEndian;
    if (word == "binary_big_endian") return PlyEncoding::kBigEndian;
    tokens.fail(shown(word) + " is not a PLY encoding");
}

PlyElement parse_element(Tokens& tokens) {
    PlyElement element;
    element.name = std::string(tokens.next());
    element.count = tokens.integer("the number of elements");
    element.line = tokens.line_number();
    if (element.count < 0) tokens.fail("the number of elements is negative");
    return element;
}

PlyProperty parse_property(Tokens tokens) {
    Tokens ahead = tokens;
    PlyProperty property;
    if (ahead.next() == "list") {
        property.count_type = parse_type(ahead);
        if (!ply_is_integer(*property.count_type))
            ahead.fail("the length of a list is not of an integer type");
        tokens = ahead;
    }
    property.type = parse_type(tokens);
    property.name = std::string(tokens.next());
    if (property.name.empty()) tokens.fail("the property has no name");
    return property;
}

/// The statements of a header, taken in one after the other.
class HeaderReader {
  public:
    /// False at the end of the header.
    bool statement(Tokens& tokens) {
        const std::string_view word = tokens.next();
        if (word == "end_header") {
            // The line after "ply" must give the format; other statements come in any order.
            if (!have_format_) tokens.fail("the header has no format line");
            return false;
        }
        if (word == "format") {
            header_.encoding = parse_encoding(tokens);
            have_format_ = true;
        } else if (word == "element") {
            add_element(tokens);
        } else if (word == "property") {
            add_property(tokens);
        } else if (word != "comment" && word != "obj_info" && !word.empty()) {
            tokens.fail("unknown statement " + shown(word) + " in the PLY header");
        }
        return true;
    }
    PlyHeader take() { return std::move(header_); }

  private:
    void add_element(Tokens& tokens) {
        header_.elements.push_back(parse_element(tokens));
        names_.clear();
    }

    void add_property(Tokens& tokens) {
        if (header_.elements.empty()) tokens.fail("a property before the first element");
        PlyProperty property = parse_property(tokens);
        if (!names_.insert(property.name).second)
            tokens.fail("property " + shown(property.name) + " is declared twice");
        header_.elements.back().properties.push_back(std::move(property));
    }

    PlyHeader header_;
    std::set<std::string> names_;  // of the last element's properties: a header may hold a million of them
    bool have_format_ = false;
};

}  // namespace

std::size_t ply_size(PlyType type) {
    constexpr std::array<std::size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
    return kSizes[static_cast<std::size_t>(type)];
}

PlyHeader parse_ply_header(std::string_view bytes) {
    TextLines lines(bytes);
    HeaderReader reader;
    if (!lines.next() || lines.tokens().next() != "ply") {
        throw ContentError("syntax", 1, "line 1: a PLY file begins with the word ply");
    }
    while (true) {
        if (!lines.next()) {
            throw ContentError(
                "truncated", lines.number(),
                "the file ends within the PLY header, after line " + std::to_string(lines.number()));
        }
        Tokens tokens = lines.tokens();
        if (!reader.statement(tokens)) break;
    }
    PlyHeader header = reader.take();
    header.body = bytes.size() - lines.remaining();
    header.header_lines = lines.number();
    return header;
}

}  // namespace ricci
