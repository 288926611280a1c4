// The entry of one fuzz target for libFuzzer; RICCI_FUZZ_TARGET is its function.
#include <spdlog/spdlog.h>

#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/allocation_meter.h"
#include "tests/fuzz/fuzz_targets.h"

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    spdlog::set_level(spdlog::level::off);
    ricci::fuzz::AllocationMeter::make_fatal();
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        ricci::fuzz::RICCI_FUZZ_TARGET({data, size});
    } catch (const std::exception& error) {
        std::fprintf(stderr, "FINDING: %s\n", error.what());
        std::abort();
    }
    return 0;
}
