// Which vector instructions this processor has: one binary, the best code on each machine.
#pragma once

#include <cstdint>
#include <string_view>

namespace ricci {

/// Ascending. baseline: plain x86-64 (or another architecture); avx2 comes with FMA, avx512 with F, DQ, VL
/// and BW.
enum class InstructionSet : std::uint8_t { baseline, avx2, avx512 };
std::string_view name_of(InstructionSet set);

/// The best set of this processor.
InstructionSet best_instruction_set();

/// The set called `name`, or `best` where that is less. Throws std::invalid_argument for an unknown name.
InstructionSet lowered(InstructionSet best, std::string_view name);

/// The best set of this processor, or the lesser one that the environment variable RICCI_INSTRUCTION_SET
/// (baseline, avx2, avx512) names: read once. Results of different sets differ by rounding. Throws
/// std::invalid_argument where the variable holds anything else.
InstructionSet instruction_set();

}  // namespace ricci
