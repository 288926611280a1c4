#include "io/store/checked_driver.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "io/store/durable.h"

#if __has_include(<H5FDdevelop.h>)
#include <H5FDdevelop.h>  // HDF5 1.14 keeps the driver interface there
#endif

namespace ricci::hdf5 {
namespace {

struct DriverInfo {
    WriteOutcome* outcome;
};

// HDF5 sees the first member only.
struct CheckedFile {
    H5FD_t base;
    int fd;
    haddr_t end_of_allocation;
    haddr_t end_of_file;
    WriteOutcome* outcome;
};

CheckedFile* checked(H5FD_t* file) {
    return reinterpret_cast<CheckedFile*>(file);
}
const CheckedFile* checked(const H5FD_t* file) {
    return reinterpret_cast<const CheckedFile*>(file);
}

void remember(CheckedFile* file, int error_number) {
    if (file->outcome->error_number == 0) file->outcome->error_number = error_number;
}

H5FD_t* open_checked(const char* name, unsigned flags, hid_t access_list, haddr_t /*maximum*/) {
    const auto* info = static_cast<const DriverInfo*>(H5Pget_driver_info(access_list));
    if (info == nullptr || (flags & H5F_ACC_CREAT) == 0) return nullptr;
    const int fd = ::open(name, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd < 0) {
        info->outcome->error_number = errno;
        return nullptr;
    }
    return reinterpret_cast<H5FD_t*>(new CheckedFile{{}, fd, 0, 0, info->outcome});
}

herr_t close_checked(H5FD_t* base) {
    CheckedFile* file = checked(base);
    if (::close(file->fd) != 0) remember(file, errno);
    delete file;
    return 0;
}

int compare_checked(const H5FD_t* a, const H5FD_t* b) {
    return checked(a)->fd < checked(b)->fd ? -1 : static_cast<int>(checked(a)->fd > checked(b)->fd);
}

herr_t query_checked(const H5FD_t* /*file*/, unsigned long* flags) {
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
             H5FD_FEAT_AGGREGATE_SMALLDATA;
    return 0;
}

haddr_t allocated_checked(const H5FD_t* file, H5FD_mem_t /*type*/) {
    return checked(file)->end_of_allocation;
}

herr_t allocate_checked(H5FD_t* file, H5FD_mem_t /*type*/, haddr_t address) {
    checked(file)->end_of_allocation = address;
    return 0;
}

haddr_t end_checked(const H5FD_t* file, H5FD_mem_t /*type*/) {
    return checked(file)->end_of_file;
}

herr_t read_checked(H5FD_t* base, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t address, std::size_t size,
                    void* buffer) {
    CheckedFile* file = checked(base);
    auto* to = static_cast<char*>(buffer);
    auto offset = static_cast<off_t>(address);
    while (size > 0) {
        const ssize_t got = ::pread(file->fd, to, size, offset);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) remember(file, errno);
        if (got <= 0) {  // behind the end lie zeros, as HDF5 expects
            std::memset(to, 0, size);
            return 0;
        }
        to += got;
        offset += got;
        size -= static_cast<std::size_t>(got);
    }
    return 0;
}

herr_t write_checked(H5FD_t* base, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t address, std::size_t size,
                     const void* buffer) {
    CheckedFile* file = checked(base);
    const auto* from = static_cast<const char*>(buffer);
    auto offset = static_cast<off_t>(address);
    while (size > 0 && file->outcome->error_number == 0) {
        const ssize_t written = ::pwrite(file->fd, from, size, offset);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) {
            remember(file, errno);
            break;
        }
        from += written;
        offset += written;
        size -= static_cast<std::size_t>(written);
    }
    file->end_of_file = std::max(file->end_of_file, static_cast<haddr_t>(offset));
    return 0;
}

herr_t truncate_checked(H5FD_t* base, hid_t /*transfer*/, hbool_t /*closing*/) {
    CheckedFile* file = checked(base);
    if (file->end_of_allocation == file->end_of_file) return 0;
    if (file->outcome->error_number == 0 &&
        ::ftruncate(file->fd, static_cast<off_t>(file->end_of_allocation)) != 0)
        remember(file, errno);
    file->end_of_file = file->end_of_allocation;
    return 0;
}

H5FD_class_t driver_class() {
    H5FD_class_t driver{};
    driver.name = "ricci_checked";
    driver.maxaddr = static_cast<haddr_t>(INT64_MAX);
    driver.fc_degree = H5F_CLOSE_STRONG;
    driver.fapl_size = sizeof(DriverInfo);
    driver.open = open_checked;
    driver.close = close_checked;
    driver.cmp = compare_checked;
    driver.query = query_checked;
    driver.get_eoa = allocated_checked;
    driver.set_eoa = allocate_checked;
    driver.get_eof = end_checked;
    driver.read = read_checked;
    driver.write = write_checked;
    driver.truncate = truncate_checked;
    constexpr H5FD_mem_t kMap[H5FD_MEM_NTYPES] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(kMap), std::end(kMap), std::begin(driver.fl_map));
    return driver;
}

}  // namespace

void use_checked_driver(hid_t access_list, WriteOutcome& outcome) {
    static const H5FD_class_t driver = driver_class();
    // Registered once and kept: HDF5 drops it at exit.
    static const hid_t id = H5FDregister(&driver);
    const DriverInfo info{&outcome};
    if (id < 0 || H5Pset_driver(access_list, id, &info) < 0) throw FileError("HDF5 refuses the file driver");
}

}  // namespace ricci::hdf5
