#include "io/store/whole_file.h"

#include <unistd.h>

#include "io/store/durable.h"
#include "io/store/schema.h"
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

}  // namespace ricci::schema
