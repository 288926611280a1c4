// What decides the last bits of results on a machine.
#pragma once

#include <string>

namespace ricci::app {

/// "lanes avx512, OpenBLAS SkylakeX": the instruction set of the lanes, and the kernels that OpenBLAS has
/// chosen, where that is the BLAS in use. Throws std::invalid_argument as instruction_set() does.
std::string processor_kind();

}  // namespace ricci::app
