// Comparing result files bit for bit.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "io/store/hdf5_file.h"

namespace ricci::testing {

inline void collect_digests(hid_t group, const std::string& prefix,
                            std::map<std::string, std::uint64_t>& all) {
    for (const std::string& name : hdf5::link_names(group)) {
        if (name == "seconds") continue;
        std::string path = prefix;
        path.append("/").append(name);
        const hdf5::Handle object(H5Oopen(group, name.c_str(), H5P_DEFAULT), name);
        if (H5Iget_type(object) == H5I_GROUP) {
            collect_digests(object, path, all);
        } else {
            all[path] = hdf5::Input(group, name).digest();
        }
    }
}

/// Checksum of every dataset's values but those named seconds, by path: equal maps, equal bits.
inline std::map<std::string, std::uint64_t> digests(const std::string& path) {
    const hdf5::Session session;
    const hdf5::Handle file = hdf5::open_input(path);
    std::map<std::string, std::uint64_t> all;
    collect_digests(file, "", all);
    return all;
}

}  // namespace ricci::testing
