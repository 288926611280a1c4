#include "io/picture/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "io/picture/svg_text.h"
#include "io/store/durable.h"

namespace ricci {
namespace {

constexpr double kMaximalPixel = 1e7;

std::string paint_attributes(const Paint& paint) {
    std::string text = fmt::format(" fill=\"{}\"", paint.fill ? hexadecimal(*paint.fill) : "none");
    if (paint.stroke) {
        text += fmt::format(" stroke=\"{}\"", hexadecimal(*paint.stroke));
        if (paint.stroke_width != 1.0)
            text += fmt::format(" stroke-width=\"{}\"", svg_number(paint.stroke_width));
        if (!paint.dashes.empty()) {
            text += " stroke-dasharray=\"";
            for (std::size_t i = 0; i < paint.dashes.size(); ++i)
                text += (i > 0 ? " " : "") + svg_number(paint.dashes[i]);
            text += '"';
        }
    }
    if (paint.opacity != 1.0) text += fmt::format(" opacity=\"{}\"", svg_number(paint.opacity));
    return text;
}

std::string opacity_attribute(double opacity) {
    return opacity == 1.0 ? "" : fmt::format(" opacity=\"{}\"", svg_number(opacity));
}

}  // namespace

Paint filled(const Colour& colour) {
    Paint paint;
    paint.fill = colour;
    return paint;
}

Paint stroked(const Colour& colour, double stroke_width) {
    Paint paint;
    paint.stroke = colour;
    paint.stroke_width = stroke_width;
    return paint;
}

// A position in hundredths of a pixel, from the upper left corner. Differences of such are exact, so that
// relative coordinates do not drift.
struct SvgPicture::Pixel {
    std::int64_t x, y;
    bool operator==(const Pixel&) const = default;
};

SvgPicture::SvgPicture(double width, double height, const ViewBox& view) : width_(width), height_(height) {
    for (const double extent : {width, height, view.width, view.height})
        if (!(extent > 0.0 && std::isfinite(extent)))
            throw std::invalid_argument("a picture and its view have positive extents");
    scale_ = std::min(width / view.width, height / view.height);
    left_ = view.left + 0.5 * view.width - 0.5 * width / scale_;
    top_ = view.bottom + 0.5 * view.height + 0.5 * height / scale_;
}

SvgPicture::Pixel SvgPicture::pixel_of(const PlanePoint& point) const {
    if (!std::isfinite(point[0]) || !std::isfinite(point[1]))
        throw std::invalid_argument("a point of a picture is not finite");
    const auto rounded = [](double pixels) {
        return std::int64_t{std::llround(kSvgUnits * std::clamp(pixels, -kMaximalPixel, kMaximalPixel))};
    };
    return {rounded(scale_ * (point[0] - left_)), rounded(scale_ * (top_ - point[1]))};
}

// SVG stretches a radius that is too short for its chord, which rounding may make it.
void SvgPicture::append_arc(std::string& data, const Pixel& from, const Pixel& to, double curvature) const {
    const auto dx = static_cast<double>(to.x - from.x), dy = static_cast<double>(to.y - from.y);
    const double bend = std::abs(curvature) / (scale_ * kSvgUnits);  // per unit of the file
    const double sagitta = 0.125 * bend * (dx * dx + dy * dy);
    if (sagitta < 0.5) return append_svg_numbers(data, 'l', {to.x - from.x, to.y - from.y});
    // The radius in so many digits that the arc moves by less than a unit.
    const std::int64_t radius = std::llround(1.0 / bend);
    // Sweep 1 is clockwise on the screen.
    append_svg_numbers(data, 'a', {radius, radius});
    data += curvature < 0.0 ? " 0 0 1 " : " 0 0 0 ";
    append_svg_numbers(data, '\0', {to.x - from.x, to.y - from.y});
}

std::string SvgPicture::path_data(const SvgPath& path) const {
    std::string data;
    Pixel start{0, 0}, at{0, 0};
    for (const SvgPath::Command& command : path.commands_) {
        if (command.verb == SvgPath::Verb::close) {
            data += 'z';
            at = start;
            continue;
        }
        const Pixel to = pixel_of(command.point);
        if (command.verb == SvgPath::Verb::move) {
            // The first "m" is absolute, since nothing comes before it.
            append_svg_numbers(data, 'm', {to.x - at.x, to.y - at.y});
            start = to;
        } else if (command.verb == SvgPath::Verb::line) {
            append_svg_numbers(data, 'l', {to.x - at.x, to.y - at.y});
        } else {
            append_arc(data, at, to, command.curvature);
        }
        at = to;
    }
    return data;
}

void SvgPicture::element(const std::string& start, const Paint& paint, const std::string& title) {
    body_ += start + paint_attributes(paint);
    const std::size_t space = start.find(' ');
    if (title.empty())
        body_ += "/>\n";
    else
        body_ += fmt::format("><title>{}</title></{}>\n", xml_text(title), start.substr(1, space - 1));
}

void SvgPicture::path(const SvgPath& path, const Paint& paint, const std::string& title) {
    if (!path.empty()) element(fmt::format("<path d=\"{}\"", path_data(path)), paint, title);
}

void SvgPicture::line(const PlanePoint& from, const PlanePoint& to, const Paint& paint,
                      const std::string& title) {
    path(SvgPath().move_to(from).line_to(to), paint, title);
}

void SvgPicture::polyline(std::span<const PlanePoint> points, const Paint& paint, const std::string& title) {
    path(SvgPath().polyline(points), paint, title);
}

void SvgPicture::polygon(std::span<const PlanePoint> corners, const Paint& paint, const std::string& title) {
    path(SvgPath().polygon(corners), paint, title);
}

void SvgPicture::circle(const PlanePoint& centre, double radius, const Paint& paint,
                        const std::string& title) {
    dot(centre, radius * scale_, paint, title);
}

void SvgPicture::dot(const PlanePoint& centre, double pixels, const Paint& paint, const std::string& title) {
    if (!(pixels >= 0.0 && std::isfinite(pixels)))
        throw std::invalid_argument("the radius of a circle is not a length");
    const Pixel at = pixel_of(centre);
    element(fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"", svg_decimal(at.x), svg_decimal(at.y),
                        svg_number(pixels)),
            paint, title);
}

void SvgPicture::text(const PlanePoint& point, const std::string& words, const TextStyle& style) {
    Pixel at = pixel_of(point);
    const double cosine = std::cos(style.angle), sine = std::sin(style.angle);
    at.x += std::llround(kSvgUnits * (style.right * cosine - style.up * sine));
    at.y -= std::llround(kSvgUnits * (style.right * sine + style.up * cosine));
    const std::string x = svg_decimal(at.x), y = svg_decimal(at.y);
    body_ += fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\"", x, y, svg_number(style.size),
                         hexadecimal(style.colour));
    if (style.anchor != TextAnchor::start)
        body_ += style.anchor == TextAnchor::middle ? " text-anchor=\"middle\"" : " text-anchor=\"end\"";
    if (style.bold) body_ += " font-weight=\"bold\"";
    if (style.italic) body_ += " font-style=\"italic\"";
    if (style.angle != 0.0)
        body_ += fmt::format(" transform=\"rotate({} {} {})\"",
                             svg_number(-style.angle * 180.0 / std::numbers::pi), x, y);
    body_ += fmt::format(">{}</text>\n", xml_text(words));
}

void SvgPicture::open_group(const std::string& name, const std::string& attributes) {
    const std::string label = xml_text(name);
    if (open_groups_++ == 0)
        body_ += fmt::format("<g inkscape:groupmode=\"layer\" inkscape:label=\"{}\"{}>\n", label, attributes);
    else
        body_ += fmt::format("<g inkscape:label=\"{}\"{}>\n", label, attributes);
}

void SvgPicture::begin_group(const std::string& name, double opacity) {
    open_group(name, opacity_attribute(opacity));
}

void SvgPicture::begin_group(const std::string& name, const SvgPath& clip, double opacity) {
    const int number = ++clips_;
    body_ += fmt::format("<clipPath id=\"clip{}\"><path d=\"{}\"/></clipPath>\n", number, path_data(clip));
    open_group(name, fmt::format(" clip-path=\"url(#clip{})\"{}", number, opacity_attribute(opacity)));
}

void SvgPicture::end_group() {
    if (open_groups_ == 0) throw std::logic_error("no group of the picture is open");
    --open_groups_;
    body_ += "</g>\n";
}

void SvgPicture::set_title(const std::string& title) {
    title_ = title;
}

std::string SvgPicture::document() const {
    const std::string width = svg_number(width_), height = svg_number(height_);
    std::string text = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" "
        "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" "
        "width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\" "
        "stroke-linejoin=\"round\" stroke-linecap=\"round\">\n",
        width, height);
    return text + contents() + "</svg>\n";
}

std::string SvgPicture::contents() const {
    std::string text = title_.empty() ? "" : fmt::format("<title>{}</title>\n", xml_text(title_));
    text += "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" + body_;
    for (int i = 0; i < open_groups_; ++i) text += "</g>\n";
    return text;
}

std::string SvgPicture::embedded(const std::string& prefix) const {
    const std::string width = svg_number(width_), height = svg_number(height_);
    std::string inner = contents();
    for (int clip = clips_; clip > 0; --clip)
        for (const char* const form : {"id=\"clip{}\"", "url(#clip{})"}) {
            const std::string from = fmt::format(fmt::runtime(form), clip);
            std::string to = from;
            to.replace(to.find("clip"), 0, prefix);
            for (std::size_t at = inner.find(from); at != std::string::npos;
                 at = inner.find(from, at + to.size()))
                inner.replace(at, from.size(), to);
        }
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" viewBox=\"0 0 {0} {1}\" "
        "style=\"max-width:{0}px\" "
        "font-family=\"sans-serif\" stroke-linejoin=\"round\" stroke-linecap=\"round\" data-scale=\"{2}\" "
        "data-left=\"{3}\" data-top=\"{4}\">\n{5}</svg>\n",
        width, height, scale_, left_, top_, inner);
}

void SvgPicture::save(const std::string& path) const {
    write_text_durably(path, document());
}

}  // namespace ricci
