#include "kernels/instruction_set.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace ricci {
namespace {

constexpr InstructionSet kSets[] = {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512};
constexpr const char* kVariable = "RICCI_INSTRUCTION_SET";

}  // namespace

std::string_view name_of(InstructionSet set) {
    switch (set) {
        case InstructionSet::avx2:
            return "avx2";
        case InstructionSet::avx512:
            return "avx512";
        case InstructionSet::baseline:
            break;
    }
    return "baseline";
}

InstructionSet best_instruction_set() {
#if defined(__GNUC__) && defined(__x86_64__)
    __builtin_cpu_init();
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return InstructionSet::baseline;
    const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
    return wide ? InstructionSet::avx512 : InstructionSet::avx2;
#else
    return InstructionSet::baseline;
#endif
}

InstructionSet lowered(InstructionSet best, std::string_view name) {
    for (const InstructionSet set : kSets)
        if (name == name_of(set)) return std::min(set, best);
    throw std::invalid_argument(std::string(kVariable) + "=" + std::string(name) +
                                ": not one of baseline, avx2, avx512");
}

InstructionSet instruction_set() {
    static const InstructionSet chosen = [] {
        const char* name = std::getenv(kVariable);  // NOLINT(concurrency-mt-unsafe): nobody sets it
        const InstructionSet best = best_instruction_set();
        return name == nullptr ? best : lowered(best, name);
    }();
    return chosen;
}

}  // namespace ricci
