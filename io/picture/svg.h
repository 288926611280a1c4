// Pictures as SVG 1.1: a small writer whose files are short and the same bytes for the same calls.
//
// Callers draw in units of their own with y upwards; the file holds pixels with y downwards, rounded to
// 1/100 pixel. Widths, dashes and sizes of letters are in pixels.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/picture/circular_arc.h"
#include "io/picture/colour.h"

namespace ricci {

/// The part of the plane that a picture shows, in user units.
struct ViewBox {
    double left = -1.0, bottom = -1.0, width = 2.0, height = 2.0;
};

/// How a shape is painted.
struct Paint {
    std::optional<Colour> fill{};    // none: not filled
    std::optional<Colour> stroke{};  // none: no outline
    double stroke_width = 1.0;       // pixels
    double opacity = 1.0;            // of fill and stroke together, in [0, 1]
    std::vector<double> dashes{};    // pixels on, off, on, ...; empty: solid
};
Paint filled(const Colour& colour);
Paint stroked(const Colour& colour, double stroke_width = 1.0);

enum class TextAnchor : std::uint8_t { start, middle, end };

/// How text is set; its baseline starts, is centred or ends at the point that is given with it.
struct TextStyle {
    double size = 12.0;  // pixels
    TextAnchor anchor = TextAnchor::start;
    Colour colour = kBlack;
    double angle = 0.0;            // radians, anticlockwise
    double right = 0.0, up = 0.0;  // moved by so many pixels, before it is turned
    bool bold = false, italic = false;
};

/// An outline of any number of pieces in user units. A piece starts with move_to. Areas are filled by the
/// nonzero rule. Methods throw std::logic_error where a piece has no start. Long arcs are kept as several.
class SvgPath {
  public:
    SvgPath& move_to(const PlanePoint& point);
    SvgPath& line_to(const PlanePoint& point);
    /// An arc of at most half a circle that turns left by `curvature` (CircularArc) per unit of length.
    SvgPath& arc_to(const PlanePoint& point, double curvature);
    /// Back to the start of the piece, in a straight line.
    SvgPath& close();

    /// Whole pieces. An arc continues the piece when that ends exactly where the arc starts.
    SvgPath& polyline(std::span<const PlanePoint> points);
    SvgPath& polygon(std::span<const PlanePoint> corners);
    SvgPath& circle(const PlanePoint& centre, double radius);
    SvgPath& arc(const CircularArc& arc);

    [[nodiscard]] bool empty() const { return commands_.empty(); }

  private:
    friend class SvgPicture;
    enum class Verb : std::uint8_t { move, line, arc, close };
    struct Command {
        Verb verb;
        PlanePoint point;
        double curvature;
    };
    void require_started() const;
    std::vector<Command> commands_;
};

/// A picture. Shapes paint over earlier ones. Methods throw std::invalid_argument for coordinates that are
/// not finite; coordinates beyond 10^7 pixels are cut to that. Text is UTF-8; what XML cannot hold is shown
/// as \xNN or, of control characters, as U+FFFD. A title is what browsers show under the pointer; "": none.
class SvgPicture {
  public:
    /// The view is scaled by one factor, as large as fits into width x height pixels, and centred. Throws
    /// std::invalid_argument unless all four extents are positive and finite.
    SvgPicture(double width, double height, const ViewBox& view);

    /// Pixels per user unit.
    [[nodiscard]] double scale() const { return scale_; }

    void path(const SvgPath& path, const Paint& paint, const std::string& title = "");
    void line(const PlanePoint& from, const PlanePoint& to, const Paint& paint,
              const std::string& title = "");
    void polyline(std::span<const PlanePoint> points, const Paint& paint, const std::string& title = "");
    void polygon(std::span<const PlanePoint> corners, const Paint& paint, const std::string& title = "");
    void circle(const PlanePoint& centre, double radius, const Paint& paint, const std::string& title = "");
    /// A dot of a radius in pixels.
    void dot(const PlanePoint& centre, double pixels, const Paint& paint, const std::string& title = "");
    void text(const PlanePoint& point, const std::string& words, const TextStyle& style = {});

    /// What follows until end_group() belongs together; editors show groups of the outermost level as layers
    /// of that name. With `clip`, only what lies inside that outline is shown.
    void begin_group(const std::string& name, double opacity = 1.0);
    void begin_group(const std::string& name, const SvgPath& clip, double opacity = 1.0);
    /// Throws std::logic_error when none is open.
    void end_group();

    /// Title of the whole picture.
    void set_title(const std::string& title);

    /// The whole file; open groups are closed.
    [[nodiscard]] std::string document() const;
    /// The same as an element inside an HTML page, as wide as its place allows but no wider than the picture.
    /// Names within the page start with `prefix`. The attributes data-scale, data-left and data-top lead from
    /// pixels to user units: x = left + px / scale, y = top - py / scale.
    [[nodiscard]] std::string embedded(const std::string& prefix) const;
    /// Writes the file under a temporary name, fsyncs and renames it. Throws FileError.
    void save(const std::string& path) const;

  private:
    struct Pixel;
    [[nodiscard]] Pixel pixel_of(const PlanePoint& point) const;
    [[nodiscard]] std::string path_data(const SvgPath& path) const;
    void append_arc(std::string& data, const Pixel& from, const Pixel& to, double curvature) const;
    void element(const std::string& start, const Paint& paint, const std::string& title);
    void open_group(const std::string& name, const std::string& attributes);
    [[nodiscard]] std::string contents() const;

    double width_, height_, scale_ = 1.0, left_ = 0.0, top_ = 0.0;
    std::string title_, body_;
    int open_groups_ = 0, clips_ = 0;
};

}  // namespace ricci
