#include "io/store/hdf5_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "io/store/durable.h"

namespace ricci::hdf5 {
namespace {

std::recursive_mutex& session_mutex() {
    static std::recursive_mutex mutex;
    return mutex;
}

herr_t first_message(unsigned /*depth*/, const H5E_error2_t* error, void* text) {
    auto& message = *static_cast<std::string*>(text);
    if (message.empty() && error->desc != nullptr) message = error->desc;
    return 0;
}

}  // namespace

Session::Session() : lock_(session_mutex()) {
    H5Eget_auto2(H5E_DEFAULT, &printer_, &printer_data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    // A file names the filters it wants: none of them is to be loaded from wherever HDF5 looks for plugins.
    static const bool no_plugins = H5PLset_loading_state(0) >= 0;
    if (!no_plugins) throw FileError("HDF5 cannot be kept from loading plugins");
}

Session::~Session() {
    H5Eset_auto2(H5E_DEFAULT, printer_, printer_data_);
}

hid_t check(hid_t result, const std::string& what) {
    if (result >= 0) return result;
    std::string message;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, first_message, &message);
    H5Eclear2(H5E_DEFAULT);
    throw FileError(message.empty() ? what : what + ": " + message);
}

Handle::Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}

Handle& Handle::operator=(Handle&& other) noexcept {
    if (this != &other) {
        reset();
        id_ = std::exchange(other.id_, H5I_INVALID_HID);
    }
    return *this;
}

void Handle::reset() {
    if (id_ < 0) return;
    switch (H5Iget_type(id_)) {
        case H5I_FILE:
            H5Fclose(id_);
            break;
        case H5I_GROUP:
            H5Gclose(id_);
            break;
        case H5I_DATATYPE:
            H5Tclose(id_);
            break;
        case H5I_DATASPACE:
            H5Sclose(id_);
            break;
        case H5I_DATASET:
            H5Dclose(id_);
            break;
        case H5I_ATTR:
            H5Aclose(id_);
            break;
        case H5I_GENPROP_LST:
            H5Pclose(id_);
            break;
        default:
            break;  // closed already, with its file
    }
    id_ = H5I_INVALID_HID;
}

OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), path_);
    // Version 2 object headers carry checksums of their own; every HDF5 since 1.8 reads them.
    check(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18), path_);
    use_checked_driver(access, outcome_);
    const Handle creation(H5Pcreate(H5P_FILE_CREATE), path_);
    check(H5Pset_obj_track_times(creation, false), path_);
    const hid_t file = H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, creation, access);
    if (file < 0 && outcome_.error_number != 0)
        throw system_error(path_, "cannot create", outcome_.error_number);
    file_ = Handle(file, path_ + ": cannot create");
}

OutputFile::~OutputFile() {
    // Nobody will read what is abandoned: let the driver drop the rest instead of writing it.
    if (file_ >= 0 && outcome_.error_number == 0) outcome_.error_number = ECANCELED;
    file_.reset();
}

void OutputFile::check_writes() const {
    if (outcome_.error_number != 0) throw system_error(path_, "cannot write", outcome_.error_number);
}

void OutputFile::flush() {
    const herr_t flushed = H5Fflush(file_, H5F_SCOPE_LOCAL);
    check_writes();
    check(flushed, "cannot flush");
}

void OutputFile::close() {
    flush();
    const hid_t file = file_;
    check(H5Fclose(file), "cannot close");
    file_.reset();  // the identifier is gone
    check_writes();
    sync_path(path_);
}

void write_file(const std::string& path, const std::function<void(OutputFile&)>& fill) {
    try {
        OutputFile file(path);
        try {
            fill(file);
            file.close();
        } catch (const FileError& error) {
            file.check_writes();  // a failed system call explains what HDF5 stumbled over
            const std::string what = error.what();
            throw FileError(what.starts_with(path) ? what : path + ": " + what);
        }
    } catch (...) {
        ::unlink(path.c_str());
        throw;
    }
}

Handle open_input(const std::string& path) {
    if (::access(path.c_str(), R_OK) != 0) throw system_error(path, "cannot open", errno);
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), path);
    check(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), path);
    // Result files never change in place: nothing to lock, and some file systems cannot.
    check(H5Pset_file_locking(access, false, true), path);
    return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), path + ": cannot open as HDF5"};
}

Handle create_group(hid_t parent, const std::string& name) {
    const Handle creation(H5Pcreate(H5P_GROUP_CREATE), name);
    check(H5Pset_obj_track_times(creation, false), name);
    check(H5Pset_link_creation_order(creation, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED), name);
    return {H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT),
            "cannot create group " + name};
}

Handle open_group(hid_t parent, const std::string& name) {
    const std::string what =
        name_of(parent) + ": no group " + name;  // before the call: asking forgets errors
    return {H5Gopen2(parent, name.c_str(), H5P_DEFAULT), what};
}

bool has_link(hid_t parent, const std::string& name) {
    return H5Lexists(parent, name.c_str(), H5P_DEFAULT) > 0;
}

bool has_attribute(hid_t object, const std::string& name) {
    return H5Aexists(object, name.c_str()) > 0;
}

std::vector<std::string> link_names(hid_t group) {
    const std::string where = name_of(group);
    const Handle opened(H5Gopen2(group, ".", H5P_DEFAULT), where);  // a file's identifier is no group's
    const Handle creation(H5Gget_create_plist(opened), where);
    unsigned order = 0;
    check(H5Pget_link_creation_order(creation, &order), where);
    const bool created = (order & H5P_CRT_ORDER_INDEXED) != 0;
    // In the order of storage: asked for any other, HDF5 1.10 first makes a table of all links, and frees
    // what it never filled when a read fails in the middle of that.
    std::vector<std::pair<std::int64_t, std::string>> links;
    const auto collect = [](hid_t, const char* name, const H5L_info_t* link, void* list) -> herr_t {
        static_cast<decltype(links)*>(list)->emplace_back(link->corder, name);
        return 0;
    };
    hsize_t start = 0;
    check(H5Literate(group, created ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME, H5_ITER_NATIVE, &start, collect,
                     &links),
          where + ": cannot list");
    std::sort(links.begin(), links.end(), [&](const auto& x, const auto& y) {
        return created ? x.first < y.first : x.second < y.second;
    });
    std::vector<std::string> names;
    for (auto& [number, name] : links) names.push_back(std::move(name));
    return names;
}

std::string name_of(hid_t object) {
    const ssize_t length = H5Iget_name(object, nullptr, 0);
    if (length <= 0) return "?";
    std::string name(static_cast<std::size_t>(length) + 1, '\0');
    H5Iget_name(object, name.data(), name.size());
    name.pop_back();
    return name;
}

}  // namespace ricci::hdf5
