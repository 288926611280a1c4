// The style, the scripts and the library of a page, as they are built into the program.
#pragma once

#include <string_view>

namespace ricci::app {

std::string_view report_css();     // engine/app/report/assets/report.css
std::string_view report_script();  // engine/app/report/assets/report.js
std::string_view three_script();   // three.js, minified
std::string_view three_extras();   // its orbit controls and wide lines

}  // namespace ricci::app
