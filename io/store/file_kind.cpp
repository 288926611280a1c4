#include "io/store/file_kind.h"

#include "io/store/foreign_file.h"
#include "io/store/schema_index.h"

namespace ricci {

std::string kind_of_file(const std::string& path) {
    const hdf5::Session session;
    return schema::read_kind(hdf5::open_foreign(path));
}

}  // namespace ricci
