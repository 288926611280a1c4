#include "engine/app/processor_kind.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "kernels/instruction_set.h"

namespace ricci::app {

std::string processor_kind() {
    std::string kind = fmt::format("lanes {}", name_of(instruction_set()));
    using CoreName = char* (*)();
    // Looked up, for the program may be linked without OpenBLAS.
    if (const auto core = reinterpret_cast<CoreName>(dlsym(RTLD_DEFAULT, "openblas_get_corename")))
        kind += fmt::format(", OpenBLAS {}", core());
    return kind;
}

}  // namespace ricci::app
