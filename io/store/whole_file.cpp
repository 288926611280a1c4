#include "io/store/whole_file.h"

#include <unistd.h>

#include "io/store/durable.h"
#include "io/store/foreign_file.h"
#include "io/store/schema.h"
#include "io/store/schema_index.h"
#include "io/store/verify_file.h"

namespace ricci::schema {

void write_whole_file(const std::string& path, const RunInfo& info, const std::string& kind,
                      const std::function<void(hid_t)>& fill) {
    const std::string temporary = path + ".tmp";
    try {
        {
            const hdf5::Session session;
            hdf5::write_file(temporary, [&](hdf5::OutputFile& file) {
                hdf5::write_text_attribute(file.root(), "kind", kind);
                write_run_info(file.root(), info, now());
                fill(file.root());
                file.flush();
                hdf5::write_attribute<std::int32_t>(file.root(), "complete", 1);
            });
        }
        const std::vector<std::string> complaints = verify_result_file(temporary);
        if (!complaints.empty()) throw FileError(temporary + ": read back wrong: " + complaints.front());
        rename_durably(temporary, path);
    } catch (...) {
        ::unlink(temporary.c_str());
        throw;
    }
}

void read_whole_file(const std::string& path, const std::string& kind,
                     const std::function<void(hid_t)>& read) {
    try {
        const hdf5::Handle file = hdf5::open_foreign(path);
        if (read_kind(file) != kind)
            throw FileError("holds no " + kind +
                            (read_kind(file).empty() ? ", but results" : ", but " + read_kind(file)));
        read(file);
    } catch (const FileError& error) {
        const std::string what = error.what();
        throw FileError(what.starts_with(path) ? what : path + ": " + what);
    }
}

}  // namespace ricci::schema
