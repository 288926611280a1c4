// STL, binary or ASCII. The format has no vertex numbers: equal corners are merged, numbered by first
// occurrence.
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "io/mesh/formats/coincident.h"
#include "io/mesh/formats/element_defects.h"
#include "io/mesh/formats/formats.h"
#include "io/mesh/formats/text_lines.h"

namespace ricci {
namespace {

constexpr std::size_t kHeader = 84, kFacet = 50;

struct Facets {
    std::vector<Point> corner;       // 3F
    std::vector<std::int64_t> line;  // F for ASCII, of the word facet
};

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + k])) << (8 * k);
    }
    return value;
}

bool begins_with_solid(std::string_view bytes) {
    const std::size_t begin = bytes.find_first_not_of(" \t\r\n");
    return begin != std::string_view::npos && bytes.substr(begin, 5) == "solid";
}

/// Binary headers may begin with "solid" too, but a binary file holds a NUL (in its count, below 16.7 million
/// facets) and text does not.
bool is_binary(std::string_view bytes) {
    return !begins_with_solid(bytes) || bytes.find('\0') != std::string_view::npos;
}

Facets parse_binary(std::string_view bytes) {
    if (bytes.size() < kHeader) {
        throw ContentError("truncated", 0,
                           "the file is shorter than the 84 bytes of a binary STL header, and no ASCII "
                           "STL, which would begin with the word solid");
    }
    const std::size_t count = little_endian(bytes, 80);
    const std::size_t size = kHeader + kFacet * count;
    if (bytes.size() < size) {
        throw ContentError("truncated", 0,
                           "the header promises " + std::to_string(count) + " facets, " +
                               std::to_string(size) + " bytes, but the file has " +
                               std::to_string(bytes.size()));
    }
    if (bytes.size() > size) {
        throw ContentError("syntax", 0,
                           std::to_string(bytes.size() - size) + " bytes follow the " +
                               std::to_string(count) + " facets that the header promises");
    }
    Facets facets;
    facets.corner.reserve(3 * count);
    for (std::size_t f = 0; f < count; ++f) {
        for (std::size_t k = 0; k < 3; ++k) {
            Point point;
            for (std::size_t c = 0; c < 3; ++c) {
                const std::size_t at = kHeader + kFacet * f + 12 + 12 * k + 4 * c;  // the normal comes first
                point[c] = static_cast<double>(std::bit_cast<float>(little_endian(bytes, at)));
            }
            facets.corner.push_back(point);
        }
    }
    return facets;
}

/// ASCII STL as a stream of words; line breaks matter only behind solid and endsolid, where a name follows.
class AsciiStl {
  public:
    explicit AsciiStl(std::string_view text) : lines_(text), line_("", 0) {}

    Facets parse() {
        while (advance()) {
            expect("solid");
            line_ = Tokens("", lines_.number());
            solid();
        }
        return std::move(facets_);
    }

  private:
    /// Makes sure that a word is left; false at the end of the file.
    bool advance() {
        while (line_.done()) {
            if (!lines_.next()) return false;
            line_ = lines_.tokens();
        }
        return true;
    }

    std::string_view word() {
        if (!advance()) {
            throw ContentError("truncated", lines_.number(),
                               "the file ends after line " + std::to_string(lines_.number()) +
                                   " within a solid: endsolid is missing");
        }
        return line_.next();
    }

    static bool same_word(std::string_view a, std::string_view lower) {
        if (a.size() != lower.size()) return false;
        for (std::size_t i = 0; i < a.size(); ++i) {
            if ((a[i] >= 'A' && a[i] <= 'Z' ? a[i] + ('a' - 'A') : a[i]) != lower[i]) return false;
        }
        return true;
    }

    void expect(std::string_view expected) {
        const std::string_view found = word();
        if (!same_word(found, expected)) {
            line_.fail(shown(found) + " where " + std::string(expected) + " is expected");
        }
    }

    void solid() {
        while (true) {
            const std::string_view found = word();
            if (same_word(found, "endsolid")) break;
            if (!same_word(found, "facet")) line_.fail(shown(found) + " where facet or endsolid is expected");
            facet();
        }
        line_ = Tokens("", lines_.number());  // the name
    }

    void facet() {
        facets_.line.push_back(lines_.number());
        expect("normal");
        for (int k = 0; k < 3; ++k) word();  // not used, and often nan
        expect("outer");
        expect("loop");
        for (int k = 0; k < 3; ++k) {
            expect("vertex");
            Point point;
            for (double& coordinate : point) {
                advance();
                coordinate = line_.number("one of the three coordinates of a vertex");
            }
            facets_.corner.push_back(point);
        }
        expect("endloop");
        expect("endfacet");
    }

    TextLines lines_;
    Tokens line_;
    Facets facets_;
};

void check_finite(const Facets& facets, ParsedFile& file) {
    for (std::size_t i = 0; i < facets.corner.size(); ++i) {
        const Point& p = facets.corner[i];
        if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])) continue;
        const std::size_t f = i / 3;
        file.errors.add("not_finite", "face", static_cast<std::int64_t>(f), [&] {
            const std::string at = facets.line.empty() ? "" : "line " + std::to_string(facets.line[f]) + ", ";
            return at + "face " + std::to_string(f) + ": a coordinate of corner " + std::to_string(i % 3) +
                   " is not a finite number";
        });
    }
}

ParsedFile merge_corners(const Facets& facets) {
    ParsedFile file;
    PolygonSoup& soup = file.soup;
    check_finite(facets, file);
    if (facets.corner.size() > 2'147'483'646) {
        throw ContentError("too_large", 0, "the file has more than 715827882 facets, beyond 32-bit indices");
    }
    const std::vector<Index> first = first_at_position(facets.corner);
    std::vector<std::int64_t> number(first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
        const auto original = static_cast<std::size_t>(first[i]);
        if (original == i) {
            number[i] = static_cast<std::int64_t>(soup.points.size());
            soup.points.push_back(facets.corner[i]);
        }
        soup.corners.push_back(number[original]);
        if (i % 3 == 2) soup.end_face();
    }
    soup.face_line = facets.line;
    if (!first.empty()) {
        file.notes.add("merged_corners", "file", -1,
                       std::to_string(first.size()) + " STL corners with equal coordinates merged into " +
                           std::to_string(soup.points.size()) + " vertices, numbered by first occurrence");
    }
    return file;
}

}  // namespace

ParsedFile parse_stl(std::string_view bytes) {
    return merge_corners(is_binary(bytes) ? parse_binary(bytes) : AsciiStl(bytes).parse());
}

}  // namespace ricci
