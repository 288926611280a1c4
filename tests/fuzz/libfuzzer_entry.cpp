// The entry of one fuzz target for libFuzzer; RICCI_FUZZ_TARGET is its function.
#include <spdlog/spdlog.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/allocation_meter.h"
#include "tests/fuzz/fuzz_targets.h"

namespace {

std::uint64_t bytes_read = 0;

/// Beside libFuzzer's own figures; tests/fuzz/run adds them up.
void print_bytes() {
    std::fprintf(stderr, "stat::bytes_read: %llu\n", static_cast<unsigned long long>(bytes_read));
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    std::atexit(print_bytes);
    spdlog::set_level(spdlog::level::off);
    ricci::fuzz::AllocationMeter::make_fatal();
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    bytes_read += size;
    try {
        ricci::fuzz::RICCI_FUZZ_TARGET({data, size});
    } catch (const std::exception& error) {
        std::fprintf(stderr, "FINDING: %s\n", error.what());
        std::abort();
    }
    return 0;
}
