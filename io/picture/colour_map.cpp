#include "io/picture/colour_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace ricci {
namespace {

constexpr std::size_t kTableSize = 255;  // odd: the middle of a diverging map is an entry
using Table = std::array<Colour, kTableSize>;

constexpr std::array<Colour, 10> kSequential = {{{0x44, 0x01, 0x54},
                                                 {0x48, 0x28, 0x78},
                                                 {0x3e, 0x49, 0x89},
                                                 {0x31, 0x68, 0x8e},
                                                 {0x26, 0x82, 0x8e},
                                                 {0x1f, 0x9e, 0x89},
                                                 {0x35, 0xb7, 0x79},
                                                 {0x6d, 0xcd, 0x59},
                                                 {0xb4, 0xde, 0x2c},
                                                 {0xfd, 0xe7, 0x25}}};

// Lightness by hand, so that it falls evenly and alike on both sides.
constexpr std::array<LabColour, 5> kDiverging = {
    {{32.0, 10.0, -46.0}, {64.0, -8.0, -32.0}, {96.0, 0.0, 0.0}, {64.0, 24.0, 50.0}, {32.0, 26.0, 42.0}}};

LabColour between(const LabColour& a, const LabColour& b, double t) {
    return {std::lerp(a.lightness, b.lightness, t), std::lerp(a.a, b.a, t), std::lerp(a.b, b.b, t)};
}

Table table_of(std::span<const LabColour> knots) {
    Table table;
    for (std::size_t i = 0; i < kTableSize; ++i) {
        const double t = static_cast<double>(i * (knots.size() - 1)) / static_cast<double>(kTableSize - 1);
        const std::size_t knot = std::min(static_cast<std::size_t>(t), knots.size() - 2);
        table[i] = colour_of(between(knots[knot], knots[knot + 1], t - static_cast<double>(knot)));
    }
    return table;
}

const Table& table_of(ColourMap map) {
    static const Table sequential = [] {
        std::array<LabColour, kSequential.size()> knots;
        std::transform(kSequential.begin(), kSequential.end(), knots.begin(), lab_of);
        return table_of(knots);
    }();
    static const Table diverging = table_of(std::span<const LabColour>(kDiverging));
    return map == ColourMap::sequential ? sequential : diverging;
}

}  // namespace

Colour colour_at(ColourMap map, double t) {
    if (std::isnan(t)) return kGrey;
    const double entry = std::clamp(t, 0.0, 1.0) * static_cast<double>(kTableSize - 1);
    return table_of(map)[static_cast<std::size_t>(std::lround(entry))];
}

void draw_colour_bar(SvgPicture& picture, const ColourScale& scale, const ViewBox& box,
                     const std::string& title, double text_size) {
    picture.begin_group("colour bar");
    const double right = box.left + box.width, top = box.bottom + box.height;
    // Each piece reaches to the top and is painted over by the next: no seams between them.
    constexpr int kPieces = 128;
    for (int i = 0; i < kPieces; ++i) {
        const double y = box.bottom + box.height * i / kPieces;
        const std::array<PlanePoint, 4> piece = {{{box.left, y}, {right, y}, {right, top}, {box.left, top}}};
        picture.polygon(piece, filled(colour_at(scale.map, (i + 0.5) / kPieces)));
    }
    const std::array<PlanePoint, 4> frame = {
        {{box.left, box.bottom}, {right, box.bottom}, {right, top}, {box.left, top}}};
    picture.polygon(frame, stroked(kBlack, 0.5));
    TextStyle style;
    style.size = text_size;
    style.right = 7.0;
    style.up = -0.35 * text_size;  // half the height of a digit
    const double height = box.height * picture.scale();
    for (const double tick : scale.axis.ticks(std::max(2, static_cast<int>(height / (3.0 * text_size))))) {
        const double y = box.bottom + box.height * std::clamp(scale.axis.fraction_of(tick), 0.0, 1.0);
        picture.line({right, y}, {right + 4.0 / picture.scale(), y}, stroked(kBlack, 0.5));
        picture.text({right, y}, tick_label(tick), style);
    }
    style.right = 0.0;
    style.up = 0.6 * text_size;
    if (!title.empty()) picture.text({box.left, top}, title, style);
    picture.end_group();
}

}  // namespace ricci
