// Intrinsic surfaces: "V F", then one line of nine numbers per face. '#' starts a comment.
#include <cmath>
#include <string>

#include "io/mesh/formats/formats.h"
#include "io/mesh/formats/text_lines.h"

namespace ricci {
namespace {

constexpr std::int64_t kMaxIndex = 2'147'483'646;

void need_line(TextLines& lines, const std::string& what) {
    if (lines.next_filled()) return;
    throw ContentError(
        "truncated", lines.number(),
        "the file ends after line " + std::to_string(lines.number()) + ", where " + what + " is expected");
}

struct Counts {
    std::int64_t vertices = 0, faces = 0;
};

Counts parse_counts(TextLines& lines) {
    need_line(lines, "the line with the numbers of vertices and faces");
    Tokens tokens = lines.tokens();
    Counts counts;
    counts.vertices = tokens.integer("the number of vertices");
    counts.faces = tokens.integer("the number of faces");
    if (!tokens.done()) tokens.fail("the first line holds more than two numbers");
    if (counts.vertices < 0 || counts.faces < 0) tokens.fail("a count is negative");
    // Vertices take no room in the file, so that only its size bounds what a header may make us allocate.
    const auto bytes = static_cast<std::int64_t>(lines.position() + lines.remaining());
    if (counts.vertices > bytes) {
        tokens.fail("the header promises more vertices (" + std::to_string(counts.vertices) +
                    ") than the file has bytes");
    }
    if (counts.vertices > kMaxIndex || counts.faces > kMaxIndex / 3) {
        throw ContentError("too_large", lines.number(), "the surface is too large for 32-bit indices");
    }
    return counts;
}

std::string at(const Tokens& tokens, std::int64_t f) {
    return "line " + std::to_string(tokens.line_number()) + ", face " + std::to_string(f) + ": ";
}

void parse_vertices(Tokens& tokens, std::int64_t f, const Counts& counts, ParsedFile& file) {
    for (int k = 0; k < 3; ++k) {
        const std::int64_t v = tokens.integer("a vertex of the face");
        const bool valid = v >= 0 && v < counts.vertices;
        if (!valid) {
            file.errors.add("index_out_of_range", "face", f, [&] {
                return at(tokens, f) + "there is no vertex number " + std::to_string(v) +
                       "; the header promises " + std::to_string(counts.vertices) +
                       " vertices, counted from 0";
            });
        }
        file.intrinsic->tail.push_back(valid ? static_cast<Index>(v) : 0);
    }
}

void parse_lengths(Tokens& tokens, std::int64_t f, ParsedFile& file) {
    for (int k = 0; k < 3; ++k) {
        const double length = tokens.number("a length of the face");
        if (!std::isfinite(length)) {
            file.errors.add("not_finite", "face", f, [&] {
                return at(tokens, f) + "length " + std::to_string(k) + " is not a finite number";
            });
        } else if (!(length > 0)) {
            file.errors.add(length < 0 ? "negative_length" : "zero_length_edge", "face", f, [&] {
                return at(tokens, f) + "length " + std::to_string(k) + " is not positive";
            });
        }
        file.intrinsic->length.push_back(length);
    }
}

void parse_twins(Tokens& tokens, std::int64_t f, const Counts& counts, ParsedFile& file) {
    for (int k = 0; k < 3; ++k) {
        const std::int64_t twin = tokens.integer("the twin of a halfedge");
        const bool valid = twin >= -1 && twin < 3 * counts.faces;
        if (!valid) {
            file.errors.add("index_out_of_range", "face", f, [&] {
                return at(tokens, f) + "twin " + std::to_string(twin) + " is no halfedge; there are " +
                       std::to_string(3 * counts.faces) + ", counted from 0, and -1 means boundary";
            });
        }
        file.intrinsic->twin.push_back(valid ? static_cast<Index>(twin) : kNoTwin);
    }
}

}  // namespace

ParsedFile parse_len(std::string_view text) {
    TextLines lines(text, '#');
    const Counts counts = parse_counts(lines);
    ParsedFile file;
    file.intrinsic.emplace();
    file.intrinsic->vertex_count = static_cast<Index>(counts.vertices);
    for (std::int64_t f = 0; f < counts.faces; ++f) {
        need_line(lines, "face " + std::to_string(f) + " of " + std::to_string(counts.faces));
        Tokens tokens = lines.tokens();
        parse_vertices(tokens, f, counts, file);
        parse_lengths(tokens, f, file);
        parse_twins(tokens, f, counts, file);
        if (!tokens.done()) tokens.fail("more than nine numbers for a face");
    }
    if (lines.next_filled()) lines.tokens().fail("more data than the faces that the first line promises");
    return file;
}

}  // namespace ricci
