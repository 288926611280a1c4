#include "io/exchange/staged_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <utility>

namespace ricci {
namespace {

constexpr std::size_t kBuffer = std::size_t{1} << 20U;

}  // namespace

StagedFile::StagedFile(std::string path)
    : path_(std::move(path)),
      temporary_(path_ + ".tmp"),
      file_(open_file(temporary_, O_WRONLY | O_CREAT | O_TRUNC)) {}

StagedFile::~StagedFile() {
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void StagedFile::write(std::string_view bytes) {
    position_ += bytes.size();
    if (bytes.size() >= kBuffer) {
        flush();
        write_all(file_.get(), bytes, temporary_);
        return;
    }
    buffer_ += bytes;
    if (buffer_.size() >= kBuffer) flush();
}

void StagedFile::flush() {
    write_all(file_.get(), buffer_, temporary_);
    buffer_.clear();
}

void StagedFile::close() {
    flush();
    sync_file(file_.get(), temporary_);
    rename_durably(temporary_, path_);
    temporary_.clear();
}

}  // namespace ricci
