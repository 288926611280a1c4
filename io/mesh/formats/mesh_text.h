// Text of written mesh files.
#pragma once

#include <charconv>
#include <string>
#include <string_view>

#include "kernels/connectivity.h"

namespace ricci {

/// Text with shortest round-trip decimals, whatever the locale.
class MeshText {
  public:
    MeshText& operator<<(std::string_view words) {
        text_ += words;
        return *this;
    }
    MeshText& operator<<(Index number) { return append(number); }
    MeshText& operator<<(double number) { return append(number); }
    [[nodiscard]] const std::string& text() const { return text_; }

  private:
    template <class Number>
    MeshText& append(Number number) {
        char buffer[32];
        const auto end = std::to_chars(buffer, buffer + sizeof buffer, number).ptr;
        text_.append(buffer, end);
        return *this;
    }
    std::string text_;
};

}  // namespace ricci
