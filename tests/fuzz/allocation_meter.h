// Counts what a program allocates: how much memory a reader takes for a file of a given size.
#pragma once

#include <cstddef>

namespace ricci::fuzz {

/// Bytes that operator new has handed out beyond those at its construction: at their largest, since then. One
/// at a time; counts all threads. The program's operators new and delete are those of allocation_meter.cpp.
class AllocationMeter {
  public:
    /// More than `limit` bytes at once end the program where `fatal` (a fuzzer then shows where), or make
    /// operator new throw std::bad_alloc.
    explicit AllocationMeter(std::size_t limit);
    ~AllocationMeter();
    AllocationMeter(const AllocationMeter&) = delete;
    AllocationMeter& operator=(const AllocationMeter&) = delete;

    [[nodiscard]] std::size_t peak() const;
    /// For all meters.
    static void make_fatal();

  private:
    std::size_t start_;
};

}  // namespace ricci::fuzz
