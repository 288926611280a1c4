// Ending long computations that are no solves, from outside.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>

namespace ricci {

/// What a computation that was told to end throws.
struct Cancelled : std::exception {
    [[nodiscard]] const char* what() const noexcept override { return "cancelled"; }
};

/// While it lives, cancellation_point() on this thread asks `stop`. Scopes may be nested; the innermost
/// counts.
class CancellationScope {
  public:
    explicit CancellationScope(std::function<bool()> stop);
    ~CancellationScope();
    CancellationScope(const CancellationScope&) = delete;
    CancellationScope& operator=(const CancellationScope&) = delete;

  private:
    std::function<bool()> stop_;
    const std::function<bool()>* before_;
};

/// Throws Cancelled where this thread's scope says so; nothing where there is none. Between the stages of a
/// computation, and in its long loops every few milliseconds.
void cancellation_point();

/// The same at every 2^16th count.
inline void cancellation_point(std::int64_t count) {
    if ((count & 0xffff) == 0) cancellation_point();
}

}  // namespace ricci
