#include "tests/fuzz/fuzz_targets.h"

#include <array>

namespace ricci::fuzz {

std::span<const Target> targets() {
    static constexpr std::array<Target, 11> kTargets = {{{"obj", read_obj},
                                                         {"off", read_off},
                                                         {"ply", read_ply},
                                                         {"stl", read_stl},
                                                         {"len", read_len},
                                                         {"gzip", read_gzip},
                                                         {"configuration", read_configuration},
                                                         {"lists", read_lists},
                                                         {"journal", read_journal_file},
                                                         {"hdf5_bytes", read_hdf5_bytes},
                                                         {"hdf5_contents", read_hdf5_contents}}};
    return kTargets;
}

}  // namespace ricci::fuzz
