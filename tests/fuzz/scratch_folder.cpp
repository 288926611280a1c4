#include "tests/fuzz/scratch_folder.h"

#include <unistd.h>

#include <cstdlib>
#include <stdexcept>

namespace ricci::fuzz {

ScratchFolder::ScratchFolder() {
    const std::filesystem::path memory = "/dev/shm";
    const bool usable = std::filesystem::is_directory(memory) && ::access(memory.c_str(), W_OK) == 0;
    std::string pattern =
        ((usable ? memory : std::filesystem::temp_directory_path()) / "ricci-fuzz-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
    path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

void ScratchFolder::remove(const std::string& name) const {
    std::error_code ignored;
    std::filesystem::remove_all(file(name), ignored);
}

const ScratchFolder& scratch_folder() {
    static const ScratchFolder folder;
    return folder;
}

}  // namespace ricci::fuzz
