// What a parent and its child processes say to each other: frames with a checksum on a pipe. A child that is
// about to crash may write anything, so the parent believes whole frames with a right checksum only, and
// reads their contents with bounds.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "io/store/run_store.h"
#include "io/store/shape_index.h"

namespace ricci::app {

/// What a child wrote is not what it should have.
class ProtocolError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Appends values to a message; MessageReader takes them out in the same order.
class MessageWriter {
  public:
    template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T> MessageWriter& put(const T& value) {
        bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
        return *this;
    }
    MessageWriter& put(std::string_view text) { return put(std::span(text.data(), text.size())); }
    MessageWriter& put(const std::string& text) { return put(std::string_view(text)); }
    MessageWriter& put(const char* text) { return put(std::string_view(text)); }
    template <class T>
    requires std::is_trivially_copyable_v<T> MessageWriter& put(std::span<T> values) {
        put(static_cast<std::uint64_t>(values.size()));
        bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
        return *this;
    }
    template <class T>
    requires std::is_trivially_copyable_v<T> MessageWriter& put(const std::vector<T>& values) {
        return put(std::span(values));
    }
    MessageWriter& put(const FailureRecord& failure);
    MessageWriter& put(const ItemRecord& item);
    MessageWriter& put(const SweepBlock& block);
    MessageWriter& put(const ShapeRecord& shape);

    [[nodiscard]] const std::string& bytes() const { return bytes_; }

  private:
    std::string bytes_;
};

/// Throws ProtocolError where the message ends too early.
class MessageReader {
  public:
    explicit MessageReader(std::string_view bytes) : left_(bytes) {}

    template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T> T get() {
        T value{};
        std::memcpy(&value, take(1, sizeof value).data(), sizeof value);
        return value;
    }
    template <class T>
    requires std::is_trivially_copyable_v<T> std::vector<T> get_vector() {
        const auto count = get<std::uint64_t>();
        const std::string_view bytes = take(count, sizeof(T));
        std::vector<T> values(static_cast<std::size_t>(count));
        if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
        return values;
    }
    std::string get_text();
    FailureRecord get_failure();
    ItemRecord get_item();
    SweepBlock get_block();
    ShapeRecord get_shape();
    /// Nothing may be left.
    void end() const;

  private:
    std::string_view take(std::uint64_t count, std::size_t size);

    std::string_view left_;
};

/// One message on the pipe.
struct Frame {
    std::uint32_t kind = 0;
    std::string bytes;
};

/// The bytes of a frame as they go down the pipe.
std::string framed(std::uint32_t kind, std::string_view bytes);

/// Puts frames together from pieces as they are read.
class FrameAssembler {
  public:
    void add(std::string_view piece) { buffer_ += piece; }
    /// The next whole frame. Throws ProtocolError on bytes that are none.
    std::optional<Frame> next();

  private:
    std::string buffer_;
    std::size_t start_ = 0;
};

}  // namespace ricci::app
