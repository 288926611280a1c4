// File names as people count them: frame2 before frame10.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ricci::app {

/// Whether `a` comes before `b`: runs of digits compare by their value, all else byte by byte; of names that
/// are equal so far ("1", "01") the one that is less byte by byte.
bool natural_less(std::string_view a, std::string_view b);

/// expand_inputs, but what a folder or a glob holds is in natural order. Throws as expand_inputs.
std::vector<std::string> expand_in_natural_order(const std::vector<std::string>& arguments);

}  // namespace ricci::app
