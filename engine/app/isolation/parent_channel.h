// The child's end of the socket to its parent.
#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "engine/app/isolation/message.h"
#include "io/store/durable.h"

namespace ricci::app {

/// Thread-safe. When the parent is gone the process ends at once: nobody would take its results.
class ParentChannel {
  public:
    /// Takes over the socket at stdin, which becomes /dev/null.
    ParentChannel();

    /// The first message. Not beside ask().
    std::string job();
    void send(std::uint32_t kind, std::string_view bytes);
    /// Sends, and waits for the answer.
    std::string ask(std::uint32_t kind, std::string_view bytes);
    /// From time to time while work goes on: tells the parent so, and hears how many threads may work.
    void pulse();
    [[nodiscard]] int threads() const;
    void set_threads(int threads);

  private:
    std::string wait_for(std::uint32_t kind);
    void receive(bool wait);
    void take(const Frame& frame);

    mutable std::mutex mutex_;
    FileDescriptor socket_;
    FrameAssembler assembler_;
    std::vector<Frame> arrived_;
    int threads_ = 1;
    std::chrono::steady_clock::time_point last_pulse_ = std::chrono::steady_clock::now();
};

}  // namespace ricci::app
