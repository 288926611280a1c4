#include "engine/app/pictures/side_style.h"

#include <array>

namespace ricci::app {
namespace {

constexpr std::array<Colour, 7> kPairColours = {{{213, 94, 0},
                                                 {0, 114, 178},
                                                 {0, 158, 115},
                                                 {204, 121, 167},
                                                 {230, 159, 0},
                                                 {86, 180, 233},
                                                 {110, 62, 20}}};
constexpr Colour kBoundary{60, 66, 78};

}  // namespace

Paint pair_paint(std::size_t k, double width) {
    Paint paint = stroked(kPairColours[k % kPairColours.size()], width);
    const std::size_t round = (k / kPairColours.size()) % 3;
    if (round == 1) paint.dashes = {3.0 * width, 2.0 * width};
    if (round == 2) paint.dashes = {0.1, 2.0 * width};  // round ends make dots of these
    return paint;
}

std::vector<int> pair_numbers(const CutGraph& cut) {
    std::vector<int> number;
    int pairs = 0;
    for (const CutSide& side : cut.sides) {
        const auto partner = static_cast<std::size_t>(side.partner);
        if (side.partner < 0)
            number.push_back(-1);
        else
            number.push_back(partner < number.size() ? number[partner] : pairs++);
    }
    return number;
}

Paint side_paint(int pair, double width) {
    return pair < 0 ? stroked(kBoundary, width) : pair_paint(static_cast<std::size_t>(pair), width);
}

std::string set_name(const std::string& name) {
    constexpr std::string_view kInverse = "^-1";
    const std::size_t tail = name.rfind(kInverse);
    if (tail == std::string::npos || tail + kInverse.size() != name.size()) return name;
    return name.substr(0, tail) + "\u207b\u00b9";
}

}  // namespace ricci::app
