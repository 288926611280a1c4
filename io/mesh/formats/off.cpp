// Geomview OFF. Read line by line, one vertex or face each, because the number of colour components varies in
// practice (COFF with three of them); free-form files that break this are refused, never misread.
#include <cmath>
#include <string>

#include "io/mesh/formats/element_defects.h"
#include "io/mesh/formats/formats.h"
#include "io/mesh/formats/text_lines.h"

namespace ricci {
namespace {

class OffParser {
  public:
    explicit OffParser(std::string_view text) : lines_(text, '#') {}

    ParsedFile parse() {
        header();
        for (std::int64_t v = 0; v < vertices_; ++v) vertex(v);
        for (std::int64_t f = 0; f < faces_; ++f) face(f);
        if (lines_.next_filled()) {
            lines_.tokens().fail("more data than the " + std::to_string(vertices_) + " vertices and " +
                                 std::to_string(faces_) + " faces that the header promises");
        }
        return std::move(file_);
    }

  private:
    void need_line(const std::string& what) {
        if (lines_.next_filled()) return;
        throw ContentError("truncated", lines_.number(),
                           "the file ends after line " + std::to_string(lines_.number()) + ", where " + what +
                               " is expected");
    }

    /// "[ST][C][N][4][n]OFF [BINARY]" and "V F [E]", on one line or two, even glued together; the word is
    /// optional.
    void header() {
        need_line("the header");
        std::string_view line = lines_.line();
        line.remove_prefix(std::min(line.find_first_not_of(" \t\v\f"), line.size()));
        const std::size_t word_end = std::min(line.find("OFF"), line.size());
        if (word_end < line.size()) {
            prefix(line.substr(0, word_end));
            line.remove_prefix(word_end + 3);
        }
        Tokens tokens(line, lines_.number());
        if (tokens.done()) {
            need_line("the line with the counts");
            tokens = lines_.tokens();
        } else if (Tokens(line, 0).next() == "BINARY") {
            throw ContentError(
                "unsupported_format", 1,
                "binary OFF is not supported (its byte order is ambiguous in practice); convert it to "
                "ASCII OFF or to PLY");
        }
        vertices_ = count(tokens, "the number of vertices");
        faces_ = count(tokens, "the number of faces");
        if (!tokens.done()) count(tokens, "the number of edges");
        if (!tokens.done()) tokens.fail("the line with the counts holds more than three numbers");
    }

    void prefix(std::string_view word) const {
        if (word.find_first_of("4n") != std::string_view::npos) {
            throw ContentError(
                "unsupported_format", lines_.number(),
                "OFF of other than three dimensions (" + shown(word) + "OFF) is not supported");
        }
        if (word.find_first_not_of("STCN") != std::string_view::npos) {
            Tokens({}, lines_.number()).fail(shown(word) + " before OFF is no variant of OFF");
        }
    }

    /// A line takes at least two bytes per element, which bounds what a header may promise.
    std::int64_t count(Tokens& tokens, const char* what) const {
        const std::int64_t value = tokens.integer(what);
        if (value < 0) tokens.fail(std::string(what) + " is negative");
        return value;
    }

    void vertex(std::int64_t v) {
        need_line("vertex " + std::to_string(v) + " of " + std::to_string(vertices_));
        Tokens tokens = lines_.tokens();
        Point point;
        for (double& coordinate : point)
            coordinate = tokens.number("one of the three coordinates of a vertex");
        const std::int64_t extra = tokens.count_numbers("colour, normal or texture coordinate of a vertex");
        if (v == 0) extra_ = extra;
        // All lines alike, or this is no file of one vertex per line.
        if (extra != extra_) {
            tokens.fail("vertex " + std::to_string(v) + " has " + std::to_string(3 + extra) +
                        " numbers, the ones before have " + std::to_string(3 + extra_));
        }
        add_point(file_, point, lines_.number());
    }

    void face(std::int64_t f) {
        need_line("face " + std::to_string(f) + " of " + std::to_string(faces_));
        Tokens tokens = lines_.tokens();
        const std::int64_t corners = count(tokens, "the number of corners of a face");
        for (std::int64_t k = 0; k < corners; ++k) {
            file_.soup.corners.push_back(tokens.integer("the vertex of a corner"));
        }
        const std::int64_t colours = tokens.count_numbers("colour of a face");
        if (colours == 2 || colours > 4) {
            tokens.fail("face " + std::to_string(f) + " declares " + std::to_string(corners) +
                        " corners, but " + std::to_string(colours) +
                        " more numbers follow, which is no colour");
        }
        end_face_of_line(file_, lines_.number());
    }

    TextLines lines_;
    ParsedFile file_;
    std::int64_t vertices_ = 0, faces_ = 0;
    std::int64_t extra_ = 0;  // numbers after the coordinates, the same for all vertices
};

}  // namespace

ParsedFile parse_off(std::string_view text) {
    return OffParser(text).parse();
}

}  // namespace ricci
