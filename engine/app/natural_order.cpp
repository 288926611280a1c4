#include "engine/app/natural_order.h"

#include <algorithm>

#include "engine/app/console.h"

namespace ricci::app {
namespace {

bool digit(char c) {
    return c >= '0' && c <= '9';
}

/// The digits at the front without leading zeros; removes them from `text`.
std::string_view take_number(std::string_view& text) {
    const std::size_t end =
        static_cast<std::size_t>(std::find_if_not(text.begin(), text.end(), digit) - text.begin());
    std::string_view number = text.substr(0, end);
    text.remove_prefix(end);
    number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
    return number;
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
    std::string_view x = a, y = b;
    while (!x.empty() && !y.empty()) {
        if (digit(x.front()) && digit(y.front())) {
            const std::string_view m = take_number(x), n = take_number(y);
            if (m.size() != n.size()) return m.size() < n.size();
            if (m != n) return m < n;
            continue;
        }
        if (x.front() != y.front())
            return static_cast<unsigned char>(x.front()) < static_cast<unsigned char>(y.front());
        x.remove_prefix(1);
        y.remove_prefix(1);
    }
    return x.empty() != y.empty() ? x.empty() : a < b;
}

std::vector<std::string> expand_in_natural_order(const std::vector<std::string>& arguments) {
    std::vector<std::string> files;
    for (const std::string& argument : arguments) {
        std::vector<std::string> found = expand_inputs({argument});
        std::sort(found.begin(), found.end(), natural_less);
        files.insert(files.end(), found.begin(), found.end());
    }
    return files;
}

}  // namespace ricci::app
