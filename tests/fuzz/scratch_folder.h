// A folder of the process's own for the files that a target writes.
#pragma once

#include <filesystem>
#include <string>

namespace ricci::fuzz {

/// In memory where the machine has such a place; removed when the process ends.
class ScratchFolder {
  public:
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }
    /// Removes what `name` names, folder or file.
    void remove(const std::string& name) const;

  private:
    std::string path_;
};
const ScratchFolder& scratch_folder();

}  // namespace ricci::fuzz
