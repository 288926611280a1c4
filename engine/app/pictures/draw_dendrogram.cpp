#include <algorithm>
#include <array>
#include <stdexcept>

#include "engine/app/pictures/distance_pictures.h"
#include "io/picture/axis.h"
#include "io/picture/colour.h"

namespace ricci::app {
namespace {

constexpr std::size_t kMaxNames = 400;                          // shapes with names in the picture
constexpr double kNameSize = 9.0, kRow = 12.0, kThinRow = 2.0;  // pixels
constexpr double kMargin = 16.0, kTitle = 34.0, kAxis = 40.0, kTree = 440.0;

/// Draws one tree; user units are pixels.
class TreeDrawing {
  public:
    TreeDrawing(const Dendrogram& tree, const std::vector<std::size_t>& clusters,
                const std::vector<std::string>& names)
        : tree_(tree),
          clusters_(clusters),
          names_(names),
          named_(tree.leaves <= kMaxNames),
          row_(named_ ? kRow : kThinRow),
          width_(2.0 * kMargin + kTree + text_width()),
          height_(kTitle + kAxis + kMargin + row_ * static_cast<double>(tree.leaves)),
          heights_(0.0, top_height()) {}

    SvgPicture draw(const std::string& title) {
        SvgPicture picture = titled_picture(width_, height_, kMargin, title);
        place_clusters();
        draw_axis(picture);
        draw_branches(picture);
        if (named_) draw_names(picture);
        return picture;
    }

  private:
    [[nodiscard]] double text_width() const {
        std::size_t longest = 0;
        if (named_)
            for (const std::string& name : names_) longest = std::max(longest, name.size());
        return std::min(0.6 * kNameSize * static_cast<double>(longest), 400.0) + 8.0;
    }
    [[nodiscard]] double top_height() const {
        const double top = tree_.merges.empty() ? 0.0 : tree_.merges.back().height;
        return top > 0.0 ? 1.02 * top : 1.0;
    }
    [[nodiscard]] double x_of(double height) const {
        return kMargin + kTree * (1.0 - heights_.fraction_of(height));
    }
    [[nodiscard]] double height_of(std::size_t cluster) const {
        return cluster < tree_.leaves ? 0.0 : tree_.merges[cluster - tree_.leaves].height;
    }

    // Leaves at equal distances, a merge in the middle of its two clusters.
    void place_clusters() {
        y_.assign(tree_.leaves, 0.0);
        const std::vector<std::size_t> order = leaf_order(tree_);
        for (std::size_t k = 0; k < order.size(); ++k)
            y_[order[k]] = height_ - kTitle - row_ * (static_cast<double>(k) + 0.5);
        group_.assign(clusters_.begin(), clusters_.end());
        for (const Merge& merge : tree_.merges) {
            y_.push_back(0.5 * (y_[merge.first] + y_[merge.second]));
            group_.push_back(group_[merge.first] == group_[merge.second] ? group_[merge.first] : kMixed);
        }
    }

    [[nodiscard]] Colour colour_of(std::size_t cluster) const {
        const std::size_t group = group_[cluster];
        return group == kMixed ? kGrey : kCategoryColours[group % kCategoryColours.size()];
    }

    void draw_branches(SvgPicture& picture) const {
        picture.begin_group("tree");
        const double width = named_ ? 1.2 : 0.7;
        for (std::size_t k = 0; k < tree_.merges.size(); ++k) {
            const Merge& merge = tree_.merges[k];
            const double x = x_of(merge.height);
            for (const std::size_t child : {merge.first, merge.second}) {
                const std::array<PlanePoint, 3> branch = {
                    {{x, y_[tree_.leaves + k]}, {x, y_[child]}, {x_of(height_of(child)), y_[child]}}};
                const bool whole = group_[tree_.leaves + k] != kMixed || group_[child] == kMixed;
                picture.polyline(branch,
                                 stroked(whole ? colour_of(tree_.leaves + k) : colour_of(child), width));
            }
        }
        picture.end_group();
    }

    void draw_names(SvgPicture& picture) const {
        picture.begin_group("names");
        TextStyle style;
        style.size = kNameSize;
        for (std::size_t i = 0; i < tree_.leaves; ++i) {
            style.colour = colour_of(i);
            picture.text({x_of(0.0) + 5.0, y_[i] - 0.35 * kNameSize}, names_[i], style);
        }
        picture.end_group();
    }

    void draw_axis(SvgPicture& picture) const {
        picture.begin_group("axis");
        const Paint thin = stroked(kBlack, 0.75);
        const double y = kAxis - 6.0;
        picture.line({x_of(heights_.high()), y}, {x_of(0.0), y}, thin);
        TextStyle style;
        style.size = 10.0;
        style.anchor = TextAnchor::middle;
        for (const double tick : heights_.ticks(6)) {
            picture.line({x_of(tick), y}, {x_of(tick), y - 4.0}, thin);
            picture.text({x_of(tick), y - 15.0}, tick_label(tick), style);
        }
        picture.text({kMargin + 0.5 * kTree, 6.0}, "distance", style);
        picture.end_group();
    }

    static constexpr std::size_t kMixed = static_cast<std::size_t>(-1);
    const Dendrogram& tree_;
    const std::vector<std::size_t>& clusters_;
    const std::vector<std::string>& names_;
    bool named_;
    double row_, width_, height_;
    Axis heights_;
    std::vector<double> y_;           // of every cluster
    std::vector<std::size_t> group_;  // flat cluster that holds it whole
};

}  // namespace

SvgPicture draw_dendrogram(const Dendrogram& tree, const std::vector<std::size_t>& clusters,
                           const std::vector<std::string>& names, const std::string& title) {
    if (tree.leaves == 0 || clusters.size() != tree.leaves || names.size() != tree.leaves)
        throw std::invalid_argument("not one name and one cluster per shape");
    return TreeDrawing(tree, clusters, names).draw(title);
}

}  // namespace ricci::app
