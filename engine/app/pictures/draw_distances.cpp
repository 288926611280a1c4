#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "engine/app/pictures/distance_pictures.h"
#include "io/picture/colour_map.h"

namespace ricci::app {
namespace {

constexpr std::size_t kMaxCells = 300;  // per row
constexpr std::size_t kMaxNames = 150;  // shapes with names in the picture
constexpr double kNameSize = 9.0;       // pixels
constexpr double kMargin = 12.0, kTitle = 30.0, kBar = 14.0, kBarNumbers = 60.0;

/// Cells of the picture: runs of shapes in the order of the leaves.
struct Cells {
    std::size_t count = 0;
    std::vector<double> mean;  // count x count; NaN where nothing is known

    [[nodiscard]] double at(std::size_t row, std::size_t column) const { return mean[row * count + column]; }
};

Cells make_cells(const DistanceMatrix& distances, const std::vector<std::size_t>& order) {
    const std::size_t n = order.size();
    Cells cells;
    cells.count = std::min(n, kMaxCells);
    const auto cell_of = [&](std::size_t place) { return place * cells.count / n; };
    std::vector<double> sum(cells.count * cells.count, 0.0), number(sum.size(), 0.0);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) {
            const double d = distances(order[i], order[j]);
            if (!std::isfinite(d)) continue;
            const std::size_t cell = cell_of(i) * cells.count + cell_of(j);
            sum[cell] += d;
            number[cell] += 1.0;
        }
    for (std::size_t k = 0; k < sum.size(); ++k) cells.mean.push_back(sum[k] / number[k]);
    return cells;
}

double largest_of(const Cells& cells) {
    double largest = 0.0;
    for (const double d : cells.mean)
        if (std::isfinite(d)) largest = std::max(largest, d);
    return largest > 0.0 ? largest : 1.0;
}

std::size_t longest(const std::vector<std::string>& names) {
    std::size_t length = 0;
    for (const std::string& name : names) length = std::max(length, name.size());
    return length;
}

/// Draws one matrix; user units are pixels.
class HeatMap {
  public:
    HeatMap(const DistanceMatrix& distances, const std::vector<std::size_t>& order,
            const std::vector<std::string>& names)
        : order_(order),
          names_(names),
          cells_(make_cells(distances, order)),
          scale_{Axis(0.0, largest_of(cells_)), ColourMap::sequential},
          named_(order.size() <= kMaxNames),
          cell_(named_ ? std::clamp(600.0 / static_cast<double>(std::max<std::size_t>(cells_.count, 1)),
                                    kNameSize + 2.0, 40.0)
                       : 600.0 / static_cast<double>(cells_.count)),
          side_(cell_ * static_cast<double>(cells_.count)),
          text_(named_ ? std::min(0.6 * kNameSize * static_cast<double>(longest(names)), 320.0) + 8.0 : 0.0),
          width_(kMargin + text_ + side_ + 16.0 + kBar + kBarNumbers),
          height_(kTitle + side_ + text_ + 2.0 * kMargin),
          left_(kMargin + text_),
          top_(height_ - kTitle - kMargin) {}

    SvgPicture draw(const std::string& title) {
        SvgPicture picture = titled_picture(width_, height_, kMargin, title);
        draw_cells(picture);
        if (named_) draw_names(picture);
        const double bar = std::min(side_, 240.0);
        draw_colour_bar(picture, scale_, {left_ + side_ + 16.0, top_ - bar, kBar, bar}, "", 11.0);
        return picture;
    }

  private:
    [[nodiscard]] double x_of(std::size_t column) const {
        return left_ + cell_ * static_cast<double>(column);
    }
    [[nodiscard]] double y_of(std::size_t row) const { return top_ - cell_ * static_cast<double>(row); }

    // Cells of one colour that lie side by side are one rectangle.
    void draw_cells(SvgPicture& picture) const {
        picture.begin_group("distances");
        for (std::size_t row = 0; row < cells_.count; ++row)
            for (std::size_t begin = 0; begin < cells_.count;) {
                const Colour colour = scale_.colour_of(cells_.at(row, begin));
                std::size_t end = begin + 1;
                while (end < cells_.count && !titled() && scale_.colour_of(cells_.at(row, end)) == colour)
                    ++end;
                const std::array<PlanePoint, 4> corners = {{{x_of(begin), y_of(row + 1)},
                                                            {x_of(end), y_of(row + 1)},
                                                            {x_of(end), y_of(row)},
                                                            {x_of(begin), y_of(row)}}};
                picture.polygon(corners, filled(colour), titled() ? cell_title(row, begin) : "");
                begin = end;
            }
        picture.end_group();
    }

    [[nodiscard]] bool titled() const { return order_.size() <= 60; }
    [[nodiscard]] std::string cell_title(std::size_t row, std::size_t column) const {
        return fmt::format("{} - {}: {:.6g}", names_[order_[row]], names_[order_[column]],
                           cells_.at(row, column));
    }

    void draw_names(SvgPicture& picture) const {
        picture.begin_group("names");
        TextStyle style;
        style.size = kNameSize;
        style.anchor = TextAnchor::end;
        for (std::size_t k = 0; k < order_.size(); ++k)
            picture.text({left_ - 4.0, 0.5 * (y_of(k) + y_of(k + 1)) - 0.35 * kNameSize}, names_[order_[k]],
                         style);
        style.angle = 1.5707963267948966;  // upwards
        for (std::size_t k = 0; k < order_.size(); ++k)
            picture.text({0.5 * (x_of(k) + x_of(k + 1)) + 0.35 * kNameSize, top_ - side_ - 4.0},
                         names_[order_[k]], style);
        picture.end_group();
    }

    const std::vector<std::size_t>& order_;
    const std::vector<std::string>& names_;
    Cells cells_;
    ColourScale scale_;
    bool named_;
    double cell_, side_, text_, width_, height_, left_, top_;
};

}  // namespace

SvgPicture titled_picture(double width, double height, double margin, const std::string& title) {
    SvgPicture picture(width, height, {0.0, 0.0, width, height});
    picture.set_title(title);
    TextStyle style;
    style.size = 14.0;
    style.bold = true;
    picture.text({margin, height - 22.0}, title, style);
    return picture;
}

SvgPicture draw_distances(const DistanceMatrix& distances, const std::vector<std::size_t>& order,
                          const std::vector<std::string>& names, const std::string& title) {
    std::vector<std::size_t> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 0; i < sorted.size(); ++i)
        if (sorted[i] != i) throw std::invalid_argument("the order of the shapes does not name each once");
    if (order.empty() || order.size() != distances.size || names.size() != distances.size)
        throw std::invalid_argument("not one name and one place per shape");
    return HeatMap(distances, order, names).draw(title);
}

std::vector<std::string> short_names(const std::vector<std::string>& names) {
    if (names.empty()) return names;
    std::size_t shared = names.front().rfind('/') == std::string::npos ? 0 : names.front().rfind('/') + 1;
    for (const std::string& name : names) {
        std::size_t same = 0;
        while (same < std::min(shared, name.size()) && name[same] == names.front()[same]) ++same;
        const std::size_t slash = same == 0 ? std::string::npos : name.rfind('/', same - 1);
        shared = same == shared ? shared : (slash == std::string::npos ? 0 : slash + 1);
    }
    std::vector<std::string> cut;
    cut.reserve(names.size());
    for (const std::string& name : names) cut.push_back(name.substr(shared));
    return cut;
}

}  // namespace ricci::app
