#include "tests/fuzz/allocation_meter.h"

#include <malloc.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <new>

namespace ricci::fuzz {
namespace {

constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
std::atomic<std::size_t> live = 0, peak_live = 0, limit_live = kNoLimit;
std::atomic<bool> fatal = false;

void* take(std::size_t bytes, std::size_t alignment) {
    if (live.load() + bytes > limit_live.load() && bytes > 0) {
        if (fatal) {
            std::fprintf(stderr,
                         "ERROR: an allocation of %zu bytes exceeds the limit for this input (%zu live)\n",
                         bytes, live.load());
            std::abort();
        }
        return nullptr;
    }
    void* memory = alignment == 0
                       ? std::malloc(bytes == 0 ? 1 : bytes)
                       : std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
    if (memory == nullptr) return nullptr;
    const std::size_t now = live += ::malloc_usable_size(memory);
    std::size_t highest = peak_live.load();
    while (now > highest && !peak_live.compare_exchange_weak(highest, now)) {
    }
    return memory;
}

void* take_or_throw(std::size_t bytes, std::size_t alignment) {
    if (void* memory = take(bytes, alignment)) return memory;
    throw std::bad_alloc();
}

void give_back(void* memory) {
    if (memory == nullptr) return;
    live -= ::malloc_usable_size(memory);
    std::free(memory);
}

}  // namespace

AllocationMeter::AllocationMeter(std::size_t limit) : start_(live.load()) {
    peak_live = start_;
    limit_live = limit > kNoLimit - start_ ? kNoLimit : start_ + limit;
}

AllocationMeter::~AllocationMeter() {
    limit_live = kNoLimit;
}

std::size_t AllocationMeter::peak() const {
    return peak_live.load() - start_;
}

void AllocationMeter::make_fatal() {
    fatal = true;
}

}  // namespace ricci::fuzz

using ricci::fuzz::give_back;
using ricci::fuzz::take;
using ricci::fuzz::take_or_throw;

// NOLINTBEGIN(misc-new-delete-overloads): all of them are here
void* operator new(std::size_t bytes) {
    return take_or_throw(bytes, 0);
}
void* operator new[](std::size_t bytes) {
    return take_or_throw(bytes, 0);
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
    return take(bytes, 0);
}
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
    return take(bytes, 0);
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
    return take_or_throw(bytes, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
    return take_or_throw(bytes, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t bytes, std::align_val_t alignment, const std::nothrow_t&) noexcept {
    return take(bytes, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment, const std::nothrow_t&) noexcept {
    return take(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    give_back(memory);
}
void operator delete[](void* memory) noexcept {
    give_back(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    give_back(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
    give_back(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
    give_back(memory);
}
void operator delete[](void* memory, const std::nothrow_t&) noexcept {
    give_back(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    give_back(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
    give_back(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    give_back(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
    give_back(memory);
}
void operator delete(void* memory, std::align_val_t, const std::nothrow_t&) noexcept {
    give_back(memory);
}
void operator delete[](void* memory, std::align_val_t, const std::nothrow_t&) noexcept {
    give_back(memory);
}
// NOLINTEND(misc-new-delete-overloads)
