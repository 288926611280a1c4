// Text as the output files hold it.
#pragma once

#include <string>

namespace ricci::hdf5 {

/// The text as files store it: bytes that are not valid UTF-8, and NUL, become \xNN.
std::string stored_text(const std::string& text);

}  // namespace ricci::hdf5
